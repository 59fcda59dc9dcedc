//! The version of a release is the same in each file that names it.

use std::fs;
use std::path::Path;

use toml::Table;

fn read(file: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("..").join(file);
    fs::read_to_string(&path).unwrap_or_else(|error| panic!("{file}: {error}"))
}

#[test]
fn every_file_has_the_version_of_the_workspace() {
    let manifest: Table = read("Cargo.toml").parse().unwrap();
    let version = manifest["workspace"]["package"]["version"].as_str().unwrap();

    let published = manifest["workspace"]["dependencies"].as_table().unwrap();
    assert_eq!(published.len(), 4);
    for (name, dependency) in published {
        assert_eq!(dependency["version"].as_str(), Some(version), "{name} in Cargo.toml");
    }

    let citation = read("CITATION.cff");
    let cited = citation.lines().find_map(|line| line.strip_prefix("version: "));
    assert_eq!(cited, Some(version), "CITATION.cff");

    // Maturin takes the version of the package from Cargo.
    let python: Table = read("pyproject.toml").parse().unwrap();
    assert!(!python["project"].as_table().unwrap().contains_key("version"), "pyproject.toml");
}
