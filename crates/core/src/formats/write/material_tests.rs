//! Materials and images, as written and read again.

use super::tests::{bytes, library, read_all, rich, scene};
use super::*;
use crate::formats::held::Held;
use crate::formats::limits::Budget;
use crate::formats::mesh_file;
use crate::scene::{
    Alpha, Attribute, Color, MeshData, Opacity, Reflectance, Texture, TextureProjection, UpAxis,
    Wrap,
};
use glam::Vec2;
use std::sync::Arc;

/// What an OBJ's library says of materials is read again: opacity, reflection, and images, each in one file.
#[test]
fn an_obj_has_the_looks_and_images_of_its_materials() {
    let image = |texels: [[u8; 4]; 2], wrap| {
        let texture = Texture::new(2, 1, texels.to_vec()).expect("two texels");
        Arc::new(texture.wrapped([wrap; 2]))
    };
    let opaque = image([[9, 8, 7, 255], [255, 0, 1, 255]], Wrap::Clamp);
    let translucent = image([[200, 100, 0, 0], [10, 20, 30, 255]], Wrap::Repeat);
    let holes = image([[77; 4], [0; 4]], Wrap::Repeat);
    let alpha = |factor| Alpha {
        factor,
        image: Some(Arc::clone(&holes)),
    };
    let material = |name: &str| Material::new(name, Color([10, 20, 30]));
    let materials = vec![
        Material {
            texture: Some(Arc::clone(&opaque)),
            opacity: Opacity::Mask {
                alpha: alpha(1.0),
                cutoff: Opacity::CUTOFF,
            },
            ..material("masked")
        },
        Material {
            texture: Some(Arc::clone(&translucent)),
            opacity: Opacity::Blend(alpha(0.3)),
            ..material("glass")
        },
        Material {
            texture: Some(Arc::clone(&opaque)),
            reflectance: Some(Arc::new(Reflectance {
                metallic: 0.7,
                roughness: 1e-7,
                emission: [0.1, 3.5, 0.0],
                ..Reflectance::default()
            })),
            ..material("metal")
        },
        Material {
            opacity: Opacity::Blend(alpha(1f32.next_down())),
            ..material("curtain")
        },
        Material {
            reflectance: Some(Arc::new(Reflectance {
                metallic: 1.0,
                roughness: 1.0,
                texture: Some(image([[0, 9, 255, 255], [0, 200, 30, 255]], Wrap::Clamp)),
                emission: [1.0, 2.0, 0.0],
                emission_texture: Some(Arc::clone(&opaque)),
                is_unlit: false,
            })),
            ..material("lamp")
        },
        material("plain"),
        // Another look by the same name.
        Material {
            opacity: Opacity::Blend(Alpha {
                factor: 0.5,
                image: None,
            }),
            ..material("plain")
        },
    ];
    let data = MeshData {
        triangles: vec![[0, 1, 2]; 8],
        material_of_triangle: vec![0, 1, 2, 3, 4, 5, 6, u32::MAX],
        materials: materials.clone(),
        uvs: Some(Attribute {
            values: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
            indices: Some(vec![[0, 1, 2]; 8]),
        }),
        normals: None,
        ..rich()
    };
    // Full opacity but for the image, which a library cannot say otherwise.
    let mut full = materials.clone();
    full[3].opacity = Opacity::Blend(alpha(1.0));
    let data = MeshData {
        materials: full,
        ..data
    };
    let scene = scene([data]);
    let (bytes, written) = bytes(&scene, MeshFormat::Obj);
    assert_eq!(written.lost, [""; 0]);
    let names = library(&scene).images;
    let names: Vec<&str> = names.iter().map(|(name, _)| name.as_str()).collect();
    assert_eq!(
        names,
        [
            "an image-1.png",
            "an image-2.png",
            "an image-3.png",
            "an image-4.png",
            "an image-5.png"
        ]
    );
    let again = read_all(&scene, "a.obj", &bytes);
    let mesh = &again.objects[0].mesh;
    for (number, expected) in (0..).zip(&materials) {
        let found = mesh.material(number).expect("a material");
        let name = match number {
            6 => "plain 2",
            _ => expected.name.as_str(),
        };
        assert_eq!(found.name, name);
        assert_eq!(found.color, expected.color, "{name}");
        assert_eq!(found.reflectance, expected.reflectance, "{name}");
        assert_eq!(found.texture, expected.texture, "{name}");
        let opacity = |material: &Material| {
            let alpha = material.opacity.alpha().cloned();
            let image = alpha.as_ref().and_then(|alpha| alpha.image.clone());
            let texels = image.map(|image| image.texels().iter().map(|t| t[3]).collect::<Vec<_>>());
            let is_mask = matches!(material.opacity, Opacity::Mask { .. });
            (is_mask, alpha.map(|alpha| alpha.factor), texels)
        };
        assert_eq!(opacity(found), opacity(expected), "{name}");
    }
    assert_eq!(
        mesh.material(7).map(|material| &*material.name),
        Some("none")
    );
}

/// An MTL's images stand for the products with its numbers, and what is full needs none.
#[test]
fn an_objs_images_of_roughness_and_metal_have_the_factors_in_them() {
    let texture = |texels: [[u8; 4]; 2]| Texture::new(2, 1, texels.to_vec()).map(Arc::new);
    let material = Material {
        reflectance: Some(Arc::new(Reflectance {
            metallic: 0.5,
            roughness: 0.25,
            texture: texture([[7, 255, 100, 255], [7, 255, 0, 255]]),
            emission_texture: texture([[1; 4]; 2]),
            ..Reflectance::default()
        })),
        ..Material::new("worn", Color([10, 20, 30]))
    };
    let data = MeshData {
        triangles: vec![[0, 1, 2]],
        material_of_triangle: vec![0],
        materials: vec![material],
        uvs: Some(Attribute {
            values: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
            indices: None,
        }),
        normals: None,
        ..rich()
    };
    let scene = scene([data]);
    let written = library(&scene);
    assert_eq!(written.images.len(), 1, "the emission is black");
    assert!(
        written.text.contains("map_Pm an image-1.png\n"),
        "{}",
        written.text
    );
    let (bytes, _) = bytes(&scene, MeshFormat::Obj);
    let again = read_all(&scene, "a.obj", &bytes);
    let found = again.objects[0]
        .mesh
        .material(0)
        .and_then(|it| it.reflectance.clone());
    let expected = Reflectance {
        metallic: 1.0,
        roughness: 0.25,
        texture: texture([[0, 255, 50, 255], [0, 255, 0, 255]]),
        ..Reflectance::default()
    };
    assert_eq!(found.as_deref(), Some(&expected));
}

/// An object's own image is that of its triangles, also of those without a material.
#[test]
fn an_obj_has_the_images_of_objects() {
    let texture = |red| {
        let texture = Texture::new(1, 1, vec![[red, 2, 3, 255]]).expect("a texel");
        Some(Arc::new(texture))
    };
    let plain = || MeshData {
        materials: Vec::new(),
        material_of_triangle: Vec::new(),
        ..rich()
    };
    let mut one = scene([plain()]);
    one.objects[0].texture = texture(1);
    let (bytes, _) = bytes(&one, MeshFormat::Obj);
    let again = read_all(&one, "a.obj", &bytes);
    let named = again.objects[0].texture.as_ref();
    assert!(
        matches!(named, Some(mesh_file::MeshTexture::Named(path)) if path == Path::new("an image-1.png"))
    );

    let mut two = scene([plain(), plain()]);
    two.objects[0].texture = texture(1);
    two.objects[1].texture = texture(9);
    two.objects[1].mapping.projection = Some(TextureProjection::Sphere);
    let (bytes, written) = self::bytes(&two, MeshFormat::Obj);
    assert_eq!(
        written.lost,
        ["images that are not placed by texture coordinates (1)"]
    );
    let mesh = &read_all(&two, "a.obj", &bytes).objects[0].mesh;
    let red = |number| {
        let texture = mesh.material(number)?.texture.as_ref()?;
        Some(texture.texels()[0][0])
    };
    assert_eq!([red(0), red(4)], [Some(1), None]);
}

/// Images of materials and objects are written into a GLB, each once, and come back texel for texel.
#[test]
fn a_glb_has_the_images_of_materials_and_objects() {
    let image = |texels: [[u8; 4]; 2], wrap| {
        let texture = Texture::new(2, 1, texels.to_vec()).expect("two texels");
        Arc::new(texture.wrapped([wrap; 2]))
    };
    let opaque = image([[9, 8, 7, 255], [255, 0, 1, 255]], Wrap::Mirror);
    let translucent = image([[200, 200, 200, 0], [10, 20, 30, 255]], Wrap::Repeat);
    let holes = image([[3, 3, 3, 255], [3, 3, 3, 0]], Wrap::Mirror);
    let mut data = rich();
    let base = data.materials[1].color;
    let mask = |image: &Arc<Texture>| Opacity::Mask {
        alpha: Alpha {
            factor: 1.0,
            image: Some(Arc::clone(image)),
        },
        cutoff: 0.25,
    };
    data.materials[0].texture = Some(Arc::clone(&opaque));
    data.materials[0].opacity = mask(&holes);
    data.materials[1].texture = Some(Arc::clone(&translucent));
    data.materials[1].reflectance = Some(Arc::new(Reflectance {
        emission_texture: Some(Arc::clone(&opaque)),
        emission: [1.0; 3],
        ..Reflectance::default()
    }));
    let plain = MeshData {
        materials: Vec::new(),
        material_of_triangle: Vec::new(),
        ..rich()
    };
    let mut scene = scene([data, plain.clone(), plain]);
    scene.objects[1].texture = Some(Arc::clone(&opaque));
    scene.objects[2].texture = Some(Arc::clone(&opaque));
    scene.objects[2].mapping.projection = Some(TextureProjection::Sphere);
    let (bytes, written) = bytes(&scene, MeshFormat::Glb);
    let lost = "images that are not placed by texture coordinates (1)";
    assert!(
        written.lost.contains(&lost.to_owned()),
        "{:?}",
        written.lost
    );
    let (_, as_ply) = self::bytes(&scene, MeshFormat::Ply { ascii: false });
    assert!(as_ply.lost.contains(&"images of objects (3)".to_owned()));

    let nothing = |_: &str| None;
    let budget = Budget::default();
    let files = Held::new(&nothing, &budget);
    let read = mesh_file::read(Path::new("a.glb"), &bytes, &files, UpAxis::Y, &|_| ());
    let read = read.expect("what was written is read");
    assert!(read.warnings.is_empty(), "{:?}", read.warnings);
    let find = |object: usize, name: &str| -> Material {
        let mut all = read.objects[object].mesh.materials().iter();
        all.find(|material| material.name == name)
            .expect(name)
            .clone()
    };
    let names: Vec<_> = scene.objects[0]
        .mesh
        .materials()
        .iter()
        .map(|m| &*m.name)
        .collect();
    let first = find(0, names[0]);
    assert_eq!(first.texture.as_ref(), Some(&opaque));
    let Opacity::Mask { alpha, cutoff } = &first.opacity else {
        panic!("{:?}", first.opacity)
    };
    let alphas = alpha.image.as_ref().map(|image| image.texels().to_vec());
    assert_eq!(alphas, Some(vec![[9, 8, 7, 255], [255, 0, 1, 0]]));
    assert_eq!(*cutoff, 0.25);
    let second = find(0, names[1]);
    let Color([r, g, b]) = base;
    let over = image([[r, g, b, 255], [10, 20, 30, 255]], Wrap::Repeat);
    assert_eq!(second.texture, Some(over));
    let reflectance = second.reflectance.expect("written");
    assert_eq!(reflectance.emission_texture.as_ref(), Some(&opaque));
    let of_object = &read.objects[1].mesh;
    let triangle = of_object.kept()[0];
    let texture = of_object
        .material(triangle)
        .and_then(|m| m.texture.as_ref());
    assert_eq!(texture, Some(&opaque));
    let without = read.objects[2].mesh.material(triangle);
    assert!(without.is_none_or(|material| material.texture.is_none()));
    let png = bytes
        .windows(8)
        .filter(|bytes| *bytes == b"\x89PNG\r\n\x1a\n");
    assert_eq!(png.count(), 3, "each combination once");
}
