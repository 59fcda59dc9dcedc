//! How many pairs lie in each decade of depth, and the widest gap between depths.
//!
//! In models of buildings, depths below a hundredth of a millimeter are rounding, and depths above
//! a tenth are mistakes. Few pairs lie between, and a tolerance in that gap tells them apart.

/// Numbers of pairs by depth. Lengths are in world units.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Decades {
    /// The decades that are not empty, from the least depth.
    pub decades: Vec<Decade>,
    /// The widest gap between depths, or `None` if no depth is twice as large as the one below it.
    pub gap: Option<DepthGap>,
}

/// Number of pairs whose depth is at least `from` and less than `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decade {
    /// Least depth: a power of 10, or 0 in the first decade, which holds all depths below the
    /// rounding of coordinates.
    pub from: f64,
    /// End of the decade: the next power of 10.
    pub to: f64,
    /// Number of pairs.
    pub count: usize,
}

/// A gap between depths: the largest ratio of two depths with few depths between them, at least 2.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DepthGap {
    /// Largest depth below the gap.
    pub from: f64,
    /// Smallest depth above the gap.
    pub to: f64,
    /// Number of pairs below the gap.
    pub below: usize,
    /// Number of pairs inside the gap: at most one of 1,000 pairs.
    pub inside: usize,
    /// Number of pairs above the gap.
    pub above: usize,
}

/// Number of pairs for each pair that may lie inside the gap. A smaller number makes gaps of pairs
/// that are not rare; with a larger one a few odd pairs hide the gap.
const PAIRS_PER_STRAY: usize = 1000;

/// Minimum ratio of the depths on both sides of a gap. Depths that differ less belong together.
const MIN_RATIO: f64 = 2.0;

/// Maximum number of pairs inside the gap. The time grows with it.
const MAX_STRAYS: usize = 16;

impl Decades {
    /// Counts depths. `rounding` is the depth below which depths do not differ.
    pub(super) fn new(mut depths: Vec<f64>, rounding: f64) -> Self {
        depths.retain(|depth| depth.is_finite());
        let floor = rounding.max(f64::MIN_POSITIVE);
        depths.sort_unstable_by(f64::total_cmp);
        let small = depths.partition_point(|&depth| depth < floor);
        let mut decades: Vec<Decade> = Vec::new();
        if small > 0 {
            decades.push(Decade { from: 0.0, to: floor, count: small });
        }
        for &depth in &depths[small..] {
            match decades.last_mut() {
                Some(decade) if depth < decade.to => decade.count += 1,
                _ => {
                    let [from, to] = powers_around(depth);
                    let from = decades.last().map_or(from, |last| last.to.max(from));
                    decades.push(Decade { from, to, count: 1 });
                }
            }
        }
        Self { decades, gap: widest_gap(&depths, floor) }
    }
}

/// Returns the powers of 10 around a positive number: the largest that is not above it, and the
/// next.
fn powers_around(depth: f64) -> [f64; 2] {
    let power = |exponent: i32| format!("1e{exponent}").parse::<f64>().unwrap_or(f64::INFINITY);
    let mut exponent = depth.log10().floor() as i32;
    while power(exponent) > depth {
        exponent -= 1;
    }
    while power(exponent + 1) <= depth {
        exponent += 1;
    }
    [power(exponent), power(exponent + 1)]
}

fn widest_gap(sorted: &[f64], floor: f64) -> Option<DepthGap> {
    let strays = (sorted.len() / PAIRS_PER_STRAY).min(MAX_STRAYS);
    let mut best: Option<(f64, usize, usize)> = None;
    for low in 0..sorted.len() {
        for high in low + 1..sorted.len().min(low + 2 + strays) {
            // Each pair inside must double the ratio, or else the gap ends there.
            let ratio = sorted[high].max(floor) / sorted[low].max(floor);
            let width = ratio / 2_f64.powi((high - low - 1) as i32);
            if width >= MIN_RATIO && best.is_none_or(|(most, ..)| width > most) {
                best = Some((width, low, high));
            }
        }
    }
    let (_, low, high) = best?;
    let (below, above) = (low + 1, sorted.len() - high);
    Some(DepthGap { from: sorted[low], to: sorted[high], below, inside: high - low - 1, above })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depths_are_counted_by_decade() {
        let depths = vec![3.0, 0.0, 1e-17, 0.05, 0.1, 0.099, 2.9, f64::INFINITY, 1e-6];
        let found = Decades::new(depths, 2e-6).decades;
        let expected = [(0.0, 2e-6, 3), (0.01, 0.1, 2), (0.1, 1.0, 1), (1.0, 10.0, 2)];
        assert_eq!(found.iter().map(|d| (d.from, d.to, d.count)).collect::<Vec<_>>(), expected);
        assert_eq!(Decades::new(Vec::new(), 0.0), Decades::default());
    }

    #[test]
    fn powers_of_ten_begin_their_decade() {
        for exponent in -20..20 {
            let power = format!("1e{exponent}").parse::<f64>().unwrap();
            assert_eq!(powers_around(power)[0], power);
            assert_eq!(powers_around(power.next_down())[1], power);
        }
    }

    #[test]
    fn the_widest_gap_separates_rounding_from_mistakes() {
        let of = |depths: &[f64]| Decades::new(depths.to_vec(), 1e-9).gap;
        let gap = of(&[1e-7, 2e-7, 3e-3, 1e-2, 0.1]).unwrap();
        assert_eq!((gap.from, gap.to, gap.below, gap.inside, gap.above), (2e-7, 3e-3, 2, 0, 3));
        // Depths below the rounding of coordinates do not differ.
        let gap = of(&[0.0, 1e-18, 1e-2, 0.5]).unwrap();
        assert_eq!((gap.from, gap.to), (1e-18, 1e-2));
        assert_eq!((of(&[]), of(&[1.0]), of(&[1.0, 1.5, 2.5])), (None, None, None));
        // One stray in 2,000 pairs does not hide the gap.
        let mut many = vec![1e-7; 1000];
        many.extend([2e-3; 1000]);
        many.push(1e-5);
        let gap = of(&many).unwrap();
        assert_eq!((gap.below, gap.inside, gap.above), (1000, 1, 1000));
    }
}
