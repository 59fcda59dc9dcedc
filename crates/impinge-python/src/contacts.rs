//! Contacts as columns of arrays.

use impinge::query::shapes::{Feature, Manifold};
use pyo3::prelude::*;

use crate::arrays::{array, ragged, row_array};

/// A contact point in a row of the columns.
#[derive(Clone)]
struct Contact {
    manifold: i64,
    normal: [f64; 3],
    points: [[f64; 3]; 2],
    bounds: [f64; 2],
    /// Of either shape: the part, the kind of feature, and its one or two numbers.
    id: [u32; 8],
}

/// Offsets of each row's contacts, (n + 1,), and the columns of those of all: numbers of the manifolds within their row, (k,),
/// normals, (k, 3), points of a and of b, (k, 3), lower and upper bounds of the depths, (k,), and ids, (k, 2, 4).
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

/// The kind of a feature, and its numbers.
fn feature(feature: Feature) -> [u32; 3] {
    match feature {
        Feature::Vertex(vertex) => [0, vertex, 0],
        Feature::Edge(from, to) => [1, from, to],
        Feature::Face(face) => [2, face, 0],
    }
}
