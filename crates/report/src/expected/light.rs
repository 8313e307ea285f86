//! The light of lit modes, as the shader documents it: a key light from the upper left of the camera that reaches
//! slightly beyond a right angle, a fill from sky to ground, and a rim. It is written down a second time on purpose:
//! documentation and shader must agree.

use super::range::{Single, Vector, dot, exactly_single, minus, plus, scaled};
use raycast_core::camera::Camera;
use raycast_core::shade::LightSet;

const KEY: f64 = 0.80;
const WRAP: f64 = 0.10;
const SKY: [f64; 3] = [0.160, 0.168, 0.184];
const GROUND: [f64; 3] = [0.066, 0.060, 0.055];
const RIM: f64 = 0.10;

/// A light's direction in the camera's axes (right, up and back; `None` at the eye), and its colour.
type LightSource = (Option<[f64; 3]>, [f64; 3]);

const HEADLIGHT: [LightSource; 1] = [(None, [0.88; 3])];
const THREE_POINT: [LightSource; 3] = [
    (Some([-0.65, 0.65, 0.85]), [0.78, 0.735, 0.675]),
    (Some([0.90, 0.05, 0.60]), [0.125, 0.150, 0.185]),
    (Some([0.45, 0.60, -0.80]), [0.300, 0.315, 0.340]),
];

/// The lights of a picture.
#[derive(Clone)]
pub(super) struct Lights {
    /// The direction to the key light of the soft set.
    to_key: Option<Vector<24>>,
    /// The lights of the other sets.
    sources: Vec<(Option<Vector<24>>, Vector<24>)>,
    up: Vector<24>,
    sky: Vector<24>,
    ground: Vector<24>,
}

impl Lights {
    pub(super) fn new(camera: &Camera, set: LightSet) -> Self {
        // The vector and its length are rounded, so the unit vector may be a few roundings off.
        let near = |x: f64| Single::around(x, 4.0 * f64::from(f32::EPSILON));
        let towards = |[x, y, z]: [f64; 3]| -> Vector<24> {
            let direction = camera.up() * y + camera.right() * x - camera.forward() * z;
            direction.normalize().to_array().map(near)
        };
        let constant = |rgb: [f64; 3]| rgb.map(|channel| Single::exactly(channel).rounded());
        let (given, sky, ground): (&[LightSource], _, _) = match set {
            LightSet::Soft => (&[], SKY, GROUND),
            LightSet::Headlight => (&HEADLIGHT, [0.06; 3], [0.06; 3]),
            LightSet::ThreePoint => (&THREE_POINT, [0.100, 0.107, 0.120], [0.058, 0.052, 0.047]),
        };
        let sources = given.iter();
        Self {
            to_key: (set == LightSet::Soft).then(|| towards([-0.6, 0.7, 0.9])),
            sources: sources
                .map(|(direction, color)| (direction.map(towards), constant(*color)))
                .collect(),
            up: exactly_single(camera.up().as_vec3()),
            sky: constant(sky),
            ground: constant(ground),
        }
    }

    /// The ambient light on a surface with this unit normal.
    pub(super) fn around(&self, normal: Vector<24>) -> Vector<24> {
        let half = Single::exactly(0.5);
        let above = half + half * dot(normal, self.up);
        plus(self.ground, scaled(minus(self.sky, self.ground), above))
    }

    /// Each light's direction (`None` at the eye), and the light that a white surface facing it reflects.
    pub(super) fn shining(&self) -> Vec<(Option<Vector<24>>, Vector<24>)> {
        match self.to_key {
            Some(to_key) => vec![(Some(to_key), [Single::exactly(KEY).rounded(); 3])],
            None => self.sources.clone(),
        }
    }

    /// The light that a white surface with this unit normal reflects to an eye in that direction.
    pub(super) fn on(&self, normal: Vector<24>, to_eye: Vector<24>) -> Vector<24> {
        let number = Single::exactly;
        let Some(to_key) = self.to_key else {
            let mut light = self.around(normal);
            for (direction, color) in &self.sources {
                let facing = dot(normal, direction.unwrap_or(to_eye)).max(0.0);
                light = plus(light, scaled(*color, facing));
            }
            return light;
        };
        let key = (dot(normal, to_key) + number(WRAP).rounded()) / number(1.0 + WRAP).rounded();
        let key = key.max(0.0);
        let above = number(0.5) + number(0.5) * dot(normal, self.up);
        let away = number(1.0) - dot(normal, to_eye).abs().min(1.0);
        let rim = away * away * away * above;
        let white = number(KEY).rounded() * key + number(RIM).rounded() * rim;
        plus(
            plus(self.ground, scaled(minus(self.sky, self.ground), above)),
            [white; 3],
        )
    }
}

/// The unit vector from a pixel of the picture to the eye.
///
/// It is documented to be computed in single precision from the picture's corner, and what a pixel to the right and
/// down adds: with the place in the picture in pixels, not from the ray; of a panorama from the direction there.
pub(super) fn to_eye(camera: &Camera, x: f64, y: f64) -> Vector<24> {
    use raycast_core::camera::Projection;
    let to_single = |vector: raycast_core::glam::DVec3| {
        vector.to_array().map(|c| {
            // Rounded in double precision a few times, then once to single precision.
            Single::exactly(c).rounded()
        })
    };
    if camera.projection() == Projection::Orthographic {
        // Normalised once more, as every other direction is.
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
