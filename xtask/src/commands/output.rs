//! Plain text for a terminal of 80 columns.

use std::fmt::Write as _;
use std::io::{self, Write as _};
use std::path::Path;

use super::CommandError;

/// Columns of the labels of [`field`].
const LABEL_WIDTH: usize = 13;
/// Columns of a line.
const WIDTH: usize = 80;

/// Writes to standard output, at once.
pub(crate) fn print(text: &str) -> Result<(), CommandError> {
    let mut stdout = io::stdout().lock();
    stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()).map_err(CommandError::Output)
}

/// Says where a report's page is.
pub(crate) fn print_page(page: &Path) -> Result<(), CommandError> {
    let page = page.canonicalize().unwrap_or_else(|_| page.to_owned());
    print(&format!("{}\n", page.display()))
}

/// Appends `label` and `value`, the value folded at blanks into a column of its own. A word too long for it is not cut: a path
/// must stay one.
pub(crate) fn field(text: &mut String, label: &str, value: &str) {
    let mut line = format!("  {label:<LABEL_WIDTH$}");
    let mut is_fresh = true;
    for word in value.split_whitespace() {
        if !is_fresh && line.chars().count() + 1 + word.chars().count() > WIDTH {
            text.push_str(&line);
            text.push('\n');
            line = " ".repeat(LABEL_WIDTH + 2);
            is_fresh = true;
        }
        if !is_fresh {
            line.push(' ');
        }
        line.push_str(word);
        is_fresh = false;
    }
    text.push_str(line.trim_end());
    text.push('\n');
}

/// `1 vertex`, `2 vertices`.
pub(crate) fn counted(count: usize, one: &str, many: &str) -> String {
    if count == 1 { format!("1 {one}") } else { format!("{count} {many}") }
}

/// Four significant digits, with an exponent only where the number is very large or very small.
pub(crate) fn short(value: f64) -> String {
    let magnitude = value.abs();
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    if !(1e-3..1e6).contains(&magnitude) {
        return format!("{value:.3e}");
    }
    let decimals = [1e3, 1e2, 1e1, 1e0, 1e-1, 1e-2, 1e-3].iter().position(|&step| magnitude >= step);
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write!(text, "{value:.*}", decimals.unwrap_or(6));
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn four_digits_are_enough() {
        for (value, text) in [
            (0.0, "0"),
            (1.0, "1.000"),
            (-12.3456, "-12.35"),
            (123_456.7, "123457"),
            (0.012_345, "0.01235"),
            (0.001, "0.001000"),
            (1.5e-7, "1.500e-7"),
            (2e9, "2.000e9"),
        ] {
            assert_eq!(short(value), text);
        }
    }

    #[test]
    fn long_values_are_folded_and_long_words_are_not() {
        let mut text = String::new();
        field(&mut text, "note", &"word ".repeat(40));
        field(&mut text, "file", &format!("at {}", "x".repeat(100)));
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].starts_with("  note         word word"));
        assert!(lines[1].starts_with("               word"));
        assert!(lines.iter().all(|line| line.len() <= WIDTH || line.trim().len() == 100), "{text}");
        assert_eq!(text.matches("word").count(), 40);
    }

    #[test]
    fn one_and_many() {
        assert_eq!(counted(1, "edge", "edges"), "1 edge");
        assert_eq!(counted(0, "edge", "edges"), "0 edges");
    }
}
