//! Meshes of shapes: a box, a rectangle, profiles revolved around y, and models made of polygons.

use super::{Attribute, Color, Diagonals, Material, MeshData, Shape, ShapeError};
use crate::math;
use glam::{DVec2, DVec3, Vec2, Vec3};
use raycast_assets::{Corner, Face, Model};
use std::f64::consts::TAU;

impl Shape {
    /// The mesh: outward normals, and texture coordinates that cover the image once; each face of a cube and each petal
    /// has all of it. The monkey's go past the image's edges behind the ears.
    ///
    /// # Errors
    /// As [`Shape::check`].
    pub fn mesh(&self) -> Result<MeshData, ShapeError> {
        self.check()?;
        let (flat, point) = (|normal: DVec2| [normal; 2], DVec2::new);
        let (up, outwards) = (DVec2::Y, DVec2::X);
        Ok(match *self {
            Self::Cube { size } => cube(size),
            Self::Plane { size } => plane(size),
            Self::Sphere {
                radius,
                segments,
                rings,
            } => sphere(radius, segments, rings),
            Self::Cone {
                radius,
                height,
                segments,
            } => {
                let half = height * 0.5;
                let profile = [point(0.0, -half), point(radius, -half), point(0.0, half)];
                let side = point(height, radius).normalize_or(up);
                revolved(&profile, &[flat(-up), flat(side)], segments)
            }
            Self::Cylinder {
                radius,
                height,
                segments,
            } => {
                let half = height * 0.5;
                let profile = [
                    point(0.0, -half),
                    point(radius, -half),
                    point(radius, half),
                    point(0.0, half),
                ];
                revolved(&profile, &[flat(-up), flat(outwards), flat(up)], segments)
            }
            Self::Torus {
                radius,
                tube,
                segments,
                rings,
            } => torus(radius, tube, segments, rings),
            Self::Disc { radius, segments } => {
                let profile = [point(radius, 0.0), DVec2::ZERO];
                revolved(&profile, &[flat(up)], segments)
            }
            Self::Monkey { size } => polygons(&raycast_assets::monkey(), size),
            Self::Dahlia { size, petals } => polygons(&raycast_assets::dahlia(petals), size),
        })
    }
}

/// A rectangle in the xz-plane, seen from above.
fn plane(size: DVec2) -> MeshData {
    let corner = |x: f64, z: f64| DVec3::new(x * size.x * 0.5, 0.0, z * size.y * 0.5);
    MeshData {
        positions: vec![
            corner(-1.0, 1.0),
            corner(1.0, 1.0),
            corner(1.0, -1.0),
            corner(-1.0, -1.0),
        ],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        normals: Some(Attribute {
            values: vec![Vec3::Y; 4],
            indices: None,
        }),
        uvs: Some(Attribute {
            values: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
            indices: None,
        }),
        ..MeshData::default()
    }
}

/// A half circle, revolved; its ends are exactly on the axis.
fn sphere(radius: f64, segments: u32, rings: u32) -> MeshData {
    let directions: Vec<DVec2> = (0..=rings)
        .map(|ring| match ring {
            0 => DVec2::NEG_Y,
            _ if ring == rings => DVec2::Y,
            _ => {
                let angle = TAU * (0.5 * f64::from(ring) / f64::from(rings) - 0.25);
                let (sin, cos) = math::sin_cos(angle);
                DVec2::new(cos, sin)
            }
        })
        .collect();
    let profile: Vec<DVec2> = directions.iter().map(|d| *d * radius).collect();
    let normals: Vec<[DVec2; 2]> = directions
        .windows(2)
        .map(|ends| [ends[0], ends[1]])
        .collect();
    revolved(&profile, &normals, segments)
}

/// A circle beside the axis, revolved.
fn torus(radius: f64, tube: f64, segments: u32, rings: u32) -> MeshData {
    let directions: Vec<DVec2> = (0..rings)
        .map(|ring| {
            let (sin, cos) = math::sin_cos(TAU * f64::from(ring) / f64::from(rings));
            DVec2::new(cos, sin)
        })
        .collect();
    let middle = DVec2::new(radius, 0.0);
    let mut profile: Vec<DVec2> = directions.iter().map(|d| *d * tube + middle).collect();
    // The profile is closed: it ends where it begins.
    profile.extend(profile.first().copied());
    let next = directions.iter().cycle().skip(1);
    let normals: Vec<[DVec2; 2]> = directions.iter().zip(next).map(|(a, b)| [*a, *b]).collect();
    revolved(&profile, &normals, segments)
}

/// A box: eight vertices; each face has its own normal and the whole texture.
fn cube(size: DVec3) -> MeshData {
    let corner = |index: u32| {
        let side = |bit: u32| if index >> bit & 1 == 1 { 0.5 } else { -0.5 };
        DVec3::new(side(0), side(1), side(2)) * size
    };
    // Counter-clockwise from outside, from the corner at the bottom left.
    let faces: [[u32; 4]; 6] = [
        [4, 5, 7, 6],
        [1, 0, 2, 3],
        [5, 1, 3, 7],
        [0, 4, 6, 2],
        [6, 7, 3, 2],
        [0, 1, 5, 4],
    ];
    let normals = vec![Vec3::Z, -Vec3::Z, Vec3::X, -Vec3::X, Vec3::Y, -Vec3::Y];
    let halves = |[a, b, c, d]: [u32; 4]| [[a, b, c], [a, c, d]];
    MeshData {
        positions: (0..8).map(corner).collect(),
        triangles: faces.into_iter().flat_map(halves).collect(),
        normals: Some(Attribute {
            values: normals,
            indices: Some((0..12).map(|half| [half / 2; 3]).collect()),
        }),
        uvs: Some(Attribute {
            values: vec![Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y],
            indices: Some((0..6).flat_map(|_| halves([0, 1, 2, 3])).collect()),
        }),
        ..MeshData::default()
    }
}

/// A profile revolved around y; its points are (distance from the axis, height). A point on the axis becomes one
/// vertex; a profile that ends where it begins is closed. `normals` are those at both ends of each of its segments.
/// Segments that go up face outwards.
fn revolved(profile: &[DVec2], normals: &[[DVec2; 2]], segments: u32) -> MeshData {
    let turned: Vec<DVec2> = (0..segments)
        .map(|segment| {
            let (sin, cos) = math::sin_cos(TAU * f64::from(segment) / f64::from(segments));
            DVec2::new(cos, -sin)
        })
        .collect();
    let place = |point: DVec2, turn: DVec2| DVec3::new(point.x * turn.x, point.y, point.x * turn.y);
    let is_closed = profile.len() > 2 && profile.first() == profile.last();
    let mut positions = Vec::new();
    // The first vertex of each point of the profile, and whether the point is a single vertex on the axis.
    let mut rings: Vec<(u32, bool)> = Vec::new();
    let distinct = profile.len() - usize::from(is_closed);
    for point in &profile[..distinct] {
        let is_pole = point.x == 0.0;
        rings.push((positions.len() as u32, is_pole));
        if is_pole {
            positions.push(place(*point, DVec2::X));
        } else {
            positions.extend(turned.iter().map(|turn| place(*point, *turn)));
        }
    }
    if is_closed {
        rings.extend(rings.first().copied());
    }
    let corner = |(first, is_pole): (u32, bool), segment: u32| match is_pole {
        true => first,
        false => first + segment % segments,
    };
    let mut mesh = MeshData::default();
    let (mut normal_values, mut normal_indices) = (Vec::new(), Vec::new());
    let (mut uv_values, mut uv_indices) = (Vec::new(), Vec::new());
    let lines = normals.len();
    for (line, ends) in normals.iter().enumerate() {
        let (low, high) = (rings[line], rings[line + 1]);
        let first_normal = normal_values.len() as u32;
        for normal in ends {
            normal_values.extend(turned.iter().map(|turn| place(*normal, *turn).as_vec3()));
        }
        let first_uv = uv_values.len() as u32;
        for (end, (_, is_pole)) in [low, high].into_iter().enumerate() {
            // A pole has no longitude: its texture coordinate is that of the middle of its triangle.
            let shift = if is_pole { 0.5 } else { 0.0 };
            uv_values.extend((0..=segments).map(|segment| {
                let u = (f64::from(segment) + shift) / f64::from(segments);
                let v = (line + end) as f64 / lines as f64;
                DVec2::new(u, v).as_vec2()
            }));
        }
        for segment in 0..segments {
            let next = segment + 1;
            let ends = [(0, segment), (0, next), (1, next), (1, segment)];
            let [a, b, c, d] = ends.map(|(end, at)| corner([low, high][end as usize], at));
            let normal = ends.map(|(end, at)| first_normal + end * segments + at % segments);
            let is_pole = |end: u32| [low, high][end as usize].1;
            let uv = ends.map(|(end, at)| {
                let at = if is_pole(end) { segment } else { at };
                first_uv + end * (segments + 1) + at
            });
            let halves = [[0, 1, 2], [0, 2, 3]];
            let kept = halves.into_iter().zip([!low.1, !high.1]);
            for (half, _) in kept.filter(|(_, is_kept)| *is_kept) {
                mesh.triangles.push(half.map(|at: usize| [a, b, c, d][at]));
                normal_indices.push(half.map(|at| normal[at]));
                uv_indices.push(half.map(|at| uv[at]));
            }
        }
    }
    mesh.positions = positions;
    mesh.normals = Some(Attribute {
        values: normal_values,
        indices: Some(normal_indices),
    });
    mesh.uvs = Some(Attribute {
        values: uv_values,
        indices: Some(uv_indices),
    });
    mesh
}

/// A model of polygons, `size` times as large. Each polygon becomes a fan from its first corner.
fn polygons(model: &Model, size: f64) -> MeshData {
    let mut mesh = MeshData {
        positions: model.positions.iter().map(|p| *p * size).collect(),
        materials: model
            .materials
            .iter()
            .map(|material| Material::new(material.name, Color(material.srgb)))
            .collect(),
        ..MeshData::default()
    };
    let (mut normals, mut uvs) = (Vec::new(), Vec::new());
    let mut diagonals = Vec::new();
    for Face { material, corners } in &model.faces {
        let last = corners.len().saturating_sub(2);
        for at in 1..=last {
            let fan = [0, at, at + 1].map(|corner| corners[corner]);
            let indices = |of: fn(Corner) -> usize| fan.map(|corner| of(corner) as u32);
            mesh.triangles.push(indices(|corner| corner.position));
            normals.push(indices(|corner| corner.normal));
            uvs.push(indices(|corner| corner.uv));
            mesh.material_of_triangle.push(*material as u32);
            diagonals.push([at > 1, false, at < last]);
        }
    }
    mesh.diagonals = Diagonals::of(diagonals.len());
    for (triangle, edges) in diagonals.into_iter().enumerate() {
        mesh.diagonals.set(triangle, edges);
    }
    mesh.normals = Some(Attribute {
        values: model.normals.iter().map(|n| n.as_vec3()).collect(),
        indices: Some(normals),
    });
    mesh.uvs = Some(Attribute {
        values: model.uvs.iter().map(|uv| uv.as_vec2()).collect(),
        indices: Some(uvs),
    });
    mesh
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Mesh;
    use std::collections::HashMap;

    fn shapes() -> [Shape; 9] {
        [
            Shape::Cube {
                size: DVec3::new(1.0, 2.0, 3.0),
            },
            Shape::Plane {
                size: DVec2::new(1.0, 2.0),
            },
            Shape::Sphere {
                radius: 1.5,
                segments: 33,
                rings: 17,
            },
            Shape::Cone {
                radius: 1.0,
                height: 3.0,
                segments: 3,
            },
            Shape::Cylinder {
                radius: 0.1,
                height: 3.0,
                segments: 32,
            },
            Shape::Torus {
                radius: 1.0,
                tube: 0.25,
                segments: 40,
                rings: 20,
            },
            Shape::Disc {
                radius: 2.0,
                segments: 7,
            },
            Shape::Monkey { size: 2.0 },
            Shape::Dahlia {
                size: 0.5,
                petals: 21,
            },
        ]
    }

    /// Each edge is used once in each direction; edges on the rims of open shapes are used once.
    #[test]
    fn shapes_are_closed_and_face_outwards() {
        for shape in shapes() {
            let data = shape.mesh().expect("a good shape");
            assert_eq!(data.triangles.len() as u64, shape.triangles(), "{shape:?}");
            let mut edges: HashMap<(u32, u32), i32> = HashMap::new();
            let mut volume = 0.0;
            for &[a, b, c] in &data.triangles {
                for (from, to) in [(a, b), (b, c), (c, a)] {
                    *edges.entry((from, to)).or_default() += 1;
                }
                let [a, b, c] = [a, b, c].map(|i| data.positions[i as usize]);
                volume += a.dot(b.cross(c)) / 6.0;
            }
            assert!(edges.values().all(|count| *count == 1), "{shape:?}");
            let open = edges
                .keys()
                .filter(|(a, b)| !edges.contains_key(&(*b, *a)))
                .count();
            let (expected_open, expected_volume) = match shape {
                Shape::Cube { .. } => (0, 6.0..6.1),
                Shape::Plane { .. } => (4, -0.1..0.1),
                Shape::Sphere { .. } => (0, 13.6..14.2),
                // A third of the base's area, 3 √3 / 4, times the height, 3.
                Shape::Cone { .. } => (0, 1.29..1.31),
                Shape::Cylinder { .. } => (0, 0.093..0.0943),
                Shape::Torus { .. } => (0, 1.18..1.234),
                Shape::Disc { .. } => (7, -0.1..0.1),
                Shape::Monkey { .. } => (0, 36.1..36.2),
                Shape::Dahlia { .. } => (0, 0.0154..0.0155),
            };
            assert_eq!(open, expected_open, "{shape:?}");
            assert!(expected_volume.contains(&volume), "{shape:?}: {volume}");
        }
    }

    #[test]
    fn normals_are_those_of_the_surface_and_coordinates_lie_in_the_texture() {
        for shape in shapes() {
            let mesh = Mesh::new(shape.mesh().expect("a good shape"));
            assert_eq!(mesh.dropped().total(), 0, "{shape:?}");
            let is_monkey = matches!(shape, Shape::Monkey { .. });
            for number in 0..mesh.triangles().len() as u32 {
                let [a, b, c] = mesh.corners(number).expect("corners");
                let flat = (b - a).cross(c - a).normalize();
                for normal in mesh.corner_normals(number).expect("normals") {
                    assert!(normal.is_normalized(), "{shape:?}: {normal}");
                    // On a cone of three sides normals turn by 60° from a corner to the middle, and by more in the
                    // monkey's creases.
                    let least = if is_monkey { 0.0 } else { 0.45 };
                    assert!(
                        normal.dot(flat) > least,
                        "{shape:?} {number}: {normal} {flat}"
                    );
                }
                for uv in mesh.corner_uvs(number).expect("coordinates") {
                    assert!(
                        is_monkey || uv.min_element() >= 0.0 && uv.max_element() <= 1.0,
                        "{uv}"
                    );
                }
            }
        }
    }
}
