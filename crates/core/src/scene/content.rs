use super::{
    Alpha, Attribute, Color, ColorRule, Material, Mesh, Object, Opacity, Photograph, Projector,
    Quantity, Reflectance, Scalar, ScalarAt, Scene, Texture, TextureMapping, TextureProjection,
    Transform, Wrap,
};
use crate::digest::{Digest, Digester};
use glam::{DAffine3, DVec3};

impl Scene {
    /// A checksum of all that decides pictures of the scene, object by object: triangles, normals, texture
    /// coordinates, colours, textures and transforms. Names and files do not count: a renamed mesh is the same mesh.
    pub fn content(&self) -> Digest {
        let mut hash = Digester::new();
        hash.number(self.objects.len() as u64);
        for object in &self.objects {
            add_object(&mut hash, object);
        }
        hash.finish()
    }
}

/// Marks optional parts that few scenes have, so that the checksums of others stay as they were when the part was
/// added. No count is as large.
const MORE: u64 = u64::MAX;

/// Vertex colours that are digested at a time: one by one they took longer than all else of a mesh.
const AT_ONCE: usize = 4096;

fn add_object(hash: &mut Digester, object: &Object) {
    // Destructured, so that the compiler demands a decision about each new field.
    let Object {
        name: _,
        mesh,
        transform,
        parent,
        color,
        texture,
        mapping,
        blend_by,
        source: _,
        up_axis: _,
        texture_source: _,
        node: _,
        visible,
        hidden_groups: _,
        shape: _,
    } = object;
    add_placement(hash, (transform, *parent));
    add_color_rule(hash, color, mesh);
    add_mesh(hash, mesh);
    match texture {
        None => hash.number(0),
        Some(texture) => add_texture(hash, texture),
    }
    if *mapping != TextureMapping::default() {
        hash.bytes(b"mapping");
        add_mapping(hash, mapping);
    }
    if let Some(name) = blend_by {
        hash.bytes(b"blend by");
        hash.bytes(name.as_bytes());
        let values = mesh.scalar(name).map_or(&[][..], |scalar| &scalar.values);
        hash.words(values.iter().map(|value| value.to_bits()));
    }
    // Nothing is hashed where all objects are visible, so that checksums from before objects could be hidden stay
    // valid.
    if !visible {
        hash.bytes(b"hidden");
    }
    let shown = object.kept();
    if shown.len() < mesh.kept().len() {
        hash.bytes(b"hidden groups");
        hash.number(shown.len() as u64);
        hash.words(shown.iter().copied());
    }
}

pub(super) fn add_placement(hash: &mut Digester, (transform, parent): (&Transform, Option<usize>)) {
    let Transform {
        translate,
        rotate,
        scale,
        matrix,
    } = transform;
    hash.doubles(
        [translate, rotate, scale]
            .into_iter()
            .flat_map(DVec3::to_array),
    );
    if *matrix != DAffine3::IDENTITY {
        hash.number(MORE);
        hash.doubles(matrix.to_cols_array());
    }
    hash.number(parent.map_or(0, |parent| parent as u64 + 1));
}

pub(super) fn add_color_rule(hash: &mut Digester, color: &ColorRule, mesh: &Mesh) {
    match color {
        ColorRule::File => hash.number(0),
        ColorRule::Uniform(color) => {
            hash.number(1);
            add_color(hash, *color);
        }
        ColorRule::PerTriangle { seed } => {
            hash.number(2);
            hash.number((*seed).into());
        }
        ColorRule::ByObject => hash.number(3),
        ColorRule::ByGroup => {
            hash.number(6);
            // Only groups that colours show count.
            let runs = mesh.groups().runs();
            hash.number(runs.len() as u64);
            hash.words(runs.iter().flat_map(|run| [run.first, run.group]));
        }
        ColorRule::Normal => hash.number(4),
        ColorRule::Value(quantity) => {
            hash.number(5);
            hash.bytes(quantity.to_string().as_bytes());
            // Only a scalar that colours show counts.
            let scalar = match quantity {
                Quantity::Scalar(name) => mesh.scalar(name),
                _ => None,
            };
            if let Some(Scalar {
                name: _,
                at,
                values,
            }) = scalar
            {
                hash.number(match at {
                    ScalarAt::Vertices => 0,
                    ScalarAt::Triangles => 1,
                });
                hash.number(values.len() as u64);
                hash.words(values.iter().map(|value| value.to_bits()));
            }
        }
    }
}

fn add_mesh(hash: &mut Digester, mesh: &Mesh) {
    hash.doubles(mesh.offset().to_array());
    hash.number(mesh.positions().len() as u64);
    hash.list(mesh.positions());
    hash.number(mesh.triangles().len() as u64);
    hash.list(mesh.triangles());
    add_attribute(hash, mesh.normals());
    add_attribute(hash, mesh.uvs());
    hash.number(mesh.vertex_colors().len() as u64);
    let mut bytes = Vec::new();
    for colors in mesh.vertex_colors().chunks(AT_ONCE) {
        bytes.clear();
        for color in colors {
            bytes.extend(u64::from(color.is_some()).to_le_bytes());
            bytes.extend(color.map(|Color(rgb)| rgb).iter().flatten());
        }
        hash.bytes(&bytes);
    }
    // Wireframes can leave them out. Hashed only where present: meshes of triangles keep their checksum.
    let diagonals = mesh.diagonals().words();
    if diagonals.iter().any(|word| *word != 0) {
        hash.bytes(b"diagonals");
        hash.words(
            diagonals
                .iter()
                .flat_map(|word| [*word as u32, (*word >> 32) as u32]),
        );
    }
    hash.number(mesh.materials().len() as u64);
    for material in mesh.materials() {
        add_color(hash, material.color);
    }
    hash.number(mesh.material_of_triangle().len() as u64);
    hash.list(mesh.material_of_triangle());
    for (number, material) in mesh.materials().iter().enumerate() {
        let Material {
            name: _,
            color: _,
            texture,
            by_vertex,
            reflectance,
            opacity,
        } = material;
        if *by_vertex || texture.is_some() {
            hash.number(MORE);
            hash.number(number as u64);
            hash.number((*by_vertex).into());
            match texture {
                None => hash.number(0),
                Some(texture) => add_texture(hash, texture),
            }
        }
        if let Some(reflectance) = reflectance {
            hash.number(MORE);
            hash.number(number as u64);
            add_reflectance(hash, reflectance);
        }
        // Hashed only where present: scenes without keep their checksum.
        if let Some(Alpha { factor, image }) = opacity.alpha() {
            hash.bytes(b"opacity");
            hash.number(number as u64);
            let cutoff = match opacity {
                Opacity::Mask { cutoff, .. } => cutoff.to_bits().into(),
                Opacity::Opaque | Opacity::Blend(_) => MORE,
            };
            hash.number(cutoff);
            hash.number(factor.to_bits().into());
            match image {
                None => hash.number(0),
                Some(image) => add_texture(hash, image),
            }
        }
    }
}

fn add_reflectance(hash: &mut Digester, reflectance: &Reflectance) {
    let Reflectance {
        metallic,
        roughness,
        texture,
        emission: [r, g, b],
        emission_texture,
        is_unlit,
    } = reflectance;
    let numbers = [metallic, roughness, r, g, b].map(|number| f64::from(*number));
    hash.doubles(numbers);
    hash.number((*is_unlit).into());
    for texture in [texture, emission_texture] {
        match texture {
            None => hash.number(0),
            Some(texture) => add_texture(hash, texture),
        }
    }
}

fn add_attribute<T: bytemuck::Pod>(hash: &mut Digester, attribute: Option<&Attribute<T>>) {
    let Some(Attribute { values, indices }) = attribute else {
        hash.number(0);
        return;
    };
    hash.number(values.len() as u64);
    hash.list(values);
    match indices {
        None => hash.number(0),
        Some(indices) => {
            hash.number(indices.len() as u64);
            hash.list(indices);
        }
    }
}

fn add_texture(hash: &mut Digester, texture: &Texture) {
    hash.number(texture.width().into());
    hash.number(texture.height().into());
    hash.bytes(texture.texels().as_flattened());
    let wrap = texture.wrap();
    if wrap != [Wrap::Repeat; 2] {
        hash.number(MORE);
        for wrap in wrap {
            match wrap {
                Wrap::Repeat => hash.number(0),
                Wrap::Mirror => hash.number(1),
                Wrap::Clamp => hash.number(2),
                Wrap::Border(None) => hash.number(3),
                Wrap::Border(Some(color)) => {
                    hash.number(4);
                    add_color(hash, color);
                }
            }
        }
    }
}

fn add_mapping(hash: &mut Digester, mapping: &TextureMapping) {
    let TextureMapping {
        projection,
        projector,
        photograph,
    } = mapping;
    hash.number(match projection {
        None => 0,
        Some(TextureProjection::Uv) => 1,
        Some(TextureProjection::Triplanar) => 2,
        Some(TextureProjection::PerTriangle) => 3,
        Some(TextureProjection::Plane) => 4,
        Some(TextureProjection::Sphere) => 5,
        Some(TextureProjection::Cylinder) => 6,
        Some(TextureProjection::Camera) => 7,
    });
    if let Some(projector) = projector {
        let Projector {
            center,
            front,
            up,
            size,
        } = projector;
        hash.doubles([center, front, up].into_iter().flat_map(|v| v.to_array()));
        hash.doubles(size.to_array());
    }
    if let Some(photograph) = photograph {
        let Photograph {
            eye,
            target,
            up,
            fov,
            shift: [right, raised],
            lens,
        } = photograph;
        hash.bytes(b"photograph");
        hash.doubles([eye, target, up].into_iter().flat_map(|v| v.to_array()));
        hash.doubles([*fov, *right, *raised]);
        if let Some(lens) = lens {
            hash.bytes(b"lens");
            hash.doubles(*lens);
        }
    }
}

fn add_color(hash: &mut Digester, Color([r, g, b]): Color) {
    hash.bytes(&[r, g, b]);
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::scene::{Bounds, Diagonals, Groups, MeshData};
    use glam::{Vec2, Vec3};
    use std::path::PathBuf;
    use std::sync::Arc;

    const PHOTOGRAPH: Photograph = Photograph {
        eye: DVec3::Z,
        target: DVec3::ZERO,
        up: DVec3::Y,
        fov: 45.0,
        shift: [0.0; 2],
        lens: None,
    };

    pub(in crate::scene) fn data() -> MeshData {
        MeshData {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z],
            triangles: vec![[0, 1, 2], [0, 1, 3]],
            normals: Some(Attribute {
                values: vec![Vec3::Z, Vec3::X],
                indices: Some(vec![[0, 0, 1], [1, 1, 0]]),
            }),
            uvs: Some(Attribute {
                values: vec![Vec2::ZERO, Vec2::X, Vec2::Y, Vec2::ONE],
                indices: None,
            }),
            materials: vec![
                Material::new("a", Color([1, 2, 3])),
                Material::new("b", Color([4, 5, 6])),
            ],
            material_of_triangle: vec![0, 1],
            colors: vec![Some(Color([7, 8, 9])), None, None, None],
            scalars: vec![Scalar {
                name: "s".to_owned(),
                at: ScalarAt::Triangles,
                values: vec![1.0, 2.0],
            }],
            ..MeshData::default()
        }
    }

    pub(in crate::scene) fn scene(data: MeshData, change: impl Fn(&mut Object)) -> Scene {
        let mut object = Object::new("object", Arc::new(Mesh::new(data)));
        change(&mut object);
        Scene {
            objects: vec![
                Object::new("first", Arc::new(Mesh::new(self::data()))),
                object,
            ],
        }
    }

    pub(in crate::scene) fn texture(texel: u8) -> Option<Arc<Texture>> {
        Texture::new(1, 2, vec![[texel; 4], [0; 4]]).map(Arc::new)
    }

    fn rough(roughness: f32) -> Option<Arc<Reflectance>> {
        Some(Arc::new(Reflectance {
            roughness,
            ..Reflectance::default()
        }))
    }

    pub(in crate::scene) fn alpha(factor: f32, image: Option<Arc<Texture>>) -> Alpha {
        Alpha { factor, image }
    }

    pub(in crate::scene) fn mask(cutoff: f32, alpha: Alpha) -> Opacity {
        Opacity::Mask { alpha, cutoff }
    }

    fn wrapped(wrap: Wrap) -> Option<Arc<Texture>> {
        let texture = texture(1).map(Arc::unwrap_or_clone)?;
        Some(Arc::new(texture.wrapped([Wrap::Repeat, wrap])))
    }

    #[test]
    fn all_that_decides_a_picture_counts() {
        let mut digests = vec![scene(data(), |_| ()).content(), Scene::default().content()];
        fn diagonals(edges: [bool; 3]) -> Diagonals {
            let mut diagonals = Diagonals::of(2);
            diagonals.set(0, edges);
            diagonals
        }
        let changes: [fn(&mut MeshData); 24] = [
            |data| data.colors[0] = Some(Color([7, 8, 10])),
            |data| data.colors.swap(0, 1),
            |data| data.positions[1].x = 1f64.next_up() as f32 as f64 + 1e-7,
            |data| data.positions.iter_mut().for_each(|p| p.x += 1e6),
            |data| data.triangles[1] = [1, 0, 3],
            |data| data.triangles.truncate(1),
            |data| data.diagonals = diagonals([true, false, false]),
            |data| data.diagonals = diagonals([false, true, false]),
            |data| data.normals = None,
            |data| data.normals.as_mut().expect("normals").values[0] = Vec3::Y,
            |data| data.normals.as_mut().expect("normals").indices = None,
            |data| data.uvs.as_mut().expect("coordinates").values[0].x = 0.5,
            |data| data.materials[1].color = Color([4, 5, 7]),
            |data| data.material_of_triangle = vec![1, 0],
            |data| data.materials[0].by_vertex = true,
            |data| data.materials[0].reflectance = Some(Arc::default()),
            |data| data.materials[1].reflectance = Some(Arc::default()),
            |data| data.materials[0].reflectance = rough(0.25),
            |data| data.materials[0].texture = texture(1),
            |data| data.materials[1].texture = texture(1),
            |data| data.materials[0].opacity = Opacity::Blend(alpha(0.5, None)),
            |data| data.materials[1].opacity = Opacity::Blend(alpha(0.5, None)),
            |data| data.materials[0].opacity = mask(0.5, alpha(0.5, texture(1))),
            |data| data.materials[0].opacity = mask(0.25, alpha(0.5, texture(1))),
        ];
        for change in changes {
            let mut data = data();
            change(&mut data);
            digests.push(scene(data, |_| ()).content());
        }
        let changes: [fn(&mut Object); 31] = [
            |object| object.transform.translate.y = 1e-300,
            |object| object.transform.rotate.y = 1.0,
            |object| object.transform.scale.y = 2.0,
            |object| object.transform.matrix.translation.y = 1e-300,
            |object| object.parent = Some(0),
            |object| object.color = ColorRule::Uniform(Color([0; 3])),
            |object| object.color = ColorRule::PerTriangle { seed: 0 },
            |object| object.color = ColorRule::PerTriangle { seed: 1 },
            |object| object.color = ColorRule::ByObject,
            |object| object.color = ColorRule::ByGroup,
            |object| {
                object.color = ColorRule::ByGroup;
                object.mesh = Arc::new(Mesh::new(MeshData {
                    groups: Groups::of_triangles(vec!["g".to_owned()], [None, Some(0)])
                        .expect("a group"),
                    ..data()
                }));
            },
            |object| object.color = ColorRule::Normal,
            |object| object.color = ColorRule::Value(Quantity::Area),
            |object| object.color = ColorRule::Value(Quantity::Distance(None)),
            |object| object.color = ColorRule::Value(Quantity::Distance(Some(DVec3::X))),
            |object| object.color = ColorRule::Value(Quantity::Scalar("s".into())),
            |object| {
                object.color = ColorRule::Value(Quantity::Scalar("s".into()));
                let mut data = data();
                data.scalars[0].values[1] = 3.0;
                object.mesh = Arc::new(Mesh::new(data));
            },
            |object| object.texture = texture(1),
            |object| object.texture = texture(2),
            |object| object.texture = wrapped(Wrap::Mirror),
            |object| object.texture = wrapped(Wrap::Clamp),
            |object| object.texture = wrapped(Wrap::Border(None)),
            |object| object.texture = wrapped(Wrap::Border(Some(Color([0; 3])))),
            |object| object.mapping.projection = Some(TextureProjection::Uv),
            |object| object.mapping.projection = Some(TextureProjection::Plane),
            |object| object.mapping.projector = Some(Projector::about(&Bounds::EMPTY)),
            |object| object.mapping.photograph = Some(PHOTOGRAPH),
            |object| {
                object.mapping.photograph = Some(Photograph {
                    fov: 46.0,
                    ..PHOTOGRAPH
                })
            },
            |object| {
                let lens = Some([0.0; 5]);
                object.mapping.photograph = Some(Photograph { lens, ..PHOTOGRAPH });
            },
            |object| object.blend_by = Some("s".to_owned()),
            |object| object.blend_by = Some("t".to_owned()),
        ];
        for change in changes {
            digests.push(scene(data(), change).content());
        }
        let count = digests.len();
        let distinct: std::collections::HashSet<_> = digests.into_iter().collect();
        assert_eq!(distinct.len(), count);
    }

    #[test]
    fn names_and_files_do_not() {
        let renamed = |object: &mut Object| {
            object.name = "another".to_owned();
            object.source = Some(PathBuf::from("a.obj"));
            object.texture_source = Some(PathBuf::from("a.png"));
        };
        let mut data = data();
        let plain = scene(data.clone(), |_| ()).content();
        data.materials[0].name = "c".to_owned();
        assert_eq!(scene(data, renamed).content(), plain);
    }
}
