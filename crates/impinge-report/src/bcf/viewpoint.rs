//! The file `viewpoint.bcfv` of a topic: the camera, and both parts selected and colored.

use std::io;

use impinge::clash::Member;

use super::frame::Frame;
use super::topic::Topic;
use super::version::BcfVersion;
use super::xml::{Document, document, element, empty, text, vector};
use crate::picture::{COLOR_A, COLOR_B, FIELD_OF_VIEW, View};

/// Returns the file. All parts are visible, and nothing is clipped.
pub(super) fn viewpoint(
    topic: &Topic<'_>,
    view: &View<'_>,
    frame: &Frame,
    version: BcfVersion,
    size: [u32; 2],
) -> io::Result<Vec<u8>> {
    let guid = topic.viewpoint().to_string();
    document("VisualizationInfo", &[("Guid", &guid)], |info| {
        element(info, "Components", &[], |components| {
            if version == BcfVersion::V2 {
                hints(components)?;
            }
            element(components, "Selection", &[], |selection| {
                topic.parts.iter().try_for_each(|member| component(selection, member))
            })?;
            element(components, "Visibility", &[("DefaultVisibility", "true")], |visibility| match version {
                BcfVersion::V2 => Ok(()),
                BcfVersion::V3 => hints(visibility),
            })?;
            element(components, "Coloring", &[], |coloring| {
                topic.parts.iter().zip([COLOR_A, COLOR_B]).try_for_each(|(member, [r, g, b])| {
                    let value = format!("{r:02X}{g:02X}{b:02X}");
                    element(coloring, "Color", &[("Color", &value)], |color| match version {
                        BcfVersion::V2 => component(color, member),
                        BcfVersion::V3 => element(color, "Components", &[], |list| component(list, member)),
                    })
                })
            })
        })?;
        element(info, "PerspectiveCamera", &[], |camera| {
            let [away, up] = view.away_and_up().map(|direction| frame.direction(direction));
            vector(camera, "CameraViewPoint", frame.point(view.eye()))?;
            vector(camera, "CameraDirection", away)?;
            vector(camera, "CameraUpVector", up)?;
            text(camera, "FieldOfView", &FIELD_OF_VIEW.to_string())?;
            match version {
                BcfVersion::V2 => Ok(()),
                BcfVersion::V3 => text(camera, "AspectRatio", &(f64::from(size[0]) / f64::from(size[1])).to_string()),
            }
        })
    })
}

/// Hides spaces and openings, which are no parts.
fn hints(parent: &mut Document) -> io::Result<()> {
    let hidden = ["SpacesVisible", "SpaceBoundariesVisible", "OpeningsVisible"].map(|name| (name, "false"));
    empty(parent, "ViewSetupHints", &hidden)
}

/// Writes a part, with its key as IFC GlobalId if it is one.
fn component(parent: &mut Document, member: &Member) -> io::Result<()> {
    let is_digit = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_' || byte == b'$';
    let is_global_id = member.key.len() == 22 && member.key.bytes().all(is_digit);
    let attributes: &[(&str, &str)] = if is_global_id { &[("IfcGuid", &member.key)] } else { &[] };
    element(parent, "Component", attributes, |component| text(component, "AuthoringToolId", &member.identity()))
}
