//! Sums, products and roots of doubles, rounded up or down, in plain IEEE arithmetic.
//!
//! An exact result is kept, so numbers on a grid stay on it. Any other result moves to the
//! neighboring double on the safe side. Fused multiply-add is not used, so the bits are the same on
//! every machine.
//!
//! Source: Knuth, *The Art of Computer Programming*, volume 2, 4.2.2 (the error of a sum); Dekker
//! 1971 (the error of a product).

/// Largest magnitude for which volumes are proved: 2^320. Every posed coordinate is smaller (below
/// 2^301). Squares, and sums of squares, of smaller numbers are far from overflow.
pub(super) const LIMIT: f64 = f64::from_bits((1023 + 320) << 52);

/// Relative error of one rounding, half a unit in the last place: 2^-53.
pub(super) const HALF_ULP: f64 = 0.5 * f64::EPSILON;

/// Threshold for underflow, 2^-960: the rounding error of a smaller product may itself have lost
/// bits.
const TINY: f64 = f64::from_bits((1023 - 960) << 52);

/// Returns `a + b` rounded to nearest, and its rounding error. Exact unless it overflows.
#[inline(always)]
pub(super) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    (sum, (a - (sum - b_part)) + (b - b_part))
}

/// Returns `a · b` rounded to nearest, and its rounding error. Exact if the product is zero or its
/// magnitude is between 2^-960 and 2^990.
#[inline(always)]
pub(super) fn two_product(a: f64, b: f64) -> (f64, f64) {
    const SPLITTER: f64 = (1_u32 << 27) as f64 + 1.0;
    let split = |x: f64| {
        let wide = SPLITTER * x;
        let high = wide - (wide - x);
        (high, x - high)
    };
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (split(a), split(b));
    (product, a_low * b_low - (((product - a_high * b_high) - a_low * b_high) - a_high * b_low))
}

/// Returns the smallest double that is not below `a + b`.
#[inline(always)]
pub(super) fn add_up(a: f64, b: f64) -> f64 {
    let (sum, lost) = two_sum(a, b);
    if lost > 0.0 { sum.next_up() } else { sum }
}

/// Returns the largest double that is not above `a + b`.
#[inline(always)]
pub(super) fn add_down(a: f64, b: f64) -> f64 {
    0.0 - add_up(-a, -b)
}

/// Returns a double not below `a · b`.
#[inline(always)]
pub(super) fn mul_up(a: f64, b: f64) -> f64 {
    let (product, lost) = two_product(a, b);
    if a == 0.0 || b == 0.0 {
        0.0
    } else if product.abs() < TINY || lost > 0.0 {
        product.next_up()
    } else {
        product
    }
}

/// Returns a double not above `a · b`.
#[inline(always)]
pub(super) fn mul_down(a: f64, b: f64) -> f64 {
    0.0 - mul_up(-a, b)
}

/// Returns a double not above `a / b`, for non-negative `a` and positive `b`.
#[inline(always)]
pub(super) fn div_down(a: f64, b: f64) -> f64 {
    let quotient = a / b;
    if mul_up(quotient, b) <= a { quotient } else { quotient.next_down() }
}

/// Returns a double not below the square root of `x`, for non-negative `x`.
#[inline(always)]
pub(super) fn sqrt_up(x: f64) -> f64 {
    let root = x.sqrt();
    if mul_down(root, root) >= x { root } else { root.next_up() }
}

/// Returns a double not below the length of `vector`.
///
/// # Accuracy
/// Two units in the last place, unless a square underflows.
#[inline(always)]
pub(super) fn length_up([x, y, z]: [f64; 3]) -> f64 {
    sqrt_up(add_up(add_up(mul_up(x, x), mul_up(y, y)), mul_up(z, z)))
}

/// Returns a double not below the distance of two points.
#[inline(always)]
pub(super) fn distance_up(p: [f64; 3], q: [f64; 3]) -> f64 {
    length_up(std::array::from_fn(|axis| add_up(p[axis].max(q[axis]), -p[axis].min(q[axis]))))
}

/// Returns the largest single that is not above `x`. It is minus infinity if every finite single is
/// above.
#[inline(always)]
pub(super) fn f32_down(x: f64) -> f32 {
    let nearest = x as f32;
    if f64::from(nearest) > x { nearest.next_down() } else { nearest }
}

/// Returns the smallest single that is not below `x`. It is infinity if every finite single is
/// below.
#[inline(always)]
pub(super) fn f32_up(x: f64) -> f32 {
    -f32_down(-x)
}

#[cfg(test)]
mod tests {
    use dashu_ratio::RBig;
    use impinge_testkit::generate::Rng;

    use super::*;

    fn exact(x: f64) -> RBig {
        RBig::try_from(x).expect("finite")
    }

    /// Numbers with few or many bits, of similar and of very different size.
    fn number(rng: &mut Rng) -> f64 {
        let mantissa = if rng.one_in(2) { rng.integer(-8, 8) as f64 } else { rng.uniform(-1.0, 1.0) };
        mantissa * 2_f64.powi(rng.integer(-3, 3) as i32 * rng.choose(&[1, 20, 100]))
    }

    #[test]
    fn every_result_is_a_bound_next_to_the_exact_value() {
        let mut rng = Rng::new(1);
        let mut kept = 0;
        for _ in 0..20_000 {
            let (a, b) = (number(&mut rng), number(&mut rng));
            let cases = [
                (exact(a) + exact(b), add_down(a, b), add_up(a, b)),
                (exact(a) * exact(b), mul_down(a, b), mul_up(a, b)),
            ];
            for (truth, down, up) in cases {
                assert!(exact(down) <= truth && truth <= exact(up), "{a:e} {b:e}");
                assert!(down == up || down.next_up() == up, "{a:e} {b:e}: {down:e} {up:e}");
                kept += usize::from(down == up);
            }
            let square = a.abs();
            let up = sqrt_up(square);
            assert!(exact(square) <= exact(up) * exact(up));
            assert!(up == 0.0 || exact(up.next_down()) * exact(up.next_down()) <= exact(square));
            if b != 0.0 {
                assert!(exact(div_down(a.abs(), b.abs())) * exact(b.abs()) <= exact(a.abs()));
            }
            let (down, up) = (f32_down(a), f32_up(a));
            assert!(f64::from(down) <= a && a <= f64::from(up) && (down == up || down.next_up() == up));
        }
        assert!(kept > 10_000, "{kept} of 40,000 are exact");
    }

    #[test]
    fn underflowing_products_are_rounded_outward() {
        let tiny = f64::from_bits(3);
        assert_eq!((mul_down(tiny, 0.5), mul_up(tiny, tiny)), (f64::from_bits(1), f64::from_bits(1)));
        assert_eq!((mul_up(-tiny, tiny), mul_down(-tiny, tiny)), (f64::from_bits(1), -f64::from_bits(1)));
        assert_eq!(length_up([tiny, 0.0, 0.0]).total_cmp(&tiny), std::cmp::Ordering::Greater);
        assert_eq!((length_up([3.0, 4.0, 0.0]), distance_up([1.0; 3], [1.0; 3])), (5.0, 0.0));
    }
}
