//! All that is kept for the fuzzers, without a fuzzer: hand-made files, those that reach far into the
//! readers, and each that a fuzzer found wrong once.

use raycast_tests::fuzz::TARGETS;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// What a fuzzer allows one file, of 4 kB at most.
const PATIENCE: Duration = Duration::from_secs(10);

fn fuzz() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../fuzz")
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder)
        .unwrap_or_else(|error| panic!("{}: {error}", folder.display()))
        .map(|entry| entry.expect("a folder can be listed").file_name());
    let mut names: Vec<String> = entries
        .map(|name| name.into_string().expect("names are Unicode"))
        .collect();
    names.sort();
    names
}

#[test]
fn every_seed_holds() {
    let mut faults = Vec::new();
    for (target, check) in TARGETS {
        let folder = fuzz().join("seeds").join(target);
        let seeds = names(&folder);
        assert!(seeds.len() > 1, "{target} has {} seeds", seeds.len());
        for name in seeds {
            let bytes = std::fs::read(folder.join(&name)).expect("a seed can be read");
            let started = Instant::now();
            if let Err(fault) = check(&bytes) {
                faults.push(format!("{target}/{name}: {fault}"));
            }
            let took = started.elapsed();
            assert!(took < PATIENCE, "{target}/{name} took {took:?}");
        }
    }
    assert!(faults.is_empty(), "{faults:#?}");
}

/// A target that the fuzzer does not know is never hunted.
#[test]
fn the_fuzzer_knows_every_target() {
    let mut expected: Vec<String> = TARGETS.map(|(name, _)| name.to_owned()).to_vec();
    expected.sort();
    assert_eq!(names(&fuzz().join("seeds")), expected);
    let files: Vec<String> = expected.iter().map(|name| format!("{name}.rs")).collect();
    assert_eq!(names(&fuzz().join("fuzz_targets")), files);
    let manifest = std::fs::read_to_string(fuzz().join("Cargo.toml")).expect("a manifest");
    for name in expected {
        assert!(manifest.contains(&format!("name = \"{name}\"\n")), "{name}");
    }
}
