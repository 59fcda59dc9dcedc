//! The sections of the page: a heading, a sentence, and the table to make from a record.

use super::pivot::{Pivot, Time, Unit};

/// A section of the page.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Section {
    /// Heading.
    pub(crate) heading: &'static str,
    /// Sentences that say what is measured, wrapped at 100 columns.
    pub(crate) about: &'static str,
    /// Benchmark whose record is shown.
    pub(crate) bench: &'static str,
    /// Table to make from the record.
    pub(crate) pivot: Pivot,
}

const fn time(quantity: &'static str, heading: &'static str, unit: Unit) -> Time {
    Time { quantity, heading, unit }
}

/// Sections in the order of the page.
pub(crate) const SECTIONS: [Section; 18] = [
    Section {
        heading: "All intersecting pairs beside FCL and Coal",
        about: "\
All pairs of triangles that intersect, for a mesh of 2,000,000 triangles and its copy at a pose:
median. The first four poses are of two torus knots. The others are two spheres that nearly
coincide, a small knot among long slivers, and two rods of 20,000 long triangles. The column
python-fcl is the time that a Python program waits. FCL is its share without the Python objects.",
        bench: "rivals",
        pivot: Pivot {
            cases: "pose",
            ours: "impinge",
            counts: &[("impinge", "pairs", "pairs")],
            times: &[time("all pairs median", "", Unit::Milliseconds)],
        },
    },
    Section {
        heading: "First hit beside FCL and Coal",
        about: "Whether the same meshes intersect at the same poses: median.",
        bench: "rivals",
        pivot: Pivot {
            cases: "pose",
            ours: "impinge",
            counts: &[],
            times: &[time("first hit median", "", Unit::Microseconds)],
        },
    },
    Section {
        heading: "Build beside FCL and Coal",
        about: "The hierarchy of the same meshes: median.",
        bench: "rivals",
        pivot: Pivot {
            cases: "pose",
            ours: "impinge",
            counts: &[],
            times: &[time("build median", "", Unit::Milliseconds)],
        },
    },
    Section {
        heading: "First hits of real meshes beside FCL and Coal",
        about: "\
Whether two scanned or designed meshes intersect: mean of 300 poses, minimum of the runs. impinge
gets all poses in one call. FCL and Coal are called in a loop, which costs about 3 µs of Python.",
        bench: "first_hits",
        pivot: Pivot {
            cases: "meshes and poses",
            ours: "impinge",
            counts: &[],
            times: &[time("pose minimum", "", Unit::Microseconds)],
        },
    },
    Section {
        heading: "Distance beside FCL and Coal",
        about: "\
Distance of two meshes: minimum of the runs at each pose, mean of the poses. The first call has no
cache. Later calls of impinge start from the answer at the same pose, or at the pose before.",
        bench: "rivals_distance",
        pivot: Pivot {
            cases: "poses",
            ours: "impinge",
            counts: &[],
            times: &[
                time("without cache mean", "first call", Unit::Microseconds),
                time("cache of same pose mean", "same pose again", Unit::Microseconds),
                time("cache of last pose mean", "next pose", Unit::Microseconds),
            ],
        },
    },
    Section {
        heading: "Rays beside Embree",
        about: "\
First hit of a ray: median. Embree computes in single precision and is asked through embreex. The
table counts the rays for which Embree passes through a face that the ray hits; impinge has none.",
        bench: "rivals_rays",
        pivot: Pivot {
            cases: "rays",
            ours: "impinge, in one call",
            counts: &[
                ("Embree", "rays passed through a face", "missed by Embree"),
                ("Embree, robust", "rays passed through a face", "missed by Embree, robust"),
            ],
            times: &[time("ray median", "", Unit::Microseconds)],
        },
    },
    Section {
        heading: "Build, refit and pairs beside Embree",
        about: "\
A knot of 2,000,000 triangles in single precision: median. Embree's pairs are overlapping boxes;
impinge's pairs are triangles that intersect, decided exactly.",
        bench: "rivals_embree",
        pivot: Pivot {
            cases: "pose",
            ours: "impinge",
            counts: &[],
            times: &[
                time("build median", "build", Unit::Milliseconds),
                time("refit median", "refit", Unit::Milliseconds),
                time("find pairs median", "pairs", Unit::Milliseconds),
            ],
        },
    },
    Section {
        heading: "One call from Python",
        about: "\
One call at one pose, for two wavy sheets of triangles: median. One sheet is the other moved up by
an eighth of its side, or turned so that they cross.",
        bench: "latency",
        pivot: Pivot {
            cases: "faces and question",
            ours: "impinge",
            counts: &[],
            times: &[time("call median", "", Unit::Microseconds)],
        },
    },
    Section {
        heading: "Functions of Python beside other libraries",
        about: "\
One call of a function of impinge, and of another library that has it: minimum. Each library uses
the threads that it uses by itself. impinge, Open3D and libigl use two cores for many points and
rays, and the others one. The large mesh has 2,000,000 faces, and the scan is the human that comes
with impinge. Open3D and Embree compute in single precision, and libigl approximates winding
numbers. FCL returns depths of curved shapes that are often longer than the shortest way out.
`impinge.load` validates a mesh and builds its hierarchy, and trimesh does not.",
        bench: "verbs",
        pivot: Pivot {
            cases: "call",
            ours: "impinge",
            counts: &[],
            times: &[time("call minimum", "", Unit::Microseconds)],
        },
    },
    Section {
        heading: "Drop-in modules beside trimesh and python-fcl",
        about: "\
One call of `impinge.trimesh` or `impinge.fcl`, and the same call of the original: minimum. The
managers hold 200 boxes, or 100 spheres of 1,280 faces. impinge returns all pairs of faces of two
solids as contacts, trimesh one contact. With overlaps, the minimum distance of trimesh is minus the
depth of any pair, and that of impinge is the true minimum.",
        bench: "doors",
        pivot: Pivot {
            cases: "call",
            ours: "impinge",
            counts: &[],
            times: &[time("call minimum", "", Unit::Microseconds)],
        },
    },
    Section {
        heading: "Shapes beside parry3d",
        about: "\
Two shapes at 500 random poses: minimum of the runs, mean of the poses. Every answer of impinge is
proved in double precision. parry3d computes in single precision without a bound of its error.",
        bench: "shapes",
        pivot: Pivot {
            cases: "shapes",
            ours: "impinge",
            counts: &[],
            times: &[
                time("intersects", "intersects", Unit::Nanoseconds),
                time("distance", "distance", Unit::Nanoseconds),
                time("depth", "depth", Unit::Nanoseconds),
            ],
        },
    },
    Section {
        heading: "Small worlds beside rapier3d",
        about: "\
One step of a world in which all bodies move, about 1 in size at a mean spacing of 2: median. Both
engines step in turn, keep their pairs from step to step, and find the same pairs. rapier3d computes
in single precision. It detects collisions only, without dynamics.",
        bench: "small_worlds",
        pivot: Pivot {
            cases: "world",
            ours: "impinge",
            counts: &[("impinge", "pairs", "pairs")],
            times: &[
                time("intersections", "intersections", Unit::Microseconds),
                time("contacts", "contacts", Unit::Microseconds),
            ],
        },
    },
    Section {
        heading: "Worlds of meshes",
        about: "\
One step of 2,000 tumbling bodies of 20,480 triangles on two threads: median. Boxes are those of the
rotated box (own) or tight (climbing). Every pair is decided exactly.",
        bench: "worlds",
        pivot: Pivot {
            cases: "boxes",
            ours: "impinge",
            counts: &[("impinge", "examined", "pairs of boxes")],
            times: &[
                time("step", "step", Unit::Milliseconds),
                time("realign", "realign", Unit::Milliseconds),
                time("broad", "broad phase", Unit::Milliseconds),
                time("narrow", "narrow phase", Unit::Milliseconds),
            ],
        },
    },
    Section {
        heading: "Boxes that all move beside parry3d",
        about: "\
One step in which all boxes move: minimum of the processor time. Sizes are alike (like) or spread
over a ratio of 1,000 (pareto). parry3d is left out where it would need gigabytes of memory.",
        bench: "growth_worlds",
        pivot: Pivot {
            cases: "sizes and boxes",
            ours: "impinge",
            counts: &[("impinge", "pairs", "pairs")],
            times: &[time("step minimum", "", Unit::Milliseconds)],
        },
    },
    Section {
        heading: "Clashes of buildings beside IfcClash",
        about: "\
Clashes deeper than 2 mm (intersection), or parts nearer than 10 mm (clearance), of the same
triangles on two cores: median, with the time for preparing the parts. Depths by exact booleans tell
which pairs of closed parts are deeper. The table counts the pairs that IfcClash misses, and those
that it reports although they are not deeper. impinge has no such pair. It also finds how deep each
pair is. In the duplex, pairs with an open part, such as a window, take nine tenths of its time.",
        bench: "clash",
        pivot: Pivot {
            cases: "building and question",
            ours: "impinge",
            counts: &[("IfcClash", "missed", "missed by IfcClash"), ("IfcClash", "false", "false of IfcClash")],
            times: &[time("time median", "", Unit::Milliseconds)],
        },
    },
    Section {
        heading: "Robots beside Pinocchio with Coal",
        about: "\
Whether a robot collides with itself in a configuration, or with a human of 26,756 triangles too,
and its clearance; with the kinematics, on one thread: median of the runs, mean of the
configurations. Pinocchio and Coal are called in a loop, which costs about a microsecond of Python,
and stop at the first collision, too. All verdicts are right, and the clearances agree.",
        bench: "robots",
        pivot: Pivot {
            cases: "robot",
            ours: "impinge",
            counts: &[("impinge", "rows", "configurations")],
            times: &[time("configuration median", "", Unit::Microseconds)],
        },
    },
    Section {
        heading: "Convex hulls beside qhull",
        about: "Convex hull of a set of points: median.",
        bench: "hulls",
        pivot: Pivot {
            cases: "points of",
            ours: "impinge",
            counts: &[("impinge", "points", "points"), ("impinge", "vertices", "vertices")],
            times: &[time("hull median", "", Unit::Milliseconds)],
        },
    },
    Section {
        heading: "Growth with the number of triangles",
        about: "\
Two torus knots deep in each other: minimum. Build and refit grow with the triangles, all pairs
with the pairs.",
        bench: "growth",
        pivot: Pivot {
            cases: "mesh",
            ours: "impinge",
            counts: &[("impinge", "pairs", "pairs")],
            times: &[
                time("build minimum", "build", Unit::Milliseconds),
                time("refit minimum", "refit", Unit::Milliseconds),
                time("all pairs minimum", "all pairs", Unit::Milliseconds),
            ],
        },
    },
];
