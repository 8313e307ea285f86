//! Visibility of whole pictures of 1280 × 720: RayCast with each instruction set beside other people's
//! trees, and beside Embree where `EMBREE_LIBRARY` names it.
//!
//! `cargo bench -p raycast-report` runs all; words after `--` choose, and `--help` tells more. Casters
//! run one after another here: for ratios on a machine that is shared use `raycast bench --baselines`,
//! which takes turns.

use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use raycast_core::Simd;
use raycast_core::camera::Lattice;
use raycast_core::{Accel, Precision};
use raycast_report::casters::{self, Caster};
use raycast_report::embree::Embree;
use raycast_report::scenes::Made;
use raycast_report::subject::{find_tiles, tiles};
use std::collections::HashMap;
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

const SIZE: (u32, u32) = (1280, 720);

const SCENES: [Made; 5] = [
    Made::Ball(1_000),
    Made::Ball(16_000),
    Made::Ball(125_000),
    Made::Ball(1_000_000),
    Made::Interior(100_000),
];

/// A scene made ready for everyone.
struct Ready {
    /// The medium view's rays, then the close one's.
    views: [Vec<Lattice>; 2],
    raycast: Vec<Box<dyn Caster>>,
    others: Vec<Box<dyn Caster>>,
}

impl Ready {
    fn new(made: Made) -> Self {
        let scene = made.scene();
        let accel = Accel::build(&scene).expect("a valid scene");
        let view = |close| {
            let camera = made.camera(&scene, SIZE, close).expect("a good size");
            tiles(&camera, 1)
        };
        let raycast = Simd::available().map(|simd| {
            let accel = Arc::new(accel.clone().with_simd(simd));
            casters::raycast_simd(&accel, Precision::Exact)
        });
        let raycast = raycast.collect();
        let views = [view(false), view(true)];
        let accel = Arc::new(accel);
        let mut others = casters::trees(&accel);
        if let Ok(library) = Embree::load(rayon::current_num_threads()) {
            others.extend(casters::embree(&accel, &library).expect("Embree's scenes"));
        }
        Self {
            views,
            raycast,
            others,
        }
    }
}

/// The scene, made at its first use.
fn ready(made: Made) -> Arc<Ready> {
    static MADE: LazyLock<Mutex<HashMap<String, Arc<Ready>>>> = LazyLock::new(Mutex::default);
    let mut all = MADE.lock().unwrap_or_else(PoisonError::into_inner);
    let entry = all.entry(made.to_string());
    Arc::clone(entry.or_insert_with(|| Arc::new(Ready::new(made))))
}

fn run(bencher: Bencher<'_, '_>, caster: Option<&dyn Caster>, lattices: &[Lattice]) {
    // What this machine does not have takes no time.
    let Some(caster) = caster else { return };
    let rays: usize = lattices.iter().map(Lattice::len).sum();
    bencher
        .counter(ItemsCount::new(rays))
        .bench_local(|| black_box(find_tiles(caster, lattices)));
}

/// RayCast, from the plainest instruction set to the widest.
#[divan::bench(args = SCENES, consts = [0, 1, 2], sample_count = 15)]
fn raycast_medium<const SIMD: usize>(bencher: Bencher<'_, '_>, made: Made) {
    let ready = ready(made);
    run(
        bencher,
        ready.raycast.get(SIMD).map(|caster| &**caster),
        &ready.views[0],
    );
}

#[divan::bench(args = SCENES, consts = [0, 1, 2], sample_count = 15)]
fn raycast_close<const SIMD: usize>(bencher: Bencher<'_, '_>, made: Made) {
    let ready = ready(made);
    run(
        bencher,
        ready.raycast.get(SIMD).map(|caster| &**caster),
        &ready.views[1],
    );
}

fn other(made: Made, name: &str, bencher: Bencher<'_, '_>, view: usize) {
    let ready = ready(made);
    let caster = ready
        .others
        .iter()
        .find(|caster| caster.name().starts_with(name));
    run(bencher, caster.map(|caster| &**caster), &ready.views[view]);
}

const OTHERS: [&str; 4] = [
    "Embree 16 robust",
    "Embree 8 robust",
    "Embree 1 robust",
    "obvhs BVH2",
];

#[divan::bench(args = SCENES, consts = [0, 1, 2, 3], sample_count = 7)]
fn others_medium<const WAY: usize>(bencher: Bencher<'_, '_>, made: Made) {
    other(made, OTHERS[WAY], bencher, 0);
}

#[divan::bench(args = SCENES, consts = [0, 1, 2, 3], sample_count = 7)]
fn others_close<const WAY: usize>(bencher: Bencher<'_, '_>, made: Made) {
    other(made, OTHERS[WAY], bencher, 1);
}

fn main() {
    divan::main();
}
