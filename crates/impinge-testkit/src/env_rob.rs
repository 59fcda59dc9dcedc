//! 250 recorded poses of one mesh against another, with the exact number of intersecting pairs of
//! each.
//!
//! The meshes are `env.obj` (2,180 triangles) and `rob.obj` (216 triangles) of FCL's tests. They
//! are not part of this repository. They are read from the folder that the environment variable
//! `IMPINGE_DATA` names, below `nasty/fcl_resources` and `oracle`. Here a pose is *baked* before
//! the query: the vertices of env are moved in f64, `((r0*x + r1*y) + r2*z) + t` without fused
//! operations, and the query is about the moved vertices.

use crate::read_error::{ReadError, read_text};
use crate::{Affine, Mesh};
use sha2::{Digest, Sha256};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Both meshes and the recorded poses.
#[derive(Clone, Debug)]
pub struct EnvRob {
    /// Mesh that moves.
    pub env: Mesh,
    /// Mesh at rest.
    pub rob: Mesh,
    /// Recorded poses and answers.
    pub rows: Vec<Row>,
}

/// One recorded pose and its answers.
#[derive(Clone, Debug)]
pub struct Row {
    /// Pose by which the vertices of env are baked.
    pub world_from_env: Affine,
    /// Exact number of intersecting pairs.
    pub pair_count: usize,
    /// [`pairs_digest`] of the pairs (face of env, face of rob).
    pub pairs_digest: String,
    /// Distance computed by Coal. It is 0 if Coal reports an intersection.
    pub coal_distance: f64,
}

/// Returns the folder that `IMPINGE_DATA` names. If the variable is not set, writes to standard
/// error that the caller is skipped.
pub fn data_folder() -> Option<PathBuf> {
    let folder = std::env::var_os("IMPINGE_DATA").map(PathBuf::from);
    if folder.is_none() {
        // A failed write to standard error is ignored.
        writeln!(std::io::stderr(), "skipped: IMPINGE_DATA names no folder of extra data").ok();
    }
    folder
}

/// Returns the first 16 hexadecimal digits of the SHA-256 of the text `i,j;i,j;…` over the pairs,
/// in the given order.
pub fn pairs_digest(pairs: &[(u32, u32)]) -> String {
    let texts: Vec<String> = pairs.iter().map(|(i, j)| format!("{i},{j}")).collect();
    Sha256::digest(texts.join(";")).iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}

impl EnvRob {
    /// Reads the two meshes and the table from the data folder.
    ///
    /// # Errors
    /// Returns an error if a file cannot be read or a line of it is invalid.
    pub fn read(data: &Path) -> Result<Self, ReadError> {
        let meshes = data.join("nasty/fcl_resources");
        Ok(Self {
            env: read_with(&meshes.join("env.obj"), parse_obj)?,
            rob: read_with(&meshes.join("rob.obj"), parse_obj)?,
            rows: read_with(&data.join("oracle/env_rob_250.csv"), parse_rows)?,
        })
    }

    /// Returns env with its vertices moved and rounded as in the table.
    pub fn baked_env(&self, row: &Row) -> Mesh {
        Mesh {
            vertices: self.env.vertices.iter().map(|&v| row.world_from_env.apply_rounded(v)).collect(),
            faces: self.env.faces.clone(),
        }
    }
}

fn read_with<T>(path: &Path, parse: fn(&str) -> Result<T, String>) -> Result<T, ReadError> {
    parse(&read_text(path)?).map_err(|message| ReadError::new(path, message))
}

/// Parses vertices and faces of plain indices. Polygons are cut into fans, and the first line, a
/// count, is skipped.
fn parse_obj(text: &str) -> Result<Mesh, String> {
    let mut mesh = Mesh::default();
    for (number, line) in text.lines().enumerate().skip(1) {
        let wrong = || format!("line {}: cannot be parsed: {line:?}", number + 1);
        let mut words = line.split_whitespace();
        match words.next() {
            Some("v") => {
                let numbers: Vec<f64> = words.map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
                mesh.vertices.push(numbers.try_into().map_err(|_| wrong())?);
            }
            Some("f") => {
                let one_based: Vec<u32> = words.map(str::parse).collect::<Result<_, _>>().map_err(|_| wrong())?;
                if one_based.len() < 3 || one_based.iter().any(|&i| i == 0 || i as usize > mesh.vertices.len()) {
                    return Err(wrong());
                }
                mesh.faces.extend(one_based.windows(2).skip(1).map(|w| [one_based[0] - 1, w[0] - 1, w[1] - 1]));
            }
            Some(_) => return Err(wrong()),
            None => {}
        }
    }
    Ok(mesh)
}

fn parse_rows(text: &str) -> Result<Vec<Row>, String> {
    text.lines()
        .enumerate()
        .skip(1)
        .map(|(number, line)| parse_row(line).ok_or_else(|| format!("line {}: cannot be parsed: {line:?}", number + 1)))
        .collect()
}

fn parse_row(line: &str) -> Option<Row> {
    let words: Vec<&str> = line.split(',').collect();
    let [_, pose @ .., count, digest, distance] = words.as_slice() else { return None };
    let numbers: Vec<f64> = pose.iter().map(|word| parse_hex_float(word)).collect::<Option<_>>()?;
    let [r00, r01, r02, r10, r11, r12, r20, r21, r22, x, y, z] = numbers.try_into().ok()?;
    Some(Row {
        world_from_env: Affine::new([[r00, r01, r02], [r10, r11, r12], [r20, r21, r22]], [x, y, z]),
        pair_count: count.parse().ok()?,
        pairs_digest: (*digest).to_owned(),
        coal_distance: distance.parse().ok()?,
    })
}

/// Parses a normal number or zero as written by C and Python: `-0x1.811b37f940278p-4`.
fn parse_hex_float(text: &str) -> Option<f64> {
    let (sign, digits) = text.strip_prefix('-').map_or((1.0, text), |rest| (-1.0, rest));
    let (mantissa, exponent) = digits.strip_prefix("0x")?.split_once('p')?;
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let integer = u64::from_str_radix(&format!("{whole}{fraction}"), 16).ok()?;
    let exponent = exponent.parse::<i32>().ok()? - 4 * i32::try_from(fraction.len()).ok()?;
    let is_exact = integer < 1 << 53 && (-1022..=1023 - 53).contains(&exponent);
    is_exact.then(|| sign * integer as f64 * f64::from_bits(((exponent + 1023) as u64) << 52))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::oracle::{brute_force, grid};

    #[test]
    fn hex_floats_are_parsed() {
        assert_eq!(parse_hex_float("0x1.999999999999ap-4"), Some(0.1));
        assert_eq!(parse_hex_float("-0x1.6a9ab1a89391ep+11"), Some(-2900.8341868288253));
        assert_eq!(parse_hex_float("0x0.0p+0"), Some(0.0));
        assert_eq!(["1.0", "0x1.8", "0x1.zp+0", "0x1p+9999"].map(parse_hex_float), [None; 4]);
    }

    #[test]
    fn digests_are_those_of_sha256sum() {
        // echo -n "" | sha256sum; echo -n "1,2;30,4" | sha256sum
        assert_eq!(pairs_digest(&[]), "e3b0c44298fc1c14");
        assert_eq!(pairs_digest(&[(1, 2), (30, 4)]), "db30758451f6e333");
    }

    #[test]
    fn objects_are_parsed_and_errors_name_the_line() {
        let mesh = parse_obj("9 9\r\nv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 .5\r\n\r\nf 1 2 3 4\r\n");
        assert_eq!(mesh.map(|mesh| (mesh.vertices[3], mesh.faces)), Ok(([0.0, 1.0, 0.5], vec![[0, 1, 2], [0, 2, 3]])));
        for (wrong, line) in
            [("\nv 1 2", 2), ("\nv 1 2 x", 2), ("\nv 1 2 3\nf 1 1 2", 3), ("\nf 0 0 0", 2), ("\nvn 1 2 3", 2)]
        {
            assert!(parse_obj(wrong).is_err_and(|message| message.starts_with(&format!("line {line}:"))));
        }
    }

    #[test]
    fn the_table_agrees_with_the_oracle() {
        let Some(data) = data_folder() else { return };
        let set = EnvRob::read(&data).unwrap_or_else(|error| panic!("{error}"));
        assert_eq!([set.env.faces.len(), set.rob.faces.len(), set.rows.len()], [2_180, 216, 250]);
        let hits = set.rows.iter().filter(|row| row.pair_count > 0).count();
        assert!((75..175).contains(&hits), "{hits}");
        // Every 13th row, so that some intersect and some do not.
        for row in set.rows.iter().step_by(13) {
            let (env, rob) = (set.baked_env(row), set.rob.at(Affine::IDENTITY));
            let pairs = grid(env.at(Affine::IDENTITY), rob);
            assert_eq!((pairs.len(), pairs_digest(&pairs)), (row.pair_count, row.pairs_digest.clone()));
            assert_eq!(row.coal_distance == 0.0, row.pair_count > 0);
        }
        let row = &set.rows[0];
        assert_eq!(
            brute_force(set.baked_env(row).at(Affine::IDENTITY), set.rob.at(Affine::IDENTITY)).len(),
            row.pair_count
        );
    }

    /// Run with `IMPINGE_DATA=... cargo test --release -p impinge-testkit whole_table --
    /// --ignored`.
    #[test]
    #[ignore = "all 250 rows"]
    fn the_whole_table_agrees_with_the_oracle() {
        let Some(data) = data_folder() else { return };
        let set = EnvRob::read(&data).unwrap_or_else(|error| panic!("{error}"));
        for (number, row) in set.rows.iter().enumerate() {
            let pairs = grid(set.baked_env(row).at(Affine::IDENTITY), set.rob.at(Affine::IDENTITY));
            assert_eq!((pairs.len(), pairs_digest(&pairs)), (row.pair_count, row.pairs_digest.clone()), "row {number}");
        }
    }
}
