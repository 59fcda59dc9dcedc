//! The plane across an axis that cuts a cell best, by the surface area heuristic at the borders of bins.
//!
//! Source: MacDonald, Booth, *Heuristics for ray tracing using space subdivision*, 1990; Shevtsov, Soupikov, Kapustin, *Highly parallel
//! fast kd-tree construction*, 2007 (where faces begin and end is counted in bins).

/// Borders that are tried along an axis are one less.
const BINS: usize = 32;

/// What passing a plane costs, in comparisons with faces.
const PASSAGE: f64 = 1.0;

/// The part of the mesh's box that a cell has, planes of faces aside.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
}

impl Region {
    /// The parts below and above a plane in it.
    pub(super) fn cut(&self, axis: usize, at: f64) -> [Self; 2] {
        let (mut below, mut above) = (*self, *self);
        (below.high[axis], above.low[axis]) = (at, at);
        [below, above]
    }

    pub(super) fn corners(&self) -> [[f64; 3]; 8] {
        let end = |corner: usize, axis: usize| if corner >> axis & 1 == 1 { self.high[axis] } else { self.low[axis] };
        std::array::from_fn(|corner| [0, 1, 2].map(|axis| end(corner, axis)))
    }

    /// Half of the surface.
    fn area(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| self.high[axis] - self.low[axis]);
        x * y + y * z + z * x
    }

    /// The axis and the place of the plane that makes rays cheapest, where it makes them cheaper than comparing them with all faces.
    /// The faces are given by where they begin and end along the axes.
    pub(super) fn best_plane(&self, faces: &[[[f64; 3]; 2]]) -> Option<(usize, f64)> {
        let whole = self.area();
        let mut best = (faces.len() as f64, None);
        for axis in 0..3 {
            let (low, width) = (self.low[axis], self.high[axis] - self.low[axis]);
            let (mut firsts, mut lasts) = ([0_u32; BINS], [0_u32; BINS]);
            let bin = |x: f64| (((x - low) / width * BINS as f64) as usize).min(BINS - 1);
            for [min, max] in faces {
                firsts[bin(min[axis])] += 1;
                lasts[bin(max[axis])] += 1;
            }
            let (mut below, mut above) = (0, faces.len() as u32);
            for border in 1..BINS {
                below += firsts[border - 1];
                above -= lasts[border - 1];
                let at = low + width * (border as f64 / BINS as f64);
                let [under, over] = self.cut(axis, at).map(|part| part.area());
                let cost = PASSAGE + (under * f64::from(below) + over * f64::from(above)) / whole;
                // Not where the region is flat: neither is a NaN below the best.
                if cost < best.0 && low < at && at < self.high[axis] {
                    best = (cost, Some((axis, at)));
                }
            }
        }
        best.1
    }
}
