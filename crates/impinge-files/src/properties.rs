//! Properties from JSON: names with values of any kind as text.

use std::fmt;

use serde::{
    Deserialize, Deserializer,
    de::{MapAccess, Visitor},
};
use serde_json::value::RawValue;

/// The entries of a JSON object, in the order of the file. The text of a string is its content; the
/// text of any other value is its JSON.
pub(crate) struct Properties(pub(crate) Vec<(String, String)>);

impl Properties {
    /// Takes out the value of the first entry with one of these names that is a text, a number, or
    /// `true` or `false`, and that is not empty. The first name that has such a value wins.
    pub(crate) fn take(&mut self, names: &[&str]) -> Option<String> {
        let is_plain = |text: &str| !text.is_empty() && text != "null" && !text.starts_with(['{', '[']);
        let at = names
            .iter()
            .find_map(|name| self.0.iter().position(|(found, text)| found.as_str() == *name && is_plain(text)))?;
        Some(self.0.remove(at).1)
    }
}

impl<'de> Deserialize<'de> for Properties {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct Entries;
        impl<'de> Visitor<'de> for Entries {
            type Value = Properties;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("an object")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Properties, A::Error> {
                let mut found = Vec::new();
                while let Some((name, value)) = map.next_entry::<String, Box<RawValue>>()? {
                    found.push((name, text(&value)));
                }
                Ok(Properties(found))
            }
        }
        deserializer.deserialize_map(Entries)
    }
}

/// Returns the text of a value: the content of a string, and the JSON of any other value.
pub(crate) fn text(value: &RawValue) -> String {
    let json = value.get();
    let content = if json.starts_with('"') { serde_json::from_str(json).ok() } else { None };
    content.unwrap_or_else(|| json.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_of_any_kind_become_text_in_their_order() {
        let json = r#"{"b": "F\u00390", "a": 1.50, "list": [1, {"x": null}], "none": null, "a": true}"#;
        let mut found: Properties = serde_json::from_str(json).unwrap();
        let texts: Vec<(&str, &str)> = found.0.iter().map(|(name, text)| (&**name, &**text)).collect();
        let expected = [("b", "F90"), ("a", "1.50"), ("list", r#"[1, {"x": null}]"#), ("none", "null"), ("a", "true")];
        assert_eq!(texts, expected);
        assert_eq!(found.take(&["none", "list", "a", "b"]).as_deref(), Some("1.50"));
        assert_eq!(found.take(&["a"]).as_deref(), Some("true"));
        assert_eq!(found.take(&["a"]), None);
        assert_eq!(found.0.len(), 3);
    }
}
