//! Casting lattices from far away: packets of rays as they pass a [`NearEye`], each ray with a place of its own.

use super::Find;
use crate::hit::{Cull, Precision};
use crate::num::simd::{Lanes, Work, dispatch};
use crate::packet::frustum::Window;
use crate::packet::interval_zbuffer::IntervalZBuffer;
use crate::packet::params::{LARGE_SIDE, ROW, SIDE};
use crate::packet::places::{Fit, NearEye, Places};
use crate::packet::ray_rect::RayRect;
use crate::packet::traversal::Traversal;

/// The window of the near eye's plane that contains all that it sees of the scene.
const WHOLE_SCENE: Window = Window {
    across: (-1.0, 1.0),
    along: (-1.0, 1.0),
};

impl<'a> Find<'a> {
    /// Whether packets may see the scene from another eye than their rays': which side of a triangle a ray sees, and
    /// where a clipping plane cuts it, would be those seen from there.
    pub(super) fn may_see_from_near(&self) -> bool {
        self.precision == Precision::Exact && self.cull == Cull::None && self.clip.is_empty()
    }

    /// Casts all rays of the lattice in packets that are seen from `near`.
    pub(super) fn find_from(&mut self, near: NearEye) {
        dispatch(self.accel.simd, FindFar { find: self, near });
    }
}

/// [`Find`] for a lattice's rays as they pass a near eye.
struct FindFar<'f, 'a> {
    find: &'f mut Find<'a>,
    near: NearEye,
}

impl Work for FindFar<'_, '_> {
    #[inline(always)]
    fn run(self, lanes: impl Lanes) {
        let Self { find, near } = self;
        let new = || Traversal::<true>::new(find.accel, find.clip, find.lattice, find.precision);
        // The first one only tells which rays pass the scene.
        let (mut from_far, mut traversal) = (new(), new());
        traversal.see_from(near.eye);
        let camera = &find.lattice.camera;
        if !traversal.find_entry_points_through(lanes, &camera.unit_perspective(), &WHOLE_SCENE) {
            return;
        }
        let mut zbuffer = IntervalZBuffer::new();
        let mut places = Places::new(camera);
        let mut rest: Vec<RayRect> = Vec::new();
        for large in RayRect::all(find.lattice).split(LARGE_SIDE) {
            from_far.find_entry_points(lanes, &large);
            if from_far.entry_points.is_empty() {
                continue;
            }
            rest.extend(large.split(SIDE as u32));
            while let Some(packet) = rest.pop() {
                let ray =
                    |column, row| (find.lattice).ray(packet.column + column, packet.row + row);
                let size = (packet.columns, packet.rows);
                let middle = ray(packet.columns / 2, packet.rows / 2);
                let known = (find.accel).prepare(&middle, find.cull, find.precision);
                let fit = match known.and_then(|known| near.pass(&known)) {
                    Some(known) => places.find_from_near(lanes, (camera, &near, &known), size, ray),
                    None => Fit::Wide,
                };
                match fit {
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
        find.counts.nodes += from_far.counts.nodes + traversal.counts.nodes;
        find.counts.triangles += traversal.counts.triangles;
    }
}
