//! The built program. The steps themselves take minutes and include this test: a stand-in for cargo shows what is asked of it.

#![cfg(unix)]
#![expect(clippy::unwrap_used, reason = "helpers of tests")]

use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use tempfile::TempDir;

/// What the program said.
struct Said {
    code: i32,
    out: String,
    err: String,
}

/// A folder in which the program runs.
struct Bench(TempDir);

impl Bench {
    fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn command(&self, args: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_verify"));
        command.args(args).current_dir(self.0.path()).stdin(Stdio::null());
        command
    }
}

fn said(command: &mut Command) -> Said {
    let output = command.output().unwrap();
    let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
    Said { code: output.status.code().unwrap(), out: text(output.stdout), err: text(output.stderr) }
}

#[test]
fn what_it_does_not_know_is_refused_with_its_usage() {
    let bench = Bench::new();
    let unknown = said(&mut bench.command(&["--setpu"]));
    assert_eq!(unknown.code, 2);
    assert!(unknown.err.contains("'--setpu'") && unknown.err.contains("--setup"), "{}", unknown.err);
    let help = said(&mut bench.command(&["--help"]));
    assert!(help.code == 0 && help.out.contains("--setup"), "{}", help.out);
}

fn script(bench: &Bench, name: &str, body: &str) {
    let path = bench.path(name);
    std::fs::write(&path, format!("#!/bin/sh\n{body}\n")).unwrap();
    std::fs::set_permissions(&path, std::fs::Permissions::from_mode(0o755)).unwrap();
}

fn with_cargo(body: &str) -> (Bench, Said) {
    let bench = Bench::new();
    script(&bench, "cargo", body);
    let mut command = bench.command(&[]);
    command.env("CARGO", bench.path("cargo")).env("LOG", bench.path("log")).env_remove("RUSTDOCFLAGS");
    let said = said(&mut command);
    (bench, said)
}

const LOGGED: &str = r#"case "$*" in *--version) ;; *) echo "$RUSTDOCFLAGS|$*" >> "$LOG" ;; esac"#;

#[test]
fn all_run_in_order() {
    let (bench, said) = with_cargo(LOGGED);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let log = std::fs::read_to_string(bench.path("log")).unwrap();
    let expected = "|fmt --all --check\n|clippy --workspace --all-targets -- -D warnings\n\
                    -D warnings|doc --workspace --no-deps\n|test --workspace\n";
    assert_eq!(log, expected);
    assert!(said.out.contains("all passed in") && !said.out.contains("FAILED"), "{}", said.out);
}

#[test]
fn the_first_failure_ends_it() {
    let (bench, said) = with_cargo(&format!("{LOGGED}\ncase \"$*\" in clippy*warnings) exit 101 ;; esac"));
    assert_eq!(said.code, 1);
    let log = std::fs::read_to_string(bench.path("log")).unwrap();
    assert_eq!(log.lines().count(), 2, "{log}");
    let rows =
        ["formatting    passed", "lints         FAILED", "documentation not run", "tests         not run"];
    assert!(rows.iter().all(|row| said.out.contains(row)), "{}", said.out);
    assert!(said.err.contains("lints failed") && said.err.contains("`cargo clippy"), "{}", said.err);
}

#[test]
fn missing_components_are_said_before_anything_runs() {
    let (bench, said) = with_cargo(&format!("{LOGGED}\n[ \"$1\" != clippy ]"));
    assert_eq!(said.code, 1);
    assert!(said.err.contains("rustup component add clippy"), "{}", said.err);
    assert!(!bench.path("log").exists());
}

/// A machine without an adapter, whose user is `uid` and whose package manager is a script.
#[cfg(target_os = "linux")]
fn set_up(uid: &str, apt_get: &str) -> (Bench, Said) {
    let bench = Bench::new();
    script(&bench, "cargo", "exit 0");
    script(&bench, "id", &format!("echo {uid}"));
    script(&bench, "sudo", "exit 1");
    script(&bench, "apt-get", &format!("echo \"$@\" >> log\n{apt_get}"));
    let here = bench.path(".");
    let path = std::env::join_paths([here.as_path(), Path::new("/usr/bin"), Path::new("/bin")]).unwrap();
    let mut command = bench.command(&["--setup"]);
    command.env("PATH", path).env("CARGO", bench.path("cargo"));
    command.env("VK_DRIVER_FILES", bench.path("icd.json")).env("LD_LIBRARY_PATH", bench.path(""));
    let said = said(&mut command);
    (bench, said)
}

#[test]
#[cfg(target_os = "linux")]
fn setup_installs_the_driver_and_fetches_lists_only_if_needed() {
    let install =
        r#"echo '{"ICD": {"library_path": "libfake.so"}}' > icd.json; touch libfake.so libvulkan.so.1"#;
    let (bench, said) = set_up("0", install);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    assert!(said.out.contains("software Vulkan driver is installed"), "{}", said.out);
    let once =
        "install -y --no-install-recommends -o DPkg::Lock::Timeout=120 mesa-vulkan-drivers libvulkan1\n";
    assert_eq!(std::fs::read_to_string(bench.path("log")).unwrap(), once);

    let stale = format!("grep -q update log || {{ echo no such package; exit 100; }}\n{install}");
    let (bench, said) = set_up("0", &stale);
    assert_eq!(said.code, 0, "{}{}", said.out, said.err);
    let log = std::fs::read_to_string(bench.path("log")).unwrap();
    assert_eq!(log, format!("{once}update\n{once}"));
}

#[test]
#[cfg(target_os = "linux")]
fn setup_that_fails_is_an_error_and_one_that_may_not_is_a_note() {
    let (_, said) = set_up("0", "echo no network; exit 100");
    assert_eq!(said.code, 1);
    let told = said.err.contains("no network") && said.err.contains("apt-get update && apt-get install");
    assert!(told && !said.out.contains("=="), "{}{}", said.out, said.err);

    let (_, said) = set_up("0", "exit 0");
    assert_eq!(said.code, 1);
    assert!(said.err.contains("cannot be found"), "{}", said.err);

    let (bench, said) = set_up("1000", "exit 0");
    assert_eq!(said.code, 0, "{}", said.err);
    assert!(said.out.contains("sudo apt-get install") && said.out.contains("all passed"), "{}", said.out);
    assert!(!bench.path("log").exists());
}
