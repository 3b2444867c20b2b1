//! Hands the compiler's version to the program: a report says what its numbers were built with.

use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    let rustc = std::env::var("RUSTC").unwrap_or_else(|_| "rustc".to_owned());
    let version = Command::new(rustc).arg("--version").output();
    if let Some(text) = version.ok().and_then(|output| String::from_utf8(output.stdout).ok()) {
        println!("cargo::rustc-env=VIVACE_RUSTC_VERSION={}", text.trim());
    }
    for name in ["TARGET", "PROFILE"] {
        if let Ok(value) = std::env::var(name) {
            println!("cargo::rustc-env=VIVACE_{name}={value}");
        }
    }
}
