//! Normals at a crease angle, computed independently: corner by corner, from the triangles that smooth edges lead to.

use super::range::{Single, Vector};
use raycast_core::glam::{DVec3, Vec3};
use raycast_core::math;
use raycast_core::scene::Mesh;
use std::collections::HashMap;

/// The least difference from the crease angle, in degrees, at which an angle is surely below or above it: far more
/// than the rounding of double precision, and still negligible.
const DECISION_MARGIN: f64 = 1e-6;

/// A position, with positive zeros.
type PositionKey = [u32; 3];

/// The triangles at each position of a mesh.
pub(super) struct Creased<'m> {
    mesh: &'m Mesh,
    degrees: f64,
    /// Triangles, and which of their corners is at the position.
    at: HashMap<PositionKey, Vec<(u32, usize)>>,
}

impl<'m> Creased<'m> {
    pub(super) fn new(mesh: &'m Mesh, degrees: f32) -> Self {
        let mut at: HashMap<PositionKey, Vec<(u32, usize)>> = HashMap::new();
        for &triangle in mesh.kept() {
            for (side, corner) in corners(mesh, triangle).into_iter().enumerate() {
                at.entry(place(corner)).or_default().push((triangle, side));
            }
        }
        Self {
            mesh,
            degrees: degrees.into(),
            at,
        }
    }

    /// The normals at a triangle's corners, in its mesh's space.
    pub(super) fn corner_normals(&self, triangle: u32) -> [Vector<24>; 3] {
        let unknown = [Single::UNKNOWN; 3];
        [0, 1, 2].map(|side| self.normal(triangle, side).unwrap_or(unknown))
    }

    /// `None` where rounding may decide.
    fn normal(&self, triangle: u32, side: usize) -> Option<Vector<24>> {
        let star = self.at.get(&place(corners(self.mesh, triangle)[side]))?;
        // For each vertex at the other end of an edge: the triangles whose edge leads there, and those whose edge
        // comes from there.
        let mut edges: HashMap<PositionKey, [Vec<usize>; 2]> = HashMap::new();
        for (number, &(triangle, side)) in star.iter().enumerate() {
            for (way, end) in self.ends(triangle, side).into_iter().enumerate() {
                edges.entry(end).or_default()[way].push(number);
            }
        }
        let first = star.iter().position(|corner| *corner == (triangle, side))?;
        let mut fan = vec![false; star.len()];
        let mut open = vec![first];
        fan[first] = true;
        while let Some(number) = open.pop() {
            let (triangle, side) = star[number];
            for end in self.ends(triangle, side) {
                let [[one], [other]] = edges.get(&end)?.each_ref().map(|list| &list[..]) else {
                    continue;
                };
                let other = if *one == number { *other } else { *one };
                if !fan[other] && self.is_smooth(triangle, star[other].0)? {
                    fan[other] = true;
                    open.push(other);
                }
            }
        }
        let fan = star.iter().zip(fan).filter(|(_, is_in)| *is_in);
        let parts = fan.map(|(&(triangle, side), _)| {
            let [a, b, c] = self.turned(triangle, side);
            let (e, f) = (b - a, c - a);
            // |e × f| / (|e|² |f|²), as the sine of the angle over both lengths.
            let sine = math::sin(e.angle_between(f));
            self.unit(triangle) * (sine / (e.length() * f.length()))
        });
        let (sum, size) = parts.fold((DVec3::ZERO, 0.0), |(sum, size), part| {
            (sum + part, size + part.length())
        });
        if sum.length().is_nan() || sum.length() < 1e-6 * size {
            return None;
        }
        let near = |x: f64| Single::around(x, 2f64.powi(-23));
        Some(sum.normalize().to_array().map(near))
    }

    /// The corners, starting with this one.
    fn turned(&self, triangle: u32, side: usize) -> [DVec3; 3] {
        let corners = corners(self.mesh, triangle);
        [0, 1, 2].map(|step| corners[(side + step) % 3].as_dvec3())
    }

    /// The other ends of the two edges at a corner.
    fn ends(&self, triangle: u32, side: usize) -> [PositionKey; 2] {
        let corners = corners(self.mesh, triangle);
        [1, 2].map(|step| place(corners[(side + step) % 3]))
    }

    fn unit(&self, triangle: u32) -> DVec3 {
        let [a, b, c] = self.turned(triangle, 0);
        (b - a).cross(c - a).normalize()
    }

    fn is_smooth(&self, one: u32, other: u32) -> Option<bool> {
        if self.degrees >= 180.0 {
            return Some(true);
        }
        let (one, other) = (self.unit(one), self.unit(other));
        let angle = math::atan2(one.cross(other).length(), one.dot(other)).to_degrees();
        ((angle - self.degrees).abs() > DECISION_MARGIN).then_some(angle < self.degrees)
    }
}

fn corners(mesh: &Mesh, triangle: u32) -> [Vec3; 3] {
    mesh.corners(triangle).unwrap_or_default()
}

fn place(corner: Vec3) -> PositionKey {
    (corner + 0.0).to_array().map(f32::to_bits)
}
