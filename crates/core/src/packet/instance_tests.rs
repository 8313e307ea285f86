//! Instances against one tree over all triangles: the same answers, bit for bit, from packets and from single rays.

use super::cast_tests::{cameras, waves_mesh};
use crate::bvh::Accel;
use crate::hit::{Cull, Detail, Hit, Precision};
use crate::num::simd::Simd;
use crate::random::Random;
use crate::ray::Ray;
use crate::scene::{Mesh, MeshData, Object, Scene, Transform};
use glam::{DAffine3, DVec3};
use std::sync::Arc;

fn below(random: &mut Random, count: u32) -> u32 {
    ((random.unit() * f64::from(count)) as u32).min(count - 1)
}

fn soup(random: &mut Random, count: u32, offset: DVec3) -> Arc<Mesh> {
    let positions = (0..count).flat_map(|_| {
        let center = random.point();
        [0; 3].map(|_| offset + center + random.point() * 0.3)
    });
    Arc::new(Mesh::new(MeshData {
        positions: positions.collect(),
        triangles: (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        ..MeshData::default()
    }))
}

/// Objects that share few meshes, around a point: some without transform, some with the same transform, some with
/// parents, some hidden.
fn scene(random: &mut Random, offset: DVec3) -> Scene {
    let meshes = [
        soup(random, 1, offset),
        soup(random, 4, offset),
        soup(random, 40, offset),
        Arc::new(waves_mesh(12, 1.0, offset)),
        soup(random, 0, offset),
    ];
    let mut objects: Vec<Object> = Vec::new();
    for number in 0..30 {
        let mesh = &meshes[below(random, meshes.len() as u32) as usize];
        let mut object = Object::new(format!("{number}"), Arc::clone(mesh));
        if number % 3 != 0 {
            object.transform.rotate = random.point() * 90.0;
            object.transform.scale = random.point() * 0.4 + 0.6;
            // Relative to the mesh's own position.
            let matrix = object.transform.parent_from_object();
            object.transform = Transform::from_matrix(
                DAffine3::from_translation(offset + random.point() * 0.7)
                    * matrix
                    * DAffine3::from_translation(-offset),
            );
        }
        if number % 5 == 4 {
            object.transform = objects[number - 2].transform;
            object.mesh = Arc::clone(&objects[number - 2].mesh);
        }
        object.parent = (number % 7 == 6).then(|| number - 1);
        if number % 7 == 6 {
            object.transform = Transform {
                rotate: DVec3::new(0.0, 1.0, 0.0),
                ..Transform::IDENTITY
            };
        }
        object.visible = number % 8 != 7;
        objects.push(object);
    }
    Scene { objects }
}

/// Compares both trees; returns how many rays hit something.
pub(super) fn assert_equal(
    one: &Accel,
    other: &Accel,
    offset: DVec3,
    random: &mut Random,
) -> usize {
    assert_eq!(one.origin(), other.origin());
    let mut hits = 0;
    for _ in 0..300 {
        let (from, to) = (random.point() * 2.0, random.point());
        let corner = match one.len() as u32 {
            0 => to,
            count => one.origin() + one.corners(below(random, count))[0].as_dvec3() - offset,
        };
        let to = if below(random, 2) == 0 { to } else { corner };
        let ray = Ray::new(offset + from, to - from);
        for cull in [Cull::None, Cull::Back] {
            let hit = one.cast(&ray, cull);
            assert_eq!(other.cast(&ray, cull), hit, "{ray:?}");
            assert_eq!(other.cast_brute_force(&ray, cull), hit, "{ray:?}");
            hits += usize::from(hit.is_some());
        }
    }
    let (mut expected, mut found) = (Vec::new(), Vec::new());
    for (number, camera) in cameras(1.5, offset).into_iter().enumerate() {
        let plane = camera.plane();
        let rect = crate::camera::Rect {
            x: 0,
            y: 0,
            width: plane.columns,
            height: plane.rows,
        };
        let lattice = camera.sub_camera(rect).lattice();
        let cull = [Cull::None, Cull::Back][number % 2];
        let simd = [Simd::best(), Simd::Plain, Simd::Avx2][number % 3];
        one.cast_lattice(
            &lattice,
            cull,
            Precision::Exact,
            Detail::Full,
            &mut expected,
        );
        let other = other.clone().with_simd(simd);
        other.cast_lattice(&lattice, cull, Precision::Exact, Detail::Full, &mut found);
        for (at, (a, b)) in expected.iter().zip(&found).enumerate() {
            assert_eq!(a.is_miss(), b.is_miss(), "{camera:?} {at}");
            assert_eq!(
                [a.t, a.u, a.v].map(f32::to_bits),
                [b.t, b.u, b.v].map(f32::to_bits)
            );
            if !a.is_miss() {
                assert_eq!(one.identify(a.primitive), other.identify(b.primitive));
                assert_eq!(one.corners(a.primitive), other.corners(b.primitive));
                hits += 1;
            }
        }
    }
    hits
}

fn is_at_rest(object: &Object) -> bool {
    object.transform == Transform::IDENTITY && object.parent.is_none()
}

fn assert_entry_points_have_what_is_seen(accel: &Accel, offset: DVec3) {
    for camera in cameras(1.5, offset) {
        let plane = camera.plane();
        let rect = crate::camera::Rect {
            x: 0,
            y: 0,
            width: plane.columns,
            height: plane.rows,
        };
        for large in accel.record_trace(&camera.sub_camera(rect).lattice(), Cull::None) {
            let listed = large
                .entry_points
                .iter()
                .flat_map(|entry| &entry.primitives);
            let listed: std::collections::HashSet<_> = listed.collect();
            let seen = large.packets.iter().flat_map(|packet| &packet.seen);
            assert!(seen.into_iter().all(|primitive| listed.contains(primitive)));
        }
    }
}

#[test]
fn instances_answer_as_one_tree_does() {
    let mut random = Random(21);
    let mut hits = 0;
    for round in 0..12 {
        let offset = [DVec3::ZERO, DVec3::new(3e5, -7e6, 41.0)][round % 2];
        let scene = scene(&mut random, offset);
        let one = Accel::build(&scene).expect("a valid scene");
        let other = Accel::build_instances(&scene).expect("a valid scene");
        assert!(other.has_instances() && !one.has_instances());
        hits += assert_equal(&one, &other, offset, &mut random);
        for _ in 0..20 {
            let direction = random.point();
            assert_eq!(one.support(direction), other.support(direction));
        }
        let (a, b) = (one.bounds(), other.bounds());
        assert_eq!((a.min, a.max), (b.min, b.max));
        // Objects that have moved: their corners are placed by each packet.
        let mut elsewhere = scene.clone();
        for object in elsewhere.objects.iter_mut().filter(|o| !is_at_rest(o)) {
            object.transform.translate += DVec3::splat(0.01);
        }
        let before = Accel::build_instances(&elsewhere).expect("a valid scene");
        let moved = before.updated_at_once(&scene).expect("a small change");
        hits += assert_equal(&one, &moved, offset, &mut random);
        assert!(moved.retained_bytes() < before.retained_bytes());
        assert_entry_points_have_what_is_seen(&moved, offset);
    }
    assert!(hits > 100_000, "{hits}");
}

#[test]
fn updated_trees_answer_as_trees_built_from_scratch() {
    let mut random = Random(22);
    let mut scene = scene(&mut random, DVec3::ZERO);
    let mut accel = Accel::build_instances(&scene).expect("a valid scene");
    let removed = scene.objects[29].clone();
    for round in 0..24 {
        let which = below(&mut random, scene.objects.len() as u32) as usize;
        match round % 6 {
            0 => scene.objects[which].visible ^= true,
            1 => scene.objects[which].transform.translate += random.point() * 0.3,
            2 => {
                let copy = scene.objects[which].clone();
                scene.objects.push(copy);
            }
            3 => _ = scene.objects.pop(),
            4 => scene.objects[which].transform = Transform::IDENTITY,
            _ => scene
                .objects
                .iter_mut()
                .for_each(|object| object.visible = round == 11),
        }
        let updated = accel.updated_at_once(&scene).expect("a small change");
        let anew = Accel::build(&scene).expect("a valid scene");
        assert_equal(&anew, &updated, DVec3::ZERO, &mut random);
        accel = updated;
    }
    // A mesh without a known tree needs one built; a mesh with one does not, wherever its objects were in between.
    let new = soup(&mut random, 50, DVec3::ZERO);
    scene.objects.push(Object::new("new", new));
    assert!(accel.updated_at_once(&scene).is_none());
    let accel = accel.updated(&scene).expect("a valid scene");
    let anew = Accel::build(&scene).expect("a valid scene");
    assert_equal(&anew, &accel, DVec3::ZERO, &mut random);
    let kept = std::mem::take(&mut scene.objects);
    let accel = accel.updated_at_once(&scene).expect("nothing at all");
    assert!(accel.is_empty() && accel.bounds().is_empty());
    scene.objects = kept;
    scene.objects.push(removed);
    assert!(accel.updated_at_once(&scene).is_some());
}

#[test]
fn moving_the_first_object_moves_no_corner_of_another() {
    let mut random = Random(23);
    let offset = DVec3::new(1e6, 0.0, 0.0);
    let mut scene = scene(&mut random, offset);
    scene.objects[0].mesh = soup(&mut random, 9, offset);
    let accel = Accel::build_instances(&scene).expect("a valid scene");
    scene.objects[0].transform.translate.x = -2e6 / 3.0;
    let moved = accel.updated_at_once(&scene).expect("a small change");
    assert_eq!(moved.origin(), accel.origin());
    let others = |accel: &Accel| {
        let all = accel
            .primitives()
            .map(|p| (accel.identify(p), accel.corners(p)));
        let mut all: Vec<_> = all.filter(|((object, _), _)| *object != 0).collect();
        all.sort_by_key(|(id, _)| *id);
        all
    };
    assert!(others(&accel).len() > 100);
    assert_eq!(others(&moved), others(&accel));
}

#[test]
fn equal_distances_go_to_the_lowest_object_then_the_lowest_triangle() {
    let mut random = Random(24);
    let mesh = Arc::new(waves_mesh(6, 1.0, DVec3::ZERO));
    // The same triangles in another order and orientation: no copies, at the same positions.
    let mut data = MeshData {
        positions: mesh.positions().iter().map(|p| p.as_dvec3()).collect(),
        triangles: mesh.triangles().to_vec(),
        ..MeshData::default()
    };
    data.triangles.reverse();
    data.triangles
        .iter_mut()
        .for_each(|corners| corners.swap(1, 2));
    let turned = Arc::new(Mesh::new(data));
    for order in [[0, 1, 1], [1, 0, 1], [1, 1, 0]] {
        let objects = order.map(|which| Object::new("", Arc::clone([&mesh, &turned][which])));
        let mut scene = Scene {
            objects: objects.to_vec(),
        };
        let one = Accel::build(&scene).expect("a valid scene");
        let mut other = Accel::build_instances(&scene).expect("a valid scene");
        assert!(assert_equal(&one, &other, DVec3::ZERO, &mut random) > 1000);
        let down = Ray::new(DVec3::new(0.013, 1.0, 0.021), DVec3::NEG_Y);
        for expected in 0..3 {
            let object = |hit: Hit| hit.object;
            assert_eq!(other.cast(&down, Cull::None).map(object), Some(expected));
            scene.objects[expected as usize].visible = false;
            other = other.updated_at_once(&scene).expect("a small change");
        }
        assert!(other.is_empty());
    }
}

#[test]
fn triangles_out_of_range_are_counted_and_the_others_are_hit() {
    let corners = vec![DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ONE * 1e10];
    let mesh = Arc::new(Mesh::new(MeshData {
        positions: corners,
        triangles: vec![[0, 1, 2], [0, 1, 3]],
        ..MeshData::default()
    }));
    let mut far = Object::new("far", Arc::clone(&mesh));
    far.transform.scale = DVec3::splat(1e9);
    let mut scene = Scene {
        objects: vec![far, Object::new("near", mesh)],
    };
    let one = Accel::build(&scene).expect("a valid scene");
    let other = Accel::build_instances(&scene).expect("a valid scene");
    assert_eq!((other.out_of_range(), other.len()), (1, 3));
    let mut random = Random(25);
    assert_equal(&one, &other, DVec3::ZERO, &mut random);
    for scale in [1e300, 0.0, 1e-40] {
        scene.objects[0].transform.scale = DVec3::splat(scale);
        let one = Accel::build(&scene).expect("a valid scene");
        let other = other.updated_at_once(&scene).expect("a small change");
        assert_eq!(one.out_of_range(), other.out_of_range());
        assert_equal(&one, &other, DVec3::ZERO, &mut random);
    }
}

#[test]
fn trees_that_are_kept_for_objects_to_come_count_as_memory() {
    let mut random = Random(26);
    let mesh = soup(&mut random, 500, DVec3::ZERO);
    let mut scene = Scene {
        objects: (0..3).map(|_| Object::new("", Arc::clone(&mesh))).collect(),
    };
    scene.objects[1].transform.translate.x = 1.0;
    scene.objects[2].transform.translate.x = 2.0;
    let shown = Accel::build_instances(&scene).expect("a valid scene");
    let tree = Accel::build(&Scene::from(Mesh::clone(&mesh))).expect("a valid scene");
    // The placed corners of three objects, and the mesh's own.
    assert!(shown.retained_bytes() > 3 * tree.retained_bytes());
    let objects = std::mem::take(&mut scene.objects);
    let empty = shown.updated_at_once(&scene).expect("nothing at all");
    assert!(empty.is_empty() && empty.retained_bytes() > tree.retained_bytes() / 2);
    drop(objects);
}
