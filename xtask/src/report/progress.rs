//! Progress on the terminal: a bar where there is one, plain lines where stderr goes to a file.

use std::io::IsTerminal as _;
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

/// Progress through the steps of figures.
#[derive(Debug)]
pub struct Progress {
    bar: Option<ProgressBar>,
    quiet: bool,
    figure: String,
    step: u64,
    n_steps: u64,
    started: Instant,
    figure_started: Instant,
}

impl Progress {
    /// Writes to stderr, as a bar if that is a terminal.
    pub fn new() -> Self {
        Self::with(std::io::stderr().is_terminal(), false)
    }

    /// Writes nothing.
    pub fn silent() -> Self {
        Self::with(false, true)
    }

    fn with(terminal: bool, quiet: bool) -> Self {
        let bar = terminal.then(|| {
            let bar = ProgressBar::new(0);
            let template = "{elapsed_precise} {prefix:.bold} [{bar:24}] {pos}/{len} {wide_msg}";
            bar.set_style(
                ProgressStyle::with_template(template)
                    .unwrap_or_else(|_| ProgressStyle::default_bar())
                    .progress_chars("=> "),
            );
            bar.enable_steady_tick(Duration::from_millis(200));
            bar
        });
        let now = Instant::now();
        Self { bar, quiet, figure: String::new(), step: 0, n_steps: 0, started: now, figure_started: now }
    }

    /// Begins a figure of `n_steps` steps.
    pub fn figure(&mut self, id: &str, n_steps: u64) {
        self.figure = id.to_owned();
        (self.step, self.n_steps) = (0, n_steps);
        self.figure_started = Instant::now();
        if let Some(bar) = &self.bar {
            bar.set_prefix(id.to_owned());
            bar.set_length(n_steps);
            bar.set_position(0);
            bar.set_message(String::new());
        }
    }

    /// Says what is done next, and counts it.
    pub fn step(&mut self, what: &str) {
        match &self.bar {
            Some(bar) => {
                bar.set_position(self.step);
                bar.set_message(what.to_owned());
            }
            None => self.plain(&format!("{}/{} {what}", self.step + 1, self.n_steps.max(self.step + 1))),
        }
        self.step += 1;
    }

    /// Ends the figure and says how long it took \[s\].
    pub fn done(&mut self) -> f64 {
        let seconds = self.figure_started.elapsed().as_secs_f64();
        self.note(&format!("done in {seconds:.1} s"));
        self.figure.clear();
        if let Some(bar) = &self.bar {
            bar.set_position(self.n_steps);
            bar.set_message("writing");
        }
        seconds
    }

    /// Says something that stays on the screen.
    pub fn note(&self, text: &str) {
        match &self.bar {
            Some(bar) => bar.println(format!("{}{text}", self.prefix())),
            None => self.plain(text),
        }
    }

    fn plain(&self, text: &str) {
        if !self.quiet {
            eprintln!("{:8.1} s  {}{text}", self.started.elapsed().as_secs_f64(), self.prefix());
        }
    }

    fn prefix(&self) -> String {
        if self.figure.is_empty() { String::new() } else { format!("{}: ", self.figure) }
    }
}

impl Default for Progress {
    fn default() -> Self {
        Self::new()
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn steps_may_exceed_the_plan() {
        let mut progress = Progress::silent();
        progress.figure("fig3", 1);
        progress.step("one");
        progress.step("two");
        assert!(progress.done() >= 0.0);
        assert_eq!(progress.step, 2);
    }
}
