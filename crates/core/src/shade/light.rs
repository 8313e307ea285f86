//! The light of lit modes.

use crate::camera::Camera;
use glam::Vec3;

/// Brightness of the key light on a surface that faces it.
pub(super) const KEY: f32 = 0.80;

/// How far round the key light reaches past a right angle, as a cosine: the edge of its shadow
/// side is soft, so that shapes there can still be read.
pub(super) const WRAP: f32 = 0.10;

/// Fill from above the camera, a little cool, and from below, a little warm and much darker.
pub(super) const SKY: Vec3 = Vec3::new(0.160, 0.168, 0.184);
pub(super) const GROUND: Vec3 = Vec3::new(0.066, 0.060, 0.055);

/// Brightness of the rim where a surface turns away from the eye.
pub(super) const RIM: f32 = 0.10;

/// A key light that stands up and to the left of the camera, a soft fill from its upper side, and a
/// faint rim. They move with the camera: whatever one looks at is lit.
///
/// Brightness is in linear light. White that faces the key light is at about 0.95.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lights {
    pub(super) to_key: Vec3,
    pub(super) up: Vec3,
}

impl Lights {
    pub(super) fn new(camera: &Camera) -> Self {
        let (right, up, back) = (
            camera.right().as_vec3(),
            camera.up().as_vec3(),
            -camera.forward().as_vec3(),
        );
        Self {
            to_key: (up * 0.7 - right * 0.6 + back * 0.9).normalize(),
            up,
        }
    }

    /// What a white surface sends back: `normal` and `to_eye` are unit vectors in world space.
    pub(super) fn on(&self, normal: Vec3, to_eye: Vec3) -> Vec3 {
        let key = ((normal.dot(self.to_key) + WRAP) / (1.0 + WRAP)).max(0.0);
        let above = 0.5 + 0.5 * normal.dot(self.up);
        let away = 1.0 - normal.dot(to_eye).abs().min(1.0);
        let rim = away * away * away * above;
        GROUND + (SKY - GROUND) * above + Vec3::splat(KEY * key + RIM * rim)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{ImagePlane, Placement, Projection};
    use crate::math;
    use glam::DVec3;

    #[test]
    fn white_facing_the_key_light_is_bright_but_not_burnt() {
        let plane = ImagePlane::new(4, 4, 0.1).expect("a good plane");
        let placement = Placement {
            eye: DVec3::new(3.0, 4.0, 5.0),
            target: DVec3::ZERO,
            up: DVec3::Y,
        };
        let camera = Camera::new(placement, Projection::Perspective, plane);
        let lights = Lights::new(&camera);
        let to_eye = -camera.forward().as_vec3();
        let facing = lights.on(lights.to_key, to_eye);
        assert!(
            facing.min_element() > 0.92 && facing.max_element() < 0.98,
            "{facing}"
        );
        let below = lights.on(-camera.up().as_vec3(), to_eye);
        assert!(
            below.min_element() > 0.05 && below.max_element() < 0.25,
            "{below}"
        );
        // Over all directions towards the eye nothing is brighter than white.
        for i in 0..1000 {
            let angle = i as f32 * 2.4;
            let z = (i as f32 + 0.5) / 1000.0;
            let across = (1.0 - z * z).sqrt();
            let normal = camera.right().as_vec3() * (math::cos(angle.into()) as f32 * across)
                + camera.up().as_vec3() * (math::sin(angle.into()) as f32 * across)
                + to_eye * z;
            let light = lights.on(normal, to_eye);
            assert!(
                light.max_element() < 1.0 && light.min_element() > 0.0,
                "{light}"
            );
        }
    }
}
