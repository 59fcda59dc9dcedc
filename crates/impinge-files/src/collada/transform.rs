//! The transforms of a COLLADA node (COLLADA 1.4.1 specification, chapter 5, "node"), composed in
//! f64.

use crate::{error::LoadError, instance::Affine};

use crate::xml_tree::{Id, Tree};

type Vector = [f64; 3];

/// Returns the product of a node's transforms in the order of the file.
pub(super) fn of_node(tree: &Tree<'_>, node: Id) -> Result<Affine, LoadError> {
    let mut product = Affine::IDENTITY;
    for child in tree.children(node) {
        let transform = match tree.name(child) {
            "matrix" => matrix(tree, child)?,
            "translate" => translation(tree.array(child)?),
            "rotate" => {
                let [x, y, z, degrees] = tree.array(child)?;
                rotation([x, y, z], degrees)
            }
            "scale" => {
                let [x, y, z] = tree.array(child)?;
                Affine { rows: [[x, 0.0, 0.0, 0.0], [0.0, y, 0.0, 0.0], [0.0, 0.0, z, 0.0]] }
            }
            "lookat" => {
                let [a, b, c, d, e, f, g, h, i] = tree.array(child)?;
                look_at([a, b, c], [d, e, f], [g, h, i]).ok_or_else(|| wrong(tree, child, "three different points"))?
            }
            "skew" => {
                let [degrees, a, b, c, d, e, f] = tree.array(child)?;
                skew(degrees, [a, b, c], [d, e, f])
                    .ok_or_else(|| wrong(tree, child, "an angle between two different axes"))?
            }
            _ => continue,
        };
        product = product.after(&transform);
    }
    Ok(product)
}

/// Returns the map of an element that holds a 4x4 matrix by rows.
pub(super) fn matrix(tree: &Tree<'_>, id: Id) -> Result<Affine, LoadError> {
    let m: [f64; 16] = tree.array(id)?;
    if m[12..] != [0.0, 0.0, 0.0, 1.0] {
        let found = format!("{:?}", &m[12..]);
        let error = LoadError::syntax("a matrix with last row 0, 0, 0, 1", found.as_bytes());
        return Err(error.at(tree.place(id)));
    }
    Ok(Affine { rows: [0, 1, 2].map(|i| [0, 1, 2, 3].map(|k| m[4 * i + k])) })
}

fn wrong(tree: &Tree<'_>, id: Id, expected: &str) -> LoadError {
    let expected = format!("{expected} in the element {}", tree.name(id));
    LoadError::syntax(expected, tree.text(id).trim().as_bytes()).at(tree.place(id))
}

fn translation([x, y, z]: Vector) -> Affine {
    Affine { rows: [[1.0, 0.0, 0.0, x], [0.0, 1.0, 0.0, y], [0.0, 0.0, 1.0, z]] }
}

/// Returns the rotation about an axis of any length. Rotations by multiples of 90 degrees about a
/// coordinate axis are exact. If the axis has length zero, returns the identity.
fn rotation(axis: Vector, degrees: f64) -> Affine {
    let Some([x, y, z]) = normalized(axis) else { return Affine::IDENTITY };
    let (sin, cos) = sin_cos(degrees);
    let k = 1.0 - cos;
    Affine {
        rows: [
            [cos + k * x * x, k * x * y - sin * z, k * x * z + sin * y, 0.0],
            [k * x * y + sin * z, cos + k * y * y, k * y * z - sin * x, 0.0],
            [k * x * z - sin * y, k * y * z + sin * x, cos + k * z * z, 0.0],
        ],
    }
}

/// Returns sine and cosine, which are exact for multiples of 90 degrees.
fn sin_cos(degrees: f64) -> (f64, f64) {
    match degrees.rem_euclid(360.0) {
        0.0 => (0.0, 1.0),
        90.0 => (1.0, 0.0),
        180.0 => (0.0, -1.0),
        270.0 => (-1.0, 0.0),
        other => other.to_radians().sin_cos(),
    }
}

/// Returns the rigid map that moves the origin to `eye`, and turns -Z towards `interest` and Y
/// upwards. Returns `None` if these points define no frame.
fn look_at(eye: Vector, interest: Vector, up: Vector) -> Option<Affine> {
    let back = normalized([0, 1, 2].map(|k| eye[k] - interest[k]))?;
    let right = normalized(cross(up, back))?;
    let up = cross(back, right);
    Some(Affine { rows: [0, 1, 2].map(|k| [right[k], up[k], back[k], eye[k]]) })
}

/// Returns the shear along `along` that turns the direction `turned` by an angle towards it
/// (RenderMan's `Skew`). Returns `None` if there is no such shear.
fn skew(degrees: f64, turned: Vector, along: Vector) -> Option<Affine> {
    let along = normalized(along)?;
    let (sin, cos) = sin_cos(degrees);
    // The part of `turned` that is perpendicular to `along` spans the plane of rotation.
    let on_along = dot(turned, along);
    let across = normalized([0, 1, 2].map(|k| turned[k] - on_along * along[k]))?;
    let on_across = dot(turned, across);
    let (x, y) = (on_across * cos - on_along * sin, on_across * sin + on_along * cos);
    if x <= 0.0 {
        return None;
    }
    let shear = y / x - on_along / on_across;
    let mut map = Affine::IDENTITY;
    for (row, along) in map.rows.iter_mut().zip(along) {
        for (entry, across) in row.iter_mut().zip(across) {
            *entry += shear * along * across;
        }
    }
    Some(map)
}

fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Returns the vector of length 1 in the same direction, or `None` if the vector is zero or not
/// finite.
fn normalized(v: Vector) -> Option<Vector> {
    let largest = v.iter().fold(0.0_f64, |max, x| max.max(x.abs()));
    if !(largest > 0.0 && largest.is_finite()) {
        return None;
    }
    let v = v.map(|x| x / largest);
    let length = dot(v, v).sqrt();
    Some(v.map(|x| x / length))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(transforms: &str) -> Result<Affine, LoadError> {
        let text = format!("<node>{transforms}</node>");
        of_node(&Tree::parse(&text).unwrap(), 0)
    }

    #[test]
    fn transforms_compose_in_their_order() {
        let map = node("<translate>1 2 3</translate><rotate>0 0 2 90</rotate><scale>2 3 4</scale>").unwrap();
        assert_eq!(map.apply([1.0, 1.0, 1.0]), [-2.0, 4.0, 7.0]);
        let matrix = "<matrix>0 -3 0 1 2 0 0 2 0 0 4 3 0 0 0 1</matrix>";
        assert_eq!(node(matrix).unwrap(), map);
        let twice = node(&format!("{matrix}{matrix}")).unwrap();
        assert_eq!(twice.apply([1.0, 1.0, 1.0]), map.apply([-2.0, 4.0, 7.0]));
    }

    #[test]
    fn rotations_follow_the_right_hand() {
        for quarter in 0..8 {
            let map = node(&format!("<rotate>1 0 0 {}</rotate>", 90.0 * quarter as f64 - 360.0)).unwrap();
            let expected = [[0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0, -1.0, 0.0], [0.0, 0.0, -1.0]][quarter % 4];
            assert_eq!(map.apply([0.0, 1.0, 0.0]), expected);
        }
        let third = node("<rotate>1 1 1 120</rotate>").unwrap().apply([1.0, 2.0, 3.0]);
        assert!([3.0, 1.0, 2.0].iter().zip(third).all(|(a, b)| (a - b).abs() < 1e-15));
        assert_eq!(node("<rotate>0 0 0 30</rotate>").unwrap(), Affine::IDENTITY);
    }

    #[test]
    fn lookat_places_an_object_at_the_eye() {
        let map = node("<lookat>1 2 3 1 2 -7 0 5 1</lookat>").unwrap();
        assert_eq!(map, translation([1.0, 2.0, 3.0]));
        let map = node("<lookat>0 0 0 10 0 0 0 0 1</lookat>").unwrap();
        assert_eq!(map.apply([0.0, 0.0, -1.0]), [1.0, 0.0, 0.0]);
        assert_eq!(map.apply([0.0, 1.0, 0.0]), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn skew_shears_by_the_angle() {
        let map = node("<skew>45 0 1 0 1 0 0</skew>").unwrap();
        let sheared = map.apply([5.0, 2.0, 7.0]);
        assert!((sheared[0] - 7.0).abs() < 1e-14, "{sheared:?}");
        assert_eq!(sheared[1..], [2.0, 7.0]);
    }

    #[test]
    fn invalid_transforms_are_errors() {
        let error = |text: &str| node(text).unwrap_err().to_string();
        assert!(error("<translate>1 2</translate>").contains("3 finite numbers in the element translate"));
        assert!(error("<scale>1 2 inf</scale>").contains("3 finite numbers"));
        assert!(error("<matrix>1 0 0 0 0 1 0 0 0 0 1 0 0 0 0 2</matrix>").contains("last row 0, 0, 0, 1"));
        assert!(error("<lookat>0 0 0 0 0 0 0 1 0</lookat>").contains("three different points"));
        assert!(error("<lookat>0 0 0 0 0 1 0 0 1</lookat>").contains("three different points"));
        assert!(error("<skew>90 0 1 0 1 0 0</skew>").contains("an angle between"));
        assert!(error("<skew>45 1 0 0 1 0 0</skew>").contains("an angle between"));
    }
}
