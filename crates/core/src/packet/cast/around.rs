//! Casting lattices of panoramas and of lenses. A packet's rays are given by their [`places`](crate::packet::places) on
//! a plane of the packet's own; through a lens, on the camera's image plane. Packets whose rays span too wide an angle
//! for a plane are split, and the smallest ones are cast ray by ray.

use super::Find;
use crate::camera::{LensPatch, PanoramaRays};
use crate::num::simd::{Lanes, Work};
use crate::packet::frustum::Window;
use crate::packet::interval_zbuffer::IntervalZBuffer;
use crate::packet::params::{LARGE_SIDE, ROW, SIDE};
use crate::packet::places::{Fit, Places};
use crate::packet::ray_rect::RayRect;
use crate::packet::traversal::Traversal;
use glam::DVec3;

/// The window of the image plane that contains the places of a patch's rays.
fn window(patch: &LensPatch) -> Window {
    let [across, along] = patch.window();
    Window { across, along }
}

/// [`Find`] for a panorama's lattice.
pub(super) struct FindAround<'a>(pub(super) Find<'a>);

impl Work for FindAround<'_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self(mut find) = self;
        let whole = RayRect::all(find.lattice);
        let mut traversal =
            Traversal::<true>::new(find.accel, find.clip, find.lattice, find.precision);
        let mut zbuffer = IntervalZBuffer::new();
        let mut places = Places::new(&find.lattice.camera);
        let mut rest: Vec<RayRect> = Vec::new();
        let Some(rays) = PanoramaRays::new(find.lattice) else {
            return;
        };
        let camera = &find.lattice.camera;
        let in_world = |v: DVec3| camera.right() * v.x + camera.up() * v.y + camera.forward() * v.z;
        let plane = camera.unit_perspective();
        let faces = rays.rects_of_faces().map_or_else(
            || vec![whole],
            |faces| faces.into_iter().map(RayRect::of).collect(),
        );
        let cone = |packet: &RayRect| {
            let (axis, tangent) = rays.cone(packet.rect())?;
            Some((in_world(axis).normalize_or_zero(), tangent))
        };
        for large in faces.into_iter().flat_map(|face| face.split(LARGE_SIDE)) {
            if rays.has_surely_none(large.rect()) {
                continue;
            }
            let large_patch = rays.lens_patch(large.rect(), None);
            let may_hit = match &large_patch {
                Some(patch) => traversal.find_entry_points_through(lanes, &plane, &window(patch)),
                None => traversal.find_entry_points_around(lanes, cone(&large)),
            };
            if !may_hit {
                continue;
            }
            rest.extend(large.split(SIDE as u32));
            while let Some(packet) = rest.pop() {
                if large_patch.is_none() && rays.has_surely_none(packet.rect()) {
                    continue;
                }
                // Rejects most packets beside a mesh before their rays are computed.
                let patch = rays.lens_patch(packet.rect(), large_patch.as_ref());
                let may_hit = match &patch {
                    Some(patch) => traversal.may_hit(lanes, &plane, &window(patch)),
                    None => match cone(&packet) {
                        Some(cone) => traversal.may_hit_around(lanes, cone),
                        None => true,
                    },
                };
                if !may_hit {
                    continue;
                }
                match places.find(lanes, (camera, &rays), packet.rect(), patch.as_ref()) {
                    Fit::Empty => {}
                    Fit::Wide if packet.columns.max(packet.rows) > ROW as u32 => {
                        let half = packet.columns.max(packet.rows).div_ceil(2);
                        rest.extend(packet.split(half));
                    }
                    Fit::Wide => find.cast_each(&packet),
                    Fit::Packet => {
                        if traversal.cast_at_places(lanes, &places, find.cull, &mut zbuffer) {
                            find.keep(&packet, &zbuffer);
                        }
                    }
                }
            }
        }
        find.counts.nodes += traversal.counts.nodes;
        find.counts.triangles += traversal.counts.triangles;
    }
}
