//! Poses as arguments: numbers, or a file with a matrix.

use std::ffi::OsStr;
use std::fs::File;
use std::io::Read;
use std::path::Path;

use impinge::Pose;

use crate::failure::Failure;

/// Maximum size of a file with a matrix, in bytes: more than 16 numbers need in any notation. A
/// larger file cannot be a matrix and is not read further.
const MAX_FILE_BYTES: u64 = 1 << 16;

const FORMS: &str =
    "a pose is tx,ty,tz or tx,ty,tz,qw,qx,qy,qz or a file with a 4x4 matrix (row-major, for column vectors)";

/// Parses a pose; `option` is the name of the argument, for messages.
///
/// # Errors
/// Returns an error if the argument is neither three or seven numbers nor a file with a matrix, or
/// if the pose is invalid.
pub(crate) fn parse(argument: &OsStr, option: &str) -> Result<Pose, Failure> {
    let numbers: Option<Vec<f64>> =
        argument.to_str().and_then(|text| text.split(',').map(|field| field.trim().parse().ok()).collect());
    let path = Path::new(argument);
    let pose = match numbers.as_deref() {
        Some(&[x, y, z]) => Pose::from_translation([x, y, z]),
        Some(&[x, y, z, qw, qx, qy, qz]) => Pose::from_quaternion_wxyz([x, y, z], [qw, qx, qy, qz]),
        Some(numbers) if !path.exists() => {
            let message = format!("{} given; a pose has 3 or 7", crate::numerals::counted(numbers.len(), "number"));
            return Err(Failure::new("pose", message).at(option).hint(FORMS));
        }
        _ => return read(path, option),
    };
    pose.map_err(|error| Failure::from_input(&error).at(option))
}

fn read(path: &Path, option: &str) -> Result<Pose, Failure> {
    let fail = |message: String| Failure::new("pose", message).in_file(path).at(option).hint(FORMS);
    let mut bytes = Vec::new();
    File::open(path).and_then(|file| file.take(MAX_FILE_BYTES + 1).read_to_end(&mut bytes)).map_err(|error| {
        Failure::from_io(&error, "neither numbers nor a file that can be read").in_file(path).at(option).hint(FORMS)
    })?;
    if bytes.len() as u64 > MAX_FILE_BYTES {
        return Err(fail("the file is too long for a matrix".to_owned()));
    }
    let text = str::from_utf8(&bytes).map_err(|_| fail("not a text file with a matrix".to_owned()))?;
    let matrix = matrix(text).map_err(fail)?;
    Pose::from_matrix(matrix).map_err(|error| Failure::from_input(&error).in_file(path).at(option))
}

/// Parses a matrix. Text that starts with a bracket is JSON: four rows of four numbers, or sixteen
/// numbers. Other text is sixteen numbers separated by spaces, line ends and commas.
fn matrix(text: &str) -> Result<[[f64; 4]; 4], String> {
    let text = text.trim_start_matches('\u{feff}').trim();
    let numbers: Vec<f64> = if text.starts_with('[') {
        match serde_json::from_str(text) {
            Ok(rows) => return Ok(rows),
            Err(nested) => serde_json::from_str(text).map_err(|_| format!("not a 4x4 matrix: {nested}"))?,
        }
    } else {
        let words = text.split(|c: char| c == ',' || c.is_whitespace()).filter(|word| !word.is_empty());
        words.map(|word| word.parse().map_err(|_| format!("{word:.40?} is not a number"))).collect::<Result<_, _>>()?
    };
    let count = numbers.len();
    let flat: [f64; 16] = numbers.try_into().map_err(|_| format!("{count} numbers found; a 4x4 matrix has 16"))?;
    Ok(std::array::from_fn(|row| std::array::from_fn(|column| flat[4 * row + column])))
}

/// Returns the 4x4 matrix of a pose, rows first. [`parse`] reads the same matrix back from a file.
pub(crate) fn rows(pose: &Pose) -> [[f64; 4]; 4] {
    let (linear, translation) = (pose.linear(), pose.translation());
    let row = |i: usize| [linear[i][0], linear[i][1], linear[i][2], translation[i]];
    [row(0), row(1), row(2), [0.0, 0.0, 0.0, 1.0]]
}

#[cfg(test)]
mod tests {
    use super::*;
    use impinge_testkit::generate::Rng;

    fn parsed(argument: &str) -> Result<Pose, Failure> {
        parse(OsStr::new(argument), "--pose-a")
    }

    /// Returns entries of many magnitudes and both signs, including zeros and whole numbers.
    fn entry(rng: &mut Rng) -> f64 {
        match rng.integer(0, 3) {
            0 => rng.integer(-3, 3) as f64,
            _ => rng.uniform(-1.0, 1.0) * 10_f64.powi(rng.integer(-12, 12) as i32),
        }
    }

    #[test]
    fn numbers_are_read_to_the_last_bit() {
        let mut rng = Rng::new(1);
        let mut negative_first = 0;
        for _ in 0..1000 {
            let t: [f64; 3] = std::array::from_fn(|_| entry(&mut rng));
            negative_first += usize::from(t[0] < 0.0);
            let [x, y, z] = t;
            assert_eq!(parsed(&format!("{x},{y},{z}")), Ok(Pose::from_translation(t).unwrap()));
            let q: [f64; 4] = std::array::from_fn(|_| rng.uniform(-1.0, 1.0));
            let length = q.iter().map(|x| x * x).sum::<f64>().sqrt();
            let q = q.map(|x| x / length);
            let text = format!("{x:e}, {y:e}, {z:e}, {}, {}, {}, {}", q[0], q[1], q[2], q[3]);
            assert_eq!(parsed(&text), Ok(Pose::from_quaternion_wxyz(t, q).unwrap()));
        }
        assert!((300..700).contains(&negative_first));
    }

    #[test]
    fn matrices_are_read_back_from_every_form() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("pose");
        let mut rng = Rng::new(2);
        let mut regular = 0;
        for _ in 0..200 {
            let rows_of: [[f64; 4]; 3] = std::array::from_fn(|_| std::array::from_fn(|_| entry(&mut rng)));
            let given = Pose::new(rows_of.map(|[x, y, z, _]| [x, y, z]), rows_of.map(|row| row[3]));
            let matrix = [rows_of[0], rows_of[1], rows_of[2], [0.0, 0.0, 0.0, 1.0]];
            let lines = matrix.map(|row| row.map(|x| x.to_string()).join(" ")).join("\r\n");
            let commas = format!("\u{feff}{}\n", matrix.map(|row| row.map(|x| format!("{x:e}")).join(", ")).join("\n"));
            let nested = serde_json::to_string(&matrix).unwrap();
            let flat = serde_json::to_string_pretty(matrix.as_flattened()).unwrap();
            for text in [lines, commas, nested, flat] {
                std::fs::write(&path, &text).unwrap();
                let read = parse(path.as_os_str(), "--pose-b");
                assert_eq!(read.as_ref().ok(), given.as_ref().ok(), "{text}");
                if let Ok(pose) = read {
                    assert_eq!(rows(&pose), matrix);
                    regular += 1;
                }
            }
        }
        assert!(regular > 400, "{regular}");
    }

    #[test]
    fn errors_say_what_is_wrong_with_a_matrix() {
        let error = |text: &str| matrix(text).unwrap_err();
        assert_eq!(error("1 2 3"), "3 numbers found; a 4x4 matrix has 16");
        assert_eq!(error(""), "0 numbers found; a 4x4 matrix has 16");
        assert_eq!(error("1 0 0 oops"), "\"oops\" is not a number");
        assert_eq!(error("[1, 2]"), "2 numbers found; a 4x4 matrix has 16");
        assert!(error("[[1, 2], [3, 4]]").starts_with("not a 4x4 matrix: "));
        assert!(error("[null]").starts_with("not a 4x4 matrix: "));
    }
}
