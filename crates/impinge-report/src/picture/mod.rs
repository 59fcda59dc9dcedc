//! The one software renderer: pictures without a display.
//!
//! A picture is drawn on a canvas with a depth buffer, in samples that are smaller than pixels, so
//! that edges are smooth. Several canvases are layers that are blended. The point in the middle of
//! the picture is subtracted in f64 before anything is rounded.
//!
//! `clash` draws a clash of a report: the `parts` of its scenes with their `sharp_edges`, its
//! `subject`, from the direction that `view` chooses. `scene` draws all parts of a scene, `pair`
//! two meshes with their intersection, `hierarchy` a mesh with boxes (`box_edges`, `svg`),
//! `character` hit volumes, and `robot` a robot in a configuration.
//!
//! `camera` projects along directions of `axes`. `canvas` has triangles and layers, `lines` has
//! lines and curves, `glyphs` letters, `scale` the scale bar and the axes, and `color` colors and
//! lights. `bounds` and `vector` have boxes and vectors, and `pixels` is the result.
//!
//! Tests are beside the code, and in `tests/cli` of `impinge-cli`.

mod axes;
mod bounds;
mod box_edges;
mod camera;
mod canvas;
mod character;
mod clash;
mod color;
mod glyphs;
mod hierarchy;
mod lines;
mod pair;
mod parts;
mod pixels;
mod robot;
mod scale;
mod scene;
mod sharp_edges;
mod subject;
mod svg;
mod vector;
mod view;

pub use axes::Axis;
pub use character::character;
pub use clash::{COLOR_A, COLOR_B, FIELD_OF_VIEW, Gallery, View};
pub use color::{DISTINCT, DISTINCT_NAMES};
pub use hierarchy::HierarchyPicture;
pub use pair::{Pair, PairView, pair};
pub use pixels::{Picture, png};
pub use robot::{RobotView, robot};
pub use scene::{SceneView, scene};
