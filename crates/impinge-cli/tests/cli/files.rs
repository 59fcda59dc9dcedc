//! Tests of the files that the command reads from standard input and writes.

use std::fs;
use std::io::Write;
use std::process::Stdio;

use crate::Folder;

#[test]
fn csv_rows_name_sources_and_parts() {
    let folder = Folder::new();
    let two_parts = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no first, \"quoted\"\nf 1 2 3\no second\nf 1 2 4 3\n";
    folder.write("parts.obj", two_parts);
    folder.write("blade.obj", "v 0.25 0.25 -1\nv 0.25 0.25 2\nv 0.3 0.3 2\nf 1 2 3\n");
    let run = folder.run("check parts.obj blade.obj --pairs pairs.csv --json");
    assert_eq!((run.code, run.stderr.as_str()), (1, ""));
    let text = folder.read("pairs.csv");
    let mut lines = text.lines();
    assert_eq!(lines.next(), Some("face_a,face_b,source_a,source_b,part_a,part_b"));
    assert_eq!(lines.next(), Some("0,0,0,0,\"first, \"\"quoted\"\"\","));
    // The quadrilateral becomes two triangles of source 1; the blade crosses at least one of them.
    let rest: Vec<&str> = lines.collect();
    assert!(!rest.is_empty() && rest.iter().all(|row| row.ends_with(",0,1,0,second,")), "{rest:?}");
}

#[test]
fn npy_and_csv_hold_the_same_pairs() {
    let folder = Folder::new();
    let csv = folder.run("check cube.obj big.obj --pose-a 2.5,1,0 --pairs pairs.csv --json");
    let npy = folder.run("check cube.obj big.obj --pose-a 2.5,1,0 --pairs PAIRS.NPY --json");
    assert_eq!((csv.code, npy.code), (1, 1));
    let text = folder.read("pairs.csv");
    let rows: Vec<Vec<u32>> =
        text.lines().skip(1).map(|row| row.split(',').take(2).map(|n| n.parse().unwrap()).collect()).collect();
    let bytes = fs::read(folder.path("PAIRS.NPY")).unwrap();
    assert!(bytes.starts_with(b"\x93NUMPY\x01\x00\x76\x00{'descr': '<u4', 'fortran_order': False, 'shape': ("));
    let (header, data) = bytes.split_at(128);
    assert!(str::from_utf8(&header[10..]).unwrap().contains(&format!("'shape': ({}, 2), }}", rows.len())));
    let numbers: Vec<u32> = data.chunks(4).map(|word| u32::from_le_bytes(word.try_into().unwrap())).collect();
    assert_eq!(numbers, rows.concat());
    assert!(!rows.is_empty());
}

#[test]
fn output_files_are_written_even_without_pairs() {
    let folder = Folder::new();
    assert_eq!(folder.run("check cube.obj cube.obj --pose-a 9,0,0 --pairs p.csv --curves c.obj").code, 0);
    assert_eq!(folder.read("p.csv"), "face_a,face_b,source_a,source_b,part_a,part_b\n");
    assert_eq!(folder.read("c.obj"), "");
    assert_eq!(folder.run("check cube.obj cube.obj --pose-a 9,0,0 --pairs p.npy").code, 0);
    assert_eq!(fs::metadata(folder.path("p.npy")).unwrap().len(), 128);
}

#[test]
fn curves_are_written_as_closed_polylines() {
    let folder = Folder::new();
    assert_eq!(folder.run("check cube.obj cube.obj --pose-b 0.5,0.5,0.5 --curves curve.obj").code, 1);
    let text = folder.read("curve.obj");
    let points: Vec<Vec<f64>> = text
        .lines()
        .filter_map(|line| line.strip_prefix("v "))
        .map(|line| line.split(' ').map(|x| x.parse().unwrap()).collect())
        .collect();
    let lines: Vec<&str> = text.lines().filter_map(|line| line.strip_prefix("l ")).collect();
    assert_eq!(lines.len(), 1, "{text}");
    let indices: Vec<usize> = lines[0].split(' ').map(|i| i.parse().unwrap()).collect();
    assert_eq!(indices.first(), indices.last());
    assert_eq!(indices.len(), points.len() + 1);
    let step = |ends: &[usize]| {
        let [from, to] = [&points[ends[0] - 1], &points[ends[1] - 1]];
        from.iter().zip(to).map(|(x, y)| (x - y).powi(2)).sum::<f64>().sqrt()
    };
    assert_eq!(indices.windows(2).map(step).sum::<f64>(), 3.0);
    assert!(points.iter().flatten().all(|x| (0.5..=1.0).contains(x)));
}

/// Runs the command with `input` on standard input. Returns the exit code, standard output and
/// standard error.
fn run_with_input(folder: &Folder, arguments: &str, input: &str) -> (i32, String, String) {
    let mut command = folder.command(arguments.split(' '));
    let streams = command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = streams.spawn().unwrap();
    // Ignore an error: a command with invalid arguments does not read its input.
    let _ = child.stdin.take().unwrap().write_all(input.as_bytes());
    let output = child.wait_with_output().unwrap();
    let [stdout, stderr] = [output.stdout, output.stderr].map(|text| String::from_utf8(text).unwrap());
    (output.status.code().unwrap(), stdout, stderr)
}

#[test]
fn a_mesh_is_read_from_standard_input() {
    let folder = Folder::new();
    let cube = folder.read("cube.obj");
    let (code, stdout, stderr) = run_with_input(&folder, "check - cube.obj --format obj --json", &cube);
    assert_eq!((code, stderr.as_str()), (1, ""));
    assert!(stdout.contains(r#""a":{"path":"-","triangles":12"#), "{stdout}");
    let off = "OFF\n3 1 0\n0.5 0.5 -1\n0.5 0.5 2\n0.6 0.5 2\n3 0 1 2\n";
    assert_eq!(run_with_input(&folder, "check cube.obj - --json", off).0, 1, "the content says that it is OFF");
    for (arguments, input, message) in [
        ("check - cube.obj", cube.as_str(), "--format"),
        ("check - cube.obj --format doc", "", "expected one of obj, stl"),
        ("check - - --format obj", "", "standard input holds one mesh"),
        ("inspect - --format off", "OFF 1 0 0\n0 0 x\n", "-, line 2: expected a coordinate"),
    ] {
        let (code, _, stderr) = run_with_input(&folder, arguments, input);
        assert!(code == 2 && stderr.contains(message), "{arguments}: {stderr}");
    }
    folder.write("no_extension", off);
    assert_eq!(folder.run("check no_extension cube.obj").code, 1);
    let as_obj = folder.run("check cube.obj no_extension --format obj");
    assert!(as_obj.code == 1 && as_obj.stderr.contains("was read in its own format"), "{as_obj:?}");
}
