//! Converts contact manifolds to columns of NumPy arrays, and back.

use impinge::query::{ContactId, ContactPoint, Feature, Manifold};
use pyo3::prelude::*;

use crate::arrays::{array, plain_column, ragged, row_array};

/// A contact: one row of the columns.
#[derive(Clone)]
struct Contact {
    manifold: i64,
    normal: [f64; 3],
    points: [[f64; 3]; 2],
    bounds: [f64; 2],
    /// For each shape: the part, the kind of feature, and its one or two indices.
    id: [u32; 8],
}

/// Returns contacts in the world frame: the offsets of the contacts of each row, (n + 1,), and
/// columns with the contacts of all rows: index of the manifold within its row, (k,), normal, (k,
/// 3), points of a and of b, (k, 3), lower and upper bound of the depth, (k,), and id, (k, 2, 4).
pub(crate) fn columns<'py, 'm>(
    py: Python<'py>,
    rows: impl Iterator<Item = &'m [Manifold]>,
) -> PyResult<Bound<'py, PyAny>> {
    let (offsets, contacts) = ragged(rows.map(of_row).collect());
    let (places, count) = (offsets.len(), contacts.len());
    let vectors = |of: fn(&Contact) -> [f64; 3]| row_array(py, contacts.iter().map(of).collect(), &[count]);
    let numbers = |of: fn(&Contact) -> f64| array(py, contacts.iter().map(of).collect(), &[count]);
    let columns = (
        array(py, contacts.iter().map(|contact| contact.manifold).collect(), &[count])?,
        vectors(|contact| contact.normal)?,
        vectors(|contact| contact.points[0])?,
        vectors(|contact| contact.points[1])?,
        numbers(|contact| contact.bounds[0])?,
        numbers(|contact| contact.bounds[1])?,
        array(py, contacts.iter().flat_map(|contact| contact.id).collect(), &[count, 2, 4])?,
    );
    Ok((array(py, offsets, &[places])?, columns).into_pyobject(py)?.into_any())
}

fn of_row(manifolds: &[Manifold]) -> Vec<Contact> {
    let numbered = (0..).zip(manifolds);
    let of = |(manifold, found): (i64, &Manifold)| {
        let normal = found.normal;
        let contacts = found.points.iter().map(move |point| {
            let [part_a, part_b] = [point.id.part_a, point.id.part_b];
            let ([a, b, c], [d, e, f]) = (feature(point.id.feature_a), feature(point.id.feature_b));
            let id = [part_a, a, b, c, part_b, d, e, f];
            let points = [point.point_a, point.point_b];
            Contact { manifold, normal, points, bounds: [point.lower, point.upper], id }
        });
        contacts.collect::<Vec<_>>()
    };
    numbered.flat_map(of).collect()
}

/// Returns the kind of a feature and its indices.
fn feature(feature: Feature) -> [u32; 3] {
    match feature {
        Feature::Vertex(vertex) => [0, vertex, 0],
        Feature::Edge(from, to) => [1, from, to],
        Feature::Face(face) => [2, face, 0],
    }
}

/// Returns the contacts that [`columns`] converted, or `None` if the columns contradict each other.
///
/// # Errors
/// `TypeError` if the arrays have other types.
pub(crate) fn manifolds(columns: &Bound<'_, PyAny>) -> PyResult<Option<Vec<Vec<Manifold>>>> {
    type Columns<'py> = [Bound<'py, PyAny>; 7];
    let (offsets, columns): (Bound<'_, PyAny>, Columns<'_>) = columns.extract()?;
    let [numbers, normals, points_a, points_b, lower, upper, ids] = columns;
    let (offsets, numbers): (Vec<i64>, Vec<i64>) = (plain_column(&offsets)?, plain_column(&numbers)?);
    let (normals, points_a, points_b): (Vec<f64>, Vec<f64>, Vec<f64>) =
        (plain_column(&normals)?, plain_column(&points_a)?, plain_column(&points_b)?);
    let (lower, upper): (Vec<f64>, Vec<f64>) = (plain_column(&lower)?, plain_column(&upper)?);
    let ids: Vec<u32> = plain_column(&ids)?;
    let [normals, points_a, points_b] = [&normals, &points_a, &points_b].map(|rows| rows.as_chunks::<3>().0);
    let ids = ids.as_chunks::<8>().0;
    let count = numbers.len();
    if [normals.len(), points_a.len(), points_b.len(), lower.len(), upper.len(), ids.len()] != [count; 6] {
        return Ok(None);
    }
    let row = |row: &[i64]| {
        let places = usize::try_from(row[0]).ok()?..usize::try_from(row[1]).ok()?;
        let mut found: Vec<Manifold> = Vec::new();
        for at in places.clone() {
            if at == places.start || *numbers.get(at)? != numbers[at - 1] {
                found.push(Manifold { normal: *normals.get(at)?, points: Vec::new() });
            }
            let &[part_a, a, b, c, part_b, d, e, f] = ids.get(at)?;
            let (feature_a, feature_b) = (feature_of([a, b, c])?, feature_of([d, e, f])?);
            let id = ContactId { part_a, part_b, feature_a, feature_b };
            let (point_a, point_b) = (points_a[at], points_b[at]);
            found.last_mut()?.points.push(ContactPoint { point_a, point_b, lower: lower[at], upper: upper[at], id });
        }
        Some(found)
    };
    Ok(offsets.windows(2).map(row).collect())
}

/// Returns the feature that [`feature`] converted, or `None` if the kind is unknown.
fn feature_of([kind, first, second]: [u32; 3]) -> Option<Feature> {
    match kind {
        0 => Some(Feature::Vertex(first)),
        1 => Some(Feature::Edge(first, second)),
        2 => Some(Feature::Face(first)),
        _ => None,
    }
}
