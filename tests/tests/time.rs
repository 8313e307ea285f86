//! Hostile scenes take at most twenty times as long as ordinary ones (`raycast_report::cases::time`).
//!
//! How the time is known: the least of a few, hostile and ordinary in turn, on this thread; what else the
//! machine does slows both.

#![allow(clippy::print_stdout, reason = "tests tell what they measured")]

use raycast_core::accel::Accel;
use raycast_core::intersect::{Cull, Detail, Precision};
use raycast_report::cameras::PROJECTIONS;
use raycast_report::cases::time::{LIMIT, RACES, Seen};
use raycast_report::subject;
use std::time::{Duration, Instant};

/// A picture's rays: more show more, and take longer where something is wrong.
const SIZE: (u32, u32) = (320, 240);
const ROUNDS: usize = 3;

#[test]
fn hostile_scenes_take_no_time_without_bound() {
    let mut slow = Vec::new();
    for &(name, race) in RACES {
        let race = race();
        let built = |seen: &Seen| {
            let started = Instant::now();
            let accel = Accel::build(&seen.scene).expect("a valid scene");
            (accel, started.elapsed())
        };
        let (hostile, build) = built(&race.hostile);
        let (ordinary, ordinary_build) = built(&race.ordinary);
        for projection in PROJECTIONS {
            let [mut least, mut ordinary_least] = [Duration::MAX; 2];
            for _ in 0..ROUNDS {
                let time = |accel, seen: &Seen| {
                    let tiles = subject::tiles(&seen.camera(projection, SIZE), 1);
                    let mut hits = Vec::new();
                    let started = Instant::now();
                    for tile in &tiles {
                        let accel: &Accel = accel;
                        accel.cast_lattice(
                            tile,
                            Cull::None,
                            Precision::Exact,
                            Detail::Full,
                            &mut hits,
                        );
                    }
                    started.elapsed()
                };
                least = least.min(time(&hostile, &race.hostile));
                ordinary_least = ordinary_least.min(time(&ordinary, &race.ordinary));
            }
            let ratio = least.as_secs_f64() / ordinary_least.as_secs_f64();
            println!(
                "{name}, {projection:?}: {least:?}, ordinary {ordinary_least:?}: {ratio:.1} times; built in {build:?}, ordinary {ordinary_build:?}"
            );
            let build_ratio = build.as_secs_f64() / ordinary_build.as_secs_f64();
            if ratio > LIMIT || build_ratio > LIMIT {
                slow.push((name, projection, ratio, build_ratio));
            }
        }
    }
    assert!(slow.is_empty(), "{slow:#?}");
}
