//! Converts names to bytes and back: the number of names, then the length and the UTF-8 text of
//! each.

pub(super) fn to_bytes(names: &[String]) -> Vec<u8> {
    let mut bytes = (names.len() as u32).to_le_bytes().to_vec();
    for name in names {
        bytes.extend((name.len() as u32).to_le_bytes());
        bytes.extend(name.as_bytes());
    }
    bytes
}

/// Returns the names, or `None` if the bytes do not consist of names entirely.
pub(super) fn from_bytes(mut bytes: &[u8]) -> Option<Vec<String>> {
    let (count, rest) = bytes.split_first_chunk::<4>()?;
    bytes = rest;
    // Reserve no memory: the count may be wrong.
    let mut names = Vec::new();
    for _ in 0..u32::from_le_bytes(*count) {
        let (head, rest) = bytes.split_first_chunk::<4>()?;
        let (name, rest) = rest.split_at_checked(u32::from_le_bytes(*head) as usize)?;
        names.push(String::from_utf8(name.to_vec()).ok()?);
        bytes = rest;
    }
    bytes.is_empty().then_some(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip_and_other_bytes_are_rejected() {
        let names = ["", "wheel", "Zahnräder"].map(str::to_owned).to_vec();
        let bytes = to_bytes(&names);
        assert_eq!(from_bytes(&bytes), Some(names));
        assert_eq!(from_bytes(&to_bytes(&[])), Some(Vec::new()));
        for cut in 0..bytes.len() {
            assert_eq!(from_bytes(&bytes[..cut]), None, "{cut}");
        }
        assert_eq!(from_bytes(&[bytes, vec![0]].concat()), None);
        assert_eq!(from_bytes(&[1, 0, 0, 0, 1, 0, 0, 0, 0xff]), None, "not UTF-8");
        assert_eq!(from_bytes(&[255; 12]), None);
    }
}
