use super::{
    Bounds, Color, ColorRule, HiddenGroups, Mesh, ScalarAt, Shape, Texture, TextureMapping,
    Transform, UpAxis,
};
use crate::quote::shorten;
use glam::DAffine3;
use std::collections::{BTreeMap, BTreeSet};
use std::path::PathBuf;
use std::sync::Arc;

/// A mesh with a transform and colours.
#[derive(Clone, Debug)]
pub struct Object {
    /// What a person calls it.
    pub name: String,
    /// Its triangles.
    pub mesh: Arc<Mesh>,
    /// The transform to its parent, or to the world.
    pub transform: Transform,
    /// The object, by index, whose transform it inherits.
    pub parent: Option<usize>,
    /// How its triangles get their colours.
    pub color: ColorRule,
    /// An image for its surface.
    pub texture: Option<Arc<Texture>>,
    /// How its texture is mapped, where that is set for the object itself.
    pub mapping: TextureMapping,
    /// The mesh scalar (0 to 1) that multiplies the picture's blend: how much of the texture shows at each point; all
    /// of it where the scalar is NaN. `None`: all of it everywhere.
    pub blend_by: Option<String>,
    /// The file that its mesh was read from, for saving the scene: absolute, or relative where the mesh came from a
    /// caller's own store of files.
    pub source: Option<PathBuf>,
    /// The axis of that file that points up; a mesh with Z up was rotated when it was read.
    pub up_axis: UpAxis,
    /// The file that its texture was read from, absolute or relative in the same way.
    pub texture_source: Option<PathBuf>,
    /// The index of its mesh node in that file, from 0, depth first; `None` where the object is the whole file.
    pub node: Option<u32>,
    /// Whether rays can hit it. A hidden object keeps its number, its triangles keep theirs, and its children stay
    /// where they are.
    pub visible: bool,
    /// Groups of its mesh that rays cannot hit, set by [`Object::hide_groups`]; those of another mesh hide nothing.
    pub hidden_groups: Option<Arc<HiddenGroups>>,
    /// The parameters that its mesh was made from, if it came from no file.
    pub shape: Option<Shape>,
}

impl Object {
    /// An object without transform, in the file's own colours.
    pub fn new(name: impl Into<String>, mesh: Arc<Mesh>) -> Self {
        Self {
            name: name.into(),
            mesh,
            transform: Transform::IDENTITY,
            parent: None,
            color: ColorRule::File,
            texture: None,
            mapping: TextureMapping::default(),
            blend_by: None,
            source: None,
            up_axis: UpAxis::Y,
            texture_source: None,
            node: None,
            visible: true,
            hidden_groups: None,
            shape: None,
        }
    }

    /// Hides the groups of these names and no others. The empty name is that of triangles in no group.
    pub fn hide_groups(&mut self, names: BTreeSet<String>) {
        let is_any = !names.is_empty();
        self.hidden_groups =
            is_any.then(|| Arc::new(HiddenGroups::new(Arc::clone(&self.mesh), names)));
    }

    /// Replaces its mesh, in which groups of the same names are hidden.
    pub fn set_mesh(&mut self, mesh: Arc<Mesh>) {
        self.mesh = mesh;
        if let Some(hidden) = self.hidden_groups.take() {
            self.hide_groups(hidden.names().clone());
        }
    }

    /// The hidden groups, if any are.
    pub(crate) fn hidden(&self) -> Option<&Arc<HiddenGroups>> {
        let hidden = self.hidden_groups.as_ref()?;
        Arc::ptr_eq(hidden.mesh(), &self.mesh).then_some(hidden)
    }

    /// The numbers of its mesh's kept triangles that are in no hidden group, ascending.
    pub fn kept(&self) -> &[u32] {
        self.hidden()
            .map_or(self.mesh.kept(), |hidden| hidden.kept())
    }

    /// Whether it is hidden, or a group of it.
    pub fn is_partly_hidden(&self) -> bool {
        !self.visible || self.hidden().is_some()
    }

    /// Whether it is hidden, or groups that hold all its triangles.
    pub fn is_hidden(&self) -> bool {
        !self.visible || self.hidden().is_some() && self.kept().is_empty()
    }

    /// The box around these triangles, in its own space.
    pub fn bounds(&self) -> Bounds {
        self.hidden()
            .map_or_else(|| self.mesh.bounds(), |hidden| hidden.bounds())
    }

    /// The image on one of its triangles: the object's own; else, where the object shows the file's colours, that of
    /// the triangle's material.
    #[inline]
    pub fn texture_on(&self, triangle: u32) -> Option<&Texture> {
        let texture = match &self.texture {
            None if self.color.is_file() => self.mesh.material(triangle)?.texture.as_ref(),
            texture => texture.as_ref(),
        };
        texture.map(|texture| &**texture)
    }

    /// The index of a triangle's material, where that says how it reflects light and the object shows the file's
    /// colours.
    pub(crate) fn reflecting_material(&self, triangle: u32) -> Option<u32> {
        let of_triangle = self.mesh.material_of_triangle().get(triangle as usize);
        let number = *of_triangle.filter(|_| self.color.is_file())?;
        let material = self.mesh.materials().get(number as usize)?;
        material.reflectance.is_some().then_some(number)
    }

    /// Whether the image on a triangle is multiplied by the vertex colours: so where both are its material's.
    pub(crate) fn is_tinted(&self, triangle: u32) -> bool {
        let is_own = self.texture.is_none() && self.color.is_file();
        is_own && (self.mesh.material(triangle)).is_some_and(|material| material.by_vertex)
    }

    /// The blend scalars at a triangle's corners, where the object has any.
    pub fn blend_numbers(&self, triangle: u32) -> Option<[f32; 3]> {
        let scalar = self.mesh.scalar(self.blend_by.as_deref()?)?;
        let at = |index: u32| scalar.values.get(index as usize).copied();
        match scalar.at {
            ScalarAt::Triangles => Some([at(triangle)?; 3]),
            ScalarAt::Vertices => {
                let corners = self.mesh.triangles().get(triangle as usize)?;
                let [a, b, c] = corners.map(at);
                Some([a?, b?, c?])
            }
        }
    }

    /// Whether its texture stands in for an image that could not be read.
    pub fn has_stand_in(&self) -> bool {
        self.texture
            .as_ref()
            .is_some_and(|texture| texture.is_stand_in())
    }

    /// Whether any triangle may show an image.
    pub fn has_texture(&self) -> bool {
        let mut materials = self.mesh.materials().iter();
        self.texture.is_some() || (self.color.is_file() && materials.any(|m| m.texture.is_some()))
    }

    /// The file's sRGB vertex colours at a triangle's corners, where neither the colour rule nor a material takes
    /// precedence.
    pub fn corner_colors(&self, triangle: u32) -> Option<[Color; 3]> {
        let material = self.mesh.material(triangle);
        if !self.color.is_file() || material.is_some_and(|m| !m.by_vertex) {
            return None;
        }
        self.mesh.corner_colors(triangle)
    }
}

/// Why rays cannot be cast at a scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum SceneError {
    /// A parent index that no object has.
    #[error("object {object:?} names a parent that the scene does not have")]
    NoSuchParent {
        /// The object's name.
        object: String,
    },
    /// An object that is its own ancestor.
    #[error("object {object:?} is its own ancestor")]
    ParentCycle {
        /// The object's name.
        object: String,
    },
    /// A transform with a number that is NaN or infinite.
    #[error("object {object:?} has a transform that is not finite")]
    BadTransform {
        /// The object's name.
        object: String,
    },
    /// More triangles than 32-bit numbers can identify.
    #[error("the scene has {triangles} triangles; at most {limit} can be numbered")]
    TooManyTriangles {
        /// How many there are.
        triangles: u64,
        /// How many there may be.
        limit: u32,
    },
}

/// A list of objects, numbered in order.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The objects; an object's number is its index.
    pub objects: Vec<Object>,
}

impl From<Mesh> for Scene {
    /// One object without transform, in the file's own colours.
    fn from(mesh: Mesh) -> Self {
        Self {
            objects: vec![Object::new("mesh", Arc::new(mesh))],
        }
    }
}

impl Scene {
    /// Each object's map from its own space to the world's, parents included.
    ///
    /// # Errors
    /// A parent that does not exist, a cycle of parents, a transform that is not finite.
    pub fn world_from_objects(&self) -> Result<Vec<DAffine3>, SceneError> {
        (0..self.objects.len())
            .map(|index| self.world_from_object(index))
            .collect()
    }

    /// The map from an object's own space to the world's, its parents included: in time proportional to their number.
    ///
    /// # Errors
    /// As [`Scene::world_from_objects`], and an object that does not exist.
    pub fn world_from_object(&self, index: usize) -> Result<DAffine3, SceneError> {
        let name = || (self.objects.get(index)).map_or_else(String::new, |it| shorten(&it.name));
        let mut world_from_object = DAffine3::IDENTITY;
        let mut next = Some(index);
        for _ in 0..=self.objects.len() {
            let Some(ancestor) = next else {
                return if world_from_object.is_finite() {
                    Ok(world_from_object)
                } else {
                    Err(SceneError::BadTransform { object: name() })
                };
            };
            let Some(object) = self.objects.get(ancestor) else {
                return Err(SceneError::NoSuchParent { object: name() });
            };
            world_from_object = object.transform.parent_from_object() * world_from_object;
            next = object.parent;
        }
        Err(SceneError::ParentCycle { object: name() })
    }

    /// All triangles, dropped ones included.
    pub fn triangle_count(&self) -> usize {
        self.objects
            .iter()
            .map(|object| object.mesh.triangles().len())
            .sum()
    }

    /// An upper bound of the bytes that it takes to compute [`Mesh::creased`] for the meshes without normals. A mesh
    /// that several objects share counts once.
    pub fn crease_bytes(&self) -> u64 {
        // Per triangle: its corners sorted by vertex, their normals, and a copy of both in parts. Per vertex: its
        // welded vertex, and the sorted positions.
        const TRIANGLE: u64 = 24 + 12 + 36 + 12 + 36;
        const VERTEX: u64 = 16 + 4 + 8 + 8;
        let bytes = |mesh: &Mesh| match mesh.has_normals() {
            true => 0,
            false => {
                let (triangles, vertices) = (mesh.triangles().len(), mesh.positions().len());
                TRIANGLE * triangles as u64 + VERTEX * vertices as u64
            }
        };
        let meshes = self.objects.iter().map(|object| &object.mesh);
        let distinct: BTreeMap<_, _> = meshes
            .map(|mesh| (Arc::as_ptr(mesh), bytes(mesh)))
            .collect();
        distinct.values().sum()
    }

    /// The bytes that the mip levels of its textures take once a filter needs them. A texture that several objects or
    /// materials share counts once.
    pub fn level_bytes(&self) -> u64 {
        let distinct: BTreeMap<_, _> = self
            .textures()
            .map(|texture| (Arc::as_ptr(texture), texture.level_bytes()))
            .collect();
        distinct.values().sum()
    }

    /// The textures of its objects and of their materials. One that several share comes several times.
    pub(crate) fn textures(&self) -> impl Iterator<Item = &Arc<Texture>> {
        self.objects.iter().flat_map(|object| {
            let materials = object.mesh.materials().iter();
            let of_materials = materials.filter_map(|material| material.texture.as_ref());
            object.texture.iter().chain(of_materials)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::MeshData;
    use glam::DVec3;

    #[test]
    fn one_object_is_placed_as_among_all_and_faults_are_errors() {
        let mesh = Arc::new(Mesh::new(MeshData::default()));
        let object = |parent, x: f64| {
            let mut object = Object::new("o", Arc::clone(&mesh));
            object.parent = parent;
            object.transform.translate = DVec3::X * x;
            object.transform.rotate = DVec3::Z * 30.0;
            object
        };
        let mut scene = Scene {
            objects: vec![
                object(Some(2), 1.0),
                object(None, 2.0),
                object(Some(1), 4.0),
            ],
        };
        let all = scene.world_from_objects().expect("valid transforms");
        for (index, expected) in all.iter().enumerate() {
            assert_eq!(scene.world_from_object(index).as_ref(), Ok(expected));
        }
        assert!(scene.world_from_object(3).is_err());
        scene.objects[1].parent = Some(7);
        assert!(scene.world_from_object(0).is_err());
        scene.objects[1].parent = Some(0);
        assert!(scene.world_from_object(0).is_err());
    }
}
