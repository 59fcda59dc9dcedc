//! The glTF extensions that a file may require.

use crate::error::LoadError;

/// Extensions that are supported, or that do not affect the triangles: materials, lights, metadata,
/// visibility, sounds, physics, and rules that move nodes only while a program runs.
const NAMES: [&str; 37] = [
    "AGI_articulations",
    "AGI_stk_metadata",
    "CESIUM_primitive_outline",
    "EXT_feature_metadata",
    "EXT_instance_features",
    "EXT_mesh_features",
    "EXT_mesh_gpu_instancing",
    "EXT_mesh_manifold",
    "EXT_structural_metadata",
    "FB_geometry_metadata",
    "GRIFFEL_bim_data",
    "KHR_animation_pointer",
    "KHR_audio",
    "KHR_audio_emitter",
    "KHR_environment_map",
    "KHR_implicit_shapes",
    "KHR_interactivity",
    "KHR_lights_image_based",
    "KHR_lights_punctual",
    "KHR_mesh_quantization",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_node_visibility",
    "KHR_physics_rigid_bodies",
    "KHR_techniques_webgl",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MSFT_audio_emitter",
    "MSFT_lod",
    "MSFT_packing_normalRoughnessMetallic",
    "MSFT_packing_occlusionRoughnessMetallic",
    "MSFT_texture_dds",
    "NV_materials_mdl",
    "OMI_physics_body",
    "OMI_physics_joint",
    "OMI_physics_shape",
    "VRM",
];

/// Name prefixes of further extensions that do not affect the triangles.
const FAMILIES: [&str; 7] =
    ["ADOBE_materials_", "EXT_lights_", "EXT_materials_", "EXT_texture_", "KHR_materials_", "KHR_texture_", "VRMC_"];

/// Reports whether the triangles are correct although a file requires this extension: it is
/// supported, or does not affect them.
pub(super) fn leaves_positions_alone(extension: &str) -> bool {
    NAMES.contains(&extension) || FAMILIES.iter().any(|family| extension.starts_with(family))
}

/// Returns the error that a file needs an extension that is not supported.
pub(super) fn lacking(extension: &str) -> LoadError {
    let error = LoadError::unsupported(format!("glTF extension {extension}"));
    if ["KHR_draco_mesh_compression", "EXT_meshopt_compression", "KHR_meshopt_compression"].contains(&extension) {
        error.with_hint("decompress it, for example with `npx @gltf-transform/cli copy in.glb out.glb`")
    } else {
        error
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_extensions_that_do_not_affect_triangles_are_ignored() {
        assert!(NAMES.is_sorted() && FAMILIES.is_sorted());
        for fine in ["EXT_mesh_features", "KHR_materials_unlit", "VRM", "VRMC_springBone", "KHR_texture_basisu"] {
            assert!(leaves_positions_alone(fine), "{fine}");
        }
        for needed in ["CESIUM_RTC", "EXT_mesh_polygon", "KHR_draco_mesh_compression", "KHR_mesh", "VRM2", ""] {
            assert!(!leaves_positions_alone(needed), "{needed}");
        }
    }
}
