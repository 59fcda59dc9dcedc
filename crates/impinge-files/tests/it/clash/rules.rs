//! Rules from TOML, a CSV matrix and clash sets of IfcClash, and their errors.

use impinge::clash::{Rule, Selector};
use impinge_files::{LoadError, Place, RulesFile, RulesFormat, Unit, parse_rules};

fn parse(text: &str, format: RulesFormat) -> Result<RulesFile, LoadError> {
    parse_rules(text.as_bytes(), format, Some(Unit::Meter))
}

fn line(error: &LoadError) -> Option<u64> {
    match error.place() {
        Some(&Place::Line(line)) => Some(line),
        _ => None,
    }
}

pub(super) const TOML: &str = r#"tolerance = "2mm"
clearance = 0.5

[sets]
pipes = { type = "IfcPipe*", scene = ["mep", "hvac"] }
walls = [
  { type = ["IfcWall*", "IfcSlab"], except = { name = "*temporary*" } },
  { path = "Site/Roof/*" },
]

[[rule]]
name = "pipes through walls"
a = "pipes"
b = "walls"
tolerance = "1/2in"
clearance = 0.025
severity = "high"

[[rule]]
a = "pipes"
b = "*"

[[ignore]]
a = "walls"
b = "walls"
why = "walls are joined"

[[accept]]
id = "c-abcd2345"
depth = "40mm"
note = "agreed"
"#;

#[test]
fn toml_has_sets_rules_ignores_and_accepts() {
    let file = parse(TOML, RulesFormat::Toml).unwrap();
    assert_eq!((file.tolerance, file.clearance), (Some(0.002), Some(0.5)));
    let list = |texts: &[&str]| texts.iter().map(|&text| text.to_owned()).collect::<Vec<_>>();
    let rules = file.rules.clone();
    assert_eq!(
        rules.sets[0].any,
        [Selector { kind: list(&["IfcPipe*"]), scene: list(&["mep", "hvac"]), ..Selector::default() }]
    );
    assert_eq!(rules.sets[1].any[0].except[0].name, ["*temporary*"]);
    assert_eq!(rules.sets[1].any[1].path, ["Site/Roof/*"]);
    let Rule { name, tolerance, clearance, severity, .. } = &rules.rules[0];
    assert_eq!(
        (name.as_str(), *tolerance, *clearance, severity.as_deref()),
        ("pipes through walls", Some(0.0127), Some(0.025), Some("high"),)
    );
    assert_eq!(rules.rules[1].name, "pipes against *");
    assert_eq!(rules.ignores[0].why, "walls are joined");
    assert_eq!((rules.accepts[0].depth, rules.accepts[0].note.as_deref()), (Some(0.04), Some("agreed")));
    assert_eq!(
        (file.line_of_set("pipes"), file.line_of_set("walls"), file.line_of_set("none")),
        (Some(5), Some(6), None)
    );
}

#[test]
fn errors_of_toml_name_the_line() {
    let cases = [
        ("tolerance = \n", 1),
        ("\ntolerance = \"2 furlongs\"\n", 2),
        ("tolerance = -1\n", 1),
        ("[sets]\na = { kind = \"x\" }\n", 2),
        ("[sets]\n\"*\" = { type = \"x\" }\n", 2),
        ("[[rule]]\na = \"*\"\nb = \"*\"\n\n[[rule]]\na = \"pipes\"\nb = \"*\"\n", 5),
        ("[[rule]]\na = \"*\"\n", 1),
        ("[[ignore]]\na = \"x\"\nb = \"*\"\n", 1),
        ("[[accept]]\nid = 5\n", 2),
        ("[[rules]]\na = \"*\"\n", 1),
    ];
    for (text, expected) in cases {
        let error = parse(text, RulesFormat::Toml).unwrap_err();
        assert_eq!(line(&error), Some(expected), "{text:?}: {error}");
    }
    // The error names the sets that exist.
    let error = parse("[sets]\nwalls = { type = \"x\" }\n[[rule]]\na = \"wals\"\nb = \"*\"\n", RulesFormat::Toml);
    assert!(error.unwrap_err().to_string().contains("the name of a set: *, walls, found \"wals\""));
}

#[test]
fn lengths_with_units_need_the_unit_of_the_scene() {
    let of = |text: &str| parse_rules(text.as_bytes(), RulesFormat::Toml, None);
    assert_eq!(of("tolerance = 0.25").unwrap().tolerance, Some(0.25));
    assert!(of("tolerance = \"2mm\"").unwrap_err().hint().unwrap().contains("--unit"));
}

pub(super) const MATRIX: &str = "mm,IfcPipe*,IfcDuct*,arch:IfcWall*\n\
    IfcPipe*,2,c25,10\nIfcDuct*,,2,10 c50\narch:IfcWall*,10,,\n";

#[test]
fn a_matrix_has_tolerances_and_clearances() {
    let file = parse(MATRIX, RulesFormat::Csv).unwrap();
    let rules = file.rules.rules.iter();
    let found: Vec<_> = rules.map(|rule| (rule.a.as_str(), rule.b.as_str(), rule.tolerance, rule.clearance)).collect();
    assert_eq!(
        found,
        [
            ("IfcDuct*", "IfcDuct*", Some(0.002), None),
            ("IfcDuct*", "IfcPipe*", None, Some(0.025)),
            ("IfcDuct*", "arch:IfcWall*", Some(0.01), Some(0.05)),
            ("IfcPipe*", "IfcPipe*", Some(0.002), None),
            ("IfcPipe*", "arch:IfcWall*", Some(0.01), None),
        ]
    );
    let walls = &file.rules.sets.iter().find(|set| set.name == "arch:IfcWall*").unwrap().any[0];
    assert_eq!((&walls.scene[..], &walls.kind[..]), (&["arch".to_owned()][..], &["IfcWall*".to_owned()][..]));
    // Without a unit in the first cell, numbers are millimeters.
    let plain = parse(&MATRIX.replacen("mm", "", 1), RulesFormat::Csv).unwrap();
    assert_eq!(plain, file);
    let inches = parse(&MATRIX.replacen("mm", "in", 1), RulesFormat::Csv).unwrap();
    assert_eq!(inches.rules.rules[0].tolerance, Some(0.0508));
    let unknown = parse_rules(MATRIX.replacen("mm", "", 1).as_bytes(), RulesFormat::Csv, None).unwrap();
    assert_eq!(unknown.rules.rules[0].tolerance, Some(2.0));
}

#[test]
fn errors_of_a_matrix_name_the_line() {
    let cases = [
        ("", 1),
        ("furlong,a,b\n", 1),
        ("mm\n", 1),
        ("mm,a,a\n", 1),
        ("mm,a,b\na,x,\n", 2),
        ("mm,a,b\na,,1\nb,2,\n", 3),
        ("mm,a,b\na,1,1,1\n", 2),
        ("mm,a,b\na,1 2,\n", 2),
        ("mm,a,b\na,-1,\n", 2),
        ("mm,a,b\na,,\n", 1),
    ];
    for (text, expected) in cases {
        let error = parse(text, RulesFormat::Csv).unwrap_err();
        assert_eq!(line(&error), Some(expected), "{text:?}: {error}");
    }
}

pub(super) const IFC_CLASH: &str = r#"[
  {"name": "pipes and walls", "mode": "intersection", "tolerance": 0.002, "check_all": true,
   "a": [{"file": "/models/mep.ifc", "mode": "i", "selector": "IfcPipeSegment, IfcPipeFitting"}],
   "b": [{"file": "arch.ifc", "mode": "e", "selector": "IfcWindow + IfcDoor"}]},
  {"name": "touching", "mode": "collision", "allow_touching": true, "a": [{"file": "C:\\models\\arch.ifc"}]},
  {"name": "room", "mode": "clearance", "clearance": 0.1, "check_all": false,
   "a": [{"file": "mep.ifc", "mode": "i", "selector": "IfcElement, !IfcValve, Name=\"P*\""}]}
]"#;

#[test]
fn clash_sets_of_ifc_clash_are_read_as_they_are() {
    let rules = parse(IFC_CLASH, RulesFormat::IfcClash).unwrap().rules;
    let found: Vec<_> = rules.rules.iter().map(|rule| (rule.name.as_str(), rule.tolerance, rule.clearance)).collect();
    assert_eq!(
        found,
        [("pipes and walls", Some(0.002), None), ("touching", Some(0.0), None), ("room", None, Some(0.1)),]
    );
    assert!(rules.rules[0].a != rules.rules[0].b && rules.rules[1].a == rules.rules[1].b);
    assert_eq!(rules.sets.len(), 4);
    let pipes = &rules.sets[0].any[0];
    assert_eq!(pipes.scene, ["mep"]);
    assert!(pipes.kind.iter().any(|kind| kind == "IfcPipeFitting"));
    let walls = &rules.sets[1].any[0];
    assert_eq!((walls.kind.len(), walls.except.len(), walls.scene.as_slice()), (0, 2, &["arch".to_owned()][..]));
    assert_eq!(rules.sets[2].any[0].scene, ["arch"]);
    let room = &rules.sets[3].any[0];
    assert_eq!((&room.kind[..], &room.name[..], room.except.len()), (&["*".to_owned()][..], &["P*".to_owned()][..], 1));
    // Lengths are meters.
    let inches = parse_rules(IFC_CLASH.as_bytes(), RulesFormat::IfcClash, Some(Unit::Millimeter)).unwrap();
    assert_eq!(inches.rules.rules[2].clearance, Some(100.0));
    for (text, part) in [
        ("[]", "at least one clash set"),
        ("{}", "line 1"),
        (r#"[{"name": "x", "mode": "clearance", "a": []}]"#, "clash set 0"),
        (r#"[{"name": "x", "mode": "touch", "a": [{"file": "a"}]}]"#, "line 1"),
        (
            r#"[{"name": "x", "mode": "clearance", "a": [{"file": "a", "mode": "i", "selector": "/x/.y"}]}]"#,
            "IFC classes",
        ),
        (r#"[{"name": "x", "mode": "clearance", "clearance": -1, "a": [{"file": "a"}]}]"#, "clash set 0"),
    ] {
        let error = parse(text, RulesFormat::IfcClash).unwrap_err().to_string();
        assert!(error.contains(part), "{text}: {error}");
    }
}
