//! Random changes of texts, for files that are damaged.

use impinge_testkit::generate::Rng;

/// Returns a text with up to `changes` random changes: bytes, words in place of pieces, cuts, and
/// repeated pieces. A piece has at most `longest` bytes.
pub(crate) fn mutant(rng: &mut Rng, text: &str, words: &[&str], (changes, longest): (i64, usize)) -> Vec<u8> {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..rng.integer(1, changes) {
        let at = |rng: &mut Rng, bytes: &[u8]| rng.integer(0, bytes.len().max(1) as i64 - 1) as usize;
        let (i, j) = (at(rng, &bytes), at(rng, &bytes));
        let (i, j) = (i.min(j), i.max(j).min(i.min(j) + longest));
        match rng.integer(0, 4) {
            0 if i < bytes.len() => bytes[i] = rng.integer(0, 255) as u8,
            1 => drop(bytes.splice(i..j, words[rng.integer(0, words.len() as i64 - 1) as usize].bytes())),
            2 => drop(bytes.drain(i..j)),
            3 => {
                let piece = bytes[i..j].to_vec();
                let to = at(rng, &bytes);
                drop(bytes.splice(to..to, piece));
            }
            _ => bytes.truncate(bytes.len() - rng.integer(0, 40).min(bytes.len() as i64) as usize),
        }
    }
    bytes
}
