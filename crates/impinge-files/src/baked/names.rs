//! Names as bytes: how many there are, then for each its length and its UTF-8.

pub(super) fn to_bytes(names: &[String]) -> Vec<u8> {
    let mut bytes = (names.len() as u32).to_le_bytes().to_vec();
    for name in names {
        bytes.extend((name.len() as u32).to_le_bytes());
        bytes.extend(name.as_bytes());
    }
    bytes
}

/// None where the bytes are not names, all of them.
pub(super) fn from_bytes(mut bytes: &[u8]) -> Option<Vec<String>> {
    let (count, rest) = bytes.split_first_chunk::<4>()?;
    bytes = rest;
    // Not reserved: the count is not to be believed.
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
    fn names_come_back_and_nothing_else_does() {
        let names = ["", "wheel", "Zahnräder"].map(str::to_owned).to_vec();
        let bytes = to_bytes(&names);
        assert_eq!(from_bytes(&bytes), Some(names));
        assert_eq!(from_bytes(&to_bytes(&[])), Some(Vec::new()));
        for cut in 0..bytes.len() {
            assert_eq!(from_bytes(&bytes[..cut]), None, "{cut}");
        }
        assert_eq!(from_bytes(&[bytes, vec![0]].concat()), None);
        assert_eq!(from_bytes(&[1, 0, 0, 0, 1, 0, 0, 0, 0xff]), None, "no UTF-8");
        assert_eq!(from_bytes(&[255; 12]), None);
    }
}
