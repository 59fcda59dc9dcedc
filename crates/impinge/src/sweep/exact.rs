//! Contact over short intervals of time, in exact arithmetic. It is used if doubles are not
//! certain.

use super::floats::Verdict;
use super::impact::Impact;
use super::polynomials::{Polynomials, Split};
use super::span::{CONTACT_LEVEL, Span};
use crate::math::Sign::{self, Negative, Positive, Zero};
use crate::math::dyadic::Dyadic;

/// Maximum number of times that the motion is halved. A miss by less than the change over 2^-96 of
/// the motion is not distinguished from contact. A larger number costs time for pairs that touch
/// without crossing, at a time that is not a binary fraction.
const MAX_LEVEL: u32 = 96;

/// Cost of evaluating an interval in the middle of the motion, in units of an interval that comes
/// from halving.
const FRESH_WORK: u32 = 16;

/// The corners as exact numbers.
pub(super) struct Exact {
    polynomials: Polynomials<Dyadic>,
    /// Differences by axis between corners of one simplex and of the other, at both ends of the
    /// motion.
    differences: [Vec<[Dyadic; 2]>; 3],
}

/// Polynomials over one interval, as positive multiples of their Bernstein coefficients.
struct Node {
    span: Span,
    polynomials: Polynomials<Dyadic>,
}

impl Exact {
    pub(super) fn new(t0: &[[f64; 3]; 4], t1: &[[f64; 3]; 4], split: Split) -> Self {
        let [start, end] = [t0, t1].map(|corners| corners.map(|corner| corner.map(Dyadic::from_f64)));
        let first = split.first();
        let differences = [0, 1, 2].map(|axis| {
            let pairs = (0..first).flat_map(|i| (first..4).map(move |j| (i, j)));
            pairs.map(|(i, j)| [&start, &end].map(|corners| &corners[i][axis] - &corners[j][axis])).collect()
        });
        Self { polynomials: Polynomials::new(&start, &end, split), differences }
    }

    /// Returns the polynomials, each divided by the sum of its coefficients' magnitudes, with every
    /// coefficient then rounded to the nearest float. The division keeps all signs.
    pub(super) fn rounded(&self) -> Polynomials<f64> {
        let Polynomials { volume, areas } = &self.polynomials;
        Polynomials { volume: normalized(volume), areas: areas.each_ref().map(|axis| axis.each_ref().map(normalized)) }
    }

    /// Returns the first contact within `span`, or `None` if contact is disproved there.
    ///
    /// Each interval takes one unit of `work`. If no work is left, the result is undecided, which
    /// is the safe answer.
    pub(super) fn first_contact(&self, span: Span, work: &mut u32) -> Option<Impact> {
        *work = work.saturating_sub(FRESH_WORK);
        let mut stack = vec![self.node(span)];
        while let Some(node) = stack.pop() {
            let span = node.span;
            let undecided = Impact::between(span.low(), f64::INFINITY);
            if *work == 0 {
                return Some(undecided);
            }
            *work -= 1;
            let verdict = self.classify(&node);
            if verdict == Verdict::Apart {
                continue;
            }
            if self.touches_at_start(&node) {
                return Some(Impact::between(span.low(), span.low_above()));
            }
            if span.level >= CONTACT_LEVEL {
                if verdict == Verdict::Contact || self.touches_at_end(&node) {
                    return Some(Impact::between(span.low(), span.high()));
                }
                if span.level >= MAX_LEVEL {
                    return Some(undecided);
                }
            }
            let [left, right] = node.halves();
            stack.push(right);
            stack.push(left);
        }
        None
    }

    fn node(&self, span: Span) -> Node {
        let [low, high] = [span.index, span.index + 1].map(|index| exact_time(index, span.level));
        let one = Dyadic::from_f64(1.0);
        let mix = |x: &Dyadic, y: &Dyadic, t: &Dyadic| &(x * &(&one - t)) + &(y * t);
        let halve =
            |c: &[Dyadic], t: &Dyadic| -> Vec<Dyadic> { c.windows(2).map(|pair| mix(&pair[0], &pair[1], t)).collect() };
        // Value of the polar form at `low` taken `at_low` times and at `high` for the rest.
        let polar = |c: &[Dyadic], at_low: usize| {
            let mut c = c.to_vec();
            while c.len() > 1 {
                c = halve(&c, if c.len() > at_low + 1 { &high } else { &low });
            }
            c.swap_remove(0)
        };
        let volume = [3, 2, 1, 0].map(|at_low| polar(&self.polynomials.volume, at_low));
        let areas = self
            .polynomials
            .areas
            .each_ref()
            .map(|areas| areas.each_ref().map(|area| [2, 1, 0].map(|at_low| polar(area, at_low))));
        Node { span, polynomials: Polynomials { volume, areas } }
    }

    fn classify(&self, node: &Node) -> Verdict {
        let Polynomials { volume, areas } = &node.polynomials;
        if common_sign(volume).is_some() {
            return Verdict::Apart;
        }
        let mut is_inside = false;
        for axis in areas {
            let signs = axis.each_ref().map(common_sign);
            if signs.contains(&Some(Positive)) && signs.contains(&Some(Negative)) {
                return Verdict::Apart;
            }
            is_inside |= !signs.contains(&None);
        }
        if is_inside {
            let crosses = volume[0].sign() != Zero && volume[0].sign() == -volume[3].sign();
            return if crosses { Verdict::Contact } else { Verdict::Undecided };
        }
        if self.are_separated(&[node.span.index, node.span.index + 1], node.span.level) {
            return Verdict::Apart;
        }
        Verdict::Undecided
    }

    fn touches_at_start(&self, node: &Node) -> bool {
        let Polynomials { volume, areas } = &node.polynomials;
        volume[0].sign() == Zero
            && areas.iter().all(|axis| agree(axis.each_ref().map(|area| area[0].sign())))
            && !self.are_separated(&[node.span.index], node.span.level)
    }

    fn touches_at_end(&self, node: &Node) -> bool {
        let Polynomials { volume, areas } = &node.polynomials;
        volume[3].sign() == Zero
            && areas.iter().all(|axis| agree(axis.each_ref().map(|area| area[2].sign())))
            && !self.are_separated(&[node.span.index + 1], node.span.level)
    }

    /// Reports whether the corners of one simplex are beyond those of the other along some axis at
    /// all given times. The times are multiples of `2^-level`.
    fn are_separated(&self, times: &[u128], level: u32) -> bool {
        let one = Dyadic::from_f64(1.0);
        let times: Vec<Dyadic> = times.iter().map(|&index| exact_time(index, level)).collect();
        self.differences.iter().any(|pairs| {
            let mut signs = pairs.iter().flat_map(|[start, end]| {
                times.iter().map(|t| (&(start * &(&one - t)) + &(end * t)).sign()).collect::<Vec<_>>()
            });
            let first = signs.next().unwrap_or(Zero);
            first != Zero && signs.all(|sign| sign == first)
        })
    }
}

impl Node {
    fn halves(self) -> [Self; 2] {
        let Polynomials { volume: [a, b, c, d], areas } = self.polynomials;
        let sum = |x: &Dyadic, y: &Dyadic| x + y;
        let twice = |x: &Dyadic| x + x;
        let (ab, bc, cd) = (sum(&a, &b), sum(&b, &c), sum(&c, &d));
        let (abc, bcd) = (sum(&ab, &bc), sum(&bc, &cd));
        let middle = sum(&abc, &bcd);
        let eightfold = |x: &Dyadic| twice(&twice(&twice(x)));
        let fourfold = |x: &Dyadic| twice(&twice(x));
        let volumes = [
            [eightfold(&a), fourfold(&ab), twice(&abc), middle.clone()],
            [middle, twice(&bcd), fourfold(&cd), eightfold(&d)],
        ];
        let areas = areas.map(|axis| {
            axis.map(|[a, b, c]| {
                let (ab, bc) = (sum(&a, &b), sum(&b, &c));
                let middle = sum(&ab, &bc);
                ([fourfold(&a), twice(&ab), middle.clone()], [middle, twice(&bc), fourfold(&c)])
            })
        });
        let [left, right] = volumes;
        let lefts = areas.each_ref().map(|axis| axis.each_ref().map(|(left, _)| left.clone()));
        let rights = areas.map(|axis| axis.map(|(_, right)| right));
        let [left_span, right_span] = self.span.halves();
        [
            Self { span: left_span, polynomials: Polynomials { volume: left, areas: lefts } },
            Self { span: right_span, polynomials: Polynomials { volume: right, areas: rights } },
        ]
    }
}

fn normalized<const N: usize>(coefficients: &[Dyadic; N]) -> [f64; N] {
    let sum = coefficients.iter().fold(Dyadic::ZERO, |sum, x| if x.sign() == Negative { &sum - x } else { &sum + x });
    if sum.sign() == Zero {
        return [0.0; N];
    }
    coefficients.each_ref().map(|x| Dyadic::nearest_quotient(x, &sum))
}

/// Returns the time `index / 2^level`, exactly.
fn exact_time(index: u128, level: u32) -> Dyadic {
    // No index has more than 97 bits, so both parts are exact.
    let (high, low) = ((index >> 50) as f64, (index & ((1 << 50) - 1)) as f64);
    let step = f64::from_bits(u64::from(1023 - level) << 52);
    let fifty = (1_u64 << 50) as f64;
    &Dyadic::product(high, step * fifty) + &Dyadic::product(low, step)
}

/// Returns the common sign of some numbers, or `None` if their signs differ or one is zero.
fn common_sign<const N: usize>(values: &[Dyadic; N]) -> Option<Sign> {
    let sign = values[0].sign();
    (sign != Zero && values.iter().all(|x| x.sign() == sign)).then_some(sign)
}

/// Reports whether no two signs are opposite.
fn agree(signs: [Sign; 4]) -> bool {
    !(signs.contains(&Positive) && signs.contains(&Negative))
}
