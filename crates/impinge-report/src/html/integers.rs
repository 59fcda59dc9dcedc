//! Numbers in few bytes: small integers take one byte, and differences of neighbors are small.

/// Appends an integer of any size, 7 bits a byte, the lowest first. The highest bit of a byte says
/// that another byte follows.
pub(super) fn push_integer(bytes: &mut Vec<u8>, mut value: u64) {
    while value >= 0x80 {
        bytes.push((value & 0x7f) as u8 | 0x80);
        value >>= 7;
    }
    bytes.push(value as u8);
}

/// Appends the difference of each value from the one before it, the first from 0. The sign is the
/// lowest bit.
pub(super) fn push_differences(bytes: &mut Vec<u8>, values: impl IntoIterator<Item = u16>) {
    let mut before = 0_i64;
    for value in values {
        let difference = i64::from(value) - before;
        push_integer(bytes, ((difference << 1) ^ (difference >> 63)) as u64);
        before = value.into();
    }
}

/// Appends numbers, each in 8 bytes, the lowest first.
pub(super) fn push_numbers<'n>(bytes: &mut Vec<u8>, numbers: impl IntoIterator<Item = &'n f64>) {
    numbers.into_iter().for_each(|number| bytes.extend(number.to_le_bytes()));
}

/// Appends numbers in single precision, each in 4 bytes, the lowest first.
pub(super) fn push_rounded<'n>(bytes: &mut Vec<u8>, numbers: impl IntoIterator<Item = &'n f64>) {
    numbers.into_iter().for_each(|&number| bytes.extend((number as f32).to_le_bytes()));
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_numbers_and_differences_take_one_byte() {
        let mut bytes = Vec::new();
        [0, 127, 128, 300].into_iter().for_each(|value| push_integer(&mut bytes, value));
        assert_eq!(bytes, [0, 127, 0x80, 1, 0xac, 2]);
        bytes.clear();
        push_differences(&mut bytes, [5, 4, 4, 65535, 0]);
        assert_eq!(bytes, [10, 1, 0, 0xf6, 0xff, 7, 0xfd, 0xff, 7]);
    }
}
