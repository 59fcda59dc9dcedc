//! Phrases that readers stumble over, and the plain words for them.

/// A phrase, in lower case, and the plain words for it.
type Plain = (&'static str, &'static str);

/// Phrases that no comment, message or page may contain.
const BANNED: [Plain; 34] = [
    ("so many", "number of, maximum, minimum"),
    ("is none", "is invalid, is absent"),
    ("are none", "are invalid, are absent"),
    ("at hand", "available, present"),
    ("whoever", "a caller that, anyone who"),
    ("whom", "who"),
    ("lest", "so that ... not"),
    ("nought", "zero"),
    ("is told", "receives, knows"),
    ("in vain", "without a result"),
    ("askew", "edge-cross axes"),
    ("as ever", "as always; or leave it out"),
    ("dear", "costs more, slower"),
    ("dearer", "costs more, slower"),
    ("likewise", "repeat the words"),
    ("apiece", "each"),
    ("no harm", "say the effect"),
    ("judge", "validate, classify, check"),
    ("judges", "validates, classifies, checks"),
    ("judged", "validated, classified, checked"),
    ("judging", "validating, classifying, checking"),
    ("stands for itself", "say what it is"),
    ("put off", "queued, deferred"),
    ("left open", "left undecided"),
    ("leaves open", "leaves undecided"),
    ("of old", "earlier"),
    ("nobody asks", "is never used"),
    ("what becomes of", "how to treat"),
    ("what is none", "invalid input"),
    ("cheap to ask", "fast"),
    ("as said", "say it, or link to it"),
    ("whence", "from which"),
    ("thereof", "of it"),
    ("centre", "center"),
];

/// Returns a report for each banned phrase in a line of prose.
pub(crate) fn found_in(prose: &str) -> impl Iterator<Item = String> {
    let words = prose.to_lowercase();
    BANNED
        .into_iter()
        .filter(move |(phrase, _)| has_words(&words, phrase))
        .map(|(phrase, plain)| format!("\"{phrase}\": say {plain}"))
}

/// Reports whether a text contains a phrase as whole words. "There is none" is plain English.
fn has_words(text: &str, phrase: &str) -> bool {
    text.match_indices(phrase).any(|(at, _)| {
        let is_letter = |c: Option<char>| c.is_some_and(char::is_alphanumeric);
        let (before, after) = (&text[..at], &text[at + phrase.len()..]);
        !is_letter(before.chars().next_back()) && !is_letter(after.chars().next()) && !before.ends_with("there ")
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn phrases_are_found_as_whole_words_in_any_case() {
        assert_eq!(found_in("So many rows").count(), 1);
        assert_eq!(found_in("`None` if there is none, but a pose that is none").count(), 1);
        assert_eq!(found_in("the least of the nearest pairs").count(), 0);
        assert_eq!(
            found_in("Validated, not judged.").next().unwrap(),
            "\"judged\": say validated, classified, checked"
        );
    }
}
