//! Hostile scenes take at most twenty times as long as ordinary ones, but for some that are known to take
//! longer (`raycast_report::cases::time`).
//!
//! How the time is known: the least of a few, hostile and ordinary in turn, on this thread; what else the
//! machine does slows both.

#![allow(clippy::print_stdout, reason = "tests tell what they measured")]

use raycast_report::cases::time::{LIMIT, RACES};
use raycast_report::sections::time::measure;

#[test]
fn hostile_scenes_take_no_time_without_bound() {
    let mut slow = Vec::new();
    for &race in RACES {
        for cost in measure(&[race], 3, &()).expect("scenes that can be built") {
            let (times, build_times) = (cost.times(), cost.build_times());
            println!("{times:.1} times, built in {build_times:.1} times: {cost:?}");
            if times > cost.limit || build_times > LIMIT {
                slow.push(cost);
            }
        }
    }
    assert!(slow.is_empty(), "{slow:#?}");
}
