//! Distances of round volumes against quadratic programming in rationals.

use dashu_ratio::RBig;
use impinge::volume::{BoundingSphere, BoundingVolume, Capsule, DistanceBounds, Lozenge, Proximity, Round};
use impinge_testkit::generate::Rng;

use crate::volumes::exact::rational;

type Vector = [RBig; 3];

/// Core of a round volume: a corner and edges, exactly.
struct Core {
    corner: Vector,
    edges: Vec<Vector>,
    radius: f64,
}

fn exactly(p: [f64; 3]) -> Vector {
    p.map(rational)
}

fn minus(p: &Vector, q: &Vector) -> Vector {
    std::array::from_fn(|k| p[k].clone() - q[k].clone())
}

fn dot(p: &Vector, q: &Vector) -> RBig {
    (0..3).fold(RBig::ZERO, |sum, k| sum + p[k].clone() * q[k].clone())
}

/// Returns the minimum of |w - Σ tᵢ edgeᵢ|² for t in the unit cube.
///
/// A convex quadratic has its minimum at a stationary point of some face of the cube. If a face has
/// no unique stationary point, a smaller face has the same minimum.
fn squared_distance(a: &Core, b: &Core) -> RBig {
    let w = minus(&b.corner, &a.corner);
    let negated = b.edges.iter().map(|edge| edge.each_ref().map(|x| -x.clone()));
    let edges: Vec<Vector> = a.edges.iter().cloned().chain(negated).collect();
    let mut least: Option<RBig> = None;
    for face in 0..3_usize.pow(edges.len() as u32) {
        let mut rest = w.clone();
        let mut free = Vec::new();
        let mut code = face;
        for edge in &edges {
            match code % 3 {
                0 => {}
                1 => rest = minus(&rest, edge),
                _ => free.push(edge),
            }
            code /= 3;
        }
        let Some(t) = solve(&free, &rest) else { continue };
        if t.iter().any(|x| *x < RBig::ZERO || *x > RBig::ONE) {
            continue;
        }
        for (t, edge) in t.iter().zip(&free) {
            rest = std::array::from_fn(|k| rest[k].clone() - t.clone() * edge[k].clone());
        }
        let square = dot(&rest, &rest);
        least = Some(least.map_or(square.clone(), |least| least.min(square)));
    }
    least.expect("the corners are faces")
}

/// Returns the t with (edgeᵢ · Σ tⱼ edgeⱼ) = edgeᵢ · w by elimination, or `None` if it is not
/// unique.
fn solve(edges: &[&Vector], w: &Vector) -> Option<Vec<RBig>> {
    let n = edges.len();
    let mut rows: Vec<Vec<RBig>> =
        edges.iter().map(|edge| edges.iter().map(|other| dot(edge, other)).chain([dot(edge, w)]).collect()).collect();
    for k in 0..n {
        let pivot = (k..n).find(|&row| rows[row][k] != RBig::ZERO)?;
        rows.swap(k, pivot);
        for row in 0..n {
            if row != k && rows[row][k] != RBig::ZERO {
                let factor = rows[row][k].clone() / rows[k][k].clone();
                for column in k..=n {
                    let part = factor.clone() * rows[k][column].clone();
                    rows[row][column] = rows[row][column].clone() - part;
                }
            }
        }
    }
    Some((0..n).map(|k| rows[k][n].clone() / rows[k][k].clone()).collect())
}

/// Volumes that can be rebuilt with another radius.
trait Resized: Round {
    fn resized(&self, radius: f64) -> Self;
}

impl Resized for BoundingSphere {
    fn resized(&self, radius: f64) -> Self {
        Self::new(self.center(), radius).unwrap()
    }
}

impl Resized for Capsule {
    fn resized(&self, radius: f64) -> Self {
        let [start, end] = self.ends();
        Self::new(start, end, radius).unwrap()
    }
}

impl Resized for Lozenge {
    fn resized(&self, radius: f64) -> Self {
        Self::new(self.corner(), self.edges(), radius).unwrap()
    }
}

/// Size and offset shared by a pair, and whether numbers are on a grid and the pair touches.
struct Draw {
    size: f64,
    offset: f64,
    grid: bool,
    touch: bool,
}

impl Draw {
    fn new(rng: &mut Rng) -> Self {
        let (size, offset) = (rng.choose(&[1.0, 1e-6, 1e6]), rng.choose(&[0.0, 0.0, 1e7]));
        Self { size, offset, grid: !rng.one_in(3), touch: rng.one_in(2) }
    }

    fn vector(&self, rng: &mut Rng) -> [f64; 3] {
        std::array::from_fn(|_| self.size * if self.grid { rng.integer(-2, 2) as f64 } else { rng.uniform(-2.0, 2.0) })
    }

    fn point(&self, rng: &mut Rng) -> [f64; 3] {
        self.vector(rng).map(|x| x + self.offset)
    }

    fn radius(&self, rng: &mut Rng) -> f64 {
        self.size * rng.choose(&[0.0, 0.25, 0.5, 1.0])
    }

    fn sphere(&self, rng: &mut Rng) -> (BoundingSphere, Core) {
        let (center, radius) = (self.point(rng), self.radius(rng));
        (BoundingSphere::new(center, radius).unwrap(), Core { corner: exactly(center), edges: vec![], radius })
    }

    fn capsule(&self, rng: &mut Rng) -> (Capsule, Core) {
        let (start, radius) = (self.point(rng), self.radius(rng));
        let end = if rng.one_in(6) { start } else { self.point(rng) };
        let edge = minus(&exactly(end), &exactly(start));
        (Capsule::new(start, end, radius).unwrap(), Core { corner: exactly(start), edges: vec![edge], radius })
    }

    fn lozenge(&self, rng: &mut Rng) -> (Lozenge, Core) {
        let (corner, radius) = (self.point(rng), self.radius(rng));
        let u = self.vector(rng);
        // At right angles to `u`, and of the same kind of numbers; sometimes a segment or a point.
        let v = match rng.integer(0, 5) {
            0 => [0.0; 3],
            1 => [-u[1], u[0], 0.0],
            2 => [0.0, -u[2], u[1]],
            _ => [u[2], 0.0, -u[0]],
        };
        let core = Core { corner: exactly(corner), edges: vec![exactly(u), exactly(v)], radius };
        (Lozenge::new(corner, [u, v], radius).unwrap(), core)
    }
}

/// Counts of outcomes for one pair of kinds.
#[derive(Debug, Default)]
struct Tally {
    apart: usize,
    meets: usize,
    undecided: usize,
    touching: usize,
}

impl Tally {
    fn check<A: Resized, B: Resized>(&mut self, (mut a, mut core_a): (A, Core), (b, core_b): (B, Core), draw: &Draw) {
        let squared = squared_distance(&core_a, &core_b);
        // Half of the pairs touch, exactly if the root of the square is a double, else nearly.
        let gap = squared.to_f64().value().sqrt() - core_b.radius;
        if draw.touch && gap >= 0.0 {
            core_a.radius = gap;
            a = a.resized(gap);
        }
        let radii = rational(core_a.radius) + rational(core_b.radius);
        let DistanceBounds { lower, upper } = a.distance(&b);
        assert!(0.0 <= lower && lower <= upper && upper.is_finite());
        let square = |x: RBig| x.clone() * x;
        let bound = |x: f64| square(rational(x) + radii.clone());
        assert!(lower == 0.0 || bound(lower) <= squared, "{lower:e} is above the distance");
        assert!(bound(upper) >= squared, "{upper:e} is below the distance");
        let size = 8.0 * draw.size + draw.offset;
        assert!(upper - lower <= size / (1_u64 << 46) as f64, "{lower:e} to {upper:e} is wide for {size:e}");
        let meets = squared <= square(radii.clone());
        match a.proximity(&b) {
            Proximity::Apart => {
                assert!(!meets && !a.meets(&b));
                self.apart += 1;
            }
            Proximity::Intersects => {
                assert!(meets && a.meets(&b));
                self.meets += 1;
            }
            Proximity::Undecided => {
                assert!(a.meets(&b));
                self.undecided += 1;
            }
        }
        self.touching += usize::from(squared == square(radii));
    }
}

#[test]
fn the_interval_contains_the_distance_for_every_pair_of_kinds() {
    let mut rng = Rng::new(61);
    let mut tally: [Tally; 6] = Default::default();
    for _ in 0..300 {
        let draw = Draw::new(&mut rng);
        let (s, c, l) =
            (&mut |rng: &mut Rng| draw.sphere(rng), &mut |rng: &mut Rng| draw.capsule(rng), &mut |rng: &mut Rng| {
                draw.lozenge(rng)
            });
        tally[0].check(s(&mut rng), s(&mut rng), &draw);
        tally[1].check(s(&mut rng), c(&mut rng), &draw);
        tally[2].check(l(&mut rng), s(&mut rng), &draw);
        tally[3].check(c(&mut rng), c(&mut rng), &draw);
        tally[4].check(c(&mut rng), l(&mut rng), &draw);
        tally[5].check(l(&mut rng), l(&mut rng), &draw);
    }
    for counts in &tally {
        assert!(counts.apart > 60 && counts.meets > 8 && counts.undecided > 20, "{counts:?}");
    }
    assert!(tally.iter().map(|counts| counts.touching).sum::<usize>() > 80, "{tally:?}");
}

#[test]
fn an_interpenetrating_pair_is_proved_to_intersect() {
    let plate = Lozenge::new([0.0; 3], [[4.0, 0.0, 0.0], [0.0, 4.0, 0.0]], 0.5).unwrap();
    let nail = Capsule::new([1.0, 1.0, -3.0], [1.5, 1.0, 3.0], 0.125).unwrap();
    assert_eq!(plate.distance(&nail), DistanceBounds { lower: 0.0, upper: 0.0 });
    assert_eq!(nail.proximity(&plate), Proximity::Intersects);
    let across = Lozenge::new([2.0, 2.0, -1.0], [[0.0, 0.0, 2.0], [1.0, 1.0, 0.0]], 0.0).unwrap();
    assert!(across.overlaps(&plate) && across.proximity(&plate) == Proximity::Intersects);
}
