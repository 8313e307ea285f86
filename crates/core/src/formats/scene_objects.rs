//! The objects of a scene file, with the meshes, shapes and textures that they name.

use super::Progress;
use super::error::FormatError;
use super::files::beside;
use super::mesh_file::{self, MeshObject};
use super::scene_text::{Reader, line_at};
use super::scene_textures::Textures;
use super::scene_toml::{CameraToml, ObjectToml, PhotographToml, ShapeToml};
use super::scene_words::ProjectionToml;
use crate::camera::Pose;
use crate::quote::{self, quote};
use crate::ranges;
use crate::scene::{
    ColorRule, HiddenGroups, Mesh, Object, Photograph, Projector, Quantity, Shape, ShapeError,
    Texture, TextureMapping, Transform, UpAxis,
};
use glam::{DAffine3, DMat3, DVec2, DVec3};
use std::collections::{BTreeSet, HashMap};
use std::path::PathBuf;
use std::sync::Arc;
use toml::Spanned;

/// The most ancestors of an object: each costs time for each of its descendants.
pub(super) const ANCESTOR_LIMIT: usize = 1000;

/// Composes an object table's transform with the transform that the mesh file gives the object.
fn within(transform: &Transform, world_from_object: DAffine3) -> Transform {
    let matrix = if transform.matrix == DAffine3::IDENTITY {
        world_from_object
    } else if world_from_object == DAffine3::IDENTITY {
        transform.matrix
    } else {
        transform.matrix * world_from_object
    };
    Transform {
        matrix,
        ..*transform
    }
}

/// What is hidden, by mesh and names.
type Hidden = HashMap<(*const Mesh, BTreeSet<String>), Arc<HiddenGroups>>;

impl Reader<'_> {
    /// Reads the objects of the tables, in order.
    pub(super) fn objects(
        &self,
        tables: &[Spanned<ObjectToml>],
        progress: Progress<'_>,
        warnings: &mut Vec<String>,
        notes: &mut Vec<String>,
    ) -> Result<Vec<Object>, FormatError> {
        // Parents first: they are fast to check, and a fault in them is found before any file is read.
        let parents = self.parents(tables)?;
        let mut meshes: HashMap<(PathBuf, UpAxis), Vec<MeshObject>> = HashMap::new();
        // By their displayed parameters.
        let mut shapes: HashMap<String, [MeshObject; 1]> = HashMap::new();
        let mut textures = Textures::default();
        let mut hidden = Hidden::new();
        let mut objects: Vec<Object> = Vec::with_capacity(tables.len());
        let mut first_objects = Vec::with_capacity(tables.len());
        let share = 1.0 / tables.len().max(1) as f32;
        for (index, table) in tables.iter().enumerate() {
            let table = table.get_ref();
            let step = |part: f32| progress((index as f32 + part) * share);
            let (read, source) = match (&table.mesh, &table.shape) {
                (Some(named), None) => {
                    let mesh_path = beside(self.path, named.get_ref());
                    let source = self.files.source(&mesh_path);
                    let up_axis = table.up_axis.map_or(UpAxis::default(), Into::into);
                    let key = (source.clone(), up_axis);
                    if !meshes.contains_key(&key) {
                        let bytes = self.bytes(named, &mesh_path, &|part| step(part * 0.5))?;
                        let read =
                            mesh_file::read(&mesh_path, &bytes, self.files, up_axis, &|part| {
                                step(0.5 + part * 0.5);
                            })?;
                        let path = quote::path(&mesh_path);
                        notes.extend(read.notes.iter().map(|note| format!("{path}: {note}")));
                        warnings.extend(read.warnings);
                        meshes.insert(key.clone(), read.objects);
                    }
                    let read = meshes.get(&key).map_or(&[][..], Vec::as_slice);
                    (read, Some(source))
                }
                (None, Some(shape)) => {
                    let key = format!("{:?}", shape.get_ref());
                    if !shapes.contains_key(&key) {
                        shapes.insert(key.clone(), [self.shape(shape, warnings)?]);
                    }
                    (shapes.get(&key).map_or(&[][..], |made| &made[..]), None)
                }
                (Some(_), Some(shape)) => {
                    return Err(self.fault(shape, "a mesh or a shape", "both"));
                }
                (None, None) => {
                    let line = self.line(&tables[index]);
                    let expected = "an object's `mesh`, or `shape`";
                    return Err(FormatError::unexpected(self.path, line, expected, "none"));
                }
            };
            let found = self.named_nodes(table, read)?;
            mesh_file::count_objects(self.path, found, self.files.budget())?;
            let texture = self.texture(table, &tables[index..], &mut textures, warnings)?;
            let transform = self.transform(table)?;
            first_objects.push(objects.len());
            for placed in found {
                let mut object = placed.placed(source.clone());
                if let (Some(name), 2..) = (&table.name, found.len()) {
                    object.name = format!("{name}: {}", placed.name);
                } else if let Some(name) = &table.name {
                    object.name = name.clone();
                }
                object.transform = match &table.node {
                    // A table that names a node has the node's whole transform.
                    Some(_) => transform,
                    None => within(&transform, placed.world_from_object),
                };
                self.set_look(&mut object, table, texture.as_ref())?;
                objects.push(object);
            }
            if let Some(names) = &table.hidden_groups {
                let own = first_objects.last().map_or(0, |first| *first);
                self.hide_groups(names, &mut objects[own..], &mut hidden, warnings);
            }
        }
        first_objects.push(objects.len());
        self.set_parents(&parents, tables, &first_objects, &mut objects)?;
        progress(1.0);
        Ok(objects)
    }

    /// Sets the parents of the objects; those of each table begin at its entry of `first_objects`, which ends with their
    /// number.
    fn set_parents(
        &self,
        parents: &[Option<usize>],
        tables: &[Spanned<ObjectToml>],
        first_objects: &[usize],
        objects: &mut [Object],
    ) -> Result<(), FormatError> {
        for (index, parent) in parents.iter().enumerate() {
            let Some(parent) = *parent else { continue };
            let count = first_objects[parent + 1] - first_objects[parent];
            if let (2.., Some(named)) = (count, &tables[index].get_ref().parent) {
                let found = format!("{}, a file of {count} objects", quote(named.get_ref()));
                return Err(self.fault(named, "the name of one object as parent", &found));
            }
            for object in &mut objects[first_objects[index]..first_objects[index + 1]] {
                object.parent = Some(first_objects[parent]);
            }
        }
        Ok(())
    }

    /// Sets what a table says of its objects' looks.
    fn set_look(
        &self,
        object: &mut Object,
        table: &ObjectToml,
        texture: Option<&(Arc<Texture>, PathBuf)>,
    ) -> Result<(), FormatError> {
        object.shape = table.shape.as_ref().map(|shape| (*shape.get_ref()).into());
        object.visible = table.visible.unwrap_or(true);
        if let Some(color) = &table.color {
            object.color = color.get_ref().rule(table.seed);
            if let ColorRule::Value(Quantity::Scalar(name)) = &object.color {
                self.check_scalar(color, name, &object.mesh, "another color")?;
            }
        }
        if let Some((texture, source)) = texture {
            object.texture = Some(Arc::clone(texture));
            object.texture_source = Some(source.clone());
        }
        object.mapping = TextureMapping {
            projection: table.texture_projection.map(Into::into),
            projector: self.projector(table, object)?,
            photograph: match &table.texture_camera {
                Some(camera) => Some(self.photograph(camera)?),
                None => None,
            },
        };
        if let Some(named) = &table.blend_by {
            let name = named.get_ref();
            self.check_scalar(named, name, &object.mesh, "no `blend-by`")?;
            object.blend_by = Some(name.clone());
        }
        Ok(())
    }

    /// Hides groups of the objects of a table. Objects of one mesh share what is computed for it.
    fn hide_groups(
        &self,
        names: &Spanned<BTreeSet<String>>,
        objects: &mut [Object],
        hidden: &mut Hidden,
        warnings: &mut Vec<String>,
    ) {
        let all = names.get_ref();
        for name in all {
            let has = |object: &Object| {
                name.is_empty() || object.mesh.groups().names().iter().any(|own| own == name)
            };
            if !objects.iter().any(has) {
                let line = line_at(self.text.as_bytes(), names.span().start);
                let path = quote::path(self.path);
                warnings.push(format!(
                    "{path}:{line}: hidden-groups: the mesh has no group {}",
                    quote(name)
                ));
            }
        }
        for object in objects {
            let key = (Arc::as_ptr(&object.mesh), all.clone());
            object.hidden_groups = match hidden.get(&key) {
                Some(known) => Some(Arc::clone(known)),
                None => {
                    object.hide_groups(all.clone());
                    hidden.extend(object.hidden_groups.clone().map(|it| (key, it)));
                    continue;
                }
            };
        }
    }

    /// Checks that a scalar that the file names exists in the mesh.
    fn check_scalar<T>(
        &self,
        value: &Spanned<T>,
        name: &str,
        mesh: &Mesh,
        other: &str,
    ) -> Result<(), FormatError> {
        if mesh.scalar(name).is_some() {
            return Ok(());
        }
        let names: Vec<_> = mesh.scalars().iter().map(|s| quote(&s.name)).collect();
        let expected = match names[..] {
            [] => format!("{other}: the mesh has no scalars"),
            _ => format!("one of the mesh's scalars, {}", names.join(", ")),
        };
        Err(self.fault(value, &expected, &quote(name)))
    }

    /// The objects of a mesh file that a table stands for: the node that it names, or all.
    fn named_nodes<'o>(
        &self,
        table: &ObjectToml,
        read: &'o [MeshObject],
    ) -> Result<&'o [MeshObject], FormatError> {
        let Some(node) = &table.node else {
            return Ok(read);
        };
        let number = *node.get_ref();
        // A file without nodes has no node to name.
        let nodes = read.iter().filter(|object| object.node.is_some()).count();
        match read.get(number as usize).filter(|_| nodes > 0) {
            Some(object) => Ok(std::slice::from_ref(object)),
            None => {
                let expected =
                    format!("the number of one of the file's {nodes} mesh nodes, from 0");
                Err(self.fault(node, &expected, &number.to_string()))
            }
        }
    }

    /// A shape's mesh; its memory is counted before it is made.
    fn shape(
        &self,
        shape: &Spanned<ShapeToml>,
        warnings: &mut Vec<String>,
    ) -> Result<MeshObject, FormatError> {
        let table = shape;
        let refused = |error: ShapeError| {
            FormatError::refused(self.path, self.line(table), &error.to_string())
        };
        let shape = Shape::from(*table.get_ref());
        shape.check().map_err(refused)?;
        let budget = self.files.budget();
        if shape.triangles() > budget.triangles_left() {
            budget.add_triangles(self.path, shape.triangles())?;
        }
        // A triangle has three corners in each of three lists, and at most three vertices of its own.
        let bytes = shape.triangles() * 3 * (3 * 4 + 24 + 12 + 8);
        let _share = budget.share(self.path, "the shape", bytes)?;
        let data = shape.mesh().map_err(refused)?;
        let mesh = mesh_file::store(self.path, data, budget, warnings)?;
        Ok(MeshObject::from_mesh(shape.name(), mesh))
    }

    /// The projector of an object's texture, if the file sets any part of it; the rest is as for the mesh's bounds.
    fn projector(
        &self,
        table: &ObjectToml,
        object: &Object,
    ) -> Result<Option<Projector>, FormatError> {
        let directions = [
            &table.texture_center,
            &table.texture_front,
            &table.texture_up,
        ];
        let starts = directions.into_iter().flatten();
        let starts = starts.map(|value| value.span().start);
        let size = table.texture_size.as_ref();
        let mut starts = starts.chain(size.map(|size| size.span().start));
        let Some(start) = starts.next() else {
            return Ok(None);
        };
        let default = Projector::about(&object.mesh.bounds());
        let vector = |value: &Option<Spanned<[f64; 3]>>, default| match value {
            Some(value) => self.vector(value),
            None => Ok(default),
        };
        let projector = Projector {
            center: vector(&table.texture_center, default.center)?,
            front: vector(&table.texture_front, default.front)?,
            up: vector(&table.texture_up, default.up)?,
            size: table
                .texture_size
                .as_ref()
                .map_or(default.size, |size| DVec2::from_array(*size.get_ref())),
        };
        match projector.axes() {
            Ok(_) => Ok(Some(projector)),
            Err(error) => {
                let line = Some(line_at(self.text.as_bytes(), start));
                Err(FormatError::refused(self.path, line, &error.to_string()))
            }
        }
    }

    /// The camera that took a texture, with the checks of the scene's own camera.
    fn photograph(&self, table: &Spanned<PhotographToml>) -> Result<Photograph, FormatError> {
        let PhotographToml {
            eye,
            target,
            up,
            fov,
            shift,
            lens,
        } = table.get_ref().clone();
        let camera = CameraToml {
            projection: ProjectionToml::default(),
            lens,
            eye,
            target,
            up,
            fov,
            frame: None,
        };
        let camera = self.camera(&Spanned::new(table.span(), camera))?;
        let Pose { eye, target, up } = camera.pose;
        Ok(Photograph {
            eye,
            target,
            up,
            fov: camera.frame,
            shift: match &shift {
                Some(shift) => self.in_range(shift, ranges::shift(*shift.get_ref()))?,
                None => [0.0; 2],
            },
            lens: (camera.projection.lens()).map(|lens| lens.coefficients()),
        })
    }

    fn transform(&self, table: &ObjectToml) -> Result<Transform, FormatError> {
        let vector = |value: &Option<Spanned<[f64; 3]>>, default| match value {
            Some(value) => self.vector(value),
            None => Ok(default),
        };
        Ok(Transform {
            translate: vector(&table.translate, DVec3::ZERO)?,
            rotate: vector(&table.rotate, DVec3::ZERO)?,
            scale: vector(&table.scale, DVec3::ONE)?,
            matrix: match &table.matrix {
                Some(matrix) => self.matrix(matrix)?,
                None => DAffine3::IDENTITY,
            },
        })
    }

    /// An affine map: three rows of four finite numbers, and optionally a fourth, 0 0 0 1.
    fn matrix(&self, value: &Spanned<Vec<f64>>) -> Result<DAffine3, FormatError> {
        let numbers = value.get_ref();
        if numbers.len() != 12 && numbers.len() != 16 {
            let found = format!("{}", numbers.len());
            return Err(self.fault(value, "a matrix of 12 or 16 numbers, row by row", &found));
        }
        if let Some(number) = numbers.iter().find(|number| !number.is_finite()) {
            return Err(self.fault(value, "finite numbers", &number.to_string()));
        }
        let (rows, last) = numbers.split_at(12);
        if !last.is_empty() && last != [0.0, 0.0, 0.0, 1.0] {
            let found = format!("{last:?}");
            return Err(self.fault(value, "0, 0, 0, 1 as a matrix's last row", &found));
        }
        let column = |at: usize| DVec3::new(rows[at], rows[4 + at], rows[8 + at]);
        Ok(DAffine3 {
            matrix3: DMat3::from_cols(column(0), column(1), column(2)),
            translation: column(3),
        })
    }

    /// The index of each object's parent, which must exist, have a unique name, and be no descendant.
    fn parents(&self, tables: &[Spanned<ObjectToml>]) -> Result<Vec<Option<usize>>, FormatError> {
        let mut named: HashMap<&str, Vec<usize>> = HashMap::new();
        for (index, table) in tables.iter().enumerate() {
            if let Some(name) = &table.get_ref().name {
                named.entry(name).or_default().push(index);
            }
        }
        let parent_of = |table: &Spanned<ObjectToml>| {
            let Some(parent) = &table.get_ref().parent else {
                return Ok(None);
            };
            match named.get(parent.get_ref().as_str()).map(Vec::as_slice) {
                Some(&[index]) => Ok(Some(index)),
                None | Some([]) => {
                    let found = quote(parent.get_ref());
                    Err(self.fault(parent, "the name of an object as parent", &found))
                }
                Some(several) => {
                    let found = format!("{} of {} objects", quote(parent.get_ref()), several.len());
                    Err(self.fault(parent, "the name of one object as parent", &found))
                }
            }
        };
        let parents: Vec<Option<usize>> = tables.iter().map(parent_of).collect::<Result<_, _>>()?;
        for (start, table) in tables.iter().enumerate() {
            let Some(parent) = &table.get_ref().parent else {
                continue;
            };
            let mut ancestors = std::iter::successors(parents[start], |&index| parents[index]);
            if ancestors
                .by_ref()
                .take(ANCESTOR_LIMIT)
                .any(|index| index == start)
            {
                let found = format!("{}, its own descendant", quote(parent.get_ref()));
                return Err(self.fault(parent, "a parent that is no descendant", &found));
            }
            if ancestors.next().is_some() {
                let expected = format!("at most {ANCESTOR_LIMIT} ancestors");
                return Err(self.fault(parent, &expected, "more"));
            }
        }
        Ok(parents)
    }
}
