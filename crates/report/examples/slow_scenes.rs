//! Looks for scenes that take more than the goal's times as long as as many ordinary triangles:
//! `cargo run --release -p raycast-report --example slow_scenes -- FIRST COUNT [COLUMNS ROWS]`.
//!
//! Prints each that it finds, and how many there were. A seed always gives the same scene; run it alone, on an idle
//! machine. With a word instead of numbers it prints the times of all timed cases whose names contain that.

#![allow(clippy::print_stdout, reason = "an example tells its findings")]

use raycast_report::cases::time::{SLOWDOWN_GOAL, TIMED_CASES, hunted};
use raycast_report::sections::time::{HostileCost, measure_pair};

/// Columns and rows of the pictures, as in the report.
const SIZE: (u32, u32) = (64, 48);

/// Rounds that a scene's times are the least of, once it has been slow in one.
const ROUNDS: usize = 3;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let words: Vec<String> = std::env::args().skip(1).collect();
    let numbers: Result<Vec<u32>, _> = words.iter().map(|word| word.parse()).collect();
    match (&words[..], numbers.as_deref()) {
        (_, Ok(&[first, count])) => hunt(first, count, SIZE),
        (_, Ok(&[first, count, columns, rows])) => hunt(first, count, (columns, rows)),
        ([name], _) => cases(name),
        _ => Err("name the first seed and how many, or a part of a timed case's name".into()),
    }
}

fn hunt(first: u32, count: u32, size: (u32, u32)) -> Result<(), Box<dyn std::error::Error>> {
    let (mut views, mut slow) = (0, 0);
    for seed in first..first.saturating_add(count) {
        let (name, pair) = (format!("seed {seed}"), hunted(seed.into()));
        let is_slow = |cost: &HostileCost| cost.slowdown() > SLOWDOWN_GOAL;
        let mut costs = measure_pair(&name, &pair, size, 1)?;
        views += costs.len();
        if costs.iter().any(is_slow) {
            costs = measure_pair(&name, &pair, size, ROUNDS)?;
        }
        for cost in costs.iter().filter(|cost| is_slow(cost)) {
            slow += 1;
            show(cost);
        }
    }
    println!("{slow} of {views} views took more than {SLOWDOWN_GOAL} times as long");
    Ok(())
}

fn cases(name: &str) -> Result<(), Box<dyn std::error::Error>> {
    for case in TIMED_CASES.iter().filter(|case| case.name.contains(name)) {
        for cost in measure_pair(case.name, &(case.scenes)(), SIZE, ROUNDS)? {
            show(&cost);
        }
    }
    Ok(())
}

fn show(cost: &HostileCost) {
    println!(
        "{}, {:?}: {} triangles, {:.1} ms, ordinary ones {:.2} ms, {:.1} times",
        cost.name,
        cost.projection,
        cost.triangles,
        cost.cast.as_secs_f64() * 1e3,
        cost.ordinary_cast.as_secs_f64() * 1e3,
        cost.slowdown()
    );
}
