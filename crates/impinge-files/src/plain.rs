//! Escapes text from files, so that it is safe to print: a terminal obeys control characters.

use std::fmt::{self, Write};

/// Writes text with control characters as escapes, such as `\u{1b}`. Characters that change the
/// direction of text are escaped too, because they can make a message read as another one.
pub(crate) struct Plain<'a, 'b>(pub(crate) &'a mut fmt::Formatter<'b>);

impl Write for Plain<'_, '_> {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for part in text.split_inclusive(is_control_character) {
            match part.chars().next_back().filter(|&last| is_control_character(last)) {
                Some(last) => {
                    self.0.write_str(&part[..part.len() - last.len_utf8()])?;
                    write!(self.0, "{}", last.escape_unicode())?;
                }
                None => self.0.write_str(part)?,
            }
        }
        Ok(())
    }
}

/// Returns text from a file with control characters as escapes, such as `\u{1b}`, so that it is
/// safe to print.
///
/// ```
/// assert_eq!(impinge_files::escaped("wall\u{1b}[2J"), "wall\\u{1b}[2J");
/// ```
#[must_use]
pub fn escaped(text: &str) -> String {
    struct Escaped<'t>(&'t str);
    impl fmt::Display for Escaped<'_> {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            Plain(f).write_str(self.0)
        }
    }
    Escaped(text).to_string()
}

/// Reports whether a character controls a terminal or the direction of text.
pub(crate) fn is_control_character(character: char) -> bool {
    character.is_control()
        || matches!(character, '\u{061C}' | '\u{200E}' | '\u{200F}' | '\u{202A}'..='\u{202E}' | '\u{2066}'..='\u{2069}')
}

#[cfg(test)]
mod tests {
    use std::fmt;

    use super::*;

    struct Shown(&'static str);

    impl fmt::Display for Shown {
        fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            write!(Plain(f), "<{}>", self.0)
        }
    }

    #[test]
    fn control_characters_are_escaped_and_nothing_else() {
        for (text, expected) in [
            ("plain, caf\u{e9} \u{1F600} {}\\", "<plain, caf\u{e9} \u{1F600} {}\\>"),
            ("\u{1b}]0;title\u{7}", "<\\u{1b}]0;title\\u{7}>"),
            ("a\nb\u{9b}31m\u{202e}", "<a\\u{a}b\\u{9b}31m\\u{202e}>"),
        ] {
            assert_eq!(Shown(text).to_string(), expected);
        }
    }
}
