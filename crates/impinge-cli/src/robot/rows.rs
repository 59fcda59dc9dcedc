//! Reads configurations from a .csv or .npy file.

use std::fs;
use std::path::Path;

use impinge::robot::Robot;

use crate::failure::Failure;
use crate::output;

/// Reads configurations: rows of one value for each coordinate of the robot.
///
/// A .csv file may begin with a line of the names of the coordinates, in any order. A .npy file has
/// an array of two axes of 64-bit or 32-bit floats in the order of the computer's memory.
///
/// # Errors
/// Returns an error that names the line or the part of the file at fault.
pub(super) fn read(path: &Path, robot: &Robot) -> Result<Vec<f64>, Failure> {
    let bytes = fs::read(path).map_err(|error| Failure::from_io(&error, "cannot be read").in_file(path))?;
    let values = match output::extension(path).as_str() {
        "csv" => read_csv(&bytes, robot),
        "npy" => read_npy(&bytes, robot.coordinates().len()),
        _ => Err(Failure::new("configurations", "unknown format").hint("pass a .csv or .npy file")),
    };
    let values = values.map_err(|failure| failure.in_file(path))?;
    if values.is_empty() {
        return Err(Failure::new("configurations", "the file has no configurations").in_file(path));
    }
    Ok(values)
}

fn read_csv(bytes: &[u8], robot: &Robot) -> Result<Vec<f64>, Failure> {
    let columns = robot.coordinates().len();
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(bytes);
    let mut order: Vec<usize> = (0..columns).collect();
    let mut values = Vec::new();
    for (at, record) in reader.records().enumerate() {
        let place = format!("line {}", at + 1);
        let record = record.map_err(|error| Failure::new("csv", error.to_string()).at(&place))?;
        if at == 0 && record.iter().any(|field| field.parse::<f64>().is_err()) {
            order = header(&record, robot)?;
            continue;
        }
        if record.len() != columns {
            let message = format!("a row has {} values; the robot has {columns} coordinates", record.len());
            return Err(Failure::new("configurations", message).at(place).hint(names(robot)));
        }
        let first = values.len();
        values.resize(first + columns, 0.0);
        for (field, column) in record.iter().zip(&order) {
            let number = field.parse::<f64>().ok().filter(|number| number.is_finite());
            values[first + column] =
                number.ok_or_else(|| Failure::new("csv", format!("{field:?} is not a number")).at(&place))?;
        }
    }
    Ok(values)
}

/// Returns for each column the coordinate that it names.
fn header(record: &csv::StringRecord, robot: &Robot) -> Result<Vec<usize>, Failure> {
    let coordinates = robot.coordinates();
    let find = |name: &str| coordinates.iter().position(|coordinate| coordinate.name == name);
    let order: Option<Vec<usize>> = record.iter().map(find).collect();
    let order = order.filter(|order| {
        let mut sorted = order.clone();
        sorted.sort_unstable();
        sorted.into_iter().eq(0..coordinates.len())
    });
    order.ok_or_else(|| {
        Failure::new("configurations", "the first line must name each coordinate once").at("line 1").hint(names(robot))
    })
}

fn names(robot: &Robot) -> String {
    let names: Vec<&str> = robot.coordinates().iter().map(|coordinate| coordinate.name.as_str()).collect();
    format!("the coordinates are {}", names.join(", "))
}

/// Reads an array file of NumPy (NEP 1).
fn read_npy(bytes: &[u8], columns: usize) -> Result<Vec<f64>, Failure> {
    let broken = || Failure::new("npy", "not an array file of NumPy").hint("write it with numpy.save");
    let rest = bytes.strip_prefix(b"\x93NUMPY").ok_or_else(broken)?;
    let (length, start) = match rest {
        [1, _, a, b, ..] => (usize::from(u16::from_le_bytes([*a, *b])), 4),
        [2 | 3, _, a, b, c, d, ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, 6),
        _ => return Err(broken()),
    };
    let header = rest.get(start..).and_then(|rest| rest.get(..length)).ok_or_else(broken)?;
    let header = std::str::from_utf8(header).map_err(|_| broken())?;
    let data = &rest[start + length..];
    let shape = header.split_once("'shape':").and_then(|(_, after)| after.split_once('('));
    let shape = shape.and_then(|(_, after)| after.split_once(')')).ok_or_else(broken)?.0;
    let axes: Option<Vec<usize>> =
        shape.split(',').map(str::trim).filter(|axis| !axis.is_empty()).map(|axis| axis.parse().ok()).collect();
    let axes = axes.ok_or_else(broken)?;
    let rows = match axes[..] {
        [rows, own] if own == columns => rows,
        [own] if own == columns => 1,
        _ => {
            let message = format!("the array has the shape ({shape}); the robot has {columns} coordinates");
            return Err(Failure::new("configurations", message).hint(format!("pass an array of shape (n, {columns})")));
        }
    };
    let count = rows.checked_mul(columns).ok_or_else(broken)?;
    let values: Vec<f64> = if header.contains("'<f8'") {
        data.as_chunks::<8>().0.iter().map(|bytes| f64::from_le_bytes(*bytes)).collect()
    } else if header.contains("'<f4'") {
        data.as_chunks::<4>().0.iter().map(|bytes| f64::from(f32::from_le_bytes(*bytes))).collect()
    } else {
        return Err(Failure::new("npy", "the array must have 64-bit or 32-bit floats"));
    };
    if header.contains("'fortran_order': True") && axes.len() == 2 {
        return Err(Failure::new("npy", "the array is in column order").hint("apply numpy.ascontiguousarray first"));
    }
    if values.len() == count { Ok(values) } else { Err(broken()) }
}
