//! The steps, and what each has come to.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::time::Instant;

use crate::{Error, print, setup};

/// One thing to run.
struct Step {
    name: &'static str,
    args: &'static [&'static str],
    /// Added to RUSTDOCFLAGS.
    rustdoc_flags: &'static str,
}

const STEPS: [Step; 4] = [
    Step { name: "formatting", args: &["fmt", "--all", "--check"], rustdoc_flags: "" },
    Step {
        name: "lints",
        args: &["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"],
        rustdoc_flags: "",
    },
    Step { name: "documentation", args: &["doc", "--workspace", "--no-deps"], rustdoc_flags: "-D warnings" },
    Step { name: "tests", args: &["test", "--workspace"], rustdoc_flags: "" },
];

/// Sets up what is missing, then runs the steps.
///
/// # Errors
/// The first step that fails, by name; an installation that fails.
pub(crate) fn run(may_install: bool) -> Result<(), Error> {
    let cargo = std::env::var("CARGO").unwrap_or_else(|_| "cargo".to_owned());
    setup::check_components(&cargo)?;
    setup::vulkan(may_install)?;
    let mut summary = String::from("\nsummary\n");
    let start = Instant::now();
    let mut failed = None;
    for step in &STEPS {
        if failed.is_some() {
            add(&mut summary, step, "not run", None);
            continue;
        }
        print(&format!("\n== {}: {}\n", step.name, step.command_line()))?;
        let step_start = Instant::now();
        let passed = step.run(&cargo)?;
        let seconds = step_start.elapsed().as_secs_f64();
        let verdict = if passed { "passed" } else { "FAILED" };
        print(&format!("== {} {verdict} in {seconds:.1} s\n", step.name))?;
        add(&mut summary, step, verdict, Some(seconds));
        if !passed {
            failed = Some(step);
        }
    }
    print(&summary)?;
    match failed {
        None => print(&format!("all passed in {:.1} s\n", start.elapsed().as_secs_f64())),
        Some(step) => Err(Error::Failed(format!(
            "{} failed; see above, and repeat it with `{}`{}",
            step.name,
            step.command_line(),
            if step.name == "formatting" { ", or mend it with `cargo fmt --all`" } else { "" }
        ))),
    }
}

impl Step {
    fn command_line(&self) -> String {
        let flags = match self.rustdoc_flags {
            "" => String::new(),
            flags => format!("RUSTDOCFLAGS=\"{flags}\" "),
        };
        format!("{flags}cargo {}", self.args.join(" "))
    }

    fn run(&self, cargo: &str) -> Result<bool, Error> {
        let mut command = Command::new(cargo);
        command.args(self.args).current_dir(root()).stdin(Stdio::null());
        if !self.rustdoc_flags.is_empty() {
            let own = std::env::var("RUSTDOCFLAGS").unwrap_or_default();
            command.env("RUSTDOCFLAGS", format!("{own} {}", self.rustdoc_flags).trim_start());
        }
        // Mesa's driver asks for it, and complains where it is not set.
        if std::env::var_os("XDG_RUNTIME_DIR").is_none() {
            command.env("XDG_RUNTIME_DIR", std::env::temp_dir());
        }
        let status = command.status();
        let status = status.map_err(|error| Error::Failed(format!("cannot run {cargo}: {error}")))?;
        Ok(status.success())
    }
}

fn add(summary: &mut String, step: &Step, verdict: &str, seconds: Option<f64>) {
    let seconds = seconds.map_or(String::new(), |seconds| format!("{seconds:8.1} s"));
    // Writing to a string cannot fail.
    let _ = writeln!(summary, "{}", format!("  {:<14}{verdict:<8}{seconds}", step.name).trim_end());
}

/// The folder of the workspace: of the sources that this runs from, or else that it was built from.
fn root() -> PathBuf {
    let built_from = || env!("CARGO_MANIFEST_DIR").into();
    let package: PathBuf = std::env::var_os("CARGO_MANIFEST_DIR").map_or_else(built_from, PathBuf::from);
    package.parent().map_or_else(|| package.clone(), PathBuf::from)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_can_be_typed_as_they_are_shown() {
        assert_eq!(STEPS[0].command_line(), "cargo fmt --all --check");
        assert_eq!(STEPS[2].command_line(), "RUSTDOCFLAGS=\"-D warnings\" cargo doc --workspace --no-deps");
    }

    #[test]
    fn the_root_holds_the_workspace() {
        assert!(root().join("Cargo.toml").is_file() && root().join("xtask").is_dir());
    }
}
