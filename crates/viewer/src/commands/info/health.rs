//! What is wrong with a mesh, and how much there is of it.

use raycast_core::glam::DAffine3;
use raycast_core::health;
use raycast_core::scene::Mesh;
use serde::Serialize;

/// How the triangles of a mesh join, and how much there is of it.
#[derive(Debug, Serialize)]
pub(super) struct HealthInfo {
    pub(super) closed: bool,
    pub(super) shells: usize,
    pub(super) euler_characteristic: i64,
    open_edges: usize,
    non_manifold_edges: usize,
    flipped: usize,
    degenerate: usize,
    duplicates: usize,
    unused_vertices: usize,
    one_sided: usize,
    inside_out: usize,
    /// In its place in the scene, in scene units.
    pub(super) area: f64,
    /// `null` where it is open.
    pub(super) volume: Option<f64>,
}

impl HealthInfo {
    pub(super) fn of(mesh: &Mesh, world_from_object: &DAffine3) -> Option<Self> {
        let health = health::check(mesh, &|_| true)?;
        let size = health::size(mesh, world_from_object, &|_| true)?;
        Some(Self {
            closed: health.is_closed(),
            shells: health.shells,
            euler_characteristic: health.euler_characteristic(),
            open_edges: health.open_edges.len(),
            non_manifold_edges: health.non_manifold_edges.len(),
            flipped: health.flipped.len(),
            degenerate: health.degenerate.len(),
            duplicates: health.duplicates.len(),
            unused_vertices: health.unused_vertices.len(),
            one_sided: health.one_sided,
            inside_out: health.inside_out,
            area: size.area,
            volume: health.is_closed().then_some(size.volume),
        })
    }

    /// The faults that there are, in words.
    pub(super) fn faults(&self) -> String {
        let kinds = [
            (self.open_edges, "open edges"),
            (self.non_manifold_edges, "non-manifold edges"),
            (self.flipped, "flipped"),
            (self.degenerate, "degenerate"),
            (self.duplicates, "duplicates"),
            (self.unused_vertices, "unused vertices"),
            (self.one_sided, "one-sided parts"),
            (self.inside_out, "shells inside out"),
        ];
        let found = kinds.into_iter().filter(|(count, _)| *count > 0);
        let found: Vec<_> = found
            .map(|(count, kind)| format!("{count} {kind}"))
            .collect();
        match found[..] {
            [] => "none".to_owned(),
            _ => found.join(", "),
        }
    }
}
