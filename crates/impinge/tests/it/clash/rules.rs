//! Rules: which pairs are checked, with which tolerance and clearance.

use impinge::clash::{ALL, Accept, ClashError, Ignore, Options, Rule, Rules, Selector, Set, Status, find};
use impinge::query::batch::Execution;

use super::models::{house, report, rows, scene_of, side};

fn set(name: &str, selector: Selector) -> Set {
    Set { name: name.to_owned(), any: vec![selector] }
}

fn of_type(pattern: &str) -> Selector {
    Selector { kind: vec![pattern.to_owned()], ..Selector::default() }
}

fn rule(a: &str, b: &str) -> Rule {
    Rule { name: format!("{a} against {b}"), a: a.to_owned(), b: b.to_owned(), ..Rule::default() }
}

fn sets() -> Vec<Set> {
    vec![set("walls", of_type("IfcWall*")), set("pipes", of_type("IfcPipe*")), set("signs", of_type("IfcSign"))]
}

#[test]
fn only_pairs_that_a_rule_names_are_checked() {
    let rules = Rules { sets: sets(), rules: vec![rule("pipes", "walls")], ..Rules::default() };
    let found = report(&house(), Options { rules: Some(&rules), ..Options::new(1e-4) });
    assert_eq!(rows(&found), ["clash P-1 W-1", "clash P-1 W-2", "clash P-2 W-1"]);
    assert_eq!((found.duplicates.len(), found.checked_by_rule.clone()), (0, vec![3]));
    assert_eq!(found.counts.unchecked + 3, found.counts.candidates);
    // The order of the two sets does not matter, and one set may be checked against itself.
    for (a, b, count) in [("walls", "pipes", 3), ("pipes", "pipes", 0), (ALL, "pipes", 3), (ALL, ALL, 4)] {
        let rules = Rules { sets: sets(), rules: vec![rule(a, b)], ..Rules::default() };
        let found = report(&house(), Options { rules: Some(&rules), ..Options::new(1e-4) });
        assert_eq!(found.clashes.len(), count, "{a} {b}");
    }
}

#[test]
fn the_first_rule_that_names_a_pair_applies() {
    let lenient = Rule { tolerance: Some(10.0), ..rule("pipes", "walls") };
    let near = Rule { clearance: Some(0.01), severity: Some("low".to_owned()), ..rule(ALL, "walls") };
    let rules = Rules { sets: sets(), rules: vec![lenient, near], ..Rules::default() };
    let found = report(&house(), Options { rules: Some(&rules), ..Options::new(1e-4) });
    assert_eq!(rows(&found), ["clearance F-1 W-1", "contained B-1 W-2"]);
    assert!(found.clashes.iter().all(|clash| clash.rule == Some(1) && clash.severity.as_deref() == Some("low")));
    assert_eq!(found.counts.contact, 3);
}

#[test]
fn ignores_come_before_rules_and_are_counted() {
    let ignores = vec![
        Ignore { why: "sleeves are missing".to_owned(), a: "pipes".to_owned(), b: "walls".to_owned() },
        Ignore { why: "signs are copies".to_owned(), a: "signs".to_owned(), b: "signs".to_owned() },
    ];
    let rules = Rules { sets: sets(), ignores, ..Rules::default() };
    let found = report(&house(), Options { rules: Some(&rules), ..Options::new(1e-4) });
    assert_eq!(rows(&found), ["contained B-1 W-2"]);
    assert_eq!((found.ignored_by_rule, found.counts.ignored), (vec![3, 3], 6));
}

#[test]
fn selectors_match_types_names_paths_scenes_and_exceptions() {
    let count = |selector: Selector| {
        let rules = Rules { sets: vec![set("s", selector)], rules: vec![rule("s", ALL)], ..Rules::default() };
        report(&house(), Options { rules: Some(&rules), ..Options::new(1e-4) }).clashes.len()
    };
    let list = |pattern: &str| vec![pattern.to_owned()];
    assert_eq!(count(Selector { name: list("P-?"), ..Selector::default() }), 3);
    assert_eq!(count(Selector { name: list("P-2"), ..Selector::default() }), 1);
    assert_eq!(count(Selector { name: vec!["P-2".to_owned(), "B-*".to_owned()], ..Selector::default() }), 2);
    assert_eq!(count(Selector { path: list("Site/*"), kind: list("IfcFastener"), ..Selector::default() }), 1);
    assert_eq!(count(Selector { scene: list("hou*"), ..Selector::default() }), 4);
    assert_eq!(
        count(Selector {
            name: list("P-*"),
            except: vec![of_type("IfcNone"), Selector { name: list("*-1"), ..Selector::default() }],
            ..Selector::default()
        }),
        1
    );
}

#[test]
fn an_empty_set_is_an_error_that_names_the_types() {
    let scene = scene_of(&house());
    let find = |rules: &Rules| {
        find(&[side("house", &scene)], Options { rules: Some(rules), ..Options::new(1e-4) }, Execution::default())
    };
    let mut rules = Rules { sets: sets(), rules: vec![rule("walls", "ducts")], ..Rules::default() };
    let error = find(&rules).unwrap_err();
    assert!(matches!(error, ClashError::UnknownSet { .. }));
    rules.sets.push(set("ducts", of_type("IfcDuct*")));
    let error = find(&rules).unwrap_err();
    assert!(matches!(error, ClashError::EmptySet { .. }));
    let text = error.to_string();
    assert!(text.contains("\"ducts\"") && text.contains("\"IfcPipeSegment\"") && text.contains("IfcSign"), "{text}");
    // A set that no rule uses may be empty.
    rules.rules = vec![rule("walls", "pipes")];
    assert!(find(&rules).is_ok());
}

#[test]
fn accepted_clashes_are_approved_until_they_grow() {
    let first = report(&house(), Options::new(1e-4));
    let accepts: Vec<Accept> = first
        .clashes
        .iter()
        .map(|clash| Accept {
            id: clash.id.clone(),
            depth: clash.depth.map(|depth| depth[1]),
            note: Some("agreed".to_owned()),
        })
        .chain([Accept { id: first.duplicates[0].id.clone(), ..Accept::default() }])
        .collect();
    let mut rules = Rules { accepts, ..Rules::default() };
    let found = report(&house(), Options { rules: Some(&rules), ..Options::new(1e-4) });
    assert!(found.is_clear());
    assert_eq!(found.count_of(Status::Approved), first.clashes.len() + 1);
    assert_eq!(found.clashes[0].note.as_deref(), Some("agreed"));
    rules.accepts[1].depth = Some(0.001);
    let found = report(&house(), Options { rules: Some(&rules), ..Options::new(1e-4) });
    assert!(!found.is_clear());
    assert_eq!(found.count_of(Status::New), 1);
}
