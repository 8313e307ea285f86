//! Faults of a mesh, its area and its volume.

use raycast_core::glam::DAffine3;
use raycast_core::health::{self, Health, Intersections};
use raycast_core::scene::Mesh;
use serde::Serialize;
use std::collections::HashMap;
use std::sync::Arc;

/// Results for meshes; a mesh that several objects share is examined once.
#[derive(Default)]
pub(super) struct Findings {
    known: HashMap<*const Mesh, (Health, Option<Intersections>)>,
    deep: bool,
}

/// How the triangles of a mesh join, and its size.
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
    /// Pairs of triangles that intersect elsewhere than at a common corner or edge; `null` if not requested.
    self_intersections: Option<usize>,
    /// Whether there are more pairs than were counted.
    more_self_intersections: bool,
    /// Under its transform in the scene, in scene units.
    pub(super) area: f64,
    /// `null` for an open mesh.
    pub(super) volume: Option<f64>,
}

impl Findings {
    /// `deep` searches self-intersections as well, which takes many times as long.
    pub(super) fn new(deep: bool) -> Self {
        Self {
            deep,
            ..Self::default()
        }
    }

    /// Examines a mesh under its transform.
    pub(super) fn examine(
        &mut self,
        mesh: &Arc<Mesh>,
        world_from_object: &DAffine3,
    ) -> Option<HealthInfo> {
        let key = Arc::as_ptr(mesh);
        if !self.known.contains_key(&key) {
            let health = health::check(mesh, &|_| true)?;
            let intersections = match self.deep {
                true => Some(health::self_intersections(mesh, &|_| true)?),
                false => None,
            };
            self.known.insert(key, (health, intersections));
        }
        let (health, intersections) = self.known.get(&key)?;
        let size = health::size(mesh, world_from_object, &|_| true)?;
        Some(HealthInfo {
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
            self_intersections: intersections.as_ref().map(|found| found.pairs.len()),
            more_self_intersections: intersections.as_ref().is_some_and(|found| found.has_more),
            area: size.area,
            volume: health.is_closed().then_some(size.volume),
        })
    }
}

impl HealthInfo {
    /// The faults, in words.
    pub(super) fn faults(&self) -> String {
        let intersections = match self.more_self_intersections {
            true => ["and more self-intersections"; 2],
            false => ["self-intersection", "self-intersections"],
        };
        let kinds = [
            (self.open_edges, ["open edge", "open edges"]),
            (
                self.non_manifold_edges,
                ["non-manifold edge", "non-manifold edges"],
            ),
            (self.flipped, ["flipped"; 2]),
            (self.degenerate, ["degenerate"; 2]),
            (self.duplicates, ["duplicate", "duplicates"]),
            (self.unused_vertices, ["unused vertex", "unused vertices"]),
            (self.one_sided, ["one-sided part", "one-sided parts"]),
            (self.inside_out, ["shell inside out", "shells inside out"]),
            (self.self_intersections.unwrap_or(0), intersections),
        ];
        let found = kinds.into_iter().filter(|(count, _)| *count > 0);
        let found: Vec<_> = found
            .map(|(count, [one, many])| format!("{count} {}", if count == 1 { one } else { many }))
            .collect();
        match found[..] {
            [] => "none".to_owned(),
            _ => found.join(", "),
        }
    }
}
