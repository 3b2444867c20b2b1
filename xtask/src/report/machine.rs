//! What a run was made on and from: machine, versions, commit, date.

use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

use serde::Serialize;

/// The machine, in words.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Machine {
    /// Model of the processor.
    pub cpu: String,
    /// Physical cores, where the system tells.
    pub cores: Option<usize>,
    /// Threads that run at the same time and are open to this program.
    pub threads: usize,
    /// Main memory \[GiB\].
    pub memory_gib: f64,
    /// Operating system.
    pub os: String,
    /// Compiler.
    pub rustc: String,
    /// Target and profile of this program.
    pub build: String,
    /// Graphics adapters in use, software adapters named as such; empty for none.
    pub adapters: Vec<String>,
}

impl Machine {
    /// Asks the system.
    pub fn probe() -> Self {
        let mut system = sysinfo::System::new();
        system.refresh_cpu_all();
        system.refresh_memory();
        let unknown = || "unknown".to_owned();
        let cpu = system.cpus().first().map(|cpu| cpu.brand().trim().to_owned());
        let arch = std::env::consts::ARCH;
        let target = option_env!("VIVACE_TARGET").unwrap_or(arch);
        let profile = option_env!("VIVACE_PROFILE").unwrap_or("unknown profile");
        Self {
            cpu: cpu.filter(|name| !name.is_empty()).unwrap_or_else(|| format!("unknown {arch} processor")),
            cores: sysinfo::System::physical_core_count(),
            threads: std::thread::available_parallelism().map_or(1, usize::from),
            memory_gib: (system.total_memory() as f64 / f64::from(1 << 30) * 10.0).round() / 10.0,
            os: sysinfo::System::long_os_version().unwrap_or_else(unknown),
            rustc: option_env!("VIVACE_RUSTC_VERSION").map_or_else(unknown, str::to_owned),
            build: format!("{target}, {profile}"),
            adapters: Vec::new(),
        }
    }

    /// Names and values, for a table.
    pub fn facts(&self) -> Vec<(&'static str, String)> {
        let cores = self.cores.map_or(String::new(), |cores| format!("{cores} cores, "));
        let adapters =
            if self.adapters.is_empty() { "none used".to_owned() } else { self.adapters.join("; ") };
        vec![
            ("Processor", self.cpu.clone()),
            ("Cores", format!("{cores}{} threads", self.threads)),
            ("Memory", format!("{} GiB", self.memory_gib)),
            ("Graphics", adapters),
            ("System", self.os.clone()),
            ("Compiler", self.rustc.clone()),
            ("Build", self.build.clone()),
        ]
    }
}

/// The commit of the working tree that holds `folder`, with "+ changes" if files differ from it; "unknown" without
/// git, or where `folder` is not itself tracked by the repository around it.
pub fn commit(folder: &Path) -> String {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").arg("-C").arg(folder).args(arguments).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    // An unpacked archive inside somebody else's repository must not claim that one's commit.
    let tracked = git(&["ls-files", "--error-unmatch", "Cargo.toml"]).is_some();
    let Some(hash) = git(&["rev-parse", "--short=12", "HEAD"]).filter(|_| tracked) else {
        return "unknown".to_owned();
    };
    let changed =
        git(&["status", "--porcelain", "--untracked-files=no"]).is_some_and(|text| !text.is_empty());
    if changed { format!("{hash} + changes") } else { hash }
}

/// Now, as `2026-05-17 09:30 UTC`.
pub fn now() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |elapsed| elapsed.as_secs());
    date(seconds)
}

/// Date and time in the Gregorian calendar of a number of seconds since 1970.
fn date(seconds: u64) -> String {
    let leap = |year: u64| year.is_multiple_of(400) || (year.is_multiple_of(4) && !year.is_multiple_of(100));
    let (mut day, mut year) = (seconds / 86_400, 1970);
    while day >= 365 + u64::from(leap(year)) {
        day -= 365 + u64::from(leap(year));
        year += 1;
    }
    let lengths = [31, 28 + u64::from(leap(year)), 31, 30, 31, 30, 31, 31, 30, 31, 30, 31];
    let mut month = 1;
    for length in lengths {
        if day < length {
            break;
        }
        day -= length;
        month += 1;
    }
    let (hour, minute) = (seconds / 3600 % 24, seconds / 60 % 60);
    format!("{year}-{month:02}-{:02} {hour:02}:{minute:02} UTC", day + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dates_follow_the_calendar() {
        assert_eq!(date(0), "1970-01-01 00:00 UTC");
        assert_eq!(date(951_782_400), "2000-02-29 00:00 UTC");
        assert_eq!(date(1_735_689_599), "2024-12-31 23:59 UTC");
        assert_eq!(date(1_735_689_600), "2025-01-01 00:00 UTC");
    }

    #[test]
    fn a_machine_says_something_everywhere() {
        let machine = Machine::probe();
        assert!(machine.threads >= 1 && machine.memory_gib > 0.0);
        assert!(machine.facts().iter().all(|(_, value)| !value.is_empty()), "{machine:?}");
        assert!(machine.rustc.starts_with("rustc "));
    }

    #[test]
    fn a_folder_without_git_has_no_commit() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(commit(folder.path()), "unknown");
        assert_eq!(commit(&folder.path().join("missing")), "unknown");
    }
}
