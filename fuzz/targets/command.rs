//! The command with arguments and small files, in a folder of its own: it must return an exit code
//! of 0, 1 or 2.

#![no_main]

use std::path::Path;
use std::sync::LazyLock;
use std::{env, fs};

use arbitrary::{Arbitrary, Unstructured};
use libfuzzer_sys::fuzz_target;
use tempfile::TempDir;

/// Arguments that the target combines. None names a path outside of the folder.
const WORDS: &[&str] = &[
    "check",
    "inspect",
    "bake",
    "fit",
    "hits",
    "world",
    "completions",
    "man",
    "help",
    "a.obj",
    "b.stl",
    "c.ply",
    "d.off",
    "e.gltf",
    "f.dae",
    "g.3mf",
    "h.impinge",
    "i.glb",
    "none.obj",
    "-o",
    "--output",
    "out.impinge",
    "out.csv",
    "out.json",
    "out.png",
    "out.toml",
    "out.ply",
    "--json",
    "--pairs",
    "--curves",
    "--distance",
    "--clearance",
    "--penetrates",
    "--solid",
    "--solid=a",
    "--solid=b",
    "--pose-a",
    "--pose-b",
    "--unit-a",
    "--unit-b",
    "--allow-empty",
    "--proxies",
    "--hierarchy",
    "fast",
    "best",
    "--weld",
    "--orient",
    "--format",
    "obj",
    "stl",
    "--picture",
    "--level",
    "--up",
    "x",
    "z",
    "--animation",
    "--volumes",
    "--mode",
    "snug",
    "--plan",
    "--save",
    "--help",
    "--version",
    "-h",
    "--",
    "-",
    "",
    "0",
    "1",
    "-1",
    "1e309",
    "nan",
    "inf",
    "0.5",
    "1,0,0",
    "1,0,0,0,1,0,0,0,1,5,0,0",
    "0,0,0,0",
    "4294967296",
    "mm",
    "m",
    "--steps",
    "3",
    "--bodies",
    "20",
    "--scene",
    "--sizes",
    "--mix",
    "--broad-phase",
    "--narrow-phase",
    "--seed",
    "bash",
    "zsh",
    "\u{FEFF}",
    "--threads",
    "2",
];

/// Names of the files that the target writes. Each receives the same content in turn.
const FILES: [&str; 9] = ["a.obj", "b.stl", "c.ply", "d.off", "e.gltf", "f.dae", "g.3mf", "h.impinge", "i.glb"];

static FOLDER: LazyLock<TempDir> = LazyLock::new(|| {
    let folder = tempfile::tempdir().expect("a folder");
    env::set_current_dir(folder.path()).expect("the folder exists");
    folder
});

#[derive(Debug)]
struct Call {
    arguments: Vec<String>,
    files: Vec<(&'static str, Vec<u8>)>,
}

impl<'a> Arbitrary<'a> for Call {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        let mut arguments = Vec::new();
        for _ in 0..bytes.int_in_range(0..=12_u8)? {
            arguments.push((*bytes.choose(WORDS)?).to_owned());
        }
        let mut files = Vec::new();
        for _ in 0..bytes.int_in_range(0..=2_u8)? {
            let name = *bytes.choose(&FILES)?;
            let len = bytes.int_in_range(0..=300_u16)?;
            files.push((name, bytes.bytes(usize::from(len).min(bytes.len()))?.to_vec()));
        }
        Ok(Self { arguments, files })
    }
}

/// Reports whether a run takes long by its arguments: a world with its default 10,000 bodies.
fn takes_long(arguments: &[String]) -> bool {
    let follows = |name: &str, most: u32| {
        let at = arguments.iter().position(|argument| argument == name)?;
        arguments.get(at + 1)?.parse::<u32>().ok().filter(|&count| count <= most)
    };
    arguments.iter().any(|argument| argument == "world")
        && (follows("--bodies", 20).is_none() || follows("--steps", 3).is_none())
}

fuzz_target!(|call: Call| {
    let folder = FOLDER.path();
    if takes_long(&call.arguments) {
        return;
    }
    for entry in fs::read_dir(folder).expect("the folder exists").flatten() {
        let _ = fs::remove_file(entry.path());
    }
    let sound = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 1\nf 1 2 3\nf 1 3 4\nf 1 4 2\nf 2 4 3\n";
    let write = |name: &str, content: &[u8]| fs::write(Path::new(folder).join(name), content).expect("a file");
    write("a.obj", sound.as_bytes());
    write("b.stl", sound.as_bytes());
    for (name, content) in &call.files {
        write(name, content);
    }
    let code = impinge_cli::run(&call.arguments);
    assert!(code <= 2, "{code}");
});
