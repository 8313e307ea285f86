//! The section that clipping planes make: where they cut a solid open, its inside is filled.
//!
//! A ray that comes from what is cut away enters what is kept at a plane. Where it then hits a back first (of a mirrored
//! object a front, by its corners), it was inside of something when it entered (of a closed mesh, by the parity of its
//! hits), and shows that point of the plane: in one colour for all sections, lit as a flat surface that faces the eye along
//! the plane's normal. An open mesh shows a section where its backs are seen through the cut. That back may itself be cut
//! away, by a plane through which the ray leaves again. Depth and numbers of a pixel stay those of the exact hit, or miss.
//!
//! A sample is on the outline where one a pixel to its left or right, above or below, is not of the same section: one of
//! another plane, of another object, or none. What lies beyond the picture's border counts as the same.

use super::LightSet;
use super::light::Lights;
use super::sides::Sides;
use super::{Mode, srgb};
use crate::bvh::Accel;
use crate::camera::{Camera, Projection};
use crate::hit::{Cull, MISS, Precision};
use crate::scene::{ClippingPlane, ClippingPlanes, Color, Masks, Scene};
use crate::single::Clipped;
use glam::{DVec3, Vec3};

/// sRGB colour of sections: no material is likely to have it.
pub(crate) const SECTION: Color = Color([0xe0, 0x7b, 0x39]);

/// The sRGB colour of their outlines.
pub(crate) const OUTLINE: Color = Color([0x2b, 0x15, 0x08]);

/// A plane and the object that it cuts; `None` where no section is visible.
pub(crate) type Cut = Option<(usize, u32)>;

/// What a sample shows of sections: nothing, an outline, or the inside of one.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Shown(u8);

impl Shown {
    pub(crate) const NONE: Self = Self(0);
}

/// The sections of a picture.
#[derive(Debug)]
pub(crate) struct Section<'a> {
    accel: &'a Accel,
    camera: Camera,
    sides: Sides,
    /// The planes through which rays enter the kept side: the same for all rays that get there.
    planes: Vec<SectionPlane>,
    /// The triangles as those planes alone keep them.
    entered: Clipped<'a>,
    masks: Option<Masks<'a>>,
    /// The planes through which rays leave the kept side.
    exits: Vec<SectionPlane>,
    /// For each object, whether its transform mirrors it.
    mirrored: Vec<bool>,
    /// The colour of the outline, then of each plane.
    colors: Vec<([f32; 4], [u8; 4])>,
}

#[derive(Debug)]
struct SectionPlane {
    /// The unit vector towards the kept side.
    normal: DVec3,
    /// The distance of the eye, or of the image plane's middle, in front of the plane, in scene units.
    depth: f64,
}

impl SectionPlane {
    /// How fast a ray approaches the kept side, per t, and the t at which it crosses the plane; its start is relative
    /// to the eye.
    fn crossing(&self, start: DVec3, direction: DVec3) -> (f64, f64) {
        let along = self.normal.dot(direction);
        (along, (self.depth - self.normal.dot(start)) / along)
    }
}

impl<'a> Section<'a> {
    /// `None` where the picture has no sections: no plane through which rays enter, culled back faces, an eye for
    /// each column, or a mode that shows properties of hits rather than surfaces.
    pub(crate) fn new(
        scene: &'a Scene,
        accel: &'a Accel,
        camera: Camera,
        mode: Mode,
        (clip, cull): (&ClippingPlanes, Cull),
    ) -> Option<Self> {
        let is_shown = cull == Cull::None && !camera.has_an_eye_a_column() && mode.shows().surfaces;
        let lights = Lights::new(&camera, LightSet::Soft);
        let eye = camera.pose().eye;
        let (base, to_eye) = (srgb::linear(SECTION), -camera.forward().as_vec3());
        let planes = clip.enabled().filter(|_| is_shown).map(|given| {
            let length = given.normal.length();
            let plane = SectionPlane {
                normal: given.normal / length,
                depth: (given.offset - given.normal.dot(eye)) / length,
            };
            (plane, *given)
        });
        // Without sections where numbers leave the range of double precision, rather than with wrong ones.
        let planes =
            planes.filter(|(plane, _)| plane.normal.is_finite() && plane.depth.is_finite());
        let is_entered = |(plane, _): &(SectionPlane, ClippingPlane)| match camera.projection() {
            Projection::Orthographic => plane.normal.dot(camera.forward()) > 0.0,
            _ => plane.depth > 0.0,
        };
        let (entered, exits): (Vec<_>, Vec<_>) = planes.partition(is_entered);
        let (planes, given): (Vec<_>, Vec<_>) = entered.into_iter().unzip();
        let entered = accel.clipped(&ClippingPlanes::new(&given).ok()?);
        let faces = planes
            .iter()
            .map(|plane| base * lights.on(-plane.normal.as_vec3(), to_eye));
        let colors = [srgb::linear(OUTLINE)].into_iter().chain(faces);
        let colors = colors.map(|Vec3 { x, y, z }| ([x, y, z, 1.0], srgb::encode([x, y, z, 1.0])));
        let colors = colors.collect();
        (!planes.is_empty()).then(|| Self {
            accel,
            camera,
            sides: Sides::new(&camera, accel.origin),
            planes,
            entered,
            masks: Masks::of(scene),
            exits: exits.into_iter().map(|(plane, _)| plane).collect(),
            mirrored: mirrored(scene),
            colors,
        })
    }

    /// Whether rays that hit nothing may show a section.
    pub(crate) fn is_seen_by_misses(&self) -> bool {
        !self.exits.is_empty()
    }

    /// The section at the sample (x, y) of the picture, whose ray hits this triangle first.
    pub(crate) fn at(&self, x: f64, y: f64, primitive: u32) -> Cut {
        let primitive = match primitive {
            MISS => self.beyond_exit(x, y)?,
            hit => hit,
        };
        let object = self.accel.identify(primitive).0;
        if (self.sides).is_back(self.accel.corners(primitive)) == self.mirrored[object as usize] {
            return None;
        }
        // A hit is kept, so its ray has entered through every plane that it crosses in this direction: the last one
        // counts.
        if self.planes.len() == 1 && !self.camera.projection().is_parallel() {
            return Some((0, object));
        }
        let (_, number) = self.entry(self.ray(x, y))?;
        Some((number, object))
    }

    /// The ray's start, relative to the eye, and its direction.
    fn ray(&self, x: f64, y: f64) -> (DVec3, DVec3) {
        let start = match self.camera.projection() {
            Projection::Orthographic => self.camera.on_plane(x, y),
            _ => DVec3::ZERO,
        };
        (start, self.camera.direction(x, y))
    }

    /// Where a ray enters the kept side: t, and the plane.
    fn entry(&self, (start, direction): (DVec3, DVec3)) -> Option<(f64, usize)> {
        let mut last = None;
        for (number, plane) in self.planes.iter().enumerate() {
            let (along, entry) = plane.crossing(start, direction);
            if along > 0.0 && entry > last.map_or(0.0, |(entry, _)| entry) {
                last = Some((entry, number));
            }
        }
        last
    }

    /// The triangle that a ray which crosses the kept side without a hit would hit first, if it did not leave it
    /// again.
    fn beyond_exit(&self, x: f64, y: f64) -> Option<u32> {
        if self.exits.is_empty() {
            return None;
        }
        let (start, direction) = self.ray(x, y);
        let (entry, _) = self.entry((start, direction))?;
        let is_kept = |plane: &SectionPlane| {
            let (along, exit) = plane.crossing(start, direction);
            match along < 0.0 {
                true => entry < exit,
                false => plane.depth <= plane.normal.dot(start),
            }
        };
        if !self.exits.iter().all(is_kept) {
            return None;
        }
        let ray = self.camera.ray(x, y);
        let cast = |kept: &Clipped<'_>| kept.cast_primitive(&ray, Cull::None, Precision::Exact);
        let hit = match &self.masks {
            None => cast(&self.entered),
            masks => cast(&self.entered.clone().masked(masks.as_ref())),
        };
        (!hit.is_miss()).then_some(hit.primitive)
    }

    /// What a sample shows, given its section and whether it is on the outline.
    pub(crate) fn shown(cut: Cut, is_outline: bool) -> Shown {
        match cut {
            None => Shown::NONE,
            Some(_) if is_outline => Shown(1),
            Some((number, _)) => Shown(number as u8 + 2),
        }
    }

    /// The colour of a section or an outline, if the sample shows one: linear light, straight alpha.
    pub(crate) fn color(&self, shown: Shown) -> Option<[f32; 4]> {
        let number = shown.0.checked_sub(1)?;
        self.colors
            .get(usize::from(number))
            .map(|(color, _)| *color)
    }

    /// As [`Section::color`], in 8 bits.
    pub(crate) fn color8(&self, shown: Shown) -> Option<[u8; 4]> {
        let number = shown.0.checked_sub(1)?;
        self.colors
            .get(usize::from(number))
            .map(|(_, color)| *color)
    }
}

/// For each object, whether its transform mirrors it.
fn mirrored(scene: &Scene) -> Vec<bool> {
    let transforms = scene.world_from_objects();
    transforms.map_or_else(
        |_| vec![false; scene.objects.len()],
        |all| all.iter().map(|t| t.matrix3.determinant() < 0.0).collect(),
    )
}
