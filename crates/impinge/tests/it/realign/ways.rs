//! All methods of realigning boxes, compared at each pose.

use impinge::Pose;
use impinge::hull::Hull;
use impinge::volume::MinMax;
use impinge::volume::realign::{ClimbingHull, LooseBox, Realign, RotatedBox, TightHull, TightPoints};
use impinge_testkit::Affine;
use impinge_testkit::generate::Rng;
use impinge_testkit::oracle::{WorldBox, tight_box};

/// All methods for one set of points.
pub(crate) struct Ways<'p> {
    points: &'p [[f64; 3]],
    tight: Vec<(&'static str, Box<dyn Realign + 'p>)>,
    loose: Vec<(&'static str, Box<dyn Realign + 'p>)>,
}

impl<'p> Ways<'p> {
    pub(crate) fn new(points: &'p [[f64; 3]], hull: &'p Hull, pivot: [f64; 3]) -> Self {
        Self {
            points,
            tight: vec![
                ("all points", Box::new(TightPoints::new(points).expect("legal"))),
                ("hull", Box::new(TightHull::new(hull))),
                ("climbing", Box::new(ClimbingHull::new(hull))),
            ],
            loose: vec![
                ("loose", Box::new(LooseBox::new(points, pivot).expect("legal"))),
                ("rotated", Box::new(RotatedBox::new(&MinMax::of(points).expect("legal")))),
            ],
        }
    }

    /// Checks every method against the exact box, and returns the exact box.
    pub(crate) fn check(&mut self, pose: &Pose) -> MinMax {
        let affine = Affine::new(*pose.linear(), *pose.translation());
        let WorldBox { low, high } = tight_box(self.points, &affine);
        let exact = MinMax::new(low, high).expect("in range");
        for (name, way) in &mut self.tight {
            let found = way.realign(pose);
            assert_eq!((found.min(), found.max()), (low, high), "{name} at {pose:?}");
        }
        for (name, way) in &mut self.loose {
            assert!(way.realign(pose).encloses(&exact), "{name} at {pose:?}");
        }
        exact
    }
}

/// Returns the rotation of a quaternion, which is normalized first.
pub(crate) fn turned(quaternion: [f64; 4], translation: [f64; 3]) -> Pose {
    let length = quaternion.iter().map(|x| x * x).sum::<f64>().sqrt();
    Pose::from_quaternion_wxyz(translation, quaternion.map(|x| x / length)).expect("of length 1")
}

pub(crate) fn any_rotation(rng: &mut Rng, translation: [f64; 3]) -> Pose {
    loop {
        let quaternion: [f64; 4] = std::array::from_fn(|_| rng.uniform(-1.0, 1.0));
        if (0.01..1.0).contains(&quaternion.iter().map(|x| x * x).sum::<f64>()) {
            return turned(quaternion, translation);
        }
    }
}
