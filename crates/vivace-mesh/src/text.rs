//! Words and line numbers of a text in memory. Nothing is copied, and nothing needs the text to be UTF-8.

use crate::MeshError;
use crate::mesh::MAX_COORDINATE;

/// A place in a text. Words are separated by ASCII white space; a carriage return is white space.
#[derive(Debug, Clone)]
pub(crate) struct Text<'a> {
    rest: &'a [u8],
    line: usize,
}

impl<'a> Text<'a> {
    /// The start of a text, past a byte order mark.
    pub(crate) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes), line: 1 }
    }

    /// The number of the current line, from 1.
    pub(crate) fn line(&self) -> usize {
        self.line
    }

    /// How many bytes are left: no count in the text can be larger.
    pub(crate) fn bytes_left(&self) -> usize {
        self.rest.len()
    }

    /// The next word of this line.
    pub(crate) fn word(&mut self) -> Option<&'a [u8]> {
        let start = self.rest.iter().position(|&b| b == b'\n' || !is_space(b)).unwrap_or(self.rest.len());
        self.rest = &self.rest[start..];
        let length = self.rest.iter().position(|&b| is_space(b)).unwrap_or(self.rest.len());
        let (word, rest) = self.rest.split_at(length);
        self.rest = rest;
        (!word.is_empty()).then_some(word)
    }

    /// The next word of this line or of a later one.
    pub(crate) fn word_anywhere(&mut self) -> Option<&'a [u8]> {
        loop {
            match self.word() {
                None if self.next_line() => {}
                word => return word,
            }
        }
    }

    /// Leaves this line; false at the end of the text.
    pub(crate) fn next_line(&mut self) -> bool {
        self.rest_of_line();
        match self.rest.split_first() {
            Some((_, rest)) => {
                self.rest = rest;
                self.line += 1;
                true
            }
            None => false,
        }
    }

    /// What is left of this line, without the line end.
    pub(crate) fn rest_of_line(&mut self) -> &'a [u8] {
        let length = self.rest.iter().position(|&b| b == b'\n').unwrap_or(self.rest.len());
        let (line, rest) = self.rest.split_at(length);
        self.rest = rest;
        line.strip_suffix(b"\r").unwrap_or(line)
    }

    /// An error at the current line.
    pub(crate) fn error(&self, reason: impl Into<String>) -> MeshError {
        MeshError::at(self.line, reason)
    }

    /// A coordinate \[m\] from a word of the current line.
    pub(crate) fn coordinate(&self, word: &[u8]) -> Result<f32, MeshError> {
        let value = number::<f32>(word).ok_or_else(|| {
            self.error(format!("{} is no number; write coordinates such as 1.5 or -2e-3", quoted(word)))
        })?;
        if !value.is_finite() && !names_digits(word) {
            return Err(self.error(format!("the coordinate {} is not finite", quoted(word))));
        }
        if value.abs() > MAX_COORDINATE {
            return Err(self.error(format!(
                "the coordinate {} is beyond {MAX_COORDINATE:e} m, where volumes overflow; scale the mesh down",
                quoted(word)
            )));
        }
        Ok(value)
    }
}

/// A number, if the whole word is one.
pub(crate) fn number<T: std::str::FromStr>(word: &[u8]) -> Option<T> {
    std::str::from_utf8(word).ok()?.parse().ok()
}

/// A word for a message: at most 40 characters, in quotes, control characters escaped.
pub(crate) fn quoted(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(160)]).into_owned();
    let short: String = text.chars().take(40).collect();
    if short.len() < word.len() && short != text { format!("{short:?}...") } else { format!("{short:?}") }
}

fn is_space(byte: u8) -> bool {
    byte.is_ascii_whitespace() || byte == 0x0b
}

/// `1e99` becomes infinite only in reading; `inf` and `nan` have no digit.
fn names_digits(word: &[u8]) -> bool {
    word.iter().any(u8::is_ascii_digit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_and_lines() {
        let mut text = Text::new(b"\xef\xbb\xbfa\tbb\r\n\n \x0bc");
        assert_eq!(
            (text.word(), text.word(), text.word(), text.line()),
            (Some(&b"a"[..]), Some(&b"bb"[..]), None, 1)
        );
        assert_eq!((text.word_anywhere(), text.line()), (Some(&b"c"[..]), 3));
        assert_eq!((text.word_anywhere(), text.next_line(), text.line()), (None, false, 3));
    }

    #[test]
    fn rests_of_lines() {
        let mut text = Text::new(b"one two\r\nthree");
        assert_eq!(text.word(), Some(&b"one"[..]));
        assert_eq!((text.rest_of_line(), text.rest_of_line()), (&b" two"[..], &b""[..]));
        assert!(text.next_line());
        assert_eq!((text.rest_of_line(), text.bytes_left()), (&b"three"[..], 0));
    }

    #[test]
    fn coordinates() {
        let text = Text::new(b"");
        assert_eq!(text.coordinate(b"-2.5e-3"), Ok(-2.5e-3));
        for (word, reason) in [
            ("1,5", "no number"),
            ("nan", "not finite"),
            ("-inf", "not finite"),
            ("1e30", "beyond 1e12"),
            ("1e99", "beyond 1e12"),
            ("0x10", "no number"),
            ("", "no number"),
        ] {
            let message = text.coordinate(word.as_bytes()).unwrap_err().to_string();
            assert!(message.contains(reason) && message.starts_with("line 1: "), "{word}: {message}");
        }
    }

    #[test]
    fn long_and_broken_words_are_quoted_in_short() {
        assert_eq!(quoted(b"a\x07b"), "\"a\\u{7}b\"");
        assert_eq!(quoted(&[b'x'; 1000]).len(), 45);
        assert_eq!(quoted(b"\xff"), "\"\u{fffd}\"");
    }
}
