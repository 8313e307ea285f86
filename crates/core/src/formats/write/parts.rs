//! A scene's meshes in world space, as writers need them.

use super::written::Written;
use crate::scene::{
    Attribute, Bounds, COORDINATE_LIMIT, Color, Mesh, Object, Scene, SceneError, is_storable,
    recentring_offset,
};
use glam::{DAffine3, DVec3, Vec2, Vec3};
use std::borrow::Cow;
use std::collections::HashMap;
use std::fmt;

/// All visible objects, and properties of all of them together.
pub(super) struct Parts<'s> {
    pub(super) parts: Vec<Part<'s>>,
    hidden: usize,
    /// Whether every coordinate is a single-precision number.
    pub(super) is_single: bool,
    /// Whether the shortest decimals of single-precision numbers suffice: a reader in double precision rounds them to
    /// the same numbers, since it will not recentre the mesh.
    pub(super) short_decimals: bool,
}

/// An object's mesh in world space.
pub(super) struct Part<'s> {
    pub(super) object: &'s Object,
    pub(super) name: &'s str,
    pub(super) mesh: &'s Mesh,
    /// Vertices in world space; zero for those that cannot be written.
    pub(super) positions: Vec<DVec3>,
    /// How far rounding to double precision moves each vertex; empty if it moves none.
    rounded: Vec<f64>,
    /// By number; triangles whose corners cannot be written have one corner three times.
    pub(super) triangles: Cow<'s, [[u32; 3]]>,
    /// Normals in world space, of unit length or zero.
    pub(super) normals: Option<Attribute<Vec3>>,
    /// The offset to which positions should be relative, so that single precision represents them best.
    pub(super) offset: DVec3,
    emptied: u64,
}

/// Whether a vertex can be written: within twice the limit, since a mesh at the limit may have been moved.
fn is_writable(position: DVec3) -> bool {
    position.is_finite() && position.abs().max_element() <= 2.0 * COORDINATE_LIMIT
}

impl<'s> Parts<'s> {
    pub(super) fn new(scene: &'s Scene) -> Result<Self, SceneError> {
        let transforms = scene.world_from_objects()?;
        let objects = scene.objects.iter().zip(transforms);
        let parts: Vec<Part<'s>> = objects
            .filter(|(object, _)| object.visible)
            .map(|(object, place)| Part::new(object, place))
            .collect();
        let hidden = scene.objects.len() - parts.len();
        let is_single = parts
            .iter()
            .flat_map(|part| &part.positions)
            .all(|position| {
                position
                    .to_array()
                    .iter()
                    .all(|&number| f64::from(number as f32) == number)
            });
        let bounds = parts
            .iter()
            .map(Part::bounds)
            .fold(Bounds::EMPTY, Bounds::union);
        // The ends of the bounding box as a reader finds them: rounding decimals is monotone.
        let read = |end: DVec3| {
            DVec3::from_array(end.to_array().map(|number| {
                let decimals = Shortest(number as f32).to_string();
                decimals.parse().unwrap_or(number)
            }))
        };
        let as_read = Bounds {
            min: read(bounds.min),
            max: read(bounds.max),
        };
        let short_decimals = is_single
            && recentring_offset(&bounds) == DVec3::ZERO
            && recentring_offset(&as_read) == DVec3::ZERO;
        Ok(Self {
            parts,
            hidden,
            is_single,
            short_decimals,
        })
    }

    /// The summary of writing in any format, before single precision moves anything.
    pub(super) fn written(&self) -> Written {
        let mut written = Written::default();
        for part in &self.parts {
            written.triangles += part.triangles.len() as u64;
            written.vertices += part.positions.len() as u64;
            written.dropped += u64::from(part.mesh.dropped().total());
            written.emptied += part.emptied;
        }
        if self.hidden > 0 {
            let count = self.hidden;
            written.lost.push(format!("hidden objects ({count})"));
        }
        written
    }

    /// Counts the vertices that are moved by being stored; `stored` gives the part of a position that is stored.
    pub(super) fn count_moves(
        &self,
        written: &mut Written,
        stored: impl Fn(&Part<'_>, DVec3) -> DVec3,
    ) {
        for part in &self.parts {
            let mut is_met = vec![false; part.positions.len()];
            for &number in part.mesh.kept() {
                for vertex in part.triangles[number as usize] {
                    is_met[vertex as usize] = true;
                }
            }
            for (vertex, position) in part.positions.iter().enumerate() {
                let rounded = part.rounded.get(vertex).copied().unwrap_or(0.0);
                let moved = (stored(part, *position) - *position).length() + rounded;
                if moved > 0.0 && is_met[vertex] {
                    written.moved += 1;
                    written.largest_move = written.largest_move.max(moved);
                }
            }
        }
    }

    /// A number as text.
    pub(super) fn decimal(&self, number: f64) -> Decimal {
        if self.short_decimals {
            Decimal::Single(Shortest(number as f32))
        } else {
            Decimal::Double(Shortest(number))
        }
    }

    pub(super) fn has(&self, is_there: impl Fn(&Part<'s>) -> bool) -> bool {
        self.parts.iter().any(is_there)
    }

    /// Records what a format of corners only loses.
    pub(super) fn record_lost_attributes(&self, written: &mut Written) {
        type Has = fn(&Mesh) -> bool;
        let kinds: [(&str, Has); 4] = [
            ("normals", Mesh::has_normals),
            ("texture coordinates", Mesh::has_uvs),
            ("colours of vertices", |mesh| {
                !mesh.vertex_colors().is_empty()
            }),
            ("materials", |mesh| !mesh.materials().is_empty()),
        ];
        for (name, has) in kinds {
            if self.has(|part| has(part.mesh)) {
                written.lost.push(name.to_owned());
            }
        }
        self.record_lost_names(written);
    }

    /// Records that a format without objects loses their names.
    pub(super) fn record_lost_names(&self, written: &mut Written) {
        if let count @ 2.. = self.parts.len() {
            written.lost.push(format!("that there are {count} objects"));
        }
    }
}

impl<'s> Part<'s> {
    fn new(object: &'s Object, world_from_object: DAffine3) -> Self {
        let mesh = &*object.mesh;
        let offset = mesh.offset();
        let at_rest = world_from_object == DAffine3::IDENTITY;
        let mut positions: Vec<DVec3> = mesh
            .positions()
            .iter()
            .map(|corner| {
                let in_object = offset + corner.as_dvec3();
                if at_rest {
                    in_object
                } else {
                    // As the tree places it.
                    world_from_object.transform_point3(in_object)
                }
            })
            .collect();
        let mut rounded = Vec::new();
        if at_rest && offset != DVec3::ZERO {
            let pairs = positions.iter().zip(mesh.positions());
            rounded = pairs
                .map(|(sum, p)| sum_error(offset, p.as_dvec3(), *sum))
                .collect();
            if !rounded.iter().any(|moved| *moved > 0.0) {
                rounded.clear();
            }
        }
        let mut emptied = 0;
        let mut triangles = Cow::Borrowed(mesh.triangles());
        let can_write = |triangle: &[u32; 3]| {
            let mut corners = triangle.iter();
            corners.all(|&i| positions.get(i as usize).is_some_and(|p| is_writable(*p)))
        };
        if !triangles.iter().all(can_write) {
            let written = triangles.iter().map(|triangle| {
                if can_write(triangle) {
                    return *triangle;
                }
                emptied += 1;
                [0; 3]
            });
            triangles = Cow::Owned(written.collect());
            if positions.is_empty() {
                positions.push(DVec3::ZERO);
            }
        }
        for position in &mut positions {
            if !is_writable(*position) {
                *position = DVec3::ZERO;
            }
        }
        let normal_matrix = world_from_object.matrix3.inverse().transpose();
        let normals = mesh.normals().map(|normals| Attribute {
            values: if at_rest {
                normals.values.clone()
            } else {
                let turn = |normal: &Vec3| {
                    let turned = normal_matrix * normal.as_dvec3();
                    turned.normalize_or_zero().as_vec3()
                };
                normals.values.iter().map(turn).collect()
            },
            indices: normals.indices.clone(),
        });
        let mut part = Self {
            object,
            name: &object.name,
            mesh,
            positions,
            rounded,
            triangles,
            normals,
            offset,
            emptied,
        };
        if !at_rest {
            part.offset = recentring_offset(&part.bounds());
        }
        part
    }

    /// The bounding box that a reader finds around all triangles that it can store.
    fn bounds(&self) -> Bounds {
        let all = self
            .triangles
            .iter()
            .map(|triangle| self.corners(*triangle));
        let storable = all.filter(|corners| corners.iter().all(|c| is_storable(*c)));
        Bounds::around(storable.flatten())
    }

    /// The corners of a triangle.
    pub(super) fn corners(&self, triangle: [u32; 3]) -> [DVec3; 3] {
        triangle.map(|corner| self.positions[corner as usize])
    }

    /// A colour a vertex, if every triangle has one at each corner.
    pub(super) fn vertex_colors(&self) -> Option<Vec<Color>> {
        let colors = self.mesh.vertex_colors();
        let color = |vertex: u32| colors.get(vertex as usize).copied().flatten();
        let mut corners = self.triangles.as_flattened().iter();
        if colors.is_empty() || !corners.all(|&corner| color(corner).is_some()) {
            return None;
        }
        let all = 0..self.positions.len() as u32;
        Some(
            all.map(|vertex| color(vertex).unwrap_or(Color::DEFAULT))
                .collect(),
        )
    }

    /// Vertices for formats in which all attributes of a vertex share an index: one for each combination of position,
    /// normal and texture coordinates.
    pub(super) fn join_attributes(&self) -> JoinedMesh {
        let normals = self.normals.as_ref();
        let uvs = self.mesh.uvs();
        let unit_channel = normals.is_none_or(|n| n.indices.is_none())
            && uvs.is_none_or(|uvs| uvs.indices.is_none());
        if unit_channel {
            let all = 0..self.positions.len() as u32;
            return JoinedMesh {
                vertices: all.map(|vertex| [vertex; 3]).collect(),
                triangles: self.triangles.to_vec(),
            };
        }
        let mut numbers: HashMap<[u32; 3], u32> = HashMap::new();
        let mut vertices = Vec::new();
        let indices = |indices: Option<&Vec<[u32; 3]>>, number: usize, triangle: [u32; 3]| {
            indices.map_or(triangle, |all| {
                all.get(number).copied().unwrap_or([u32::MAX; 3])
            })
        };
        let normal_indices = normals.and_then(|normals| normals.indices.as_ref());
        let uv_indices = uvs.and_then(|uvs| uvs.indices.as_ref());
        let join_attributes = self
            .triangles
            .iter()
            .enumerate()
            .map(|(number, &triangle)| {
                let normal = indices(normal_indices, number, triangle);
                let uv = indices(uv_indices, number, triangle);
                [0, 1, 2].map(|corner| {
                    let vertex = [triangle[corner], normal[corner], uv[corner]];
                    *numbers.entry(vertex).or_insert_with(|| {
                        vertices.push(vertex);
                        vertices.len() as u32 - 1
                    })
                })
            });
        let triangles = join_attributes.collect();
        JoinedMesh {
            vertices,
            triangles,
        }
    }

    /// A normal by its index; zero where there is none.
    pub(super) fn normal(&self, index: u32) -> Vec3 {
        let values = self.normals.as_ref().map(|normals| &normals.values);
        values
            .and_then(|values| values.get(index as usize))
            .copied()
            .unwrap_or(Vec3::ZERO)
    }

    /// Texture coordinates by their index; zero where there are none.
    pub(super) fn uv(&self, index: u32) -> Vec2 {
        let values = self.mesh.uvs().map(|uvs| &uvs.values);
        let uv = values
            .and_then(|values| values.get(index as usize))
            .copied();
        uv.filter(|uv| uv.is_finite()).unwrap_or(Vec2::ZERO)
    }
}

/// Vertices as combinations of position, normal and texture coordinates, by their indices; and triangles of them.
pub(super) struct JoinedMesh {
    pub(super) vertices: Vec<[u32; 3]>,
    pub(super) triangles: Vec<[u32; 3]>,
}

/// The rounding error of a sum (Møller, "Quasi double-precision in floating point addition", 1965).
fn sum_error(a: DVec3, b: DVec3, sum: DVec3) -> f64 {
    let part = sum - a;
    ((a - (sum - part)) + (b - part)).length()
}

/// A number as the shortest decimal that reads back as the same.
pub(super) enum Decimal {
    Single(Shortest<f32>),
    Double(Shortest<f64>),
}

impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Single(number) => number.fmt(f),
            Self::Double(number) => number.fmt(f),
        }
    }
}

/// The shortest decimal, with an exponent where that saves many zeros.
pub(super) struct Shortest<T>(pub(super) T);

impl<T: Copy + Into<f64> + fmt::Display + fmt::LowerExp> fmt::Display for Shortest<T> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.into().abs();
        if size == 0.0 || (1e-5..1e16).contains(&size) {
            fmt::Display::fmt(&self.0, f)
        } else {
            fmt::LowerExp::fmt(&self.0, f)
        }
    }
}

/// A name on one line.
pub(super) fn one_line(name: &str) -> String {
    let line: String = name
        .chars()
        .map(|c| if c.is_control() { ' ' } else { c })
        .collect();
    line.trim().to_owned()
}
