//! Tests winding numbers of real files, closed, open and defective, against another library.
//!
//! The numbers are those of `igl.winding_number` (libigl 2.6 for Python, the sum over all faces).
//! It cannot read files, so they were read with NumPy, with polygons cut into fans.

use std::path::PathBuf;

use impinge::Mesh;
use impinge_files::load;

/// A file, whether it is closed, and its winding number about some points.
struct Row {
    path: &'static str,
    closed: bool,
    windings: &'static [([f64; 3], f64)],
}

const ROWS: [Row; 7] = [
    Row {
        path: "nasty/busted.STL",
        closed: true,
        windings: &[([-0.061, 23.993, -2.756], 1.0), ([4.61, 19.012, -8.141], 0.0), ([2.608, 27.551, -4.551], 1.0)],
    },
    Row {
        path: "nasty/soup.stl",
        closed: false,
        windings: &[
            ([0.501, 0.501, 0.751], -2.012_480_937_666),
            ([0.314, 0.874, 0.44], 0.693_977_341_711),
            ([0.439, 0.625, 0.565], -0.688_025_604_89),
            ([0.75, 0.812, 0.565], 0.951_824_188_124),
            ([2.0, -1.0, 0.5], 0.007_417_265_018),
        ],
    },
    Row {
        path: "nasty/quadknot.obj",
        closed: true,
        windings: &[([-95.936, 41.788, -121.898], 1.0), ([-63.924, 0.001, -31.236], 0.0)],
    },
    Row {
        path: "nasty/leoTest1.obj",
        closed: false,
        windings: &[
            ([-141.131, 136.771, 130.67], 0.188_311_155_889),
            ([50.594, 90.88, -115.833], -0.455_087_560_247),
            ([-168.52, 149.883, 48.503], -0.713_154_628_729),
            ([-300.0, 100.0, 0.0], -0.460_647_405_901),
        ],
    },
    Row {
        path: "nasty/fcl_resources/env.obj",
        closed: false,
        windings: &[
            ([-8.5, 0.0, 2237.0], -1.833_057_3e-5),
            ([2613.0, -2628.938, 548.375], 5.256_903e-6),
            ([0.0, 0.0, -10.0], 1.000_092_236_024),
            ([100.0, 2990.0, 1000.0], -0.000_201_648_379),
        ],
    },
    Row {
        path: "nasty/fcl_resources/rob.obj",
        closed: false,
        windings: &[
            ([0.0, 0.0, 212.5], 1.000_109_806_999),
            ([437.5, -529.375, -265.625], 0.004_421_204_631),
            ([-187.5, 453.75, -53.125], 0.001_294_812_435),
        ],
    },
    Row {
        path: "meshes/stanford-bunny.obj",
        closed: false,
        windings: &[
            ([-0.017, 0.11, 0.029], 0.989_699_633_775),
            ([0.051, 0.043, -0.039], 0.001_917_882_697),
            ([-0.02, 0.04, 0.0], 1.023_852_970_697),
            ([-0.02, 0.0332, 0.0], 0.053_941_285_052),
            ([-0.075, 0.043, 0.036], -0.009_232_081_778),
        ],
    },
];

#[test]
fn winding_numbers_of_real_files_equal_those_of_libigl() {
    let Some(folder) = std::env::var_os("IMPINGE_DATA").map(PathBuf::from) else {
        eprintln!("skipped: IMPINGE_DATA names no folder of real files");
        return;
    };
    for Row { path, closed, windings } in ROWS {
        let model = load(folder.join(path)).expect("a legal file");
        let mesh = Mesh::new(model.positions, model.faces).expect("a legal mesh");
        assert_eq!(mesh.is_closed(), closed, "{path}");
        let points: Vec<[f64; 3]> = windings.iter().map(|(point, _)| *point).collect();
        let found = mesh.winding_number(&points).expect("finite points");
        for ((point, expected), found) in windings.iter().zip(&found) {
            // The reference is rounded to 12 decimals, and is a sum with one rounding per face.
            assert!((found.value - expected).abs() < 1e-10, "{path} about {point:?}: {found:?}, not {expected}");
            assert!(found.lower - 1e-10 <= *expected && *expected <= found.upper + 1e-10, "{path} about {point:?}");
            assert!(found.upper - found.lower < 1e-8, "{path} about {point:?}: {found:?}");
        }
    }
}
