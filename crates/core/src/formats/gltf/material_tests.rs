//! Ground truth: short files whose colours, opacities and reflectances are written out.

use super::tests::{gltf, notes, read};
use crate::scene::{Alpha, Color, Mesh, Opacity, Wrap};
use glam::Vec2;
use std::sync::Arc;

/// Two triangles with coordinates and these materials.
fn reflecting(materials: &str) -> (Arc<Mesh>, Vec<String>) {
    let uvs = [0f32, 0., 1., 0., 1., 1., 0., 0.25];
    let more: Vec<u8> = uvs.iter().flat_map(|x| x.to_le_bytes()).collect();
    let accessors = r#", {"bufferView": 2, "componentType": 5126, "count": 4, "type": "VEC2"}"#;
    let rest = format!(
        r#""nodes": [{{"mesh": 0}}], "meshes": [{{"primitives": [
  {{"attributes": {{"POSITION": 0, "TEXCOORD_0": 2}}, "material": 0}},
  {{"attributes": {{"POSITION": 0, "TEXCOORD_0": 2}}, "material": 1}}]}}],
"materials": [{materials}],
"extensionsUsed": ["KHR_materials_unlit", "KHR_materials_emissive_strength", "KHR_materials_clearcoat"],
"textures": [{{"source": 0}}], "images": [{{"uri": "t.ppm"}}]"#
    );
    let file = gltf(&more, accessors, &rest);
    (Arc::clone(&read(&file).scene.objects[0].mesh), notes(&file))
}

#[test]
fn reflectances_are_read_and_unsupported_features_are_counted() {
    let (mesh, notes) = reflecting(
        r#"{"pbrMetallicRoughness": {"metallicFactor": 0.25, "roughnessFactor": 7,
    "metallicRoughnessTexture": {"index": 0}}, "normalTexture": {"index": 0}, "occlusionTexture": {"index": 0},
   "emissiveFactor": [1, 0.5, 0], "emissiveTexture": {"index": 0, "texCoord": 1},
   "extensions": {"KHR_materials_emissive_strength": {"emissiveStrength": 4}, "KHR_materials_clearcoat": {}}},
  {"extensions": {"KHR_materials_unlit": {}}}"#,
    );
    let known = |number: usize| {
        let known = mesh.materials()[number].reflectance.clone();
        known.expect("a reflectance")
    };
    let first = known(0);
    assert_eq!((first.metallic, first.roughness), (0.25, 1.0));
    assert_eq!(first.emission, [4.0, 2.0, 0.0]);
    assert!(first.texture.is_some() && first.emission_texture.is_none());
    assert!(!first.is_unlit && known(1).is_unlit);
    assert_eq!((known(1).metallic, known(1).roughness), (1.0, 1.0));
    let message = "not used: images of emission by other coordinates than of colour (1 materials), images of normals \
                (1 materials), images of occlusion (1 materials), \"KHR_materials_clearcoat\"";
    assert_eq!(notes[1], message);
}

#[test]
fn colours_are_those_of_factors_vertices_and_images() {
    let mut more: Vec<u8> = vec![
        255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 255, 255, 128, 128, 128, 255,
    ];
    more.extend(
        [0f32, 0., 1., 0., 1., 1., 0., 0.25]
            .iter()
            .flat_map(|x| x.to_le_bytes()),
    );
    let accessors = r#", {"bufferView": 2, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC4"},
 {"bufferView": 2, "byteOffset": 16, "componentType": 5126, "count": 4, "type": "VEC2"}"#;
    let rest = r#""nodes": [{"mesh": 0}], "meshes": [{"primitives": [
  {"attributes": {"POSITION": 0}, "material": 1},
  {"attributes": {"POSITION": 0, "COLOR_0": 2}, "material": 0},
  {"attributes": {"POSITION": 0, "TEXCOORD_1": 3}, "material": 2},
  {"attributes": {"POSITION": 0, "COLOR_0": 2}}]}],
"materials": [{"name": "half", "pbrMetallicRoughness": {"baseColorFactor": [1, 0.5, 1, 1]}},
  {"pbrMetallicRoughness": {"baseColorFactor": [0, 1, 0.21404114, 0.5]}, "alphaMode": "BLEND"},
  {"emissiveFactor": [1, 0, 0], "pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 1],
   "baseColorTexture": {"index": 0, "texCoord": 1, "extensions": {"KHR_texture_transform":
    {"offset": [0.5, 0], "rotation": 1.5707963267948966, "scale": [2, 1]}}}}}],
"extensionsRequired": ["KHR_texture_transform"], "extensionsUsed": ["KHR_texture_transform", "X_y"],
"textures": [{"source": 0, "sampler": 0}], "samplers": [{"wrapS": 33071, "wrapT": 33648}], "images": [{"uri": "t.ppm"}]"#;
    let file = read(&gltf(&more, accessors, rest));
    let object = &file.scene.objects[0];
    let material = object.mesh.material(0).expect("a material");
    assert_eq!(material.color, Color([0, 255, 128]));
    assert_eq!(object.corner_colors(0), None);
    let half = object.corner_colors(1).expect("colours of vertices");
    assert_eq!(
        half,
        [Color([255, 0, 0]), Color([0, 188, 0]), Color([0, 0, 255])]
    );
    assert_eq!(object.corner_colors(2), None);
    let own = object.corner_colors(3).expect("colours of vertices");
    assert_eq!(
        own,
        [Color([255, 0, 0]), Color([0, 255, 0]), Color([0, 0, 255])]
    );
    assert!(object.texture_on(1).is_none());
    let image = object.texture_on(2).expect("an image");
    assert_eq!(image.texels(), [[188, 100, 0, 255]]);
    let half = Alpha {
        factor: 0.5,
        image: None,
    };
    assert_eq!(*object.mesh.opacity(0), Opacity::Blend(half.clone()));
    assert_eq!(*object.mesh.opacity(1), Opacity::Opaque);
    for (given, cutoff) in [("", 0.5), (", \"alphaCutoff\": 0.25", 0.25)] {
        let masked = rest.replace("\"BLEND\"", &format!("\"MASK\"{given}"));
        let file = read(&gltf(&more, accessors, &masked));
        let alpha = half.clone();
        let opacity = file.scene.objects[0].mesh.opacity(0).clone();
        assert_eq!(opacity, Opacity::Mask { alpha, cutoff });
        assert_eq!(file.warnings.len(), 1, "{:?}", file.warnings);
    }
    assert_eq!(image.wrap(), [Wrap::Clamp, Wrap::Mirror]);
    // (u, v) scaled by (2, 1), rotated by a quarter to (v, −u), translated by (0.5, 0), and flipped.
    let uvs = object.mesh.corner_uvs(2).expect("coordinates");
    let expected = [(0.5, 1.0), (0.5, 3.0), (1.5, 3.0)].map(|(u, v)| Vec2::new(u, v));
    for (found, expected) in uvs.iter().zip(expected) {
        assert!((*found - expected).length() < 1e-6, "{uvs:?}");
    }
    assert_eq!(object.mesh.corner_uvs(0), None);
    assert_eq!(
        file.warnings,
        [
            "a.gltf: corners behind the last whole triangle, which are passed over: 4",
            "a.gltf: blended materials, of which each layer covers by its alpha, with nothing refracted: 1",
        ]
    );
    let message = "not used: \"X_y\"";
    assert_eq!(notes(&gltf(&more, accessors, rest))[1], message);
    let emission = |triangle| {
        let material = object.mesh.material(triangle).expect("a material");
        material.reflectance.as_ref().map(|known| known.emission)
    };
    assert_eq!(
        (emission(0), emission(2)),
        (Some([0.0; 3]), Some([1.0, 0.0, 0.0]))
    );
    // An image that cannot be read gives a warning, and the rest is shown.
    let file = read(&gltf(&more, accessors, &rest.replace("t.ppm", "none.png")));
    assert!(file.scene.objects[0].texture_on(2).is_none());
    assert!(
        file.warnings
            .iter()
            .any(|message| message.starts_with("none.png: ")),
        "{:?}",
        file.warnings
    );
}
