//! What the checks need beyond Rust: formatting and lints from the toolchain, a Vulkan driver from the system.

use std::process::{Command, Stdio};

use crate::vulkan::Vulkan;
use crate::{Error, print};

/// A package manager, and how the software driver and the loader are called there.
struct Manager {
    program: &'static str,
    /// How to fetch the lists of packages anew, where that changes nothing else.
    refresh: Option<&'static str>,
    install: &'static [&'static str],
    /// Added where nobody watches.
    unattended: &'static [&'static str],
    packages: [&'static str; 2],
}

const MANAGERS: [Manager; 4] = [
    Manager {
        program: "apt-get",
        refresh: Some("update"),
        install: &["install", "-y", "--no-install-recommends"],
        unattended: &["-o", "DPkg::Lock::Timeout=120"],
        packages: ["mesa-vulkan-drivers", "libvulkan1"],
    },
    Manager {
        program: "dnf",
        refresh: None,
        install: &["install", "-y"],
        unattended: &[],
        packages: ["mesa-vulkan-drivers", "vulkan-loader"],
    },
    // Fetching pacman's lists without upgrading everything is unsupported there, so that stays with the user.
    Manager {
        program: "pacman",
        refresh: None,
        install: &["-S", "--needed", "--noconfirm"],
        unattended: &[],
        packages: ["vulkan-swrast", "vulkan-icd-loader"],
    },
    Manager {
        program: "apk",
        refresh: Some("update"),
        install: &["add"],
        unattended: &[],
        packages: ["mesa-vulkan-swrast", "vulkan-loader"],
    },
];

/// Whether the toolchain has rustfmt and clippy.
///
/// # Errors
/// One is missing; the message says how to get it.
pub(crate) fn check_components(cargo: &str) -> Result<(), Error> {
    let has = |command: &str| {
        let mut probe = Command::new(cargo);
        probe.args([command, "--version"]).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        probe.status().is_ok_and(|status| status.success())
    };
    let missing: Vec<&str> = [("fmt", "rustfmt"), ("clippy", "clippy")]
        .into_iter()
        .filter(|(command, _)| !has(command))
        .map(|(_, component)| component)
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    Err(Error::Failed(format!(
        "the toolchain lacks {}; run `rustup component add {}` (or install them where Rust came from)",
        missing.join(" and "),
        missing.join(" ")
    )))
}

/// Sees to a Vulkan adapter: installs the software driver if that is asked for, needed and allowed; else says what is missing
/// and how to get it.
///
/// # Errors
/// An installation that fails. A missing adapter alone is none: the tests that need one say so.
pub(crate) fn vulkan(install: bool) -> Result<(), Error> {
    let Some(found) = Vulkan::find() else { return Ok(()) };
    if found.is_complete() {
        return Ok(());
    }
    let missing = found.missing();
    let Some(manager) = MANAGERS.iter().find(|manager| exists(manager.program)) else {
        return note(&format!(
            "this machine lacks {missing}, and has no package manager known here; install Mesa's software driver \
             (lavapipe) and the Vulkan loader with its own"
        ));
    };
    let is_root = is_root();
    let by_hand = manager.command_line(is_root);
    if !install {
        let hint = "`cargo verify --setup` installs what is missing where it may";
        return note(&format!("this machine lacks {missing}.\n{hint}; by hand:\n  {by_hand}"));
    }
    let Some(rights) = Rights::find(is_root) else {
        return note(&format!(
            "this machine lacks {missing}, and installing takes rights that this user does not have; run\n  {by_hand}"
        ));
    };
    let packages = manager.packages.join(" and ");
    print(&format!(
        "setup: this machine lacks {missing}\nsetup: installing {packages} with {}\n",
        manager.program
    ))?;
    manager.install(rights).map_err(|report| {
        Error::Failed(format!("the installation failed:\n{report}\nTo try it by hand:\n  {by_hand}"))
    })?;
    match Vulkan::find() {
        Some(after) if !after.is_complete() => Err(Error::Failed(format!(
            "{packages} are installed, but {} cannot be found; \
             look at VK_DRIVER_FILES and VK_ICD_FILENAMES, if set",
            after.missing()
        ))),
        _ => print("setup: the software Vulkan driver is installed\n"),
    }
}

/// The tests that need the adapter fail by themselves, after all that does not.
fn note(text: &str) -> Result<(), Error> {
    print(&format!("note: {text}\nnote: without a Vulkan adapter the tests of the GPU will fail\n"))
}

/// How commands get to change the system.
#[derive(Clone, Copy)]
enum Rights {
    Root,
    Sudo,
}

impl Rights {
    fn find(is_root: bool) -> Option<Self> {
        if is_root {
            return Some(Self::Root);
        }
        let may = run(Command::new("sudo").args(["-n", "true"])).is_ok();
        may.then_some(Self::Sudo)
    }

    fn command(self, program: &str) -> Command {
        // `env` carries the variable through sudo, which drops the caller's.
        let mut command = match self {
            Self::Root => Command::new("env"),
            Self::Sudo => {
                let mut sudo = Command::new("sudo");
                sudo.args(["-n", "env"]);
                sudo
            }
        };
        command.args(["DEBIAN_FRONTEND=noninteractive", program]);
        command
    }
}

impl Manager {
    /// Tries with the lists of packages as they are, and once more with fresh ones.
    fn install(&self, rights: Rights) -> Result<(), String> {
        let command = || rights.command(self.program);
        let install = || run(command().args(self.install).args(self.unattended).args(self.packages));
        let Some(refresh) = self.refresh else { return install() };
        install().or_else(|before| {
            run(command().arg(refresh))
                .map_err(|report| format!("{before}\nand then `{} {refresh}`:\n{report}", self.program))?;
            install()
        })
    }

    /// What a person would type.
    fn command_line(&self, is_root: bool) -> String {
        let sudo = if is_root { "" } else { "sudo " };
        let refresh = self.refresh.map(|verb| format!("{sudo}{} {verb} && ", self.program));
        let words = [self.install, &self.packages].concat().join(" ");
        format!("{}{sudo}{} {words}", refresh.unwrap_or_default(), self.program)
    }
}

/// Runs a command that nobody watches; its last lines if it fails.
fn run(command: &mut Command) -> Result<(), String> {
    const LINES: usize = 12;
    let output = command.stdin(Stdio::null()).output().map_err(|error| error.to_string())?;
    if output.status.success() {
        return Ok(());
    }
    let text = [output.stdout, output.stderr].concat();
    let text = String::from_utf8_lossy(&text).into_owned();
    let lines: Vec<&str> = text.lines().filter(|line| !line.trim().is_empty()).collect();
    let last: Vec<String> =
        lines[lines.len().saturating_sub(LINES)..].iter().map(|line| format!("  {line}")).collect();
    Err(if last.is_empty() { format!("  {}", output.status) } else { last.join("\n") })
}

fn exists(program: &str) -> bool {
    let path = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&path).any(|folder| folder.join(program).is_file())
}

fn is_root() -> bool {
    let id = Command::new("id").arg("-u").stdin(Stdio::null()).output();
    id.is_ok_and(|output| output.stdout.trim_ascii() == b"0")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_to_type_are_whole() {
        let apt = &MANAGERS[0];
        let packages = "install -y --no-install-recommends mesa-vulkan-drivers libvulkan1";
        assert_eq!(apt.command_line(true), format!("apt-get update && apt-get {packages}"));
        assert_eq!(apt.command_line(false), format!("sudo apt-get update && sudo apt-get {packages}"));
        assert!(MANAGERS[2].command_line(true).starts_with("pacman -S"));
    }

    #[test]
    fn a_failure_shows_its_last_lines() {
        let error = run(Command::new("cargo").arg("no-such-command")).unwrap_err();
        assert!(error.contains("no-such-command"), "{error}");
        assert!(run(&mut Command::new("no-such-program-at-all")).is_err());
    }

    #[test]
    fn missing_components_are_named_with_their_remedy() {
        let error = check_components("no-such-cargo").unwrap_err().to_string();
        assert!(error.contains("rustup component add rustfmt clippy"), "{error}");
    }
}
