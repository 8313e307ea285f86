//! A model: polygons with materials, and their Wavefront OBJ text with its MTL library.

use std::fmt::Write;

use glam::{DVec2, DVec3};

/// Decimals of a position in the file.
pub(crate) const POSITION_DECIMALS: usize = 5;
const UV_DECIMALS: usize = 4;
const NORMAL_DECIMALS: usize = 3;

/// A diffuse colour with a name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Material {
    /// The name in `newmtl` and `usemtl`.
    pub name: &'static str,
    /// The diffuse colour, 8-bit sRGB.
    pub srgb: [u8; 3],
}

impl Material {
    /// A material of the colour `0xRRGGBB`.
    pub(crate) const fn new(name: &'static str, rgb: u32) -> Self {
        let [_, red, green, blue] = rgb.to_be_bytes();
        Self {
            name,
            srgb: [red, green, blue],
        }
    }
}

/// Where a face's corner takes its attributes from: indices from 0 into a [`Model`]'s lists.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Corner {
    /// Index of the position.
    pub position: usize,
    /// Index of the texture coordinate.
    pub uv: usize,
    /// Index of the normal.
    pub normal: usize,
}

impl Corner {
    /// A corner whose three attributes stand at the same index.
    pub(crate) fn all(index: usize) -> Self {
        Self {
            position: index,
            uv: index,
            normal: index,
        }
    }
}

/// A polygon, counter-clockwise seen from outside.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Face {
    /// Index of the material.
    pub material: usize,
    /// Three corners or more.
    pub corners: Vec<Corner>,
}

/// Polygons with positions, texture coordinates, normals and materials.
#[derive(Clone, Debug, Default)]
pub struct Model {
    /// The name of the object and, without its ending, of both files.
    pub name: &'static str,
    /// One line about the model, written as a comment.
    pub about: &'static str,
    /// The materials that faces refer to.
    pub materials: Vec<Material>,
    /// Vertex positions, Y up, right-handed.
    pub positions: Vec<DVec3>,
    /// Texture coordinates, origin bottom-left.
    pub uvs: Vec<DVec2>,
    /// Unit normals.
    pub normals: Vec<DVec3>,
    /// The faces.
    pub faces: Vec<Face>,
}

impl Model {
    /// The number of triangles when every polygon is cut into a fan.
    pub(crate) fn triangle_count(&self) -> usize {
        self.faces.iter().map(|face| face.corners.len() - 2).sum()
    }

    /// The faces' triangles as indices of positions, a polygon's fan one after another.
    pub(crate) fn triangles(&self) -> impl Iterator<Item = [usize; 3]> {
        self.faces.iter().flat_map(|face| {
            (1..face.corners.len() - 1)
                .map(move |i| [0, i, i + 1].map(|corner| face.corners[corner].position))
        })
    }

    /// Appends a model's geometry to this one; `other`'s material numbers are meant in `self`.
    pub(crate) fn append(&mut self, other: Self) {
        let (position, uv, normal) = (self.positions.len(), self.uvs.len(), self.normals.len());
        self.positions.extend(other.positions);
        self.uvs.extend(other.uvs);
        self.normals.extend(other.normals);
        self.faces.extend(other.faces.into_iter().map(|mut face| {
            for corner in &mut face.corners {
                corner.position += position;
                corner.uv += uv;
                corner.normal += normal;
            }
            face
        }));
    }

    /// The model reflected in the plane `x = 0`.
    pub(crate) fn mirrored(&self) -> Self {
        let mut mirrored = self.clone();
        for vector in mirrored.positions.iter_mut().chain(&mut mirrored.normals) {
            vector.x = -vector.x;
        }
        for face in &mut mirrored.faces {
            face.corners.reverse();
        }
        mirrored
    }

    /// Gives each position a normal, the mean of its triangles' normals, and each corner the normal
    /// of its position.
    ///
    /// A triangle counts by its angle there: G. Thürmer and C. A. Wüthrich, "Computing vertex
    /// normals from polygonal facets", 1998.
    pub(crate) fn smooth_normals(&mut self) {
        self.normals = vec![DVec3::ZERO; self.positions.len()];
        for [a, b, c] in self.triangles().collect::<Vec<_>>() {
            for [here, next, last] in [[a, b, c], [b, c, a], [c, a, b]] {
                let [p, q, r] = [here, next, last].map(|i| self.positions[i]);
                let across = (q - p).cross(r - p);
                let angle = libm::atan2(across.length(), (q - p).dot(r - p));
                self.normals[here] += across.normalize() * angle;
            }
        }
        for normal in &mut self.normals {
            *normal = normal.normalize();
        }
        for corner in self.faces.iter_mut().flat_map(|face| &mut face.corners) {
            corner.normal = corner.position;
        }
    }

    /// The files of this model: `name.obj` and `name.mtl`.
    pub(crate) fn files(&self) -> Vec<(String, Vec<u8>)> {
        vec![
            (format!("{}.obj", self.name), self.to_obj().into_bytes()),
            (format!("{}.mtl", self.name), self.to_mtl().into_bytes()),
        ]
    }

    /// The OBJ text. Faces are grouped by material, in the materials' order.
    pub(crate) fn to_obj(&self) -> String {
        let mut text = String::new();
        let out = &mut text;
        line(out, format_args!("# {}", self.about));
        let count = self.triangle_count();
        line(out, format_args!("# {count} triangles. {}", crate::MADE_BY));
        line(out, format_args!("mtllib {}.mtl", self.name));
        line(out, format_args!("o {}", self.name));
        for position in &self.positions {
            let [x, y, z] = position.to_array().map(|v| decimal(v, POSITION_DECIMALS));
            line(out, format_args!("v {x} {y} {z}"));
        }
        for uv in &self.uvs {
            let [u, v] = uv.to_array().map(|v| decimal(v, UV_DECIMALS));
            line(out, format_args!("vt {u} {v}"));
        }
        for normal in &self.normals {
            let [x, y, z] = normal.to_array().map(|v| decimal(v, NORMAL_DECIMALS));
            line(out, format_args!("vn {x} {y} {z}"));
        }
        for (index, material) in self.materials.iter().enumerate() {
            let faces: Vec<_> = self
                .faces
                .iter()
                .filter(|face| face.material == index)
                .collect();
            if faces.is_empty() {
                continue;
            }
            line(out, format_args!("usemtl {}", material.name));
            for face in faces {
                out.push('f');
                for Corner {
                    position,
                    uv,
                    normal,
                } in &face.corners
                {
                    let _ = write!(out, " {}/{}/{}", position + 1, uv + 1, normal + 1);
                }
                out.push('\n');
            }
        }
        text
    }

    /// The MTL text: each material with its diffuse colour. MTL names no colour space; like most
    /// writers this one means sRGB.
    pub(crate) fn to_mtl(&self) -> String {
        let mut text = String::new();
        line(
            &mut text,
            format_args!("# The materials of {}.obj. Kd is sRGB.", self.name),
        );
        for Material { name, srgb } in &self.materials {
            let [r, g, b] = srgb.map(|channel| decimal(f64::from(channel) / 255.0, 4));
            line(&mut text, format_args!("newmtl {name}\nKd {r} {g} {b}"));
        }
        text
    }
}

/// The number with at most `decimals` decimals, without trailing zeros and without a negative zero.
pub(crate) fn decimal(value: f64, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    if text == "-0" {
        "0".into()
    } else {
        text.into()
    }
}

fn line(out: &mut String, text: std::fmt::Arguments) {
    // Writing to a String cannot fail.
    let _ = writeln!(out, "{text}");
}
