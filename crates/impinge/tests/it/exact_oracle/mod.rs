//! Oracle of the exact stage: rational images of points, a decision by linear programming, and
//! pairs of triangles with many ties.
//!
//! Every step is in rationals, so a decision is slow. It checks `exact::triangles_intersect`, its
//! filter and its tiers of integers.

use dashu_ratio::RBig;
use impinge::Pose;
use impinge::exact::Corners;

/// Random numbers with a fixed seed: splitmix64 (Steele, Lea, Flood 2014).
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns an integer from `low` to `high`, both included.
    pub(crate) fn integer(&mut self, low: i64, high: i64) -> i64 {
        low + (self.next() % (high - low + 1) as u64) as i64
    }

    /// Returns a number distributed uniformly in [-1, 1).
    pub(crate) fn unit(&mut self) -> f64 {
        self.next() as i64 as f64 / 9_223_372_036_854_775_808.0
    }

    pub(crate) fn one_in(&mut self, n: u64) -> bool {
        self.next().is_multiple_of(n)
    }

    pub(crate) fn pick<T: Copy>(&mut self, from: &[T]) -> T {
        from[self.next() as usize % from.len()]
    }
}

pub(crate) fn rational(x: f64) -> RBig {
    RBig::try_from(x).expect("finite")
}

pub(crate) fn power_of_two(exponent: i32) -> f64 {
    // Two factors are needed, because `powi` takes the reciprocal of a power that may overflow.
    2.0_f64.powi(exponent / 2) * 2.0_f64.powi(exponent - exponent / 2)
}

/// Returns the exact image of a point.
pub(crate) fn world_point(pose: &Pose, v: &[f64; 3]) -> [RBig; 3] {
    std::array::from_fn(|i| {
        (0..3).fold(rational(pose.translation()[i]), |sum, k| sum + rational(pose.linear()[i][k]) * rational(v[k]))
    })
}

/// Reports whether two triangles have a common point.
///
/// They have one if weights `l, m >= 0` exist that sum to 1 each and satisfy `Σ l_i a_i = Σ m_j
/// b_j`. The simplex method with Bland's rule decides that.
pub(crate) fn oracle_intersects(world_from_a: &Pose, world_from_b: &Pose, a: &Corners, b: &Corners) -> bool {
    let a = a.map(|corner| world_point(world_from_a, &corner));
    let b = b.map(|corner| world_point(world_from_b, &corner));
    let zero = RBig::ZERO;
    let one = RBig::ONE;
    let mut rows: Vec<Vec<RBig>> = (0..3)
        .map(|k| {
            let mut row: Vec<RBig> = a.iter().map(|corner| corner[k].clone()).collect();
            row.extend(b.iter().map(|corner| -corner[k].clone()));
            row.push(zero.clone());
            row
        })
        .collect();
    rows.push(vec![one.clone(), one.clone(), one.clone(), zero.clone(), zero.clone(), zero.clone(), one.clone()]);
    rows.push(vec![zero.clone(), zero.clone(), zero.clone(), one.clone(), one.clone(), one.clone(), one]);
    feasible(rows)
}

/// Reports whether `M x = r`, `x >= 0` has a solution. Each row holds a row of `M` and then its
/// right side, which must not be negative.
fn feasible(mut rows: Vec<Vec<RBig>>) -> bool {
    let variables = rows[0].len() - 1;
    // The initial basis has one artificial variable per row. The objective, their sum, must reach
    // zero. Artificial variables that leave need no column, as they never return.
    let mut basis: Vec<usize> = (0..rows.len()).map(|row| variables + row).collect();
    let column_sum = |column: usize| rows.iter().fold(RBig::ZERO, |sum, row| sum + row[column].clone());
    let mut objective: Vec<RBig> = (0..=variables).map(column_sum).collect();
    // Bland's rule: the first column that improves the objective enters.
    while let Some(entering) = (0..variables).find(|&column| objective[column] > RBig::ZERO) {
        let leaving = (0..rows.len())
            .filter(|&row| rows[row][entering] > RBig::ZERO)
            .min_by(|&x, &y| {
                let ratio = |row: usize| rows[row][variables].clone() / rows[row][entering].clone();
                ratio(x).cmp(&ratio(y)).then(basis[x].cmp(&basis[y]))
            })
            .expect("the sum of artificial variables is bounded below");
        let pivot = rows[leaving][entering].clone();
        let pivot_row: Vec<RBig> = rows[leaving].iter().map(|entry| entry.clone() / pivot.clone()).collect();
        let eliminate = |row: &mut Vec<RBig>| {
            let factor = row[entering].clone();
            for (entry, own) in row.iter_mut().zip(&pivot_row) {
                *entry = entry.clone() - factor.clone() * own.clone();
            }
        };
        for row in (0..rows.len()).filter(|&row| row != leaving) {
            eliminate(&mut rows[row]);
        }
        eliminate(&mut objective);
        rows[leaving] = pivot_row;
        basis[leaving] = entering;
    }
    objective[variables] == RBig::ZERO
}

/// Returns two triangles on a small grid. Shared corners, split edges, zero areas and common planes
/// are frequent.
pub(crate) fn tied_pair(random: &mut Random) -> (Corners, Corners) {
    let extent = random.pick(&[1, 2, 2, 3, 8]);
    let flat = random.one_in(3);
    let corner = |random: &mut Random| {
        let mut corner: [f64; 3] = std::array::from_fn(|_| random.integer(-extent, extent) as f64);
        if flat {
            corner[2] = 0.0;
        }
        corner
    };
    let triangle = |random: &mut Random| -> Corners {
        let [p, q, mut r]: Corners = std::array::from_fn(|_| corner(random));
        match random.integer(0, 9) {
            0 => r = p,
            1 => r = std::array::from_fn(|k| 0.5 * (p[k] + q[k])),
            2 => return [p, p, p],
            3 => r = std::array::from_fn(|k| 2.0 * q[k] - p[k]),
            _ => {}
        }
        [p, q, r]
    };
    let a = triangle(random);
    let mut b = triangle(random);
    match random.integer(0, 5) {
        0 => b[0] = a[random.integer(0, 2) as usize],
        1 => b[1] = std::array::from_fn(|k| 0.5 * (a[0][k] + a[1][k])),
        2 => {
            let inside: [f64; 3] = std::array::from_fn(|k| 0.25 * (a[0][k] + a[1][k]) + 0.5 * a[2][k]);
            b[2] = inside;
        }
        _ => {}
    }
    if random.one_in(4) {
        // Both are sheared out of the grid's planes by the same map.
        let shear = [random.integer(-2, 2) as f64, random.integer(-2, 2) as f64];
        let sheared = |[x, y, z]: [f64; 3]| [x, y + shear[0] * z, z + shear[1] * x];
        return (a.map(sheared), b.map(sheared));
    }
    (a, b)
}

/// Returns an invertible linear map with small integer entries.
pub(crate) fn integer_linear(random: &mut Random, extent: i64) -> [[f64; 3]; 3] {
    loop {
        let linear: [[f64; 3]; 3] =
            std::array::from_fn(|_| std::array::from_fn(|_| random.integer(-extent, extent) as f64));
        if Pose::new(linear, [0.0; 3]).is_ok() {
            return linear;
        }
    }
}

pub(crate) fn integer_offset(random: &mut Random, extent: i64) -> [f64; 3] {
    std::array::from_fn(|_| random.integer(-extent, extent) as f64)
}

pub(crate) fn rotation(random: &mut Random) -> Pose {
    let axis = [random.unit(), random.unit(), random.unit() + 1.5];
    let translation = [random.unit(), random.unit(), random.unit()];
    Pose::from_axis_angle(axis, 4.0 * random.unit(), translation).expect("a rotation")
}

/// Returns the pose with the linear part and the translation multiplied by `factor`.
pub(crate) fn scaled(pose: &Pose, factor: f64) -> Pose {
    Pose::new(pose.linear().map(|row| row.map(|x| x * factor)), pose.translation().map(|x| x * factor))
        .expect("within range")
}

pub(crate) fn scaled_corners(corners: &Corners, factor: f64) -> Corners {
    corners.map(|corner| corner.map(|x| x * factor))
}
