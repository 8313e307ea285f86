//! A PLY's faces: polygons, with colours, texture coordinates and other numbers.

use super::header::{Element, Scalar as Kind};
use super::layout::{COLOR, Layout, NONE, POSITION, Row, SCALAR, UNUSED, index};
use super::reader::Reader;
use super::values::Values;
use crate::formats::error::FormatError;
use crate::formats::polygon::Polygon;
use crate::scene::{Color, Scalar, ScalarAt};
use glam::Vec2;
use std::mem::size_of;
use std::ops::Range;

/// What the properties of faces mean.
struct FaceLayout {
    layout: Layout,
    /// The index of the list of vertex indices among the properties.
    indices: usize,
    /// That of the list of the corners' texture coordinates.
    texcoords: Option<usize>,
    has_colors: bool,
    /// The names of the faces' scalars.
    scalars: Vec<String>,
}

impl FaceLayout {
    /// `None` without a list of vertex indices.
    fn new(element: &Element) -> Option<Self> {
        let mut layout = Layout::new(element, &[(&["red", "green", "blue"], COLOR)]);
        let list = |names: &[&str]| {
            let mut properties = layout.properties.iter();
            properties.position(|(property, _)| {
                property.length.is_some() && names.contains(&property.name.as_str())
            })
        };
        let indices = list(&["vertex_indices", "vertex_index"])?;
        let texcoords = list(&["texcoord"]);
        // Marked as used.
        for index in [Some(indices), texcoords].into_iter().flatten() {
            layout.properties[index].1 = POSITION;
        }
        Some(Self {
            indices,
            texcoords,
            has_colors: layout.has(COLOR),
            scalars: layout.take_scalars(),
            layout,
        })
    }
}

/// A face as it is read.
#[derive(Default)]
struct Face {
    row: Row,
    corners: Vec<u32>,
    uvs: Vec<f32>,
    scalars: Vec<f32>,
}

impl<V: Values> Reader<'_, V> {
    pub(super) fn faces(
        &mut self,
        element: &Element,
        step: &dyn Fn(f32),
    ) -> Result<(), FormatError> {
        let count = self.count(element)?;
        let Some(mut faces) = FaceLayout::new(element) else {
            if count == 0 {
                return Ok(());
            }
            let expected = "faces with a list `vertex_indices` or `vertex_index`";
            return Err(self.other_properties(element, expected));
        };
        // MeshLab gives both vertices and faces a `quality`.
        for name in &mut faces.scalars {
            if self.mesh.scalars.iter().any(|scalar| scalar.name == *name) {
                name.push_str(" of faces");
            }
        }
        self.note_scalars("faces", &faces.scalars);
        self.note_unused("faces", faces.layout.unused());
        let values = match self.plain_triangles(&faces, count)? {
            Some(values) => values,
            None => self.polygons(element, &faces, count, step)?,
        };
        self.face_scalars = named(faces.scalars, values);
        if !self.uv_triangles.is_empty() {
            let triangles = self.mesh.triangles.len();
            self.uv_triangles.resize(triangles, [NONE; 3]);
        }
        Ok(())
    }

    /// Reads all faces at once if all are triangles, as in most files, and returns their scalars; `None` otherwise, with
    /// nothing read.
    fn plain_triangles(
        &mut self,
        faces: &FaceLayout,
        count: usize,
    ) -> Result<Option<Vec<Vec<f32>>>, FormatError> {
        let has_more = faces.texcoords.is_some() || faces.has_colors;
        if has_more
            || !self.mesh.triangles.is_empty()
            || count as u64 > self.budget.triangles_left()
        {
            return Ok(None);
        }
        let each = size_of::<[u32; 3]>() + faces.scalars.len() * size_of::<f32>();
        let bytes = count as u64 * each as u64;
        drop(self.budget.share(self.path, "the mesh", bytes)?);
        let mut values = vec![Vec::new(); faces.scalars.len()];
        let (layout, indices) = (&faces.layout, faces.indices);
        let read = (self.values).triangles(layout, indices, count, self.vertices, &mut values);
        Ok(read.map(|triangles| {
            self.mesh.triangles = triangles;
            values
        }))
    }

    /// Reads faces one by one; returns the scalars of all triangles so far.
    fn polygons(
        &mut self,
        element: &Element,
        faces: &FaceLayout,
        count: usize,
        step: &dyn Fn(f32),
    ) -> Result<Vec<Vec<f32>>, FormatError> {
        let mut share = self.budget.share(self.path, "the mesh", 0)?;
        let first = self.mesh.triangles.len();
        let mut values = vec![vec![f32::NAN; first]; faces.scalars.len()];
        let mut face = Face {
            scalars: vec![0.0; faces.scalars.len()],
            ..Face::default()
        };
        for number in 0..count {
            self.read_face(element, faces, &mut face)?;
            let before = self.mesh.triangles.len();
            self.add_fan(&face.corners)?;
            let after = self.mesh.triangles.len();
            for (values, value) in values.iter_mut().zip(&face.scalars) {
                values.resize(after, *value);
            }
            if faces.has_colors {
                self.face_colors.resize(before, None);
                self.face_colors
                    .resize(after, Some(faces.layout.color(&face.row)));
            }
            self.add_corner_uvs(&face, before..after);
            if number % 16_384 == 0 {
                let held = self.face_bytes() + values.len() * after * size_of::<f32>();
                // A full list doubles, and the old one exists until the new one is filled.
                share.grow(self.path, "the mesh", 3 * held as u64)?;
                step(number as f32 / count as f32);
            }
        }
        Ok(values)
    }

    /// The bytes of what faces have added so far.
    fn face_bytes(&self) -> usize {
        self.mesh.triangles.len() * size_of::<[u32; 3]>()
            + self.polygons.len() * size_of::<Polygon>()
            + self.corner_uvs.len() * size_of::<Vec2>()
            + self.uv_triangles.len() * size_of::<[u32; 3]>()
            + self.face_colors.len() * size_of::<Option<Color>>()
    }

    fn read_face(
        &mut self,
        element: &Element,
        faces: &FaceLayout,
        face: &mut Face,
    ) -> Result<(), FormatError> {
        face.row = [0.0; UNUSED + 1];
        face.corners.clear();
        face.uvs.clear();
        for (index, (property, role)) in faces.layout.properties.iter().enumerate() {
            let read = match property.length {
                None => {
                    (self.values.value(property.kind)).map(|value| match face.row.get_mut(*role) {
                        Some(index) => *index = value,
                        None => face.scalars[*role - SCALAR] = value as f32,
                    })
                }
                Some(length) if index == faces.indices => {
                    self.corners(length, property.kind, &mut face.corners)?;
                    Ok(())
                }
                Some(length) if Some(index) == faces.texcoords => {
                    let push = |value: f64| face.uvs.push(value as f32);
                    self.values.list(length, property.kind, push)
                }
                Some(length) => self.values.list(length, property.kind, |_| ()),
            };
            read.map_err(|found| self.fault(element, &found))?;
        }
        Ok(())
    }

    /// Adds the texture coordinates of a face's corners, if it has some for each, for the triangles that it became.
    fn add_corner_uvs(&mut self, face: &Face, triangles: Range<usize>) {
        let Face { corners, uvs, .. } = face;
        let is_complete = uvs.len() == 2 * corners.len() && uvs.iter().all(|uv| uv.is_finite());
        if !is_complete || triangles.is_empty() {
            return;
        }
        let (pairs, _) = uvs.as_chunks::<2>();
        let first = self.corner_uvs.len() as u32;
        self.corner_uvs
            .extend(pairs.iter().map(|uv| Vec2::from_array(*uv)));
        self.uv_triangles.resize(triangles.start, [NONE; 3]);
        let fan = 1..corners.len() as u32 - 1;
        let triangles = fan.map(|next| [first, first + next, first + next + 1]);
        self.uv_triangles.extend(triangles);
    }

    /// The indices of a list, after checking them against the number of vertices.
    fn corners(
        &mut self,
        length: Kind,
        kind: Kind,
        corners: &mut Vec<u32>,
    ) -> Result<(), FormatError> {
        let read = self
            .values
            .list(length, kind, |value| corners.push(index(value)));
        read.map_err(|found| {
            self.values
                .fault(self.path, "a list of vertex indices", &found)
        })?;
        match corners.iter().find(|corner| **corner >= self.vertices) {
            None => Ok(()),
            Some(_) => Err(self.bad_index()),
        }
    }

    /// Adds a face as a fan.
    fn add_fan(&mut self, corners: &[u32]) -> Result<(), FormatError> {
        let [first, second, ref rest @ ..] = *corners else {
            self.small += 1;
            return Ok(());
        };
        if rest.is_empty() {
            self.small += 1;
            return Ok(());
        }
        self.check_sum(rest.len())?;
        if rest.len() > 1 {
            self.polygons.push(Polygon {
                first: self.mesh.triangles.len() as u32,
                triangles: rest.len() as u32,
            });
        }
        let mut last = second;
        for &next in rest {
            self.mesh.triangles.push([first, last, next]);
            last = next;
        }
        Ok(())
    }
}

/// Makes scalars of faces.
fn named(names: Vec<String>, values: Vec<Vec<f32>>) -> Vec<Scalar> {
    let at = ScalarAt::Triangles;
    let scalars = names.into_iter().zip(values);
    scalars
        .map(|(name, values)| Scalar { name, at, values })
        .collect()
}
