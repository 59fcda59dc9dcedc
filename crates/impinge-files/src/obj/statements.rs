//! Splits an OBJ file into statements: its lines, with continued lines joined.

use std::borrow::Cow;

use memchr::memchr;

use crate::text::{Lines, is_space, split_token, trim_start};

/// Iterates over the lines of a file, with continued lines joined.
pub(super) struct Statements<'a> {
    lines: Lines<'a>,
    /// Number of faces that end in a `\` although no corner follows.
    stray: u64,
    /// Line of the first such face.
    first_stray: u64,
}

impl<'a> Statements<'a> {
    pub(super) fn new(text: &'a [u8]) -> Self {
        Self { lines: Lines::new(text), stray: 0, first_stray: 0 }
    }

    /// Returns the next statement and the number of its first line.
    #[inline]
    pub(super) fn next(&mut self) -> Option<(u64, Cow<'a, [u8]>)> {
        let line = self.lines.next()?;
        let number = self.lines.number();
        let statement = match continued(line) {
            None => Cow::Borrowed(line),
            Some(start) => self.join_open(line, start),
        };
        Some((number, statement))
    }

    /// Returns the number of faces so far that end in a `\` although no corner follows, and the
    /// line of the first.
    pub(super) fn stray_backslashes(&self) -> (u64, u64) {
        (self.stray, self.first_stray)
    }

    /// Returns the statement that begins with `line`, which consists of `start` and a `\`.
    #[cold]
    fn join_open(&mut self, line: &'a [u8], start: &[u8]) -> Cow<'a, [u8]> {
        if is_comment_open(line) { Cow::Borrowed(line) } else { Cow::Owned(self.join(start)) }
    }

    fn join(&mut self, start: &[u8]) -> Vec<u8> {
        let (is_numeric, is_face) = (is_numeric(start), is_face(start));
        let mut joined = [start, b" "].concat();
        loop {
            if is_face && !self.corner_follows() {
                if self.stray == 0 {
                    self.first_stray = self.lines.number();
                }
                self.stray += 1;
                return joined;
            }
            let line = self.lines.next().unwrap_or_default();
            match continued(line) {
                Some(more) if !(is_numeric && memchr(b'#', line).is_some()) => {
                    joined.extend_from_slice(more);
                    joined.push(b' ');
                }
                _ => {
                    joined.extend_from_slice(line);
                    return joined;
                }
            }
        }
    }

    /// Reports whether the next line may continue a face: it begins with a number, is blank or a
    /// comment, or does not exist.
    fn corner_follows(&self) -> bool {
        let line = self.lines.clone().next().unwrap_or_default();
        trim_start(line).first().is_none_or(|b| matches!(b, b'0'..=b'9' | b'+' | b'-' | b'\\' | b'#'))
    }
}

/// Returns the line without its final `\`, or `None` if it has none. White space may follow the `\`
/// of a face.
#[inline]
fn continued(line: &[u8]) -> Option<&[u8]> {
    let line = line.strip_suffix(b"\r").unwrap_or(line);
    match line.last()? {
        b'\\' => Some(&line[..line.len() - 1]),
        b' ' | b'\t' => {
            let end = line.iter().rposition(|&b| !is_space(b))?;
            (line[end] == b'\\' && is_face(line)).then_some(&line[..end])
        }
        _ => None,
    }
}

/// Reports whether the line ends in a comment. In names and paths, `#` is a letter.
fn is_comment_open(line: &[u8]) -> bool {
    match memchr(b'#', line) {
        None => false,
        Some(at) => is_numeric(line) || trim_start(&line[..at]).is_empty(),
    }
}

/// Reports whether the line starts a vertex or a face.
fn is_numeric(line: &[u8]) -> bool {
    split_token(line).0.eq_ignore_ascii_case(b"v") || is_face(line)
}

fn is_face(line: &[u8]) -> bool {
    let keyword = split_token(line).0;
    keyword.eq_ignore_ascii_case(b"f") || keyword.eq_ignore_ascii_case(b"fo")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn statements(text: &str) -> (Vec<(u64, String)>, (u64, u64)) {
        let mut statements = Statements::new(text.as_bytes());
        let mut all = Vec::new();
        while let Some((line, statement)) = statements.next() {
            all.push((line, String::from_utf8_lossy(&statement).trim().to_owned()));
        }
        (all, statements.stray_backslashes())
    }

    fn texts(text: &str) -> Vec<String> {
        statements(text).0.into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn continued_lines_are_joined() {
        let (all, stray) = statements("g a\\\nb\nf 1 \\\r\n 2 \\\r\n 3\np 1");
        assert_eq!(all, [(1, "g a b".into()), (3, "f 1   2   3".into()), (6, "p 1".into())]);
        assert_eq!(stray, (0, 0));
        assert_eq!(texts("f 1 2 \\ \t\n3"), ["f 1 2  3"]);
        assert_eq!(texts("f 1 2 3 \\\n\nf 4"), ["f 1 2 3", "f 4"]);
        assert_eq!(texts("f 1 2 3 \\"), ["f 1 2 3"]);
    }

    #[test]
    fn a_comment_ends_with_its_line() {
        assert_eq!(texts("# a \\\nf 1"), ["# a \\", "f 1"]);
        assert_eq!(texts("f 1 2 3 # a \\\nf 4"), ["f 1 2 3 # a \\", "f 4"]);
        assert_eq!(texts("v 1 2 3 # a \\\nv 4"), ["v 1 2 3 # a \\", "v 4"]);
        assert_eq!(texts("f 1 2 \\\n3 # a \\\nf 4"), ["f 1 2  3 # a \\", "f 4"]);
        // Paths may contain a `#`, and end in a `\`.
        assert_eq!(texts("g a#b \\\nc"), ["g a#b  c"]);
    }

    #[test]
    fn a_backslash_without_corners_after_it_is_stray() {
        let (all, stray) = statements("g\nf 1 2 3 \\\nf 4 5 6\\\nv 1 2 3\n");
        assert_eq!(all, [(1, "g".into()), (2, "f 1 2 3".into()), (3, "f 4 5 6".into()), (4, "v 1 2 3".into())]);
        assert_eq!(stray, (2, 2));
    }
}
