//! Order of the modules of one crate, read from its source. Each path that starts in the crate is
//! resolved to its top module.

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use anyhow::{Context, Result};

use super::files::{LostFile, SourceFile};
use super::imports::{Child, Import, Imports, leaves};
use crate::sources::Violation;

/// Returns the violations of `order` in the crate whose `lib.rs` lies in `source`. `files` and
/// `lost` are its files; they are shown relative to `root`.
pub(super) fn check(
    source: &Path,
    root: &Path,
    (files, lost): (&[SourceFile], &[LostFile]),
    order: &[&str],
) -> Result<Vec<Violation>> {
    let mut violations = Vec::new();
    let shown = |file: &Path| file.strip_prefix(root).unwrap_or(file).to_path_buf();
    for entry in fs::read_dir(source).with_context(|| format!("reading {}", source.display()))? {
        let path = entry?.path();
        let name = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
        if name != "lib" && !order.contains(&name.as_str()) {
            violations.push(Violation { file: shown(&path), line: 1, what: no_place(&name, order) });
        }
    }

    let exported = files.first().map(|lib| exports(&lib.syntax)).unwrap_or_default();
    for file in files {
        let mut report = |line, what| violations.push(Violation { file: shown(&file.path), line, what });
        judge(&file.imports, &exported, order, &mut report);
    }
    for LostFile { declared_in, line, module } in lost {
        let what = format!("the file of module `{}` is not where its name says", module.join("::"));
        violations.push(Violation { file: shown(declared_in), line: *line, what });
    }
    violations.sort_by(|x, y| (&x.file, x.line, &x.what).cmp(&(&y.file, y.line, &y.what)));
    violations.dedup_by(|x, y| (&x.file, x.line, &x.what) == (&y.file, y.line, &y.what));
    Ok(violations)
}

/// Returns the names that the root of the crate re-exports, each with its path.
fn exports(root: &syn::File) -> BTreeMap<String, String> {
    let mut exported = BTreeMap::new();
    for item in &root.items {
        if let syn::Item::Use(import) = item {
            leaves(&import.tree, &mut Vec::new(), &mut |path, name, _| {
                let path = path.iter().skip_while(|s| *s == "crate" || *s == "self").cloned().collect::<Vec<_>>();
                exported.insert(name.to_owned(), path.join("::"));
            });
        }
    }
    exported
}

fn judge(
    imports: &Imports,
    exported: &BTreeMap<String, String>,
    order: &[&str],
    report: &mut impl FnMut(usize, String),
) {
    for Child { module, line, .. } in imports.children.iter().chain(&imports.inline) {
        if let [name] = module.as_slice()
            && !order.contains(&name.as_str())
        {
            report(*line, no_place(name, order));
        }
    }
    for import in &imports.found {
        if let Some(what) = judge_import(import, exported, order) {
            report(import.line, what);
        }
    }
}

/// Returns the rule that an import breaks, or `None`. The root of the crate, which gathers the
/// modules, may import any of them.
fn judge_import(import: &Import, exported: &BTreeMap<String, String>, order: &[&str]) -> Option<String> {
    let place = |name: &str| order.iter().position(|&m| m == name);
    let from = import.module.first()?;
    let own = place(from)?; // a module without a place is reported where it is declared
    let written = &import.written;
    match import.path.first().map(|to| (to, place(to))) {
        Some((_, Some(to))) if to <= own => None,
        Some((to, Some(_))) => {
            let allowed = if own == 0 { "none".to_owned() } else { order[..own].join(", ") };
            Some(format!("`{written}` reaches up from `{from}` to `{to}`; `{from}` may use {allowed}"))
        }
        to => {
            let owner = to.and_then(|(to, _)| exported.get(to));
            let hint = owner.map(|path| format!(", `crate::{path}`")).unwrap_or_default();
            Some(format!("`{written}` goes through the root of the crate: name the module{hint}"))
        }
    }
}

fn no_place(module: &str, order: &[&str]) -> String {
    format!("module `{module}` has no place in the order: {}", order.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::layers::files;

    const ORDER: [&str; 3] = ["low", "mid", "high"];

    /// Returns the lines and messages of the violations in `source`, the source of `module`.
    fn found(module: &str, source: &str) -> Vec<(usize, String)> {
        let module: Vec<String> = module.split("::").map(str::to_owned).collect();
        let exported = exports(&syn::parse_str("pub use high::{Roof, tiles as shingles}; pub use low::*;").unwrap());
        let mut found = Vec::new();
        let imports = Imports::of(&syn::parse_str(source).unwrap(), &module);
        judge(&imports, &exported, &ORDER, &mut |line, what| found.push((line, what)));
        found
    }

    /// Asserts that `source` in module `mid` breaks a rule only on line 2, and that the message
    /// contains `part`.
    #[track_caller]
    fn breaks(source: &str, part: &str) {
        let found = found("mid", source);
        assert_eq!(found.iter().map(|f| f.0).collect::<Vec<_>>(), [2], "{found:?}");
        assert!(found[0].1.contains(part), "{}", found[0].1);
    }

    #[test]
    fn modules_before_and_the_own_module_may_be_used() {
        let source = "use crate::low::{self, Stone, deep::{Rock as R, *}};\nuse super::low::Sand;\nuse std::fmt;\n\
            use self::part::A;\nuse crate::mid::part::B;\nmod part;\nmod inner { use super::C; use super::super::low::D; }\n\
            pub(in crate::high) fn f() -> crate::low::E { crate::low::g(super::low::H) }\nfn high() { high::<u8>() }";
        assert_eq!(found("mid", source), []);
        assert_eq!(found("mid::part", "use super::C;\nuse super::super::low::D;"), []);
    }

    #[test]
    fn every_kind_of_import_upwards_is_reported() {
        let message = "`crate::high::Roof` reaches up from `mid` to `high`; `mid` may use low";
        breaks("\nuse crate::high::Roof;", message);
        breaks("\nuse crate::{low::Stone, high::Roof as R};", message);
        breaks("\nuse crate::high as h;", "`crate::high`");
        breaks("\nuse crate::high::*;", "`crate::high::*`");
        breaks("\nuse super::high::Roof;", "`super::high::Roof` reaches up");
        breaks("\nuse self::super::high::Roof;", "to `high`");
        breaks("\npub use crate::high::Roof;", message);
        breaks("fn f() {\nuse crate::high::Roof; }", message);
        breaks("mod inner {\nuse super::super::high::Roof; }", "to `high`");
    }

    #[test]
    fn paths_outside_of_imports_count() {
        breaks("fn f() {\ncrate::high::build() }", "`crate::high::build`");
        breaks("fn f(\n_: Vec<crate::high::Roof>) {}", "`crate::high::Roof`");
        breaks("struct S;\nimpl crate::high::Cover for S {}", "`crate::high::Cover`");
        breaks("fn f() {\n<S as crate::high::Cover>::lay() }", "`crate::high::Cover::lay`");
        breaks("fn f() {\nsuper::high::build() }", "`super::high::build`");
    }

    #[test]
    fn tokens_of_macros_and_attributes_count() {
        breaks("fn f() { assert!(\ncrate::high::build()) }", "`crate::high::build`");
        breaks("macro_rules! m { () => {\n$crate::high::build() } }", "`crate::high::build`");
        breaks("macro_rules! m { () => {\nuse crate::{low::A, high::B}; } }", "`crate::high::B`");
        breaks("macro_rules! m { ($n:ident) => {\ncrate::$n() } }", "name the module");
        breaks("\n#[derive(crate::high::Cover)] struct S;", "`crate::high::Cover`");
        assert_eq!(found("mid", "fn f() { assert!(crate::low::g(self.high), \"crate::high::x\") }"), []);
    }

    #[test]
    fn the_root_of_the_crate_is_no_way_round() {
        breaks("\nuse crate::Roof;", "name the module, `crate::high::Roof`");
        breaks("\nuse crate::shingles;", "name the module, `crate::high::tiles`");
        breaks("\nuse crate::*;", "name the module");
        breaks("\nuse crate as root;", "name the module");
        breaks("\nuse super::Roof;", "name the module, `crate::high::Roof`");
        breaks("\nextern crate self as root;", "name the module");
    }

    #[test]
    fn what_is_compiled_for_tests_alone_is_free() {
        assert_eq!(found("mid", "#[cfg(test)]\nmod tests { use crate::high::Roof; }"), []);
        assert_eq!(found("mid", "#[cfg(all(test, unix))]\nuse crate::high::Roof;"), []);
        assert_eq!(found("mid", "#![cfg(test)]\nuse crate::high::Roof;"), []);
        assert_eq!(found("mid", "impl S { #[cfg(test)]\nfn f() { crate::high::g() } }"), []);
        breaks("#[cfg(not(test))]\nuse crate::high::Roof;", "to `high`");
        breaks("#[cfg(any(test, unix))]\nuse crate::high::Roof;", "to `high`");
    }

    #[test]
    fn files_are_followed_and_modules_without_a_place_reported() {
        let root = tempfile::tempdir().unwrap();
        let write = |name: &str, text: &str| {
            let path = root.path().join(name);
            fs::create_dir_all(path.parent().unwrap()).unwrap();
            fs::write(path, text).unwrap();
        };
        write("lib.rs", "pub mod low;\npub mod mid;\npub use mid::part::A;");
        write("low.rs", "mod nested;");
        write("low/nested.rs", "mod deep { mod deeper; }");
        write("low/nested/deep/deeper.rs", "\n\nuse crate::mid::part::A;");
        write("mid/mod.rs", "pub mod part;\n#[cfg(test)]\nmod tests;");
        write("mid/part.rs", "pub use crate::low::A;");
        write("mid/tests.rs", "use crate::high::B;");
        let shown = || -> Vec<String> {
            let (files, lost) = files::read(root.path()).unwrap();
            let found = check(root.path(), root.path(), (&files, &lost), &ORDER).unwrap();
            found.iter().map(ToString::to_string).collect()
        };
        let upward =
            "low/nested/deep/deeper.rs:3: `crate::mid::part::A` reaches up from `low` to `mid`; `low` may use none";
        assert_eq!(shown(), [upward]);

        write("stray/mod.rs", "");
        write("lib.rs", "mod low;\nmod aside {}\nmod mid;\nmod absent;");
        let shown = shown();
        assert!(shown.iter().any(|v| v.starts_with("stray:1: module `stray` has no place")), "{shown:?}");
        assert!(shown.iter().any(|v| v.starts_with("lib.rs:2: module `aside` has no place")), "{shown:?}");
        assert!(shown.iter().any(|v| v.starts_with("lib.rs:4: the file of module `absent` is not")), "{shown:?}");
    }
}
