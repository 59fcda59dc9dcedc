//! Attributes of the elements of a URDF or SRDF file.

use impinge::{InputErrorKind, Pose};

use crate::{
    error::LoadError,
    text::number,
    xml_tree::{Id, Tree},
};

/// Hint for text that only the xacro preprocessor understands.
const RUN_XACRO: &str = "the file is a xacro template: run `xacro FILE.xacro > FILE.urdf` and load the result";

/// An element, and the link or joint that it describes, for errors: `link "arm"`.
#[derive(Clone, Copy)]
pub(super) struct Element<'t, 'a> {
    pub(super) tree: &'t Tree<'a>,
    pub(super) id: Id,
    pub(super) subject: &'t str,
}

impl<'t, 'a> Element<'t, 'a> {
    /// Returns the first child element of a name, about the same subject.
    pub(super) fn child(&self, name: &str) -> Option<Self> {
        Some(Self { id: self.tree.child(self.id, name)?, ..*self })
    }

    /// Returns the error that something else was expected in this element.
    pub(super) fn expected(&self, expected: &str, found: &str) -> LoadError {
        let of = if self.subject.is_empty() { String::new() } else { format!(" of {}", self.subject) };
        let element = self.tree.name(self.id);
        let error = LoadError::syntax(format!("{expected} in the element {element}{of}"), found.as_bytes());
        let error = error.at(self.tree.place(self.id));
        if found.contains("${") || found.contains("$(") { error.with_hint(RUN_XACRO) } else { error }
    }

    /// Returns the text of an attribute, without spaces around it.
    pub(super) fn text(&self, attribute: &str) -> Result<String, LoadError> {
        let text = self.tree.attribute(self.id, attribute).map(|text| text.trim().to_owned());
        text.ok_or_else(|| self.expected(&format!("the attribute {attribute}"), ""))
    }

    /// Returns the name in an attribute, which must not be empty.
    pub(super) fn name(&self, attribute: &str) -> Result<String, LoadError> {
        let name = self.text(attribute)?;
        if name.is_empty() { Err(self.expected(&format!("a name as {attribute}"), "")) } else { Ok(name) }
    }

    /// Returns the `N` numbers of an attribute, or `default` if the attribute is missing. Numbers
    /// may be NaN or infinite.
    pub(super) fn any_numbers<const N: usize>(
        &self,
        attribute: &str,
        default: Option<[f64; N]>,
    ) -> Result<[f64; N], LoadError> {
        let Some(text) = self.tree.attribute(self.id, attribute) else {
            let noun = if N == 1 { "a number" } else { "numbers" };
            return default.ok_or_else(|| self.expected(&format!("{noun} as {attribute}"), ""));
        };
        let mut numbers = [0.0; N];
        let mut tokens = text.split_ascii_whitespace();
        let parsed = numbers.iter_mut().all(|x| {
            let token = tokens.next().and_then(|token| number(token.as_bytes()));
            *x = token.unwrap_or_default();
            token.is_some()
        });
        if parsed && tokens.next().is_none() {
            return Ok(numbers);
        }
        let count = if N == 1 { "a number".to_owned() } else { format!("{N} numbers") };
        Err(self.expected(&format!("{count} as {attribute}"), &text))
    }

    /// Returns the `N` finite numbers of an attribute, or `default` if the attribute is missing.
    pub(super) fn numbers<const N: usize>(
        &self,
        attribute: &str,
        default: Option<[f64; N]>,
    ) -> Result<[f64; N], LoadError> {
        let numbers = self.any_numbers(attribute, default)?;
        if numbers.iter().all(|x| x.is_finite()) {
            return Ok(numbers);
        }
        let text = self.tree.attribute(self.id, attribute).unwrap_or_default();
        Err(self.expected(&format!("finite numbers as {attribute}"), &text))
    }

    /// Returns the pose of the child element `origin`, or the identity if it is missing.
    pub(super) fn origin(&self) -> Result<Pose, LoadError> {
        let Some(origin) = self.child("origin") else { return Ok(Pose::IDENTITY) };
        let xyz = origin.numbers("xyz", Some([0.0; 3]))?;
        let rpy = origin.numbers("rpy", Some([0.0; 3]))?;
        Pose::from_roll_pitch_yaw(xyz, rpy).map_err(|error| {
            let limit = if let InputErrorKind::OutOfRange { limit, .. } = error.kind() { limit } else { "the limit" };
            origin.expected(&format!("numbers below {limit}"), &format!("{xyz:?} {rpy:?}"))
        })
    }
}
