//! All hits of packets' rays against those of single rays.

use super::MultiHits;
use super::around_tests::accel;
use super::cast_tests::{cameras, waves, waves_mesh};
use super::clip_tests::planes;
use crate::bvh::Accel;
use crate::camera::{Camera, ImagePlane, Lattice, Panorama, Pose, Projection, Rect};
use crate::hit::{Cull, Precision};
use crate::num::simd::Simd;
use crate::random::Random;
use crate::scene::{
    Alpha, ClippingPlanes, Color, Masks, Material, Mesh, MeshData, Object, Opacity, Scene,
};
use crate::single::{Clipped, MOST_HITS, OrderedHits};
use glam::DVec3;
use std::sync::Arc;

/// How many rays of a lattice have hits, and the most hits of one; each ray that is asked for has its single ray's.
fn check(
    kept: &Clipped<'_>,
    lattice: &Lattice,
    cull: Cull,
    is_opaque: &dyn Fn(u32) -> bool,
) -> (usize, usize) {
    let options = (cull, Precision::Exact);
    // All rays but each seventh.
    let wanted: Vec<bool> = (0..lattice.len()).map(|ray| ray % 7 != 3).collect();
    let mut found = MultiHits::default();
    let mut single = OrderedHits::default();
    let (mut count, mut most) = (0, 0);
    // The second time its buffers have been used.
    for _ in 0..2 {
        found.find(kept, lattice, options, &wanted, is_opaque);
    }
    for (at, &is_wanted) in wanted.iter().enumerate() {
        let hits = found.of(at);
        if !is_wanted {
            assert!(hits.is_empty());
            continue;
        }
        let ray = at as u32;
        let ray = lattice.ray(ray % lattice.columns, ray / lattice.columns);
        single.find(kept, &ray, options, is_opaque);
        let expected: Vec<u32> = single.primitives().collect();
        assert_eq!(hits, expected, "{at} {:?}", lattice.camera);
        count += usize::from(!hits.is_empty());
        most = most.max(hits.len());
    }
    (count, most)
}

fn lattices(camera: Camera) -> [Lattice; 2] {
    let rect = Rect {
        x: 3,
        y: 1,
        width: 98,
        height: 71,
    };
    let sub_camera = camera.sub_camera(rect);
    [sub_camera.lattice(), sub_camera.sparse_lattice(4, (2, 0))]
}

#[test]
fn rays_have_the_hits_of_their_single_rays() {
    let mut random = Random(31);
    let (mut count, mut most) = (0, 0);
    for (side, size, offset) in [
        (5, 1.0, DVec3::ZERO),
        (40, 1.0, DVec3::ZERO),
        (24, 30.0, DVec3::new(148_376.0, 1234.0, -223_423.0)),
    ] {
        let accel = waves(side, size, offset);
        for camera in cameras(size, offset) {
            let planes = planes(&mut random, &accel, camera.pose().eye, 2);
            for lattice in lattices(camera) {
                for cull in [Cull::None, Cull::Back] {
                    for simd in Simd::available() {
                        let accel = accel.clone().with_simd(simd);
                        for planes in [&ClippingPlanes::NONE, &planes] {
                            let kept = accel.clipped(planes);
                            for opaque in [u32::MAX, 5] {
                                let is_opaque = |primitive: u32| primitive % opaque == opaque / 2;
                                let found = check(&kept, &lattice, cull, &is_opaque);
                                count += found.0;
                                most = most.max(found.1);
                            }
                        }
                    }
                }
            }
        }
    }
    assert!(count > 100_000 && most > 3, "{count} {most}");
}

/// Layers that coincide, cross, touch, or lie within the roundings of their depths, some of them more than once.
#[test]
fn hits_at_equal_distances_go_by_object_and_triangle() {
    let mut random = Random(32);
    let mut most = 0;
    for thickness in [0.0, 1e-15, 1e-7, 1e-3, 1.0] {
        let mut layers = Vec::new();
        for _ in 0..60 {
            let corner = |random: &mut Random| random.point() * DVec3::new(0.7, 0.7, thickness);
            let corners = [(); 3].map(|()| corner(&mut random));
            layers.extend([corners; 2]);
            layers.push([corners[1], corners[0], corners[2]]);
        }
        let accel = accel(layers);
        for camera in cameras(1.0, DVec3::ZERO) {
            let kept = accel.clipped(&ClippingPlanes::NONE);
            let [lattice, _] = lattices(camera);
            let (_, found) = check(&kept, &lattice, Cull::None, &|_| false);
            most = most.max(found);
            // What lies within the error of an opaque one may be nearer.
            check(&kept, &lattice, Cull::None, &|primitive| primitive % 9 == 1);
        }
    }
    assert!(most > 20, "{most}");
}

/// Parallel rays that start on triangles, in front of some, and behind others.
#[test]
fn triangles_that_rays_start_on_are_not_hit() {
    let mut random = Random(34);
    let planes = [0.0, -1.0, 0.5, 1e-9, -1e-9];
    let mut corner = |z: f64| (random.point() * 0.8).with_z(z);
    let corners = |at: usize| [(); 3].map(|()| planes[at % 5]).map(&mut corner);
    let accel = accel((0..150).map(corners).collect());
    let plane = ImagePlane::new(101, 75, 0.015).expect("a good plane");
    let pose = Pose::towards(DVec3::ZERO, DVec3::NEG_Z);
    let camera = Camera::new(pose, Projection::Orthographic, plane);
    let kept = accel.clipped(&ClippingPlanes::NONE);
    let [lattice, _] = lattices(camera);
    let (count, most) = check(&kept, &lattice, Cull::None, &|_| false);
    assert!(count > 3000 && most > 10, "{count} {most}");
}

#[test]
fn instances_have_the_hits_of_one_tree() {
    let mesh = Arc::new(waves_mesh(16, 1.0, DVec3::ZERO));
    let mut scene = Scene {
        objects: vec![Object::new("", Arc::clone(&mesh)), Object::new("", mesh)],
    };
    scene.objects[1].transform.rotate.z = 33.0;
    let instances = Accel::build_instances(&scene).expect("a valid scene");
    for camera in cameras(1.0, DVec3::ZERO) {
        for lattice in lattices(camera) {
            let kept = instances.clipped(&ClippingPlanes::NONE);
            check(&kept, &lattice, Cull::None, &|primitive| primitive % 3 == 0);
        }
    }
}

#[test]
fn panoramas_have_the_hits_of_their_single_rays() {
    let accel = waves(16, 1.0, DVec3::ZERO);
    for camera in cameras(1.0, DVec3::ZERO) {
        for panorama in [Panorama::Equirectangular, Panorama::CubeStrip] {
            let projection = Projection::Panoramic(panorama);
            let camera = Camera::new(camera.pose(), projection, camera.plane());
            for lattice in lattices(camera) {
                let kept = accel.clipped(&ClippingPlanes::NONE);
                check(&kept, &lattice, Cull::None, &|_| false);
            }
        }
    }
}

/// More layers than a ray's hits, and more hits than a packet's buffer has room for.
#[test]
fn of_many_layers_the_nearest_count() {
    let layer = |z: f64| {
        let corner = |x: f64, y: f64| DVec3::new(x, y, z);
        [corner(-9.0, -9.0), corner(9.0, -9.0), corner(0.0, 9.0)]
    };
    let accel = accel(
        (0..400)
            .map(|at| layer(f64::from(at * 37 % 400) / 800.0))
            .collect(),
    );
    let mut most = 0;
    for camera in cameras(1.0, DVec3::ZERO) {
        let kept = accel.clipped(&ClippingPlanes::NONE);
        let [_, lattice] = lattices(camera);
        most = most.max(check(&kept, &lattice, Cull::None, &|_| false).1);
        let [lattice, _] = lattices(camera);
        check(&kept, &lattice, Cull::None, &|primitive| {
            primitive % 40 == 0
        });
    }
    assert_eq!(most, MOST_HITS);
}

/// Each second triangle has a mask that rejects all of it.
#[test]
fn hits_that_masks_reject_do_not_count() {
    let mut random = Random(33);
    let mut corner = || random.point() * DVec3::new(1.0, 1.0, 0.5);
    let material = |opacity: Opacity| Material {
        opacity,
        ..Material::new("", Color([255; 3]))
    };
    let mask = Opacity::Mask {
        alpha: Alpha {
            factor: 0.25,
            image: None,
        },
        cutoff: 0.5,
    };
    let mesh = Mesh::new(MeshData {
        positions: (0..360).map(|_| corner()).collect(),
        triangles: (0..120).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        materials: vec![material(Opacity::Opaque), material(mask)],
        material_of_triangle: (0..120).map(|triangle| triangle % 2).collect(),
        ..MeshData::default()
    });
    let scene = Scene {
        objects: vec![Object::new("", Arc::new(mesh))],
    };
    let accel = Accel::build(&scene).expect("a valid scene");
    let masks = Masks::of(&scene);
    let (mut all, mut kept) = (0, 0);
    for camera in cameras(1.0, DVec3::ZERO) {
        for lattice in lattices(camera) {
            let unmasked = accel.clipped(&ClippingPlanes::NONE);
            let masked = unmasked.clone().masked(masks.as_ref());
            all += check(&unmasked, &lattice, Cull::None, &|_| true).0;
            kept += check(&masked, &lattice, Cull::None, &|_| true).0;
        }
    }
    assert!(kept > 10_000 && all > kept + 500, "{all} {kept}");
}
