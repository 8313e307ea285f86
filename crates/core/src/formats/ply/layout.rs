//! The meaning of a PLY's properties.

use super::header::{Element, Property, Scalar};
use crate::scene::Color;
use glam::{DVec3, Vec2, Vec3};

/// No index: a corner without a value.
pub(super) const NONE: u32 = u32::MAX;

/// The meaning of a property: an index into [`Row`].
pub(super) type Role = usize;

/// The numbers of a vertex or a face.
pub(super) type Row = [f64; UNUSED + 1];

pub(super) const POSITION: Role = 0;
pub(super) const NORMAL: Role = 3;
pub(super) const COLOR: Role = 6;
pub(super) const UV: Role = 9;
/// Properties that are not used.
pub(super) const UNUSED: Role = 11;
/// Scalars, numbered from here: they have columns of their own, and no entry in a [`Row`].
pub(super) const SCALAR: Role = 12;

/// The properties of a vertex or a face, and the meaning of each.
pub(super) struct Layout {
    pub(super) properties: Vec<(Property, Role)>,
    /// The factor that scales a colour's channel to 0 to 255.
    color_scale: f64,
}

impl Layout {
    /// Finds each group of properties of which an element has all names.
    pub(super) fn new(element: &Element, groups: &[(&[&str], Role)]) -> Self {
        let properties = element.properties.iter();
        let mut properties: Vec<_> = properties.map(|p| (p.clone(), UNUSED)).collect();
        let mut color_scale = 1.0;
        for &(names, role) in groups {
            let found: Option<Vec<usize>> = names
                .iter()
                .map(|name| {
                    let is_it = |(p, _): &(Property, Role)| p.length.is_none() && p.name == *name;
                    properties.iter().position(is_it)
                })
                .collect();
            let is_taken = properties.iter().any(|(_, taken)| *taken == role);
            if let Some(found) = found.filter(|_| !is_taken) {
                if role == COLOR {
                    color_scale = match properties[found[0]].0.kind {
                        Scalar::F32 | Scalar::F64 => 255.0,
                        Scalar::U16 => 255.0 / 65535.0,
                        _ => 1.0,
                    };
                }
                for (offset, property) in found.into_iter().enumerate() {
                    properties[property].1 = role + offset;
                }
            }
        }
        Self {
            properties,
            color_scale,
        }
    }

    pub(super) fn has(&self, role: Role) -> bool {
        self.properties.iter().any(|(_, of)| *of == role)
    }

    /// The size of an element in a binary file; `None` with lists, whose lengths vary.
    pub(super) fn stride(&self) -> Option<usize> {
        let bytes = |(property, _): &(Property, Role)| match property.length {
            None => Some(property.kind.bytes()),
            Some(_) => None,
        };
        self.properties.iter().map(bytes).sum()
    }

    pub(super) fn color(&self, row: &Row) -> Color {
        // A cast saturates, and maps NaN to 0.
        let byte = |channel: usize| (row[COLOR + channel] * self.color_scale).round() as u8;
        Color([byte(0), byte(1), byte(2)])
    }

    /// Makes scalars of all unused numbers; returns their names.
    pub(super) fn take_scalars(&mut self) -> Vec<String> {
        let mut names: Vec<String> = Vec::new();
        for (property, role) in &mut self.properties {
            let is_number = property.length.is_none() && *role == UNUSED;
            if is_number && !names.contains(&property.name) {
                *role = SCALAR + names.len();
                names.push(property.name.clone());
            }
        }
        names
    }

    /// The names of unused properties.
    pub(super) fn unused(&self) -> Vec<String> {
        let unused = self.properties.iter().filter(|(_, role)| *role == UNUSED);
        unused.map(|(property, _)| property.name.clone()).collect()
    }
}

/// The vertices' values, as columns; a column that the file lacks is empty.
pub(super) struct Columns<'a> {
    pub(super) positions: &'a mut [DVec3],
    pub(super) normals: &'a mut [Vec3],
    pub(super) colors: &'a mut [Option<Color>],
    pub(super) uvs: &'a mut [Vec2],
    pub(super) scalars: Vec<&'a mut [f32]>,
}

impl<'a> Columns<'a> {
    pub(super) fn len(&self) -> usize {
        self.positions.len()
    }

    /// The first `count` rows, and the rest.
    pub(super) fn split(self, count: usize) -> (Self, Self) {
        let (positions, more_positions) = self.positions.split_at_mut(count);
        let (normals, more_normals) = self.normals.split_at_mut(count.min(self.normals.len()));
        let (colors, more_colors) = self.colors.split_at_mut(count.min(self.colors.len()));
        let (uvs, more_uvs) = self.uvs.split_at_mut(count.min(self.uvs.len()));
        let split = |scalar: &'a mut [f32]| scalar.split_at_mut(count);
        let (scalars, more_scalars) = self.scalars.into_iter().map(split).unzip();
        let first = Self {
            positions,
            normals,
            colors,
            uvs,
            scalars,
        };
        let others = Self {
            positions: more_positions,
            normals: more_normals,
            colors: more_colors,
            uvs: more_uvs,
            scalars: more_scalars,
        };
        (first, others)
    }

    /// Stores a scalar of a vertex.
    #[inline]
    pub(super) fn set_scalar(&mut self, index: usize, role: Role, value: f64) {
        if let Some(scalar) = self.scalars.get_mut(role - SCALAR) {
            scalar[index] = value as f32;
        }
    }

    #[inline]
    pub(super) fn set(&mut self, index: usize, row: &Row, layout: &Layout) {
        let three = |role| DVec3::new(row[role], row[role + 1], row[role + 2]);
        self.positions[index] = three(POSITION);
        if let Some(normal) = self.normals.get_mut(index) {
            *normal = three(NORMAL).normalize_or_zero().as_vec3();
        }
        if let Some(color) = self.colors.get_mut(index) {
            *color = Some(layout.color(row));
        }
        if let Some(uv) = self.uvs.get_mut(index) {
            *uv = Vec2::new(row[UV] as f32, row[UV + 1] as f32);
        }
    }
}

/// The index that a number represents; [`NONE`] if it is none.
pub(super) fn index(value: f64) -> u32 {
    let index = value as u32;
    if f64::from(index) == value {
        index
    } else {
        NONE
    }
}
