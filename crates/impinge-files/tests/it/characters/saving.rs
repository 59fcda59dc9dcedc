//! Tests of characters and plans as text.

use impinge::character::{Character, Mode, Posed, VolumeKind};
use impinge::mesh::Ray;
use impinge_files::{character_text, parse_character, parse_plan};

use super::{Random, fitted, robot};

#[test]
fn saved_characters_round_trip_and_plans_override_the_automatic_choice() {
    let rig = robot();
    let character = fitted(&rig, 8, Mode::Conservative);
    let text = character_text(&rig, &character);
    let loaded = parse_character(&text, &rig).unwrap();
    assert_eq!(character_text(&rig, &loaded), text);
    assert_eq!(loaded.part_of_face(), character.part_of_face());
    let pose = rig.pose_at(0, 0.4).unwrap();
    let (a, b) = (Posed::new(&character, &pose), Posed::new(&loaded, &pose));
    let mut random = Random(2);
    for _ in 0..500 {
        let ray = Ray::new(random.vector(6.0), random.unit()).unwrap();
        assert_eq!(a.ray_cast_all(&ray), b.ray_cast_all(&ray));
    }

    let plan = "[[part]]\nname = \"upper half\"\nbones = [\"Hips\", \"Head\", \"Shoulder.L\", \"Shoulder.R\"]\nkind = \"box\"\n\
        [[part]]\nbones = [\"UpperLeg.L\", \"UpperLeg.R\", \"Foot.L\", \"Foot.R\"]\n";
    let plan = parse_plan(plan, &rig).unwrap();
    let character = Character::fit(&rig, &plan, Mode::Conservative).unwrap();
    assert_eq!(character.parts()[0].name, "upper half");
    assert_eq!(character.parts()[0].volume().kind(), VolumeKind::Box);
    assert_eq!((character.parts().len(), character.parts()[1].name.as_str()), (2, "UpperLeg.L"));

    for (text, kind, place) in [
        ("[[part]]\nbones = [\"Tail\"]", "syntax", "part 0"),
        ("[[part]]\nbones = [\"Head\"]\nkind = \"cone\"", "syntax", "part 0"),
        ("[[part]]\nbones = []", "syntax", "part 0"),
        ("[[part]]\nbones = [999]", "syntax", "part 0"),
        ("part = 1", "syntax", "line 1"),
        ("[[part]]\nbones = [\"Head\"]\ncolour = 1", "syntax", "line 3"),
    ] {
        let error = parse_plan(text, &rig).unwrap_err();
        assert_eq!(error.kind().name(), kind, "{error}");
        assert!(error.place().is_some_and(|found| found.to_string() == place), "{text}: {error}");
    }
    assert!(
        parse_character("[[part]]\nbones = [\"Head\"]\nkind = \"sphere\"\nradius = -1.0\npoints = [[0, 0, 0]]", &rig)
            .is_err()
    );
}
