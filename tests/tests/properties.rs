//! What holds for any mesh and any ray, tried on many and shrunk to the least that fails.
//!
//! How the truth is known: rational arithmetic on the vertices as stored (`raycast-oracle`). The
//! tries are the same each run; `PROPTEST_RNG_SEED` gives others and `PROPTEST_CASES` more. What
//! fails becomes a hard case.

use proptest::collection::vec;
use proptest::prelude::*;
use proptest::test_runner::RngSeed;
use raycast_core::Cull;
use raycast_core::camera::{Camera, ImagePlane, Lattice, Pose, Projection, Ray, Rect};
use raycast_core::glam::DVec3;
use raycast_core::math;
use raycast_report::meshes::mesh;
use raycast_tests::check::{Check, Stage};

fn config(cases: u32) -> ProptestConfig {
    let given = ProptestConfig::default();
    let is_given = |variable: &str| std::env::var_os(variable).is_some();
    ProptestConfig {
        cases: if is_given("PROPTEST_CASES") {
            given.cases
        } else {
            cases
        },
        rng_seed: match given.rng_seed {
            RngSeed::Random => RngSeed::Fixed(4),
            fixed => fixed,
        },
        failure_persistence: None,
        max_shrink_iters: 20_000,
        ..given
    }
}

/// A number for a coordinate: whole ones make borders meet, others lie in any decade.
#[derive(Clone, Copy, Debug)]
enum Number {
    Whole(i8),
    Any(f64, i8),
}

impl Number {
    fn get(self) -> f64 {
        match self {
            Self::Whole(x) => f64::from(x),
            Self::Any(x, decade) => x * 10f64.powi(decade.into()),
        }
    }
}

fn number() -> impl Strategy<Value = Number> {
    prop_oneof![
        (-8i8..=8).prop_map(Number::Whole),
        (-1.0..1.0, Just(0)).prop_map(|(x, decade)| Number::Any(x, decade)),
        (-1.0..1.0, -4i8..=3).prop_map(|(x, decade)| Number::Any(x, decade)),
    ]
}

/// A point that may depend on those before it.
#[derive(Clone, Copy, Debug)]
enum Point {
    At([Number; 3]),
    /// On a line or in a plane with three earlier ones, or so many units in the last place off.
    Between([usize; 3], [Number; 2], i8),
}

impl Point {
    fn get(self, earlier: &[DVec3]) -> DVec3 {
        match self {
            Self::Between(of, [u, v], ulps) if !earlier.is_empty() => {
                let [a, b, c] = of.map(|i| earlier[i % earlier.len()]);
                let place = a + (b - a) * (u.get() / 8.0) + (c - a) * (v.get() / 8.0);
                nudged(place, ulps)
            }
            Self::At(numbers) => DVec3::from_array(numbers.map(Number::get)),
            Self::Between(..) => DVec3::ZERO,
        }
    }
}

/// Each coordinate, as a single, so many units in the last place further.
fn nudged(point: DVec3, ulps: i8) -> DVec3 {
    if ulps == 0 {
        return point;
    }
    let coordinate = |x: f64| {
        let mut x = x as f32;
        for _ in 0..ulps.abs() {
            x = if ulps > 0 { x.next_up() } else { x.next_down() };
        }
        f64::from(x)
    };
    DVec3::from_array(point.to_array().map(coordinate))
}

fn point() -> impl Strategy<Value = Point> {
    let between = || {
        let of = [0usize..16, 0usize..16, 0usize..16];
        (of, [number(), number()], -2i8..=2)
    };
    prop_oneof![
        3 => [number(), number(), number()].prop_map(Point::At),
        1 => [number(), number()].prop_map(|[x, y]| Point::At([x, y, Number::Whole(0)])),
        2 => between().prop_map(|(of, weights, ulps)| Point::Between(of, weights, ulps)),
    ]
}

/// Triangles over few vertices: they share corners and edges, lie on one another, cross.
#[derive(Clone, Debug)]
struct Shape {
    points: Vec<Point>,
    triangles: Vec<[usize; 3]>,
    /// Everything times a power of two.
    power: i8,
    /// Everything moved by this, in those units.
    shift: Point,
}

impl Shape {
    fn scale(&self) -> f64 {
        2f64.powi(self.power.into())
    }

    fn shift(&self) -> DVec3 {
        // Up to some thousands of lengths away, as wholes of a grain that corners keep.
        self.shift.get(&[]) * self.scale() * 64.0
    }

    fn points(&self) -> Vec<DVec3> {
        let mut points = Vec::new();
        for point in &self.points {
            points.push(point.get(&points));
        }
        points
            .into_iter()
            .map(|point| point * self.scale() + self.shift())
            .collect()
    }

    fn stage(&self) -> Stage {
        let points = self.points();
        let triangles = self
            .triangles
            .iter()
            .map(|corners| corners.map(|i| (i % points.len()) as u32))
            .collect();
        Stage::from_meshes([mesh(points, triangles)])
    }
}

fn shape() -> impl Strategy<Value = Shape> {
    let shift = prop_oneof![
        3 => Just(Point::At([Number::Whole(0); 3])),
        1 => [number(), number(), number()].prop_map(Point::At),
    ];
    let power = prop_oneof![3 => Just(0i8), 1 => -60i8..=40];
    (
        vec(point(), 3..12),
        vec([0usize..16, 0usize..16, 0usize..16], 1..16),
        power,
        shift,
    )
        .prop_map(|(points, triangles, power, shift)| Shape {
            points,
            triangles,
            power,
            shift,
        })
}

/// A place for an eye or a target: of its own, or where the shape is hardest.
fn place(point: Point, shape: &Shape) -> DVec3 {
    match point {
        Point::Between(..) => point.get(&shape.points()),
        Point::At(_) => point.get(&[]) * shape.scale() + shape.shift(),
    }
}

#[derive(Clone, Debug)]
struct Aim {
    origin: Point,
    target: Point,
    /// The direction's length as a decade.
    decade: i8,
    /// Where the range begins and ends, in distances to the target.
    range: Option<[Number; 2]>,
    cull: bool,
}

impl Aim {
    fn ray(&self, shape: &Shape) -> Ray {
        let origin = place(self.origin, shape);
        let length = 10f64.powi(self.decade.into());
        let ray = Ray::new(origin, (place(self.target, shape) - origin) * length);
        match self.range {
            None => ray,
            Some([begin, end]) => Ray {
                t_min: begin.get() / 8.0 / length,
                t_max: end.get() / 8.0 / length,
                ..ray
            },
        }
    }
}

fn aim() -> impl Strategy<Value = Aim> {
    (
        point(),
        point(),
        prop_oneof![Just(0i8), -9i8..=9],
        proptest::option::weighted(0.2, [number(), number()]),
        any::<bool>(),
    )
        .prop_map(|(origin, target, decade, range, cull)| Aim {
            origin,
            target,
            decade,
            range,
            cull,
        })
}

fn culling(cull: bool) -> Cull {
    if cull { Cull::Back } else { Cull::None }
}

/// A camera and some of its rays.
#[derive(Clone, Debug)]
struct Shot {
    eye: Point,
    target: Point,
    is_orthographic: bool,
    /// Steps of a power of two put rays on whole places.
    step: Step,
    size: (u32, u32),
    /// The first pixel, as a share of the picture; beyond 100 the picture is larger than it looks.
    first: (u32, u32),
    stride: u32,
    offset: (Number, Number),
    cull: bool,
}

#[derive(Clone, Copy, Debug)]
enum Step {
    /// The frame's height as a decade of the distance.
    Decade(f64),
    /// A power of two, in the shape's units.
    Power(i8),
}

impl Shot {
    fn lattice(&self, shape: &Shape) -> Lattice {
        let pose = Pose {
            eye: place(self.eye, shape),
            target: place(self.target, shape),
            up: DVec3::Y,
        };
        let (width, height) = self.size;
        let (x, y) = self.first;
        let [columns, rows] = [width * self.stride + 2 * x, height * self.stride + 2 * y];
        let distance = match (pose.eye - pose.target).length() {
            0.0 => 1.0,
            distance => distance,
        };
        let step = match self.step {
            Step::Decade(decade) => distance * math::pow(10.0, decade) / f64::from(rows),
            Step::Power(power) => shape.scale() * 2f64.powi(power.into()),
        };
        let plane = ImagePlane::new(columns, rows, step).expect("a good plane");
        let projection = if self.is_orthographic {
            Projection::Orthographic
        } else {
            Projection::Perspective
        };
        let rect = Rect {
            x,
            y,
            width: width * self.stride,
            height: height * self.stride,
        };
        let offset = |number: Number| (number.get() / 8.0).clamp(0.0, 1.0);
        Lattice {
            offset: (offset(self.offset.0), offset(self.offset.1)),
            ..Camera::new(pose, projection, plane)
                .sub_camera(rect)
                .sparse_lattice(self.stride, (0, 0))
        }
    }
}

fn shot() -> impl Strategy<Value = Shot> {
    let step = prop_oneof![
        (-4.0..2.0).prop_map(Step::Decade),
        (-0.5..0.8).prop_map(Step::Decade),
        (-6i8..=1).prop_map(Step::Power),
    ];
    let first = prop_oneof![Just(0u32), 0u32..70, 0u32..4000];
    let offset = || prop_oneof![Just(Number::Whole(4)), Just(Number::Whole(0)), number()];
    (
        (point(), point(), any::<bool>(), step),
        (1u32..40, 1u32..40),
        (first.clone(), first),
        prop_oneof![3 => Just(1u32), 1 => 1u32..17],
        (offset(), offset()),
        any::<bool>(),
    )
        .prop_map(
            |((eye, target, is_orthographic, step), size, first, stride, offset, cull)| Shot {
                eye,
                target,
                is_orthographic,
                step,
                size,
                first,
                stride,
                offset,
                cull,
            },
        )
}

proptest! {
    #![proptest_config(config(4000))]

    /// The tree, brute force and the oracle give the same.
    #[test]
    fn a_ray_meets_what_the_oracle_says(shape in shape(), aims in vec(aim(), 1..20)) {
        let stage = shape.stage();
        for aim in aims {
            stage.check(&aim.ray(&shape), culling(aim.cull));
        }
    }

    /// Which is the single ray's hit, bit for bit, with each instruction set.
    #[test]
    fn a_lattice_gives_what_its_rays_give(shape in shape(), shot in shot()) {
        let stage = shape.stage();
        stage.check_lattice(&shot.lattice(&shape), culling(shot.cull), 8);
    }

    /// An octahedron whose corners lie at any distance along their axes is closed around its middle.
    #[test]
    fn no_ray_leaves_a_closed_mesh(
        reaches in [number(), number(), number(), number(), number(), number()],
        power in -40i8..=40,
        shift in point(),
        directions in vec(point(), 1..40),
    ) {
        let scale = 2f64.powi(power.into());
        let middle = (shift.get(&[]) * 64.0).round() * scale;
        let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        // Wholes of a grain that a single holds next to the offset, and the middle too.
        let reach = |number: Number| (number.get().abs() * 64.0).ceil().max(1.0) / 64.0;
        let corners: Vec<DVec3> = axes
            .into_iter()
            .zip(reaches)
            .map(|(axis, number)| middle + axis * reach(number) * scale)
            .collect();
        let triangles = raycast_report::meshes::octahedron().triangles().to_vec();
        let stage = Stage::from_meshes([mesh(corners.clone(), triangles)]);
        prop_assume!(stage.accel.len() == 8);
        let stored_middle_is_inside = corners.iter().all(|&corner| corner != middle);
        prop_assume!(stored_middle_is_inside);
        for direction in directions {
            let direction = direction.get(&corners.iter().map(|&c| c - middle).collect::<Vec<_>>());
            if direction != DVec3::ZERO {
                let ray = Ray::new(middle, direction);
                prop_assert!(stage.check(&ray, Cull::None).is_some(), "{ray:?}");
            }
        }
    }
}
