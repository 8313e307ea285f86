//! The lights of lit modes.

use super::LightSet;
use crate::camera::Camera;
use glam::Vec3;

/// Brightness of the key light on a surface that faces it.
pub(super) const KEY: f32 = 0.80;

/// How far the key light reaches beyond a right angle, as a cosine. It softens the edge of the shadow side, so that
/// shapes there stay recognisable; with more, shapes look flat.
pub(super) const WRAP: f32 = 0.10;
/// The key light's strength over what the cosine reaches with it.
pub(super) const WRAPPED_KEY: f32 = KEY / (1.0 + WRAP);

/// Fill light from above the camera, slightly cool, and from below, slightly warm and much darker.
pub(super) const SKY: Vec3 = Vec3::new(0.160, 0.168, 0.184);
pub(super) const GROUND: Vec3 = Vec3::new(0.066, 0.060, 0.055);

/// Brightness of the rim light on surfaces that turn away from the eye.
pub(super) const RIM: f32 = 0.10;

/// A directional light.
#[derive(Clone, Copy, Debug)]
pub(super) struct Source {
    /// The unit vector to it; `None` where it is at the eye.
    pub(super) direction: Option<Vec3>,
    /// The light that a white surface facing it reflects.
    pub(super) color: Vec3,
}

/// The lights of a [`LightSet`], which move with the camera, and ambient light.
///
/// Brightness is in linear light. White that faces the key light, or the eye under a headlight, is at about 0.95.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lights {
    /// Whether the first source, the key light, reaches beyond a right angle, and surfaces have a rim.
    pub(super) is_soft: bool,
    /// The sources; unused ones are black.
    pub(super) sources: [Source; 3],
    pub(super) up: Vec3,
    /// Ambient light on surfaces that face up; `ground` is that on surfaces that face down.
    pub(super) sky: Vec3,
    pub(super) ground: Vec3,
}

impl Lights {
    /// - [`LightSet::Soft`]: `GROUND + (SKY − GROUND) · a + KEY · max(0, (n · l + WRAP) / (1 + WRAP)) +
    ///   RIM · (1 − |n · e|)³ · a`, with a = (1 + n · up) / 2, the unit vectors n of the surface, e to the eye and l
    ///   to the key light.
    /// - The others: `ground + (sky − ground) · a + Σ colour · max(0, n · l)` over their sources.
    pub(super) fn new(camera: &Camera, set: LightSet) -> Self {
        let (right, up, back) = (
            camera.right().as_vec3(),
            camera.up().as_vec3(),
            -camera.forward().as_vec3(),
        );
        let from = |x: f32, y: f32, z: f32, color: [f32; 3]| Source {
            direction: Some((up * y + right * x + back * z).normalize()),
            color: color.into(),
        };
        let dark = from(0.0, 0.0, 1.0, [0.0; 3]);
        let (sources, sky, ground) = match set {
            LightSet::Soft => {
                let key = Source {
                    // The order of operations decides the bits of pictures.
                    direction: Some((up * 0.7 - right * 0.6 + back * 0.9).normalize()),
                    color: Vec3::splat(KEY),
                };
                ([key, dark, dark], SKY, GROUND)
            }
            LightSet::Headlight => {
                let eye = Source {
                    direction: None,
                    color: Vec3::splat(0.88),
                };
                let around = Vec3::splat(0.06);
                ([eye, dark, dark], around, around)
            }
            LightSet::ThreePoint => (
                [
                    from(-0.65, 0.65, 0.85, [0.78, 0.735, 0.675]),
                    from(0.90, 0.05, 0.60, [0.125, 0.150, 0.185]),
                    from(0.45, 0.60, -0.80, [0.300, 0.315, 0.340]),
                ],
                Vec3::new(0.100, 0.107, 0.120),
                Vec3::new(0.058, 0.052, 0.047),
            ),
        };
        Self {
            is_soft: set == LightSet::Soft,
            sources,
            up,
            sky,
            ground,
        }
    }

    /// The light that a white surface reflects; `normal` and `to_eye` are unit vectors in world space.
    pub(super) fn on(&self, normal: Vec3, to_eye: Vec3) -> Vec3 {
        if self.is_soft {
            return self.soft(normal, to_eye);
        }
        let mut light = self.around(normal);
        for Source { direction, color } in self.sources {
            light += color * normal.dot(direction.unwrap_or(to_eye)).max(0.0);
        }
        light
    }

    fn soft(&self, normal: Vec3, to_eye: Vec3) -> Vec3 {
        let to_key = self.sources[0].direction.unwrap_or(to_eye);
        let key = (normal.dot(to_key) + WRAP).max(0.0);
        let above = 0.5 + 0.5 * normal.dot(self.up);
        let away = 1.0 - normal.dot(to_eye).abs().min(1.0);
        let rim = away * away * away * above;
        GROUND + (SKY - GROUND) * above + Vec3::splat(WRAPPED_KEY * key + RIM * rim)
    }

    /// The ambient light on a surface with this unit normal.
    pub(super) fn around(&self, normal: Vec3) -> Vec3 {
        let above = 0.5 + 0.5 * normal.dot(self.up);
        self.ground + (self.sky - self.ground) * above
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::camera::{ImagePlane, Pose, Projection};
    use crate::math;
    use glam::DVec3;

    #[test]
    fn white_facing_the_key_light_is_bright_but_not_burnt() {
        for set in [LightSet::Soft, LightSet::Headlight, LightSet::ThreePoint] {
            is_bright_but_not_burnt(set);
        }
    }

    fn is_bright_but_not_burnt(set: LightSet) {
        let plane = ImagePlane::new(4, 4, 0.1).expect("a good plane");
        let pose = Pose {
            eye: DVec3::new(3.0, 4.0, 5.0),
            target: DVec3::ZERO,
            up: DVec3::Y,
        };
        let camera = Camera::new(pose, Projection::Perspective, plane);
        let lights = Lights::new(&camera, set);
        let to_eye = -camera.forward().as_vec3();
        let to_key = lights.sources[0].direction.unwrap_or(to_eye);
        let facing = lights.on(to_key, to_eye);
        assert!(
            facing.min_element() > 0.75 && facing.max_element() < 0.98,
            "{set:?}: {facing}"
        );
        let below = lights.on(-camera.up().as_vec3(), to_eye);
        assert!(
            below.min_element() > 0.04 && below.max_element() < 0.25,
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
