//! The axis-aligned plane that cuts a cell at the least cost, by the surface area heuristic at the
//! borders of bins.
//!
//! Source: MacDonald, Booth, *Heuristics for ray tracing using space subdivision*, 1990; Shevtsov,
//! Soupikov, Kapustin, *Highly parallel fast kd-tree construction*, 2007, for counting the faces
//! that begin and end in each bin.

/// Number of bins along an axis. One border less is tried. More bins find better planes and cost
/// time.
const BINS: usize = 32;

/// Cost of passing a plane, in comparisons with faces.
const PASSAGE_COST: f64 = 1.0;

/// The part of the mesh's box that belongs to a cell, ignoring planes of faces, in the mesh's own
/// frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Region {
    pub(super) low: [f64; 3],
    pub(super) high: [f64; 3],
}

impl Region {
    /// Returns the parts below and above a plane that cuts the region.
    pub(super) fn cut(&self, axis: usize, at: f64) -> [Self; 2] {
        let (mut below, mut above) = (*self, *self);
        (below.high[axis], above.low[axis]) = (at, at);
        [below, above]
    }

    /// Returns the eight corners of the region.
    pub(super) fn corners(&self) -> [[f64; 3]; 8] {
        let end = |corner: usize, axis: usize| if corner >> axis & 1 == 1 { self.high[axis] } else { self.low[axis] };
        std::array::from_fn(|corner| [0, 1, 2].map(|axis| end(corner, axis)))
    }

    /// Returns half of the surface area.
    fn area(&self) -> f64 {
        let [x, y, z] = [0, 1, 2].map(|axis| self.high[axis] - self.low[axis]);
        x * y + y * z + z * x
    }

    /// Returns the axis and the coordinate of the axis-aligned plane with the least expected cost
    /// of a ray. Returns `None` if comparing the ray with all faces costs no more. `faces` has the
    /// minimum and maximum corners of the faces' boxes.
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
                let cost = PASSAGE_COST + (under * f64::from(below) + over * f64::from(above)) / whole;
                // In a flat region the cost may be NaN, which is not below the best.
                if cost < best.0 && low < at && at < self.high[axis] {
                    best = (cost, Some((axis, at)));
                }
            }
        }
        best.1
    }
}
