//! Order of the crates, read from their manifests. Cargo does not permit dependencies that a
//! manifest does not name.

use std::path::Path;

use anyhow::Result;
use cargo_metadata::{DependencyKind, MetadataCommand};

use crate::sources::Violation;

/// Returns the members of the workspace at `root` that are missing in `order`, and their
/// dependencies against it.
pub(super) fn check(root: &Path, order: &[&str]) -> Result<Vec<Violation>> {
    let metadata = MetadataCommand::new().manifest_path(root.join("Cargo.toml")).no_deps().exec()?;
    let mut violations = Vec::new();
    for package in metadata.workspace_packages() {
        let own = package.dependencies.iter().filter(|d| d.path.is_some() && d.kind != DependencyKind::Development);
        let own: Vec<&str> = own.map(|d| d.name.as_str()).collect();
        let manifest = package.manifest_path.as_std_path();
        let text = std::fs::read_to_string(manifest)?;
        for (name, what) in violations_of(package.name.as_str(), &own, order) {
            let line = text.lines().position(|line| line.contains(&name)).map_or(1, |at| at + 1);
            let file = manifest.strip_prefix(root).unwrap_or(manifest).to_path_buf();
            violations.push(Violation { file, line, what });
        }
    }
    Ok(violations)
}

/// Returns the names that break a rule, each with a message.
fn violations_of(package: &str, dependencies: &[&str], order: &[&str]) -> Vec<(String, String)> {
    let place = |name: &str| order.iter().position(|&c| c == name);
    let Some(own) = place(package) else {
        return vec![(
            package.to_owned(),
            format!("`{package}` has no place in the order of crates: {}", order.join(", ")),
        )];
    };
    let upward = dependencies.iter().filter(|&&name| place(name).is_none_or(|p| p >= own));
    upward
        .map(|&name| {
            let allowed = if own == 0 { "none".to_owned() } else { order[..own].join(", ") };
            (name.to_owned(), format!("`{package}` depends on `{name}`; of this workspace it may use {allowed}"))
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORDER: [&str; 3] = ["core", "files", "tool"];

    #[test]
    fn a_crate_may_depend_on_any_before_it() {
        assert_eq!(violations_of("tool", &["core", "files"], &ORDER), []);
        assert_eq!(violations_of("core", &[], &ORDER), []);
    }

    #[test]
    fn an_upward_dependency_is_reported() {
        let found = violations_of("core", &["tool"], &ORDER);
        assert_eq!(found.len(), 1);
        assert!(found[0].1.contains("`core` depends on `tool`") && found[0].1.contains("none"), "{}", found[0].1);
        assert_eq!(violations_of("files", &["core", "tool", "stray"], &ORDER).len(), 2);
    }

    #[test]
    fn a_crate_without_a_place_is_reported() {
        assert!(violations_of("stray", &[], &ORDER)[0].1.contains("no place"));
    }
}
