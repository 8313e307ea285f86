//! The section that clipping planes make: where they cut a solid open, its inside is filled.
//!
//! A ray that comes from what is cut away enters what is kept at a plane. Where it then hits a back first (of a mirrored object
//! a front, by its corners), it was
//! inside of something when it entered (of a closed mesh, by the parity of its hits), and shows that point of the plane:
//! in one colour for all sections, lit as a flat surface that faces the eye along the plane's normal. An open mesh shows
//! a section where its backs are seen through the cut. Depth and numbers of a pixel stay those of the exact hit.
//!
//! A sample is on the outline where one a pixel to its left or right, above or below, is not of the same section: one of
//! another plane, of another object, or none. What lies beyond the picture's border counts as the same.

use super::light::Lights;
use super::{Mode, srgb};
use crate::bvh::Accel;
use crate::camera::{Camera, Projection};
use crate::hit::MISS;
use crate::scene::{ClippingPlanes, Color, Scene};
use glam::{DVec3, Vec3};

/// sRGB colour of sections: no material is likely to have it.
pub(crate) const SECTION: Color = Color([0xe0, 0x7b, 0x39]);

/// And of their outlines.
pub(crate) const OUTLINE: Color = Color([0x2b, 0x15, 0x08]);

/// A plane and the object that it cuts there; `None` where no section is seen.
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
    camera: &'a Camera,
    /// The eye, relative to the tree's origin.
    eye: DVec3,
    planes: Vec<Plane>,
    /// Whether an object's transform turns its triangles' fronts to the inside.
    mirrored: Vec<bool>,
    /// Of the outline, then of each plane.
    colors: Vec<([f32; 4], [u8; 4])>,
}

#[derive(Debug)]
struct Plane {
    /// Unit vector towards what is kept.
    normal: DVec3,
    /// How far before the plane the eye, or the image plane's middle, stands: in scene units.
    depth: f64,
}

impl<'a> Section<'a> {
    /// `None` where the picture has none: no plane that any ray enters through, or a mode that shows what hits are
    /// rather than what they look like.
    pub(crate) fn new(
        scene: &Scene,
        accel: &'a Accel,
        camera: &'a Camera,
        mode: Mode,
        clip: &ClippingPlanes,
    ) -> Option<Self> {
        let is_shown = matches!(
            mode,
            Mode::Color | Mode::Flat | Mode::Smooth | Mode::Texture
        );
        let lights = Lights::new(camera);
        let eye = camera.placement().eye;
        let (base, to_eye) = (srgb::linear(SECTION), -camera.forward().as_vec3());
        let planes = clip.enabled().filter(|_| is_shown).map(|plane| {
            let length = plane.normal.length();
            let normal = plane.normal / length;
            Plane {
                normal,
                depth: (plane.offset - plane.normal.dot(eye)) / length,
            }
        });
        // What leaves the range of double precision has no section rather than a wrong one.
        let planes = planes.filter(|plane| plane.normal.is_finite() && plane.depth.is_finite());
        let is_entered = |plane: &Plane| match camera.projection() {
            Projection::Orthographic => plane.normal.dot(camera.forward()) > 0.0,
            _ => plane.depth > 0.0,
        };
        let planes: Vec<_> = planes.filter(is_entered).collect();
        let faces = planes
            .iter()
            .map(|plane| base * lights.on(-plane.normal.as_vec3(), to_eye));
        let colors = [srgb::linear(OUTLINE)].into_iter().chain(faces);
        let colors = colors.map(|Vec3 { x, y, z }| ([x, y, z, 1.0], srgb::encode([x, y, z, 1.0])));
        let colors = colors.collect();
        (!planes.is_empty()).then(|| Self {
            accel,
            camera,
            eye: eye - accel.origin,
            planes,
            mirrored: mirrored(scene),
            colors,
        })
    }

    /// What the sample at (x, y) of the picture shows of sections, where its ray hits this triangle first.
    pub(crate) fn at(&self, x: f64, y: f64, primitive: u32) -> Cut {
        if primitive == MISS {
            return None;
        }
        let object = self.accel.identify(primitive).0;
        if self.is_back(primitive) == self.mirrored[object as usize] {
            return None;
        }
        // A hit is kept, so its ray has entered through every plane that it goes through this way: the last one counts.
        if self.planes.len() == 1 && !self.camera.projection().is_parallel() {
            return Some((0, object));
        }
        let direction = self.camera.direction(x, y);
        let start = match self.camera.projection() {
            Projection::Orthographic => self.camera.on_plane(x, y),
            _ => DVec3::ZERO,
        };
        let mut last = (0.0, None);
        for (number, plane) in self.planes.iter().enumerate() {
            let along = plane.normal.dot(direction);
            let entry = (plane.depth - plane.normal.dot(start)) / along;
            if along > 0.0 && entry > last.0 {
                last = (entry, Some(number));
            }
        }
        Some((last.1?, object))
    }

    /// What a sample shows, whose section is this and is on its outline or not.
    pub(crate) fn shown(cut: Cut, is_outline: bool) -> Shown {
        match cut {
            None => Shown::NONE,
            Some(_) if is_outline => Shown(1),
            Some((number, _)) => Shown(number as u8 + 2),
        }
    }

    /// The colour of what is shown of sections, if anything is: linear light, alpha not multiplied in.
    pub(crate) fn color(&self, shown: Shown) -> Option<[f32; 4]> {
        let number = shown.0.checked_sub(1)?;
        self.colors
            .get(usize::from(number))
            .map(|(color, _)| *color)
    }

    /// The same as a picture holds it.
    pub(crate) fn color8(&self, shown: Shown) -> Option<[u8; 4]> {
        let number = shown.0.checked_sub(1)?;
        self.colors
            .get(usize::from(number))
            .map(|(_, color)| *color)
    }

    /// Whether rays see the side of a triangle from which its corners turn right.
    fn is_back(&self, primitive: u32) -> bool {
        let [a, b, c] = self.accel.corners(primitive).map(Vec3::as_dvec3);
        let along = match self.camera.projection() {
            Projection::Orthographic => self.camera.forward(),
            _ => a - self.eye,
        };
        (b - a).cross(c - a).dot(along) > 0.0
    }
}

/// For each object whether its place mirrors it.
fn mirrored(scene: &Scene) -> Vec<bool> {
    let transforms = scene.world_from_objects();
    transforms.map_or_else(
        |_| vec![false; scene.objects.len()],
        |all| all.iter().map(|t| t.matrix3.determinant() < 0.0).collect(),
    )
}
