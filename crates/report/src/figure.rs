//! Drawings in space, rendered by RayCast itself: lit triangles, and lines of constant width.

use crate::meshes;
use crate::stage::scene_of;
use crate::table::ReportError;
use image::{Rgb, RgbImage};
use raycast_core::camera::{Camera, Grid, Rect};
use raycast_core::glam::DVec3;
use raycast_core::math;
use raycast_core::picture::Picture;
use raycast_core::render::{Cancel, Settings, View};
use raycast_core::scene::{Bounds, Color, Material, Mesh, MeshData};
use raycast_core::shade::{Background, Mode, Shading};
use raycast_core::{Accel, Simd};
use std::collections::HashMap;
use std::sync::Arc;
use std::time::Duration;

/// Sides of the prisms that lines are made of.
const SIDES: u32 = 6;

/// Rays a pixel.
const SAMPLES: u32 = 16;

/// A drawing for one camera.
#[derive(Clone, Debug)]
pub struct Figure {
    camera: Camera,
    simd: Simd,
    positions: Vec<DVec3>,
    colors: Vec<Color>,
}

impl Figure {
    /// An empty drawing, rendered with this instruction set.
    pub fn new(camera: Camera, simd: Simd) -> Self {
        Self {
            camera,
            simd,
            positions: Vec::new(),
            colors: Vec::new(),
        }
    }

    /// Adds a triangle, lit from above the camera.
    pub fn triangle(&mut self, corners: [DVec3; 3], color: Color) {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a).normalize_or_zero();
        let to_eye = self.camera.pose().eye - a;
        let normal = if normal.dot(to_eye) < 0.0 {
            -normal
        } else {
            normal
        };
        let light =
            self.camera.up() * 0.7 - self.camera.forward() * 0.6 - self.camera.right() * 0.4;
        let light = 0.76 + 0.24 * normal.dot(light.normalize()).max(0.0);
        let Color(channels) = color;
        let lit = channels.map(|channel| (f64::from(channel) * light).round() as u8);
        self.plain(corners, Color(lit));
    }

    fn plain(&mut self, corners: [DVec3; 3], color: Color) {
        self.positions.extend(corners);
        self.colors.push(color);
    }

    /// Adds a ball.
    pub fn ball(&mut self, center: DVec3, radius: f64, color: Color) {
        let ball = meshes::sphere(center, radius, 24);
        for triangle in ball.triangles() {
            let corner = |at: u32| ball.offset() + ball.positions()[at as usize].as_dvec3();
            self.triangle(triangle.map(corner), color);
        }
    }

    /// Adds a line of constant width in pixels and of one colour; nothing if an end is behind the camera.
    pub fn line(&mut self, from: DVec3, to: DVec3, pixels: f64, color: Color) {
        let camera = &self.camera;
        let depth = |point: DVec3| (point - camera.pose().eye).dot(camera.forward());
        let width = |point| depth(point) / camera.distance() * camera.plane().step * pixels;
        let (from_width, to_width) = (width(from), width(to));
        let along = (to - from).normalize_or_zero();
        if from_width <= 0.0 || to_width <= 0.0 || along == DVec3::ZERO {
            return;
        }
        let (a, b) = along.any_orthonormal_pair();
        let ring = |center: DVec3, width: f64| -> [DVec3; SIDES as usize] {
            std::array::from_fn(|side| {
                let angle = std::f64::consts::TAU * side as f64 / f64::from(SIDES);
                center + (a * math::cos(angle) + b * math::sin(angle)) * (width * 0.5)
            })
        };
        // Slightly longer, so that lines that join leave no notch.
        let start = ring(from - along * (from_width * 0.4), from_width);
        let end = ring(to + along * (to_width * 0.4), to_width);
        for side in 0..SIDES as usize {
            let next = (side + 1) % SIDES as usize;
            self.plain([start[side], end[side], end[next]], color);
            self.plain([start[side], end[next], start[next]], color);
        }
    }

    /// Adds a closed polyline.
    pub fn ring(&mut self, points: &[DVec3], pixels: f64, color: Color) {
        for (at, &point) in points.iter().enumerate() {
            self.line(point, points[(at + 1) % points.len()], pixels, color);
        }
    }

    /// Adds the edges of a box.
    pub fn edges(&mut self, bounds: &Bounds, pixels: f64, color: Color) {
        let corners = bounds.corners();
        for corner in 0..8usize {
            for axis in [1, 2, 4] {
                if corner & axis == 0 {
                    self.line(corners[corner], corners[corner | axis], pixels, color);
                }
            }
        }
    }

    /// Renders the drawing over white.
    ///
    /// # Errors
    /// More triangles than can be numbered.
    pub fn draw(self) -> Result<RgbImage, ReportError> {
        let view = self.view()?;
        let picture = view.render(
            Grid::default(),
            &|| Duration::ZERO,
            &Cancel::default(),
            &|_| (),
        );
        // It is never cancelled.
        let picture = picture.unwrap_or_else(|| Picture::blank(1, 1, false));
        Ok(image(picture.width, picture.height, &picture.pixels))
    }

    /// Renders a rectangle of the drawing over white.
    ///
    /// # Errors
    /// More triangles than can be numbered.
    pub fn draw_part(self, rect: Rect) -> Result<RgbImage, ReportError> {
        let view = self.view()?;
        let tile = view.render_sub_camera(view.camera.sub_camera(rect), &|| Duration::ZERO);
        Ok(image(rect.width, rect.height, &tile.pixels))
    }

    fn view(self) -> Result<View, ReportError> {
        let (camera, simd) = (self.camera, self.simd);
        let scene = Arc::new(scene_of([self.into_mesh()]));
        let white = Color([255; 3]);
        Ok(View {
            accel: Arc::new(Accel::build(&scene)?.with_simd(simd)),
            scene,
            camera,
            settings: Settings {
                shading: Shading {
                    mode: Mode::Color,
                    background: Background::Gradient(white, white),
                    ..Shading::default()
                },
                samples: SAMPLES,
                ..Settings::default()
            },
        })
    }

    fn into_mesh(self) -> Mesh {
        let mut numbers = HashMap::new();
        let mut materials = Vec::new();
        let material_of_triangle = self.colors.iter().map(|&color| {
            *numbers.entry(color).or_insert_with(|| {
                materials.push(Material::new(color.to_string(), color));
                materials.len() as u32 - 1
            })
        });
        let material_of_triangle = material_of_triangle.collect();
        Mesh::new(MeshData {
            triangles: (0..self.colors.len() as u32)
                .map(|at| [3 * at, 3 * at + 1, 3 * at + 2])
                .collect(),
            positions: self.positions,
            materials,
            material_of_triangle,
            ..MeshData::default()
        })
    }
}

fn image(width: u32, height: u32, pixels: &[[u8; 4]]) -> RgbImage {
    RgbImage::from_fn(width, height, |x, y| {
        let [r, g, b, _] = pixels[(y * width + x) as usize];
        Rgb([r, g, b])
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::camera::{ImagePlane, Pose, Projection};

    #[test]
    fn lines_are_as_wide_far_as_near() {
        let pose = Pose {
            eye: DVec3::new(0.0, 0.0, 10.0),
            target: DVec3::ZERO,
            up: DVec3::Y,
        };
        let plane = ImagePlane::new(160, 120, 0.05).expect("a plane");
        let camera = Camera::new(pose, Projection::Perspective, plane);
        let black = Color([0; 3]);
        let mut figure = Figure::new(camera, Simd::best());
        // Receding from the eye, beside the view axis.
        let (near, far) = (DVec3::new(-1.0, 1.0, 6.0), DVec3::new(3.0, 1.0, -30.0));
        figure.line(near, far, 4.0, black);
        figure.line(DVec3::Z * 20.0, DVec3::Z * 30.0, 4.0, black);
        let picture = figure.clone().draw().expect("a picture");
        let ink = |x: u32| -> f64 {
            let column = (0..120).map(|y| 1.0 - f64::from(picture.get_pixel(x, y).0[0]) / 255.0);
            column.sum()
        };
        let place = |point| camera.project(point).expect("in front").0 as u32;
        let (left, right) = (place(near) + 4, place(far) - 4);
        assert!(right > left + 20);
        for x in left..right {
            assert!((2.5..8.0).contains(&ink(x)), "{x}: {}", ink(x));
        }
        assert!(ink(place(far) + 12) < 0.1);
        let rect = Rect {
            x: left,
            y: 10,
            width: 30,
            height: 40,
        };
        let part = figure.draw_part(rect).expect("a picture");
        for (x, y, pixel) in part.enumerate_pixels() {
            assert_eq!(pixel, picture.get_pixel(left + x, 10 + y));
        }
    }
}
