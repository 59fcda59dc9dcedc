//! Pages about two meshes, a hierarchy and a robot: their blocks say what was asked.

mod blocks;

use blocks::block;
use impinge::query;
use impinge::robot::{Collision, Joint, JointKind, Link, Other, Robot};
use impinge::scene::Scene;
use impinge::{Mesh, Pose, Shape};
use impinge_report::html::{
    PageAbout, PairPage, RobotPage, RobotStep, StepVerdict, write_hierarchy_page, write_pair_page, write_robot_page,
};
use impinge_report::picture::Axis;
use serde_json::{Value, json};

fn about() -> PageAbout<'static> {
    PageAbout {
        title: "a </script>".to_owned(),
        heading: "The answer".to_owned(),
        rows: vec![["curves".to_owned(), "1 closed".to_owned()]],
        unit: None,
        up: Axis::X,
        version: "1.2.3",
    }
}

fn mesh(shape: &Shape) -> Mesh {
    shape.to_meshes(16).remove(0).0
}

fn at(x: f64) -> Pose {
    Pose::from_translation([x, 0.25, 0.125]).unwrap()
}

fn pair_page(x: f64) -> String {
    let (a, b) = (mesh(&Shape::cuboid([1.0; 3]).unwrap()), mesh(&Shape::cylinder(2.0, 0.25).unwrap()));
    let meshes = [a.at(Pose::IDENTITY), b.at(at(x))];
    let pairs = query::intersecting_pairs(meshes[0], meshes[1]);
    let curves = query::curves_of_pairs(meshes[0], meshes[1], &pairs).polylines;
    let distance = query::distance(meshes[0], meshes[1]);
    let nearest = distance.witness.filter(|_| pairs.is_empty()).map(|witness| [witness.point_a, witness.point_b]);
    let names = ["box".to_owned(), "rod".to_owned()];
    let page = PairPage { names, meshes, pairs: &pairs, curves: &curves, nearest };
    let mut out = Vec::new();
    write_pair_page(&mut out, &page, &about()).unwrap();
    String::from_utf8(out).unwrap()
}

fn view(page: &str) -> Value {
    serde_json::from_slice(&block(page, "answer")).unwrap()
}

#[test]
fn a_page_of_two_meshes_has_their_faces_that_intersect_and_curves() {
    let page = pair_page(0.5);
    let view = view(&page);
    assert_eq!((&view["kind"], &view["up"], &view["title"]), (&"pair".into(), &"x".into(), &"a </script>".into()));
    assert_eq!(view["parts"], json!([["box", ""], ["rod", ""]]));
    assert_eq!(view["rows"], json!([["curves", "1 closed"]]));
    assert_eq!((&view["has_faces"], &view["has_curves"]), (&true.into(), &true.into()));
    assert!(view.get("nearest").is_none());
    // Both meshes, and the intersecting faces of both.
    assert_eq!(block(&page, "geometry")[0], 4, "number of meshes");
    assert_eq!(page, pair_page(0.5));
}

#[test]
fn a_page_of_meshes_that_are_apart_has_their_nearest_points() {
    let page = pair_page(2.25);
    let view = view(&page);
    let gap = view["nearest"][1][0].as_f64().unwrap() - view["nearest"][0][0].as_f64().unwrap();
    assert!((gap - 1.0).abs() < 1e-9, "{gap}");
    assert_eq!(block(&page, "geometry")[0], 2, "number of meshes");
}

#[test]
fn a_page_of_a_hierarchy_has_the_boxes_of_each_level() {
    let ball = mesh(&Shape::sphere([0.0; 3], 1.0).unwrap());
    let mut page = Vec::new();
    write_hierarchy_page(&mut page, "ball", &ball, &about()).unwrap();
    let page = String::from_utf8(page).unwrap();
    let depth = ball.tree_statistics().depth;
    assert!(depth >= 2);
    let levels = block(&page, "levels");
    assert_eq!((view(&page)["levels"].as_u64(), usize::from(levels[0])), (Some(depth as u64 + 1), depth + 1));
    // After the number of levels and the box around all of them: one box, two corners along x.
    let low = f64::from_le_bytes(levels[1..9].try_into().unwrap());
    assert!((low + 1.0).abs() < 1e-3, "{low}");
    assert_eq!(levels[49], 1, "number of boxes of level 0");
    assert_eq!(levels[50], 0, "its lower corner");
    let empty = Mesh::new(Vec::<[f64; 3]>::new(), Vec::new()).unwrap();
    let mut page = Vec::new();
    write_hierarchy_page(&mut page, "empty", &empty, &about()).unwrap();
    assert_eq!(block(&String::from_utf8(page).unwrap(), "levels"), [0]);
}

#[test]
fn a_page_of_a_robot_has_the_poses_of_each_step_and_the_pair_that_collides() {
    let ball = Shape::sphere([0.0; 3], 0.25).unwrap();
    let rail = Link { name: "rail".into(), shape: None };
    let tip = Link { name: "tip".into(), shape: Some(ball.clone()) };
    let slide = Joint::fixed("slide", "rail", "tip", Pose::IDENTITY).moving(JointKind::Prismatic, [1.0, 0.0, 0.0]);
    let robot = Robot::new(vec![rail, tip], vec![slide]).unwrap();
    let mut scene = Scene::new();
    scene.add("ground", Shape::half_space([0.0, 0.0, 1.0], -5.0).unwrap(), Pose::IDENTITY).unwrap();
    let post = scene.add("post", &ball, at(2.0)).unwrap();
    let link = robot.link("tip").unwrap();
    let collision = Collision { link, other: Other::Obstacle(post), is_undecided: false };
    let steps = [(-0.5, None), (2.0, Some(collision))].map(|(x, collision)| RobotStep {
        name: format!("at {x}"),
        text: "a sentence".to_owned(),
        verdict: if collision.is_some() { StepVerdict::Collides } else { StepVerdict::Free },
        collision,
        configuration: vec![x],
    });
    let page = RobotPage { robot: &robot, obstacles: Some(&scene), steps: &steps, slider: "Path" };
    let mut out = Vec::new();
    write_robot_page(&mut out, &page, &about()).unwrap();
    let page = String::from_utf8(out).unwrap();
    let view = view(&page);
    assert_eq!(view["parts"], json!([["tip", "link"], ["post", "obstacle"]]));
    assert_eq!(view["steps"][0], json!({"name": "at -0.5", "text": "a sentence", "verdict": "free"}));
    assert_eq!(view["steps"][1]["pair"], json!([0, 1]));
    assert_eq!((&view["moving"], &view["slider"]), (&1.into(), &"Path".into()));
    let poses = block(&page, "poses");
    assert_eq!(poses.len(), 2 * 48);
    let number = |at: usize| f32::from_le_bytes(poses[4 * at..4 * at + 4].try_into().unwrap());
    assert_eq!([number(0), number(9), number(12 + 9)], [1.0, -0.5, 2.0]);
    let invalid = [RobotStep { configuration: vec![f64::NAN], ..steps[0].clone() }];
    let page = RobotPage { robot: &robot, obstacles: None, steps: &invalid, slider: "Path" };
    assert!(write_robot_page(&mut Vec::new(), &page, &about()).is_err());
}
