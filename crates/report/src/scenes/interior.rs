use crate::meshes::{cuboid_parts, mesh};
use raycast_core::camera::{Camera, PlaneError, PlaneRequest, Pose, Projection, fov_to_frame};
use raycast_core::glam::DVec3;
use raycast_core::math;
use raycast_core::scene::Mesh;
use raycast_oracle::random::Random;
use std::f64::consts::{PI, TAU};

/// Rooms along each side of the flat.
const ROOMS: u32 = 3;
/// A room's length and width, and its height, in metres.
const SIDE: f64 = 5.0;
const HEIGHT: f64 = 2.8;
/// Half a wall.
const WALL: f64 = 0.06;
/// Round things a room: a lamp, bowls, vases, balls.
const ROUND: u32 = 8;
/// Triangles a room that are not round: walls and furniture.
const ANGULAR: u32 = 2100;

/// A furnished flat of nine rooms, about as many triangles as asked for and at least some 24,000: walls
/// with doorways, tables, chairs, shelves of books, lamps, bowls and balls. A closed shell is around it:
/// seen from inside, every ray hits something.
pub fn interior(triangles: u32) -> Mesh {
    let round = (triangles / (ROOMS * ROOMS)).saturating_sub(ANGULAR) / ROUND;
    let steps = ((f64::from(round).sqrt() / 2.0) as u32 * 2).max(8);
    let mut flat = Flat {
        positions: Vec::new(),
        faces: Vec::new(),
        random: Random::new(1),
        steps,
    };
    let far = f64::from(ROOMS) * SIDE;
    let corner = LocalFrame::at(DVec3::ZERO);
    flat.shell(DVec3::ZERO, DVec3::new(far, HEIGHT, far));
    for line in 1..ROOMS {
        let at = f64::from(line) * SIDE;
        for room in 0..ROOMS {
            flat.wall(corner, f64::from(room) * SIDE, at);
            // The same wall seen the other way: along z in place of x.
            let turned = LocalFrame {
                origin: DVec3::new(0.0, 0.0, far),
                yaw: PI / 2.0,
            };
            flat.wall(turned, f64::from(room) * SIDE, at);
        }
    }
    for room in 0..ROOMS * ROOMS {
        let (x, z) = (room % ROOMS, room / ROOMS);
        flat.furnish(DVec3::new(f64::from(x) * SIDE, 0.0, f64::from(z) * SIDE));
    }
    mesh(flat.positions, flat.faces)
}

/// A view from inside the flat: from a room's corner through the doorways, or at a table close by.
///
/// # Errors
/// A size that no picture can have.
pub fn interior_camera(size: (u32, u32), close: bool) -> Result<Camera, PlaneError> {
    let (eye, target, fov) = if close {
        let table = DVec3::new(1.5 * SIDE, 0.9, 1.5 * SIDE);
        (table + DVec3::new(1.3, 0.7, 1.1), table, 50.0)
    } else {
        let middle = DVec3::new(2.0 * SIDE, 1.2, 2.0 * SIDE);
        (DVec3::new(0.5, 1.7, 0.7), middle, 65.0)
    };
    let plane = PlaneRequest {
        size: Some(size),
        ..PlaneRequest::default()
    }
    .resolve(size, fov_to_frame(fov, eye.distance(target)))?;
    let pose = Pose {
        eye,
        target,
        up: DVec3::Y,
    };
    Ok(Camera::new(pose, Projection::Perspective, plane))
}

/// Where a thing stands, and which way it is turned about the vertical.
#[derive(Clone, Copy)]
struct LocalFrame {
    origin: DVec3,
    yaw: f64,
}

impl LocalFrame {
    fn at(origin: DVec3) -> Self {
        Self { origin, yaw: 0.0 }
    }

    fn point(self, local: DVec3) -> DVec3 {
        let (sin, cos) = math::sin_cos(self.yaw);
        let DVec3 { x, y, z } = local;
        self.origin + DVec3::new(x * cos + z * sin, y, z * cos - x * sin)
    }
}

/// The flat as far as it is built.
struct Flat {
    positions: Vec<DVec3>,
    faces: Vec<[u32; 3]>,
    random: Random,
    /// Steps around a round thing, and half as many along it.
    steps: u32,
}

impl Flat {
    /// The inside of a box.
    fn shell(&mut self, min: DVec3, max: DVec3) {
        let first = self.faces.len();
        self.cuboid(LocalFrame::at(DVec3::ZERO), min, max);
        for face in &mut self.faces[first..] {
            face.swap(1, 2);
        }
    }

    /// A box, fronts outwards.
    fn cuboid(&mut self, frame: LocalFrame, min: DVec3, max: DVec3) {
        let first = self.positions.len() as u32;
        let (corners, triangles) = cuboid_parts(min, max);
        self.positions
            .extend(corners.map(|corner| frame.point(corner)));
        self.faces
            .extend(triangles.map(|triangle| triangle.map(|corner| first + corner)));
    }

    /// A wall with a doorway, from `from` on as long as a room, `across` away from the frame.
    fn wall(&mut self, frame: LocalFrame, from: f64, across: f64) {
        let (door, door_height) = ((2.0, 3.1), 2.1);
        // Ends are within the next wall, so that no two faces lie in each other.
        let ends = (from - 0.5 * WALL, from + SIDE + 0.5 * WALL);
        let (top, bottom) = (HEIGHT + 0.1, -0.1);
        let mut part = |x: (f64, f64), y: (f64, f64)| {
            let min = DVec3::new(x.0, y.0, across - WALL);
            self.cuboid(frame, min, DVec3::new(x.1, y.1, across + WALL));
        };
        part((ends.0, from + door.0), (bottom, top));
        part((from + door.1, ends.1), (bottom, top));
        part((from + door.0, from + door.1), (door_height, top));
    }

    /// What stands in a room.
    fn furnish(&mut self, corner: DVec3) {
        let middle = corner + DVec3::new(SIDE / 2.0, 0.0, SIDE / 2.0);
        let yaw = self.random.between(-0.4, 0.4);
        let table = LocalFrame {
            origin: middle,
            yaw,
        };
        self.table(table);
        for chair in 0..4 {
            let turned = yaw + f64::from(chair) * PI / 2.0;
            let away = DVec3::new(0.0, 0.0, self.random.between(0.8, 1.1));
            let origin = LocalFrame {
                origin: middle,
                yaw: turned,
            }
            .point(away);
            let yaw = turned + self.random.between(-0.3, 0.3);
            self.chair(LocalFrame { origin, yaw });
        }
        self.shelf(LocalFrame::at(corner + DVec3::new(0.2, 0.0, 0.12)));
        let turned = LocalFrame {
            origin: corner + DVec3::new(SIDE - 0.12, 0.0, SIDE - 1.8),
            yaw: -PI / 2.0,
        };
        self.shelf(turned);
        // A lamp over the table, bowls and vases on it, balls on the floor.
        let lamp = middle + DVec3::new(0.0, 1.75, 0.0);
        self.turned(lamp, 0.25, 0.3, |along| 1.0 - 0.8 * along);
        for bowl in 0..4 {
            let angle = yaw + f64::from(bowl) * PI / 2.0 + self.random.between(0.0, 0.8);
            let away =
                DVec3::new(math::sin(angle), 0.0, math::cos(angle)) * self.random.between(0.2, 0.4);
            let height = self.random.between(0.08, 0.35);
            let waves = self.random.between(2.0, 7.0);
            let radius = self.random.between(0.05, 0.14);
            let foot = middle + away + DVec3::Y * 0.76;
            self.turned(foot, radius, height, |along| {
                0.7 + 0.3 * math::sin(along * waves)
            });
        }
        for _ in 0..3 {
            let radius = self.random.between(0.1, 0.3);
            let frame = DVec3::new(
                self.random.between(0.8, SIDE - 0.8),
                0.0,
                self.random.between(0.8, SIDE - 0.8),
            );
            self.turned(corner + frame, radius, 2.0 * radius, |along| {
                math::sin(PI * along)
            });
        }
    }

    fn table(&mut self, frame: LocalFrame) {
        let cuboid = |flat: &mut Self, min: [f64; 3], max: [f64; 3]| {
            flat.cuboid(frame, DVec3::from(min), DVec3::from(max));
        };
        cuboid(self, [-0.7, 0.72, -0.7], [0.7, 0.76, 0.7]);
        for (x, z) in [(-0.65, -0.65), (0.58, -0.65), (-0.65, 0.58), (0.58, 0.58)] {
            cuboid(self, [x, 0.0, z], [x + 0.07, 0.73, z + 0.07]);
        }
    }

    fn chair(&mut self, frame: LocalFrame) {
        let cuboid = |flat: &mut Self, min: [f64; 3], max: [f64; 3]| {
            flat.cuboid(frame, DVec3::from(min), DVec3::from(max));
        };
        cuboid(self, [-0.22, 0.43, -0.22], [0.22, 0.47, 0.22]);
        for (x, z, top) in [
            (-0.21, -0.21, 0.44),
            (0.17, -0.21, 0.44),
            (-0.21, 0.17, 0.95),
            (0.17, 0.17, 0.95),
        ] {
            cuboid(self, [x, 0.0, z], [x + 0.04, top, z + 0.04]);
        }
        for bar in 0..4 {
            let y = 0.58 + 0.09 * f64::from(bar);
            cuboid(self, [-0.18, y, 0.18], [0.18, y + 0.04, 0.2]);
        }
    }

    /// A shelf against a wall behind it, full of books.
    fn shelf(&mut self, frame: LocalFrame) {
        let (wide, deep) = (1.2, 0.3);
        let mut boxed = |min: [f64; 3], max: [f64; 3]| {
            self.cuboid(frame, DVec3::from(min), DVec3::from(max));
        };
        boxed([0.0, 0.0, 0.0], [0.02, 2.0, deep]);
        boxed([wide, 0.0, 0.0], [wide + 0.02, 2.0, deep]);
        boxed([0.01, 0.0, 0.0], [wide + 0.01, 2.0, 0.01]);
        for board in 0..5 {
            let y = 0.1 + 0.4 * f64::from(board);
            self.cuboid(
                frame,
                DVec3::new(0.01, y, 0.005),
                DVec3::new(wide + 0.01, y + 0.02, deep - 0.01),
            );
            let mut x = 0.03;
            while board < 4 && x < wide - 0.08 {
                let thick = self.random.between(0.02, 0.07);
                let tall = self.random.between(0.18, 0.34);
                let front = self.random.between(0.15, deep - 0.02);
                self.cuboid(
                    frame,
                    DVec3::new(x, y + 0.019, 0.02),
                    DVec3::new(x + thick, y + 0.02 + tall, front),
                );
                x += thick + self.random.between(0.001, 0.01);
            }
        }
    }

    /// A closed surface of revolution on a point, as wide along it as `profile` says, as a share of the
    /// radius.
    fn turned(&mut self, foot: DVec3, radius: f64, height: f64, profile: impl Fn(f64) -> f64) {
        let (steps, rings) = (self.steps, self.steps / 2);
        let bottom = self.positions.len() as u32;
        self.positions.push(foot);
        for ring in 0..rings - 1 {
            let along = f64::from(ring + 1) / f64::from(rings);
            // Rings that are as wide as the profile says, and as high as a ball's would be.
            let up = 0.5 - 0.5 * math::cos(PI * along);
            for step in 0..steps {
                let (sin, cos) = math::sin_cos(TAU * f64::from(step) / f64::from(steps));
                let wide = radius * profile(along);
                self.positions
                    .push(foot + DVec3::new(sin * wide, up * height, cos * wide));
            }
        }
        let top = self.positions.len() as u32;
        self.positions.push(foot + DVec3::Y * height);
        let at = |ring: u32, step: u32| bottom + 1 + ring * steps + step % steps;
        for step in 0..steps {
            self.faces.push([bottom, at(0, step + 1), at(0, step)]);
            for ring in 0..rings - 2 {
                let [a, b] = [at(ring, step), at(ring, step + 1)];
                let [c, d] = [at(ring + 1, step), at(ring + 1, step + 1)];
                self.faces.push([a, b, d]);
                self.faces.push([a, d, c]);
            }
            let last = rings - 2;
            self.faces.push([top, at(last, step), at(last, step + 1)]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::stage::scene_of;
    use raycast_core::{Accel, Cull};

    #[test]
    fn every_ray_from_inside_meets_a_front() {
        let flat = interior(60_000);
        let count = flat.triangles().len() as u32;
        assert!((50_000..70_000).contains(&count), "{count}");
        assert_eq!(flat.dropped().total(), 0);
        let accel = Accel::build(&scene_of([flat])).expect("a scene");
        for close in [false, true] {
            let camera = interior_camera((96, 54), close).expect("a camera");
            let plane = camera.plane();
            for y in 0..plane.rows {
                for x in 0..plane.columns {
                    let ray = camera.ray(f64::from(x) + 0.5, f64::from(y) + 0.5);
                    let any = accel.cast(&ray, Cull::None);
                    assert!(any.is_some(), "{x} {y}");
                    assert_eq!(any, accel.cast(&ray, Cull::Back), "{x} {y}");
                }
            }
        }
    }
}
