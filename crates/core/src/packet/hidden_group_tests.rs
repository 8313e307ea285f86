//! Hidden groups against the same meshes without those triangles: the same answers, bit for bit.

use super::instance_tests::assert_equal;
use crate::bvh::Accel;
use crate::random::Random;
use crate::scene::{Groups, Mesh, MeshData, Object, Scene, TreeTopology};
use glam::DVec3;
use std::collections::BTreeSet;
use std::sync::Arc;

/// The groups' names; the last is that of triangles in no group.
const NAMES: [&str; 3] = ["a", "b", ""];

/// Forty triangles in groups at random. Each third is a copy of one before it, mostly in another group; those of the
/// names in `without` have corners that do not exist.
fn soup(seed: u64, without: &BTreeSet<String>) -> Mesh {
    let mut random = Random(seed);
    let mut positions: Vec<DVec3> = Vec::new();
    let mut groups = Vec::new();
    for number in 0..40 {
        if number % 3 == 2 {
            positions.extend_from_within(positions.len() - 6..positions.len() - 3);
        } else {
            let center = random.point();
            positions.extend([0; 3].map(|_| center + random.point() * 0.3));
        }
        groups.push((random.unit() * 3.0) as u32);
    }
    let triangles =
        (0..).zip(&groups).map(
            |(number, &group)| match without.contains(NAMES[group as usize]) {
                true => [u32::MAX; 3],
                false => [3 * number, 3 * number + 1, 3 * number + 2],
            },
        );
    let names = NAMES[..2].iter().map(|&name| name.to_owned()).collect();
    let own = groups.iter().map(|&group| (group < 2).then_some(group));
    Mesh::new(MeshData {
        positions,
        triangles: triangles.collect(),
        groups: Groups::of_triangles(names, own).expect("two names"),
        ..MeshData::default()
    })
}

fn some_names(random: &mut Random) -> BTreeSet<String> {
    let all = NAMES.into_iter().filter(|_| random.unit() < 0.4);
    all.map(str::to_owned).collect()
}

/// Objects of two meshes, with and without transforms, in which groups are hidden; and the same objects of meshes that
/// lack these triangles. With `known`, meshes know their trees, as prepared ones do.
fn scenes(random: &mut Random, known: bool) -> [Scene; 2] {
    let whole = [1, 2].map(|seed| {
        let mesh = soup(seed, &BTreeSet::new());
        let tree = known.then(|| TreeTopology::of(&mesh));
        Arc::new(match tree {
            Some(tree) => mesh.with_tree(tree),
            None => mesh,
        })
    });
    let mut hidden = Scene::default();
    let mut lacking = Scene::default();
    for number in 0..8 {
        let which = number % 2;
        let names = some_names(random);
        let mut object = Object::new(format!("{number}"), Arc::clone(&whole[which]));
        if number > 1 {
            object.transform.translate = random.point() * 0.5;
            object.transform.rotate = random.point() * 90.0;
        }
        object.visible = number != 5;
        let mut other = object.clone();
        other.mesh = Arc::new(soup(which as u64 + 1, &names));
        object.hide_groups(names);
        hidden.objects.push(object);
        lacking.objects.push(other);
    }
    [hidden, lacking]
}

#[test]
fn hidden_groups_are_as_triangles_that_are_not_there() {
    let mut random = Random(41);
    let mut hits = 0;
    for round in 0..10 {
        let [hidden, lacking] = scenes(&mut random, round % 2 == 1);
        assert_eq!(hidden.bounds(), lacking.bounds());
        assert_eq!(hidden.bounding_sphere(), lacking.bounding_sphere());
        let expected = Accel::build(&lacking).expect("a valid scene");
        let shown = {
            let mut all = hidden.clone();
            let objects = all.objects.iter_mut();
            objects.for_each(|object| object.hide_groups(BTreeSet::new()));
            all
        };
        let before = Accel::build_instances(&shown).expect("a valid scene");
        let after = before.updated(&hidden).expect("a valid scene");
        for accel in [
            &Accel::build(&hidden).expect("a valid scene"),
            &Accel::build_instances(&hidden).expect("a valid scene"),
            &after,
        ] {
            assert_eq!(accel.len(), expected.len());
            hits += assert_equal(&expected, accel, DVec3::ZERO, &mut random);
        }
        // The whole meshes still have their trees.
        let again = after.updated_at_once(&shown).expect("a small change");
        let anew = Accel::build(&shown).expect("a valid scene");
        assert_equal(&anew, &again, DVec3::ZERO, &mut random);
        // What was hidden before has not: there may be many such choices.
        assert!(again.updated_at_once(&hidden).is_none());
    }
    assert!(hits > 50_000, "{hits}");
}

#[test]
fn contents_differ_where_other_triangles_are_hidden() {
    let mesh = Arc::new(soup(1, &BTreeSet::new()));
    let content = |names: &[&str]| {
        let mut scene = Scene {
            objects: vec![Object::new("soup", Arc::clone(&mesh))],
        };
        scene.objects[0].hide_groups(names.iter().map(|&name| name.to_owned()).collect());
        scene.content()
    };
    assert_ne!(content(&[]), content(&["a"]));
    assert_ne!(content(&["b"]), content(&["a"]));
    assert_eq!(content(&[]), content(&["no such group"]));
}
