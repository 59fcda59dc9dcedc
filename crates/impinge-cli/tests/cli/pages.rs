//! `--view` of `check`, `inspect` and `robot` writes a page, and leaves the answer as it is.

use crate::Folder;

const ROBOT: &str = "<robot name='r'><link name='rail'/><link name='tip'><collision><geometry><sphere radius='0.1'/>\
                     </geometry></collision></link><joint name='slide' type='prismatic'><parent link='rail'/>\
                     <child link='tip'/><axis xyz='1 0 0'/><limit lower='-9' upper='9' effort='1' velocity='1'/></joint></robot>";

/// Returns a folder with a robot, configurations and an obstacle. The second one collides.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("robot.urdf", ROBOT);
    folder.write("values.csv", "-3\n0.5\n3\n");
    folder
}

/// Runs a command with and without a page, and returns the page.
fn page(folder: &Folder, command: &str, code: i32) -> String {
    let plain = folder.run(&format!("{command} --json"));
    let run = folder.run(&format!("{command} --json --view out.html"));
    assert_eq!((run.code, run.stderr.as_str()), (code, plain.stderr.as_str()), "{command}");
    let answer = |text: &str| {
        let mut object: serde_json::Value = serde_json::from_str(text).unwrap();
        object.as_object_mut().unwrap().remove("seconds");
        object.as_object_mut().unwrap().remove("curves"); // the page needs them
        object
    };
    assert_eq!(answer(&run.stdout), answer(&plain.stdout), "{command}");
    let page = folder.read("out.html");
    assert!(
        page.starts_with("<!doctype html>")
            && page.contains("<script type=\"application/octet-stream\" id=\"answer\">"),
        "{command}"
    );
    folder.run(&format!("{command} --view again.html"));
    assert_eq!(folder.read("again.html"), page, "{command}");
    page
}

#[test]
fn pages_have_the_blocks_of_their_kind() {
    let folder = folder();
    for (command, code, more) in [
        ("check cube.obj cube.obj --pose-b 0.5,0,0", 1, None),
        ("check cube.obj cube.obj --pose-b 3,0,0", 0, None),
        ("inspect cube.obj", 0, Some("levels")),
        ("robot check robot.urdf --configs values.csv --scene cube.obj", 1, Some("poses")),
        ("robot motion robot.urdf --path values.csv --scene cube.obj", 1, Some("poses")),
    ] {
        let page = page(&folder, command, code);
        for name in ["levels", "poses"] {
            let has = page.contains(&format!("<script type=\"application/octet-stream\" id=\"{name}\">"));
            assert_eq!(has, more == Some(name), "{command}: {name}");
        }
    }
}

#[test]
fn a_page_needs_the_extension_html_and_its_own_name() {
    let folder = folder();
    for (command, message) in [
        ("check missing.obj cube.obj --view out.htm", "a name that ends in .html"),
        ("check cube.obj cube.obj --view nowhere/out.html", "the folder of the output does not exist"),
        ("check cube.obj cube.obj --up y", "--view"),
        ("inspect missing.obj --view out.png", "a name that ends in .html"),
        ("robot check robot.urdf --configs values.csv --view values.csv", "a name that ends in .html"),
        ("robot motion robot.urdf --path values.csv --view out.txt", "a name that ends in .html"),
    ] {
        let run = folder.run(command);
        assert!(run.code == 2 && run.stdout.is_empty() && run.stderr.contains(message), "{command}: {run:?}");
    }
}
