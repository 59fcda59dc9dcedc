//! Formats numbers for people.

/// Formats a count with thousands separators: `1,234,567`.
pub(crate) fn count(n: usize) -> String {
    let digits = n.to_string();
    let mut text = String::with_capacity(digits.len() * 4 / 3);
    for (at, digit) in digits.chars().enumerate() {
        if at > 0 && (digits.len() - at).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}

/// Formats a count of things: `1 pair`, `1,234 pairs`.
pub(crate) fn counted(n: usize, thing: &str) -> String {
    format!("{} {thing}{}", count(n), if n == 1 { "" } else { "s" })
}

/// Formats a length to four significant digits: `1.692`, `6800`, `3.100e-9`.
pub(crate) fn length(x: f64) -> String {
    if x == 0.0 {
        return "0".to_owned();
    }
    if !(1e-3..1e6).contains(&x.abs()) {
        return format!("{x:.3e}");
    }
    let decimals = (0..=6).find(|&decimals| x.abs() * 10_f64.powi(decimals) >= 999.95).unwrap_or(6);
    format!("{x:.*}", usize::try_from(decimals).unwrap_or_default())
}

/// Formats a short time in seconds: `3.1 ns`, `4.2 µs`, or like [`time`] from 1 ms on.
pub(crate) fn short_time(seconds: f64) -> String {
    match seconds {
        _ if seconds < 0.9995e-6 => format!("{:.1} ns", seconds * 1e9),
        _ if seconds < 0.9995e-3 => format!("{:.1} µs", seconds * 1e6),
        _ => time(seconds),
    }
}

/// Formats a time in seconds: `4.2 ms`, `1.34 s`, `75 s`.
pub(crate) fn time(seconds: f64) -> String {
    match seconds {
        _ if seconds < 0.9995 => format!("{:.1} ms", seconds * 1e3),
        _ if seconds < 60.0 => format!("{seconds:.2} s"),
        _ => format!("{seconds:.0} s"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_separated_by_thousands() {
        let cases = [(0, "0"), (999, "999"), (1000, "1,000"), (26756, "26,756"), (1_234_567, "1,234,567")];
        for (n, text) in cases {
            assert_eq!(count(n), text);
        }
        assert_eq!(
            [counted(0, "part"), counted(1, "part"), counted(1000, "part")],
            ["0 parts", "1 part", "1,000 parts"]
        );
    }

    #[test]
    fn lengths_have_four_significant_digits() {
        let cases = [
            (0.0, "0"),
            (1.0, "1.000"),
            (1.692_49, "1.692"),
            (9.999_6, "10.00"),
            (-0.038_123, "-0.03812"),
            (6800.0, "6800"),
            (123_456.7, "123457"),
            (3.1e-9, "3.100e-9"),
            (2.5e30, "2.500e30"),
        ];
        for (x, text) in cases {
            assert_eq!(length(x), text);
        }
    }

    #[test]
    fn times_have_a_unit_that_fits() {
        assert_eq!([0.0042, 0.9996, 1.336, 75.2].map(time), ["4.2 ms", "1.00 s", "1.34 s", "75 s"]);
        assert_eq!([3.14e-9, 4.2e-6, 0.99951e-3].map(short_time), ["3.1 ns", "4.2 µs", "1.0 ms"]);
    }
}
