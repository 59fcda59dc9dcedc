//! Tests of paths that are not regular files. They are refused before they are opened, because a
//! pipe without a writer, or a device without an end, would keep the reader forever.
#![cfg(unix)]

use std::{fs, io, os::unix::net::UnixListener, path::Path, process::Command};

use impinge_files::{Baked, Limits, LoadErrorKind, load, load_plan, load_rig, read_regular_file};

/// Asserts that no function opens a path. Returns the message of `load`.
fn refused(path: &Path, name: &str) -> String {
    let rig = load_rig(Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data/robot.glb")).unwrap();
    let errors = [
        load(path).unwrap_err(),
        load_rig(path).unwrap_err(),
        load_plan(path, &rig).unwrap_err(),
        Baked::open(path).err().unwrap(),
        read_regular_file(path, &Limits::default()).unwrap_err(),
    ];
    for error in &errors {
        assert_eq!((error.kind().name(), error.path()), (name, path), "{error}");
    }
    errors[0].to_string()
}

#[test]
fn pipes_devices_sockets_and_folders_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let pipe = folder.path().join("pipe.obj");
    assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let text = refused(&pipe, "not-a-file");
    assert!(text.contains("pipe.obj: not a regular file, but a pipe (read its content first"), "{text}");
    assert!(refused(Path::new("/dev/zero"), "not-a-file").contains("but a device"));
    let socket = folder.path().join("socket");
    let _listener = UnixListener::bind(&socket).unwrap();
    assert!(refused(&socket, "not-a-file").contains("but a socket"));
    refused(folder.path(), "io");
    let error = load(folder.path()).unwrap_err();
    assert!(matches!(error.kind(), LoadErrorKind::Io { kind: io::ErrorKind::IsADirectory, .. }), "{error}");
}

#[test]
fn buffers_of_gltf_files_are_refused_unless_they_are_regular_files() {
    let folder = tempfile::tempdir().unwrap();
    assert!(Command::new("mkfifo").arg(folder.path().join("b.bin")).status().unwrap().success());
    let document = folder.path().join("a.gltf");
    fs::write(&document, r#"{"asset":{"version":"2.0"},"buffers":[{"uri":"b.bin","byteLength":4}]}"#).unwrap();
    let error = load(&document).unwrap_err();
    assert_eq!(error.kind(), &LoadErrorKind::NotAFile { found: "a pipe" });
    assert!(error.to_string().contains("buffer 0"), "{error}");
}

#[test]
fn links_to_regular_files_are_read() {
    let folder = tempfile::tempdir().unwrap();
    fs::write(folder.path().join("a.obj"), "v 0 0 0\n").unwrap();
    let link = folder.path().join("b.obj");
    std::os::unix::fs::symlink("a.obj", &link).unwrap();
    assert_eq!(load(&link).unwrap().positions.len(), 1);
}
