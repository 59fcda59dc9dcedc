//! Reports: kinds, order, groups, sentences, and that they do not depend on order or threads.

use impinge::clash::{ClashError, Grouping, Kind, Options, Shared, Side, default_tolerance, find, identity};
use impinge::query::batch::Execution;
use impinge::scene::Scene;
use impinge::{Budget, Mesh, Pose, Positions, Shape, query};

use super::models::{block, house, report, rows, scene_of, side};

fn options() -> Options<'static> {
    Options { clearance: Some(0.01), ..Options::new(1e-4) }
}

#[test]
fn the_house_has_known_clashes() {
    let found = report(&house(), options());
    assert_eq!(
        rows(&found),
        ["clash P-1 W-1", "clash P-1 W-2", "clash P-2 W-1", "clearance F-1 W-1", "contained B-1 W-2",]
    );
    let kinds: Vec<&str> = found.clashes.iter().map(|clash| clash.kind.name()).collect();
    assert_eq!(kinds, ["contained", "clash", "clash", "clash", "clearance"]);
    assert!(found.clashes[1..4].is_sorted_by(|a, b| a.depth.unwrap()[0] >= b.depth.unwrap()[0]));
    let counts = found.counts;
    assert_eq!((counts.contained, counts.clash, counts.clearance, counts.duplicate), (1, 3, 1, 3));
    let [signs] = &found.duplicates[..] else { panic!("one set") };
    assert_eq!(signs.parts.iter().map(|part| part.name.as_str()).collect::<Vec<_>>(), ["S-1", "S-2", "S-3"]);
    assert!(!found.is_clear());
    let clearance = found.clashes.last().unwrap();
    assert_eq!(clearance.id, identity(&["house/key-W-1", "house/key-F-1"]));
    // Boxes of parts are rounded outward.
    let corners = clearance.bounds.unwrap();
    let expected = [[3.0, 0.25, 0.0], [4.0, 0.255, 1.0]];
    assert!(corners.as_flattened().iter().zip(expected.as_flattened()).all(|(x, y)| (x - y).abs() < 1e-6));
    let gap = clearance.gap.unwrap();
    assert!(gap[0] <= 0.005 && 0.005 <= gap[1] && gap[1] < 0.0051);
    // Without a clearance that row is absent.
    assert_eq!(report(&house(), Options::new(1e-4)).counts.clearance, 0);
}

#[test]
fn contacts_are_listed_if_they_are_asked_for() {
    let blocks = [block("", "a", [0.0; 3], [1.0; 3]), block("", "b", [1.0, 0.0, 0.0], [2.0, 1.0, 1.0])];
    let contacts = Options { contacts: true, ..Options::new(1e-6) };
    let found = report(&blocks, contacts);
    assert_eq!(rows(&found), ["contact a b"]);
    assert!(found.is_clear());
    assert_eq!(rows(&report(&blocks, Options::new(1e-6))), [""; 0]);
}

#[test]
fn curves_are_those_of_the_two_surfaces() {
    let scene = scene_of(&house());
    let sides = [side("house", &scene)];
    let mut found = find(&sides, options(), Execution::default()).unwrap();
    assert!(found.clashes.iter().all(|clash| clash.curves.is_none()));
    found.trace_curves(&sides, Execution::default()).unwrap();
    let mut curves = Vec::new();
    for clash in &found.clashes {
        let placed = [&clash.a, &clash.b].map(|member| {
            let (mesh, _) = scene.shape(member.part).as_mesh().unwrap();
            mesh.at(*scene.pose(member.part))
        });
        let expected = (clash.kind != Kind::Clearance).then(|| query::intersection_curves(placed[0], placed[1]));
        assert_eq!(clash.curves, expected);
        assert_eq!(impinge::clash::curves(clash, &sides), expected);
        curves.push(expected.map(|curves| curves.closed()));
    }
    // A part that lies inside another has no curve in common with it.
    assert_eq!((curves[0], curves[4]), (Some(0), None));
    assert!(curves[1..4].iter().all(|closed| closed.unwrap() > 0), "{curves:?}");
    // A ball has no faces.
    let mut scene = Scene::new();
    for (name, x) in [("a", 0.0), ("b", 1.5)] {
        scene.add(name, Shape::sphere([x, 0.0, 0.0], 1.0).unwrap(), Pose::IDENTITY).unwrap();
    }
    let mut found = find(&[side("balls", &scene)], options(), Execution::default()).unwrap();
    found.trace_curves(&[side("balls", &scene)], Execution::default()).unwrap();
    assert_eq!((found.clashes.len(), &found.clashes[0].curves), (1, &None));
}

#[test]
fn reports_do_not_depend_on_order_or_threads() {
    let house = house();
    let [scene, other] = [scene_of(&house[..4]), scene_of(&house[4..])];
    let sides = [side("old", &scene), side("new", &other)];
    let whole = find(&sides, options(), Execution::default()).unwrap();
    assert_eq!(rows(&whole).len(), 5);
    let on_threads = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| find(&sides, options(), Execution::default()).unwrap())
    };
    assert_eq!(on_threads(1), whole);
    assert_eq!(on_threads(2), whole);
    assert_eq!(find(&sides, options(), Execution::default().sequentially()).unwrap(), whole);
    let swapped = [sides[1].clone(), sides[0].clone()];
    assert_eq!(find(&swapped, options(), Execution::default()).unwrap(), whole);
    let mut reversed = house.clone();
    reversed.reverse();
    // Handles of parts are indices, so texts are compared.
    let [ahead, back] = [&house, &reversed].map(|blocks| report(blocks, options()));
    assert_eq!(rows(&ahead), rows(&back));
    let ids = |report: &impinge::clash::Report| report.clashes.iter().map(|clash| clash.id.clone()).collect::<Vec<_>>();
    assert_eq!(ids(&ahead), ids(&back));
    let sentences = |report: &impinge::clash::Report| {
        report.groups.iter().map(|group| group.sentence(report, &|x| x.to_string())).collect::<Vec<_>>()
    };
    assert_eq!(sentences(&ahead), sentences(&back));
    assert_eq!(ahead.duplicates[0].id, back.duplicates[0].id);
}

#[test]
fn between_checks_pairs_of_different_scenes_only() {
    let house = house();
    let [walls, rest] = [scene_of(&house[..2]), scene_of(&house[2..])];
    let between = Options { between: true, ..options() };
    let found = find(&[side("a", &walls), side("b", &rest)], between, Execution::default()).unwrap();
    assert_eq!(rows(&found).len(), 5);
    assert!(found.duplicates.is_empty());
    let found = find(&[side("a", &scene_of(&house))], between, Execution::default()).unwrap();
    assert_eq!(found.counts.candidates, 0);
}

#[test]
fn ignored_pairs_of_a_scene_are_not_checked() {
    let mut scene = scene_of(&house());
    let [wall, pipe] = ["W-1", "P-2"].map(|name| scene.find(name).unwrap());
    scene.ignore(pipe, wall);
    let found = find(&[side("house", &scene)], options(), Execution::default()).unwrap();
    assert!(rows(&found).iter().all(|row| row != "clash P-2 W-1"));
    assert_eq!(rows(&found).len(), 4);
}

#[test]
fn groups_share_a_part_types_or_scenes() {
    let of = |grouping| {
        let found = report(&house(), Options { grouping, ..options() });
        let groups = found.groups.iter().map(|group| {
            assert!(group.clashes.is_sorted());
            let clashes = group.clashes.iter().map(|&at| &found.clashes[at]);
            let mut names: Vec<String> = clashes.map(|clash| format!("{} {}", clash.a.name, clash.b.name)).collect();
            names.sort();
            (group.by.clone(), names)
        });
        groups.collect::<Vec<_>>()
    };
    let by_part: Vec<(String, Vec<String>)> = of(Grouping::Part)
        .into_iter()
        .map(|(by, clashes)| match by {
            Shared::Part(part) => (part.name.clone(), clashes),
            other => panic!("{other:?}"),
        })
        .collect();
    let names = |list: &[&str]| list.iter().map(|&name| name.to_owned()).collect::<Vec<_>>();
    // W-1 has three clashes; those of B-1 and P-1 are left for W-2.
    let expected = [("W-1", names(&["F-1 W-1", "P-1 W-1", "P-2 W-1"])), ("W-2", names(&["B-1 W-2", "P-1 W-2"]))];
    assert_eq!(by_part, expected.map(|(name, clashes)| (name.to_owned(), clashes)));
    let types = |a: &str, b: &str| Shared::Types([a.to_owned(), b.to_owned()]);
    let mut by_type = of(Grouping::Type);
    assert_eq!(by_type[0], (types("IfcPipeSegment", "IfcWall"), names(&["P-1 W-1", "P-2 W-1"])));
    by_type.sort_by_key(|(_, clashes)| clashes[0].clone());
    assert_eq!(
        by_type[1..],
        [
            (types("IfcFurniture", "IfcWall"), names(&["F-1 W-1"])),
            (types("IfcPipeSegment", "IfcWall"), names(&["P-1 W-1", "P-2 W-1"])),
            (types("IfcPipeSegment", "IfcWallStandardCase"), names(&["P-1 W-2"])),
        ]
    );
    let house_label = || "house".to_owned();
    let by_scene = of(Grouping::Scene);
    assert_eq!((&by_scene[0].0, by_scene[0].1.len()), (&Shared::Scenes([house_label(), house_label()]), 5));
    assert_eq!(of(Grouping::None), []);
}

#[test]
fn sentences_name_types_parts_and_sizes() {
    let found = report(&house(), options());
    let millimeters = |x: f64| format!("{:.0} mm", x * 1e3);
    let sentences: Vec<String> = found.clashes.iter().map(|clash| clash.sentence(&millimeters)).collect();
    assert_eq!(sentences[0], "fastener 'B-1' lies inside wall 'W-2'");
    let enters = |sentence: &&String| sentence.starts_with("pipe segment 'P-1' enters wall 'W-1' by ");
    assert_eq!(sentences.iter().filter(enters).count(), 1, "{sentences:?}");
    assert_eq!(sentences[4], "furniture 'F-1' is 5 mm away from wall 'W-1'");
    assert_eq!(found.duplicates[0].sentence(), "sign 'S-1' and 2 other parts are one shape in one place");
    let group = found.groups[1].sentence(&found, &millimeters);
    assert_eq!(group, "wall 'W-2' meets 2 parts; the worst: fastener 'B-1' lies inside wall 'W-2'");
}

#[test]
fn parts_with_equal_keys_are_told_apart_by_their_names() {
    let mut blocks = vec![
        block("", "a", [0.0; 3], [1.0; 3]),
        block("", "b", [0.5; 3], [1.5; 3]),
        block("", "c", [0.75; 3], [1.75; 3]),
    ];
    blocks.iter_mut().for_each(|block| block.key = "same".to_owned());
    let found = report(&blocks, Options::new(0.0));
    assert_eq!(rows(&found).len(), 3);
    let mut ids: Vec<&String> = found.clashes.iter().map(|clash| &clash.id).collect();
    ids.sort();
    ids.dedup();
    assert_eq!(ids.len(), 3);
    // A part without a key is identified by its name.
    blocks.iter_mut().for_each(|block| block.key = String::new());
    assert_eq!(report(&blocks, Options::new(0.0)).clashes[0].a.key.len(), 1);
}

#[test]
fn invalid_labels_and_lengths_are_errors() {
    let scene = scene_of(&house());
    let of = |labels: &[&str], options| {
        let sides: Vec<Side<'_>> = labels.iter().map(|label| side(label, &scene)).collect();
        find(&sides, options, Execution::default()).unwrap_err()
    };
    for labels in [&["a", "a"][..], &[""], &["a/b"]] {
        assert!(matches!(of(labels, options()), ClashError::Label { .. }), "{labels:?}");
    }
    for tolerance in [-1.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(of(&["a"], Options::new(tolerance)), ClashError::Length { name: "tolerance", .. }));
        let clearance = Options { clearance: Some(tolerance), ..options() };
        assert!(matches!(of(&["a"], clearance), ClashError::Length { name: "clearance", .. }));
    }
}

#[test]
fn a_spent_budget_leaves_pairs_undecided_and_says_so() {
    let scene = scene_of(&house());
    let whole = find(&[side("house", &scene)], options(), Execution::default()).unwrap();
    let mut cut = 0;
    for steps in 0..40 {
        let budget = Budget::new().with_steps(steps);
        let execution = Execution::default().sequentially().with_budget(&budget);
        match find(&[side("house", &scene)], options(), execution) {
            Err(error) => assert_eq!(error, ClashError::Stopped(impinge::budget::Stopped::Steps)),
            Ok(found) if found.stopped.is_some() => {
                cut += 1;
                // Nothing is dropped: each candidate has a kind.
                let counts = found.counts;
                assert_eq!(counts.candidates, whole.counts.candidates);
                let all = counts.duplicate + counts.contained + counts.clash + counts.undecided + counts.contact;
                assert_eq!(all + counts.clearance + counts.clear, counts.candidates);
            }
            Ok(found) => assert_eq!(found, whole),
        }
    }
    assert!(cut > 0);
    let canceled = Budget::new().with_cancel(&|| true);
    let execution = Execution::default().with_budget(&canceled);
    assert!(find(&[side("house", &scene)], options(), execution).is_err());
}

#[test]
fn the_default_tolerance_follows_unit_size_and_rounding() {
    let mut scene = Scene::new();
    scene.add("unit", Shape::cuboid([0.5; 3]).unwrap(), Pose::IDENTITY).unwrap();
    assert_eq!(default_tolerance(&[side("a", &scene)], Some(1.0)), 1e-4);
    assert_eq!(default_tolerance(&[side("a", &scene)], Some(1e-3)), 0.1);
    let unknown = default_tolerance(&[side("a", &scene)], None);
    assert!((unknown - 1e-6 * 3.0_f64.sqrt()).abs() < 1e-12, "{unknown}");
    // At 5,000 km from the origin an f32 has steps of half a meter.
    let corners = vec![[5e6, 0.0, 0.0], [5e6 + 1.0, 0.0, 0.0], [5e6, 1.0, 0.0]];
    let far = Mesh::new(Positions::F32(corners), vec![[0, 1, 2]]).unwrap();
    scene.add("far", &far, Pose::IDENTITY).unwrap();
    let far = default_tolerance(&[side("a", &scene)], Some(1.0));
    assert!((8.0..8.1).contains(&far), "{far}");
}

#[test]
fn unbounded_parts_are_near_all_others() {
    let mut scene = scene_of(&house());
    scene.add("ground", Shape::half_space([0.0, 0.0, 1.0], 0.5).unwrap(), Pose::IDENTITY).unwrap();
    let found = find(&[side("house", &scene)], options(), Execution::default()).unwrap();
    assert!(found.clashes.iter().any(|clash| [&clash.a, &clash.b].iter().any(|part| part.name == "ground")));
}
