//! Details of a part that come from the file of the scene.

/// Key, type, path and further properties of a part of a scene. All may be empty, and no check
/// reads them.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
pub struct Details {
    /// Identity of the part, which stays the same if the file changes elsewhere, for example an IFC
    /// GlobalId.
    pub key: String,
    /// Type of the part, for example `IfcWall`.
    pub kind: String,
    /// Names of the groups that contain the part, the outermost first.
    pub path: Vec<String>,
    /// Further properties of the part: names with values as text, in the order of the file.
    pub extras: Vec<(String, String)>,
}
