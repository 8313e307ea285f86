use super::Shading;
use crate::accel::{Accel, SlotHit};
use crate::camera::Camera;
use crate::scene::Scene;

/// Gives hits their colours: everything about a picture that does not change from pixel to pixel,
/// worked out once.
#[derive(Debug)]
pub struct Shader<'a> {
    scene: &'a Scene,
    accel: &'a Accel,
    camera: Camera,
    shading: Shading,
}

impl<'a> Shader<'a> {
    /// A shader for one picture.
    pub fn new(scene: &'a Scene, accel: &'a Accel, camera: Camera, shading: Shading) -> Self {
        Self {
            scene,
            accel,
            camera,
            shading,
        }
    }

    /// The colour of the sample at (x, y) of the picture: linear light, alpha not multiplied in.
    pub fn color(&self, _x: f64, _y: f64, _hit: &SlotHit) -> [f32; 4] {
        let _ = (self.scene, self.accel, self.camera, self.shading);
        unimplemented!()
    }

    /// The unit surface normal in world space, towards the eye, and the texture coordinates (zero
    /// where there are none): the picture's layers. Both zero at a miss.
    pub fn surface(&self, _x: f64, _y: f64, _hit: &SlotHit) -> ([f32; 3], [f32; 2]) {
        unimplemented!()
    }

    /// The sRGB colours of a tile's pixels through their middles; `hits` and `pixels` row by row.
    pub fn shade_tile(
        &self,
        _rect: crate::camera::Rect,
        _hits: &[SlotHit],
        _pixels: &mut [[u8; 4]],
    ) {
        unimplemented!()
    }
}

/// Linear light to 8-bit sRGB.
pub(crate) fn encode(_color: [f32; 4]) -> [u8; 4] {
    unimplemented!()
}
