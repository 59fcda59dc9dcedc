//! Objects of a `.scene` file, which MoveIt's editor of scenes exports.
//!
//! ```text
//! name of the scene
//! * name of an object
//! 0.5 0 0.2            position and orientation (x y z w) of the object; files of before 2021
//! 0 0 0 1              have neither these lines nor subframes
//! 1                    number of shapes
//! cylinder
//! 0.05 0.4             radius and length
//! 0 0 0                position and orientation of the shape
//! 0 0 0 1
//! 0 0 0 0              color
//! 0                    number of subframes
//! .
//! ```

use std::str::{Lines, SplitAsciiWhitespace};

use impinge::{Pose, Positions};

use super::{
    Content, message,
    objects::{Object, Objects, Operation},
    place,
};
use crate::{
    error::LoadError,
    pieces::{Form, Notes, Piece},
    text::number,
};

/// Returns whether a text is in this format: it has an object or its end in a line of its own.
pub(super) fn opens(text: &str) -> bool {
    text.lines().skip(1).map(str::trim).any(|line| line.starts_with('*') || line == ".")
}

/// Reads the objects of a file.
pub(super) fn read(text: &str, notes: &mut Notes<'_>) -> Result<Content, LoadError> {
    let mut words = Words { lines: text.lines(), words: "".split_ascii_whitespace(), line: 0 };
    let name = words.next_line().unwrap_or_default().trim().to_owned();
    // The line after the first object has its position, or a single number if objects have no pose.
    let after = text.lines().skip_while(|line| !line.trim_start().starts_with('*')).nth(1).unwrap_or_default();
    let has_poses = after.split_ascii_whitespace().count() > 1;
    let mut objects = Objects::default();
    loop {
        match words.next("* or .")? {
            "." => break,
            // Some files have no space after the star.
            word if word.starts_with('*') => {
                let line = words.line;
                let rest = word[1..].to_owned() + " " + words.rest().as_str();
                let name = rest.trim().to_owned();
                if name.is_empty() {
                    return Err(words.expected("a name after *", ""));
                }
                let (pose, pieces) = words.object(&name, has_poses)?;
                let frame = String::new();
                objects.apply(Operation::Add, Object { name, frame, pose, pieces, line }, notes);
            }
            other => return Err(words.expected("* or .", other)),
        }
    }
    Ok(Content { name, objects, transforms: Vec::new() })
}

/// The words of a text, with their lines.
struct Words<'t> {
    lines: Lines<'t>,
    words: SplitAsciiWhitespace<'t>,
    /// Number of the current line, from 1.
    line: usize,
}

impl<'t> Words<'t> {
    fn next_line(&mut self) -> Option<&'t str> {
        self.line += 1;
        self.lines.next()
    }

    fn next(&mut self, expected: &str) -> Result<&'t str, LoadError> {
        loop {
            if let Some(word) = self.words.next() {
                return Ok(word);
            }
            let line = self.next_line().ok_or_else(|| self.expected(expected, ""))?;
            self.words = line.split_ascii_whitespace();
        }
    }

    /// Returns the other words of the line.
    fn rest(&mut self) -> String {
        self.words.by_ref().collect::<Vec<_>>().join(" ")
    }

    fn expected(&self, expected: &str, found: &str) -> LoadError {
        LoadError::syntax(expected, found.as_bytes()).at(place(self.line))
    }

    fn numbers<const N: usize>(&mut self, what: &str) -> Result<[f64; N], LoadError> {
        let mut numbers = [0.0; N];
        for value in &mut numbers {
            let word = self.next(what)?;
            let found = number(word.as_bytes()).filter(|number| number.is_finite());
            *value = found.ok_or_else(|| self.expected(what, word))?;
        }
        Ok(numbers)
    }

    fn count(&mut self, what: &str) -> Result<u32, LoadError> {
        let word = self.next(what)?;
        word.parse().map_err(|_| self.expected(what, word))
    }

    fn pose(&mut self, of: &str) -> Result<Pose, LoadError> {
        let position = self.numbers(&format!("3 numbers as position of object {of:?}"))?;
        let orientation = self.numbers(&format!("4 numbers as orientation of object {of:?}"))?;
        message::placed(position, orientation).map_err(|reason| {
            self.expected(&format!("a valid pose of object {of:?} ({reason})"), &format!("{orientation:?}"))
        })
    }

    fn object(&mut self, of: &str, has_pose: bool) -> Result<(Pose, Vec<Piece>), LoadError> {
        let pose = if has_pose { self.pose(of)? } else { Pose::IDENTITY };
        let mut pieces = Vec::new();
        for _ in 0..self.count(&format!("the number of shapes of object {of:?}"))? {
            let form = self.form(of)?;
            let element = self.line;
            pieces.push(Piece { form, pose: self.pose(of)?, element });
            self.numbers::<4>(&format!("4 numbers as color of object {of:?}"))?;
        }
        if has_pose {
            for _ in 0..self.count(&format!("the number of subframes of object {of:?}"))? {
                self.next("the name of a subframe")?;
                self.pose(of)?;
            }
        }
        Ok((pose, pieces))
    }

    fn form(&mut self, of: &str) -> Result<Form, LoadError> {
        let dimensions = format!("the dimensions of object {of:?}");
        Ok(match self.next(&format!("a shape of object {of:?}"))? {
            "box" => Form::Box(self.numbers(&dimensions)?),
            "sphere" => Form::Sphere(self.numbers::<1>(&dimensions)?[0]),
            kind @ ("cylinder" | "cone") => {
                let [radius, length] = self.numbers(&dimensions)?;
                if kind == "cone" { Form::Cone(radius, length) } else { Form::Cylinder(radius, length) }
            }
            "mesh" => self.mesh(of)?,
            "plane" => {
                let error = LoadError::unsupported(format!("the plane of object {of:?}"));
                return Err(error.at(place(self.line)).with_hint("use a large box"));
            }
            other => {
                return Err(
                    self.expected(&format!("box, sphere, cylinder, cone or mesh as a shape of object {of:?}"), other)
                );
            }
        })
    }

    fn mesh(&mut self, of: &str) -> Result<Form, LoadError> {
        let vertices = self.count(&format!("the number of vertices of object {of:?}"))?;
        let triangles = self.count(&format!("the number of triangles of object {of:?}"))?;
        let positions: Vec<[f64; 3]> = (0..vertices)
            .map(|_| self.numbers(&format!("3 coordinates of a vertex of object {of:?}")))
            .collect::<Result<_, _>>()?;
        let mut faces = Vec::new();
        for _ in 0..triangles {
            let mut face = [0; 3];
            for corner in &mut face {
                let what = format!("the index of one of {vertices} vertices of object {of:?}");
                *corner = self.count(&what)?;
                if *corner >= vertices {
                    return Err(self.expected(&what, &corner.to_string()));
                }
            }
            faces.push(face);
        }
        Ok(Form::Mesh(Positions::F64(positions), faces))
    }
}
