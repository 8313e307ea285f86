use super::header::Element;
use super::layout::{COLOR, Columns, Layout, NONE, NORMAL, POSITION, UV, index};
use super::values::Values;
use crate::formats::error::FormatError;
use crate::formats::limits::Budget;
use crate::formats::polygon::Polygon;
use crate::formats::tokens::Found;
use crate::quote;
use crate::scene::{Color, MeshData, Scalar, ScalarAt};
use bytemuck::allocation::zeroed_vec;
use glam::{DVec3, Vec2, Vec3};
use std::mem::size_of;
use std::path::Path;

/// Reads a PLY's elements.
pub(super) struct Reader<'a, V> {
    pub(super) path: &'a Path,
    pub(super) budget: &'a Budget,
    pub(super) values: V,
    /// The number of vertices that the header declares.
    pub(super) vertices: u32,
    pub(super) mesh: MeshData,
    pub(super) normals: Vec<Vec3>,
    pub(super) uvs: Vec<Vec2>,
    pub(super) polygons: Vec<Polygon>,
    /// Texture coordinates at faces' corners, and the triangles that use them.
    pub(super) corner_uvs: Vec<Vec2>,
    pub(super) uv_triangles: Vec<[u32; 3]>,
    /// A colour a triangle, where faces have colours.
    pub(super) face_colors: Vec<Option<Color>>,
    /// Other numbers of faces: a value a triangle.
    pub(super) face_scalars: Vec<Scalar>,
    /// Faces of fewer than three corners.
    pub(super) small: usize,
    pub(super) notes: Vec<String>,
}

impl<V: Values> Reader<'_, V> {
    #[cold]
    pub(super) fn fault(&self, element: &Element, found: &Found) -> FormatError {
        let expected = format!("a number of element {}", plain(&element.name));
        self.values.fault(self.path, &expected, found)
    }

    /// The error for an element that lacks properties.
    pub(super) fn other_properties(&self, element: &Element, expected: &str) -> FormatError {
        let found = element.property_names();
        FormatError::unexpected(self.path, Some(element.line), expected, found)
    }

    /// An element's count, after checking that the file is long enough for it.
    pub(super) fn count(&self, element: &Element) -> Result<usize, FormatError> {
        let least: u64 = element
            .properties
            .iter()
            .map(|property| V::min_bytes(property.length.unwrap_or(property.kind)) as u64)
            .sum();
        let left = self.values.left() as u64;
        // The last number of a text needs no separator after it.
        if least > 0 && element.count > (left + 1) / least {
            let expected = format!("{} of element {}", element.count, plain(&element.name));
            let found = Found::Word(format!("{left} bytes for them: it is cut short"));
            return Err(self.values.fault(self.path, &expected, &found));
        }
        let count = usize::try_from(element.count).unwrap_or(usize::MAX);
        // Elements without properties take no bytes, so their count means nothing.
        Ok(if least == 0 { 0 } else { count })
    }

    pub(super) fn vertices(
        &mut self,
        element: &Element,
        step: &dyn Fn(f32),
    ) -> Result<(), FormatError> {
        let mut layout = Layout::new(
            element,
            &[
                (&["x", "y", "z"], POSITION),
                (&["nx", "ny", "nz"], NORMAL),
                (&["red", "green", "blue"], COLOR),
                (&["diffuse_red", "diffuse_green", "diffuse_blue"], COLOR),
                (&["r", "g", "b"], COLOR),
                (&["s", "t"], UV),
                (&["u", "v"], UV),
                (&["texture_u", "texture_v"], UV),
                (&["texture_s", "texture_t"], UV),
            ],
        );
        if !layout.has(POSITION) {
            let expected = "vertices with properties `x`, `y` and `z`";
            return Err(self.other_properties(element, expected));
        }
        let scalars = layout.take_scalars();
        self.note_scalars("vertices", &scalars);
        self.note_unused("vertices", layout.unused());
        let count = self.count(element)?;
        let of = |role| if layout.has(role) { count } else { 0 };
        let (normals, colors, uvs) = (of(NORMAL), of(COLOR), of(UV));
        let bytes = count * size_of::<DVec3>()
            + normals * size_of::<Vec3>()
            + colors * size_of::<Option<Color>>()
            + uvs * size_of::<Vec2>()
            + scalars.len() * count * size_of::<f32>();
        // Counted again as a mesh once all is read.
        drop(self.budget.share(self.path, "the mesh", bytes as u64)?);
        // Memory that the system has cleared: the threads that fill it are the first to touch it.
        self.mesh.positions = zeroed_vec(count);
        self.mesh.colors = vec![None; colors];
        self.normals = zeroed_vec(normals);
        self.uvs = zeroed_vec(uvs);
        let scalar = |name| Scalar {
            name,
            at: ScalarAt::Vertices,
            values: vec![0.0; count],
        };
        self.mesh.scalars = scalars.into_iter().map(scalar).collect();
        let columns = Columns {
            positions: &mut self.mesh.positions,
            normals: &mut self.normals,
            colors: &mut self.mesh.colors,
            uvs: &mut self.uvs,
            scalars: self
                .mesh
                .scalars
                .iter_mut()
                .map(|s| &mut *s.values)
                .collect(),
        };
        let read = self.values.vertices(&layout, columns, step);
        read.map_err(|found| self.fault(element, &found))
    }

    pub(super) fn note_scalars(&mut self, of: &str, names: &[String]) {
        if !names.is_empty() {
            let names: Vec<_> = names.iter().map(|name| plain(name)).collect();
            let names = quote::shorten(&names.join(", "));
            self.notes.push(format!("scalars of {of}: {names}"));
        }
    }

    pub(super) fn note_unused(&mut self, of: &str, unused: Vec<String>) {
        if !unused.is_empty() {
            let names: Vec<_> = unused.iter().map(|name| plain(name)).collect();
            let names = quote::shorten(&names.join(", "));
            self.notes
                .push(format!("not used: properties of {of}: {names}"));
        }
    }

    #[cold]
    pub(super) fn bad_index(&self) -> FormatError {
        let expected = match self.vertices {
            0 => "vertices in the file".to_owned(),
            vertices => format!("vertex indices from 0 to {}", vertices - 1),
        };
        let found = Found::Word("another in the list that ends here".to_owned());
        self.values.fault(self.path, &expected, &found)
    }

    pub(super) fn check_sum(&self, more: usize) -> Result<(), FormatError> {
        let sum = (self.mesh.triangles.len() + more) as u64;
        if sum > self.budget.triangles_left() {
            self.budget.add_triangles(self.path, sum)?;
        }
        Ok(())
    }

    /// Triangle strips, each ended by −1; every second triangle is reversed.
    pub(super) fn strips(&mut self, element: &Element) -> Result<(), FormatError> {
        let count = self.count(element)?;
        let mut share = self.budget.share(self.path, "the mesh", 0)?;
        for _ in 0..count {
            for property in &element.properties {
                let is_strip = ["vertex_indices", "vertex_index"].contains(&&*property.name);
                let read = match property.length {
                    None => self.values.value(property.kind).map(|_| ()),
                    Some(length) if !is_strip => self.values.list(length, property.kind, |_| ()),
                    Some(length) => {
                        let mut strip = Vec::new();
                        let push = |value: f64| strip.push((value != -1.0).then(|| index(value)));
                        let read = self.values.list(length, property.kind, push);
                        let held = (size_of::<[u32; 3]>() + 8) * strip.len();
                        share.grow(self.path, "the mesh", 3 * held as u64)?;
                        for strip in strip.split(Option::is_none) {
                            self.check_sum(strip.len())?;
                            for (number, corners) in strip.windows(3).enumerate() {
                                let corner = |i: usize| corners[i].unwrap_or(NONE);
                                let [a, b, c] = [0, 1, 2].map(corner);
                                if [a, b, c].iter().any(|corner| *corner >= self.vertices) {
                                    return Err(self.bad_index());
                                }
                                let turned = if number % 2 == 0 {
                                    [a, b, c]
                                } else {
                                    [b, a, c]
                                };
                                self.mesh.triangles.push(turned);
                            }
                        }
                        read
                    }
                };
                read.map_err(|found| self.fault(element, &found))?;
            }
        }
        Ok(())
    }

    /// Skips an element.
    pub(super) fn pass(&mut self, element: &Element) -> Result<(), FormatError> {
        for _ in 0..self.count(element)? {
            for property in &element.properties {
                let read = match property.length {
                    None => self.values.value(property.kind).map(|_| ()),
                    Some(length) => self.values.list(length, property.kind, |_| ()),
                };
                read.map_err(|found| self.fault(element, &found))?;
            }
        }
        Ok(())
    }
}

/// A name of the file, quoted where it contains unusual characters.
pub(super) fn plain(name: &str) -> String {
    let is_plain = name.bytes().all(|byte| byte.is_ascii_graphic());
    if is_plain {
        quote::shorten(name)
    } else {
        quote::quote(name)
    }
}
