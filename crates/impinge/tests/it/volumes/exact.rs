//! Oracle: points of volumes in rational arithmetic, from the meaning of their numbers. It shares
//! no code with the library.
//!
//! It checks fitting, merging, moving and overlap tests of every volume.

use dashu_ratio::RBig;
use impinge::Pose;
use impinge::volume::{BoundingSphere, BoundingVolume, Capsule, CenterRadius, Kdop, Lozenge, MinMax, MinWidths, Obb};

pub(crate) type Point = [RBig; 3];

pub(crate) fn rational(x: f64) -> RBig {
    RBig::try_from(x).expect("finite")
}

pub(crate) fn point(p: [f64; 3]) -> Point {
    p.map(rational)
}

/// Returns the exact image of a point.
pub(crate) fn image(pose: &Pose, p: &Point) -> Point {
    std::array::from_fn(|i| {
        (0..3).fold(rational(pose.translation()[i]), |sum, j| sum + rational(pose.linear()[i][j]) * p[j].clone())
    })
}

fn subtract(p: &Point, q: &Point) -> Point {
    std::array::from_fn(|k| p[k].clone() - q[k].clone())
}

fn dot(p: &Point, q: &Point) -> RBig {
    (0..3).fold(RBig::ZERO, |sum, k| sum + p[k].clone() * q[k].clone())
}

fn cross(p: &Point, q: &Point) -> Point {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        p[i].clone() * q[j].clone() - p[j].clone() * q[i].clone()
    })
}

fn magnitude(x: RBig) -> RBig {
    if x < RBig::ZERO { -x } else { x }
}

fn clamp(x: RBig) -> RBig {
    x.max(RBig::ZERO).min(RBig::ONE)
}

/// Volumes with an exact test of their points.
pub(crate) trait Exact: BoundingVolume {
    fn holds(&self, p: &Point) -> bool;

    /// Returns points of the volume, on its boundary if that is easy: its corners, poles and ends.
    fn witnesses(&self) -> Vec<Point>;

    /// Returns bounds of the volume along z. The witnesses fall short of them by less than the
    /// difference of the bounds.
    fn heights(&self) -> Option<[RBig; 2]> {
        let heights = || self.witnesses().into_iter().map(|p| p[2].clone());
        Some([heights().min()?, heights().max()?])
    }
}

impl Exact for MinMax {
    fn holds(&self, p: &Point) -> bool {
        (0..3).all(|k| rational(self.min()[k]) <= p[k] && p[k] <= rational(self.max()[k]))
    }

    fn witnesses(&self) -> Vec<Point> {
        corners(&point(self.min()), &point(self.max()))
    }
}

impl Exact for MinWidths {
    fn holds(&self, p: &Point) -> bool {
        (0..3).all(|k| {
            let low = rational(self.min()[k]);
            low <= p[k] && p[k] <= low + rational(self.widths()[k])
        })
    }

    fn witnesses(&self) -> Vec<Point> {
        let low = point(self.min());
        let high = std::array::from_fn(|k| low[k].clone() + rational(self.widths()[k]));
        corners(&low, &high)
    }
}

impl Exact for CenterRadius {
    fn holds(&self, p: &Point) -> bool {
        (0..3).all(|k| magnitude(p[k].clone() - rational(self.center()[k])) <= rational(self.half_extents()[k]))
    }

    fn witnesses(&self) -> Vec<Point> {
        let (center, half) = (point(self.center()), point(self.half_extents()));
        let low = subtract(&center, &half);
        let high = std::array::from_fn(|k| center[k].clone() + half[k].clone());
        corners(&low, &high)
    }
}

impl Exact for BoundingSphere {
    fn holds(&self, p: &Point) -> bool {
        let offset = subtract(p, &point(self.center()));
        let radius = rational(self.radius());
        dot(&offset, &offset) <= radius.clone() * radius
    }

    fn witnesses(&self) -> Vec<Point> {
        poles(&point(self.center()), self.radius())
    }
}

impl Exact for Capsule {
    fn holds(&self, p: &Point) -> bool {
        let [a, b] = self.ends().map(point);
        let edge = subtract(&b, &a);
        let square = dot(&edge, &edge);
        let offset = subtract(p, &a);
        let t = if square == RBig::ZERO { RBig::ZERO } else { clamp(dot(&offset, &edge) / square) };
        within(&offset, &[(t, &edge)], self.radius())
    }

    fn witnesses(&self) -> Vec<Point> {
        self.ends().iter().flat_map(|&end| poles(&point(end), self.radius())).collect()
    }
}

impl Exact for Lozenge {
    fn holds(&self, p: &Point) -> bool {
        let [u, v] = self.edges().map(point);
        let offset = subtract(p, &point(self.corner()));
        let (uu, uv, vv) = (dot(&u, &u), dot(&u, &v), dot(&v, &v));
        let determinant = uu.clone() * vv.clone() - uv.clone() * uv.clone();
        let (up, vp) = (dot(&u, &offset), dot(&v, &offset));
        // The minimum of a convex quadratic over the unit square is inside, or on one of the sides.
        let mut places = Vec::new();
        if determinant > RBig::ZERO {
            let s = (vv.clone() * up.clone() - uv.clone() * vp.clone()) / determinant.clone();
            let t = (uu.clone() * vp.clone() - uv.clone() * up.clone()) / determinant;
            if clamp(s.clone()) == s && clamp(t.clone()) == t {
                places.push([s, t]);
            }
        }
        let best = |numerator: RBig, square: &RBig| {
            if *square == RBig::ZERO { RBig::ZERO } else { clamp(numerator / square.clone()) }
        };
        for end in [RBig::ZERO, RBig::ONE] {
            places.push([end.clone(), best(vp.clone() - end.clone() * uv.clone(), &vv)]);
            places.push([best(up.clone() - end.clone() * uv.clone(), &uu), end]);
        }
        places.into_iter().any(|[s, t]| within(&offset, &[(s, &u), (t, &v)], self.radius()))
    }

    fn witnesses(&self) -> Vec<Point> {
        let [u, v] = self.edges().map(point);
        let corner = point(self.corner());
        let at = |s: bool, t: bool| -> Point {
            std::array::from_fn(|k| {
                let along = |taken: bool, edge: &Point| if taken { edge[k].clone() } else { RBig::ZERO };
                corner[k].clone() + along(s, &u) + along(t, &v)
            })
        };
        [(false, false), (true, false), (false, true), (true, true)]
            .iter()
            .flat_map(|&(s, t)| poles(&at(s, t), self.radius()))
            .collect()
    }
}

impl Exact for Obb {
    fn holds(&self, p: &Point) -> bool {
        let [a, b, c] = self.axes().map(point);
        let offset = subtract(p, &point(self.center()));
        let normals = [cross(&b, &c), cross(&c, &a), cross(&a, &b)];
        let volume = dot(&a, &normals[0]);
        assert!(volume != RBig::ZERO, "the axes span space");
        (0..3).all(|k| magnitude(dot(&offset, &normals[k]) / volume.clone()) <= rational(self.half_extents()[k]))
    }

    fn witnesses(&self) -> Vec<Point> {
        let axes = self.axes().map(point);
        (0..8)
            .map(|corner| {
                std::array::from_fn(|k| {
                    (0..3).fold(rational(self.center()[k]), |sum, axis| {
                        let reach = axes[axis][k].clone() * rational(self.half_extents()[axis]);
                        if corner >> axis & 1 == 1 { sum + reach } else { sum - reach }
                    })
                })
            })
            .collect()
    }
}

impl<const D: usize> Exact for Kdop<D> {
    fn holds(&self, p: &Point) -> bool {
        (0..D).all(|k| {
            let height = dot(&point(Self::DIRECTIONS[k]), p);
            rational(self.low()[k]) <= height && height <= rational(self.high()[k])
        })
    }

    /// Returns points from the middle of the box, if that is inside, toward its corners and sides
    /// as far as the slabs permit.
    fn witnesses(&self) -> Vec<Point> {
        let low: Point = std::array::from_fn(|k| rational(self.low()[k]));
        let high: Point = std::array::from_fn(|k| rational(self.high()[k]));
        let half = RBig::ONE / RBig::from(2);
        let middle: Point = std::array::from_fn(|k| (low[k].clone() + high[k].clone()) * half.clone());
        if !self.holds(&middle) {
            return corners(&low, &high).into_iter().filter(|corner| self.holds(corner)).collect();
        }
        let sides = (0..6).map(|i| -> Point {
            std::array::from_fn(|k| if k != i / 2 { middle[k].clone() } else { [&low, &high][i % 2][k].clone() })
        });
        let targets = corners(&low, &high).into_iter().chain(sides);
        targets
            .map(|target| {
                let way = subtract(&target, &middle);
                let mut share = RBig::ONE;
                for k in 0..D {
                    let n = point(Self::DIRECTIONS[k]);
                    let (at, rise) = (dot(&n, &middle), dot(&n, &way));
                    let end = if rise > RBig::ZERO { self.high()[k] } else { self.low()[k] };
                    if rise != RBig::ZERO {
                        share = share.min((rational(end) - at) / rise);
                    }
                }
                std::array::from_fn(|k| middle[k].clone() + share.clone() * way[k].clone())
            })
            .collect()
    }

    fn heights(&self) -> Option<[RBig; 2]> {
        Some([rational(self.low()[2]), rational(self.high()[2])])
    }
}

/// Reports whether |offset - Σ t edge| is at most the radius.
fn within(offset: &Point, parts: &[(RBig, &Point)], radius: f64) -> bool {
    let rest: Point = std::array::from_fn(|k| {
        parts.iter().fold(offset[k].clone(), |rest, (t, edge)| rest - t.clone() * edge[k].clone())
    });
    let radius = rational(radius);
    dot(&rest, &rest) <= radius.clone() * radius
}

fn corners(low: &Point, high: &Point) -> Vec<Point> {
    (0..8).map(|i| std::array::from_fn(|k| if i >> k & 1 == 1 { high[k].clone() } else { low[k].clone() })).collect()
}

fn poles(center: &Point, radius: f64) -> Vec<Point> {
    let at = |axis: usize, reach: f64| -> Point {
        std::array::from_fn(|k| center[k].clone() + if k == axis { rational(reach) } else { RBig::ZERO })
    };
    (0..3).flat_map(|axis| [at(axis, radius), at(axis, -radius)]).collect()
}
