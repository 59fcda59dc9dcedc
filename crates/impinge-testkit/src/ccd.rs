//! Recorded queries of continuous collision detection, with their true answers.
//!
//! They are from Wang and others (*A Large Scale Benchmark and an Inclusion-Based Algorithm for
//! Continuous Collision Detection*, ACM TOG 40(5), 2021). They are read from `ccd/` in the folder
//! that the environment variable `IMPINGE_DATA` names. Each query has eight rows, each with three
//! rational coordinates and the answer. All coordinates are floats.

use std::path::Path;

use dashu_int::{IBig, UBig};
use dashu_ratio::RBig;

use crate::ReadError;
use crate::read_error::read_text;

/// Four corners at both ends of a linear motion: a vertex and a face, or two edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Query {
    /// Kind of the query: which corners belong together.
    pub kind: QueryKind,
    /// Corners at the start: a vertex and three corners of a face, or the ends of two edges.
    pub t0: [[f64; 3]; 4],
    /// Corners at the end, in the same order.
    pub t1: [[f64; 3]; 4],
    /// Whether they touch at some time, according to the authors' rational arithmetic.
    pub touches: bool,
}

/// Kind of a [`Query`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum QueryKind {
    /// A vertex, followed by the corners of a face.
    VertexFace,
    /// Two edges.
    EdgeEdge,
}

/// Reads the queries of one file.
///
/// # Errors
/// Returns an error if the file cannot be read or has a row in another format.
pub fn read(path: &Path, kind: QueryKind) -> Result<Vec<Query>, ReadError> {
    let text = read_text(path)?;
    let rows: Option<Vec<([f64; 3], bool)>> = text.lines().map(row).collect();
    let rows = rows.ok_or_else(|| ReadError::new(path, "a row is not three rationals that are floats and 0 or 1"))?;
    let (queries, []) = rows.as_chunks::<8>() else {
        return Err(ReadError::new(path, "the number of rows is no multiple of eight"));
    };
    let query = |rows: &[([f64; 3], bool); 8]| {
        let corners = rows.map(|(corner, _)| corner);
        let [a, b, c, d, e, f, g, h] = corners;
        Query { kind, t0: [a, b, c, d], t1: [e, f, g, h], touches: rows[0].1 }
    };
    Ok(queries.iter().map(query).collect())
}

/// Reads the queries of every file of one kind. Folders are in the order of their names.
///
/// # Errors
/// Returns an error if [`read`] does.
pub fn read_all(data: &Path, kind: QueryKind) -> Result<Vec<(String, Vec<Query>)>, ReadError> {
    let folder = match kind {
        QueryKind::VertexFace => "vertex-face",
        QueryKind::EdgeEdge => "edge-edge",
    };
    ["erleben-sliding-spike", "erleben-spike-crack", "erleben-wedges", "unit-tests"]
        .into_iter()
        .map(|name| {
            let folder = data.join("ccd").join(name).join(folder);
            let mut queries = read(&folder.join("data_0_0.csv"), kind)?;
            queries.extend(read(&folder.join("data_0_1.csv"), kind)?);
            Ok((name.to_owned(), queries))
        })
        .collect()
}

fn row(text: &str) -> Option<([f64; 3], bool)> {
    let mut fields = text.trim().split(',');
    let mut coordinate = || {
        let numerator: IBig = fields.next()?.parse().ok()?;
        let denominator: UBig = fields.next()?.parse().ok()?;
        let exact = RBig::from_parts(numerator, denominator);
        let float = exact.to_f64().value();
        (RBig::try_from(float).ok()? == exact).then_some(float)
    };
    let corner = [coordinate()?, coordinate()?, coordinate()?];
    let touches = match fields.next()? {
        "0" => false,
        "1" => true,
        _ => return None,
    };
    fields.next().is_none().then_some((corner, touches))
}
