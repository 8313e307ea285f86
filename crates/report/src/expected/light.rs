//! The light of lit modes, as the shader documents it: a key light up and to the left of the camera,
//! wrapped a little round the shape, a fill from sky to ground, and a rim. Written down a second time on
//! purpose: what this says and what the shader does must agree.

use super::range::{Single, Vector, dot, exactly_single, plus, scaled};
use raycast_core::camera::Camera;

const KEY: f64 = 0.80;
const WRAP: f64 = 0.10;
const SKY: [f64; 3] = [0.160, 0.168, 0.184];
const GROUND: [f64; 3] = [0.066, 0.060, 0.055];
const RIM: f64 = 0.10;

/// Where the lights stand, in the camera's axes.
pub(super) struct Lights {
    to_key: Vector<24>,
    up: Vector<24>,
}

impl Lights {
    pub(super) fn new(camera: &Camera) -> Self {
        // The vector and its length are rounded, so the unit vector may be a few roundings off.
        let to_key = camera.up() * 0.7 - camera.right() * 0.6 - camera.forward() * 0.9;
        let near = |x: f64| Single::around(x, 4.0 * f64::from(f32::EPSILON));
        Self {
            to_key: to_key.normalize().to_array().map(near),
            up: exactly_single(camera.up().as_vec3()),
        }
    }

    /// What a white surface with this unit normal sends to an eye in that direction.
    pub(super) fn on(&self, normal: Vector<24>, to_eye: Vector<24>) -> Vector<24> {
        let number = Single::exactly;
        let key =
            (dot(normal, self.to_key) + number(WRAP).rounded()) / number(1.0 + WRAP).rounded();
        let key = key.max(0.0);
        let above = number(0.5) + number(0.5) * dot(normal, self.up);
        let away = number(1.0) - dot(normal, to_eye).abs().min(1.0);
        let rim = away * away * away * above;
        let white = number(KEY).rounded() * key + number(RIM).rounded() * rim;
        let constant = |rgb: [f64; 3]| rgb.map(|channel| number(channel).rounded());
        let ground = constant(GROUND);
        let sky: Vector<24> = std::array::from_fn(|i| constant(SKY)[i] - ground[i]);
        plus(plus(ground, scaled(sky, above)), [white; 3])
    }
}

/// The unit vector from a pixel of the picture to the eye.
///
/// It is said to be worked out in single precision from the picture's corner, and what a pixel to the
/// right and down adds: with the place in the picture in pixels, not from the ray; of a panorama from the direction there.
pub(super) fn to_eye(camera: &Camera, x: f64, y: f64) -> Vector<24> {
    use raycast_core::camera::Projection;
    let to_single = |vector: raycast_core::glam::DVec3| {
        vector.to_array().map(|c| {
            // Rounded in double precision a few times, then once to single precision.
            Single::exactly(c).rounded()
        })
    };
    if camera.projection() == Projection::Orthographic {
        // Made unit length once more, as every other is.
        return super::range::unit(exactly_single((-camera.forward()).as_vec3()));
    }
    if camera.projection().panorama().is_some() {
        return super::range::unit(to_single(-camera.direction(x, y).normalize_or_zero()));
    }
    let corner = to_single(-camera.direction(0.0, 0.0) / camera.distance());
    let pixel = camera.plane().step / camera.distance();
    let right = to_single(camera.right() * -pixel);
    let down = to_single(camera.up() * pixel);
    let at = |place: f64| Single::exactly(f64::from(place as f32));
    let sum = plus(plus(corner, scaled(right, at(x))), scaled(down, at(y)));
    super::range::unit(sum)
}
