//! Changed and hostile files: an answer or a typed error, in bounded time.

use impinge_files::{LoadErrorKind, RobotOptions};
use impinge_testkit::{generate::Rng, rounds};

use super::{Folder, data, load, robot};
use crate::mutants::mutant;

/// Pieces of XML that change a text.
const WORDS: [&str; 14] =
    ["<", ">", "/>", "\"", "'", "nan", "-1e999", "1e400", "&x;", "${a}", "<link name=\"", "base", "\0", "é"];

/// Returns a text in which some values of attributes are replaced, so that it is well-formed.
fn changed_values(rng: &mut Rng, text: &str) -> Vec<u8> {
    let values = ["nan", "1e400", "", "base", "palm", "elbow", "1 2 3", "-1 -1 -1", "0 0 0", "0", "-5", "fixed", "inf"];
    let mut pieces: Vec<&str> = text.split('"').collect();
    for _ in 0..rng.integer(1, 2) {
        // The pieces with odd numbers are in quotes. The first are those of the declaration.
        let at = 2 * rng.integer(2, pieces.len() as i64 / 2 - 1) as usize + 1;
        pieces[at] = values[rng.integer(0, values.len() as i64 - 1) as usize];
    }
    pieces.join("\"").into_bytes()
}

#[test]
fn changed_files_give_robots_or_typed_errors() {
    let read = |name: &str| std::fs::read_to_string(data().join(name)).unwrap();
    let (urdf, srdf) = (read("gantry.urdf"), read("gantry.srdf"));
    let folder = Folder::new(&[("robot.urdf", &urdf), ("robot.srdf", &srdf)]);
    let options = RobotOptions { srdf: Some(folder.path("robot.srdf")), ..RobotOptions::default() };
    let mut rng = Rng::new(5);
    let (mut fine, mut kinds) = (0, std::collections::BTreeMap::new());
    let count = rounds(500);
    for round in 0..count {
        let (name, text) = if round % 2 == 0 { ("robot.urdf", &urdf) } else { ("robot.srdf", &srdf) };
        let changed =
            if round % 3 == 0 { mutant(&mut rng, text, &WORDS, (6, 80)) } else { changed_values(&mut rng, text) };
        std::fs::write(folder.path(name), changed).unwrap();
        match folder.load(&options) {
            Ok(loaded) => {
                fine += 1;
                assert_eq!(loaded.robot.check_rows(&vec![0.0; loaded.robot.coordinates().len()]), Ok(1));
            }
            Err(error) => {
                assert!(error.path().starts_with(folder.path("")), "{error}");
                *kinds.entry(error.kind().name()).or_insert(0) += 1;
            }
        }
        std::fs::write(folder.path(name), text).unwrap();
    }
    assert!(
        fine > count / 10 && kinds["broken-robot"] > count / 20 && kinds["syntax"] > count / 10,
        "{fine} {kinds:?}"
    );
}

#[test]
fn entities_deep_nesting_and_long_lists_take_bounded_time() {
    let bomb: String = (1..40).map(|k| format!("<!ENTITY e{k} \"&e{};&e{};\">", k - 1, k - 1)).collect();
    let bomb = format!(
        "<!DOCTYPE robot [<!ENTITY e0 \"1 1\">{bomb}]><robot><link name='a'><collision><geometry><box size='&e39;'/></geometry></collision></link></robot>"
    );
    assert!(load(&bomb).is_err());
    let deep = format!("<robot>{}{}</robot>", "<link name='a'>".repeat(200_000), "</link>".repeat(200_000));
    assert!(load(&deep).is_ok());
    // A chain of many links, and a loop of many joints that follow each other.
    let links: Vec<String> = (0..20_000).map(|k| format!("<link name='{k}'/>")).collect();
    let joint = |k: usize, inner: &str| {
        format!("<joint name='{k}' type='continuous'><parent link='{k}'/><child link='{}'/>{inner}</joint>", k + 1)
    };
    let chain: Vec<String> = (0..19_999).map(|k| joint(k, "")).collect();
    let text = |joints: &[String]| robot(&links.iter().chain(joints).map(String::as_str).collect::<Vec<_>>());
    assert_eq!(load(&text(&chain)).unwrap().robot.coordinates().len(), 19_999);
    let followers: Vec<String> =
        (0..19_999).map(|k| joint(k, &format!("<mimic joint='{}'/>", (k + 1) % 19_999))).collect();
    let error = load(&text(&followers)).unwrap_err();
    assert!(matches!(error.kind(), LoadErrorKind::BrokenRobot { .. }), "{error}");
}

#[test]
fn groups_that_multiply_their_members_are_limited() {
    let joints: String = (0..400).map(|_| "<joint name='slide'/>".to_owned()).collect();
    let groups: Vec<String> =
        (0..4000).map(|k| format!("<group name='{k}'>{joints}<group name='{}'/></group>", k + 1)).collect();
    let urdf = std::fs::read_to_string(data().join("gantry.urdf")).unwrap();
    let srdf = robot(&groups.iter().map(String::as_str).collect::<Vec<_>>());
    let folder = Folder::new(&[("robot.urdf", &urdf), ("robot.srdf", &srdf)]);
    let options = RobotOptions { srdf: Some(folder.path("robot.srdf")), ..RobotOptions::default() };
    assert_eq!(folder.load(&options).unwrap_err().kind().name(), "too-many");
}
