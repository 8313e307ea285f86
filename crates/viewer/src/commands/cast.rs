use super::{Failure, warn, warn_of_reading, workers};
use crate::cli::CastArgs;
use crate::output::Output;
use crate::progress::TerminalProgress;
use crate::stats::{self, Stats, StatsTarget, milliseconds};
use crate::{memory, setup};
use raycast_core::formats::{HIT_BYTES, RAY_BYTES, SceneFile, decode_ray, encode_hit};
use raycast_core::{Clipped, Cull};
use rayon::prelude::*;
use std::fs::{File, Metadata};
use std::io::{Read, Write};
use std::path::Path;
use std::time::{Duration, Instant};

/// Rays in memory at a time: enough to keep every worker busy. With more, large files take more memory for nothing.
const RAYS_AT_ONCE: usize = 1 << 18;

/// Rays in one parallel task.
const RAYS_PER_TASK: usize = 1 << 10;

/// Counts of rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct Counts {
    rays: u64,
    hits: u64,
    invalid: u64,
}

impl std::ops::Add for Counts {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            hits: self.hits + other.hits,
            invalid: self.invalid + other.invalid,
        }
    }
}

/// Answers a file of rays with a file of hits.
pub(super) fn run(args: &CastArgs) -> Result<(), Failure> {
    let started = Instant::now();
    let mut inputs: Vec<&Path> = args.files.iter().map(AsRef::as_ref).collect();
    inputs.push(&args.rays);
    let output = Output::at(&args.hits, &inputs)?;
    inputs.push(&args.hits);
    let stats_target = StatsTarget::at(args.stats.as_deref(), &inputs)?;
    let (rays_file, bytes) = open_rays(&args.rays)?;
    let pool = workers(args.threads)?;

    let progress = TerminalProgress::new();
    progress.loading();
    let SceneFile {
        scene,
        warnings,
        opened,
        clip,
        ..
    } = setup::load(&args.files, &args.reading, &|share| progress.loaded(share))?;
    output.check_against(&opened)?;
    stats_target.check_against(&opened)?;
    let load_time = started.elapsed();
    let planes = args.clip.planes(clip)?;
    progress.building();
    let building = Instant::now();
    let name = setup::name_of(&args.files);
    memory::check_tree(&name, setup::stored_triangles(&scene))?;
    let accel = pool.install(|| setup::visible_tree(&name, &scene))?;
    let build_time = building.elapsed();

    let kept = accel.clipped(&planes);
    progress.counting("casting", bytes / RAY_BYTES as u64);
    let mut hits_file = output.create()?;
    let (counts, cast_time) = answer(
        &args.rays,
        rays_file,
        |bytes| {
            hits_file.write_all(bytes).map_err(|error| {
                Failure::could_not(format!(
                    "{}: cannot be written: {error}",
                    args.hits.display()
                ))
            })
        },
        |rays| pool.install(|| cast_all(&kept, args.cull, rays, &progress)),
    )?;
    progress.clear();
    let answered = counts.rays * RAY_BYTES as u64;
    if bytes > 0 && answered != bytes {
        return Err(Failure::could_not(format!(
            "{}: was changed while it was read: expected {bytes} bytes, found {answered}",
            args.rays.display()
        )));
    }
    warn_of_reading(&warnings, &scene, &accel);

    if counts.invalid > 0 {
        warn(&format!(
            "{} of {} rays are misses for a number that is not finite or a direction of zero",
            counts.invalid, counts.rays
        ));
    }
    stats_target.write(&Stats {
        triangles: scene.triangle_count() as u64,
        dropped: setup::dropped(&scene, &accel).total().into(),
        load_ms: milliseconds(load_time),
        build_ms: milliseconds(build_time),
        cast_ms: milliseconds(cast_time),
        shade_ms: 0.0,
        total_ms: milliseconds(started.elapsed()),
        rays: counts.rays,
        hits: counts.hits,
        invalid_rays: counts.invalid,
        mrays_per_s: stats::mrays_per_s(counts.rays, cast_time),
        threads: pool.current_num_threads(),
        simd: accel.simd().name(),
        instances: accel.has_instances(),
        peak_bytes: stats::peak_bytes(),
        ..Stats::default()
    })?;
    hits_file.finish()
}

/// Opens a file of rays; returns its length as well, 0 for a pipe.
fn open_rays(path: &Path) -> Result<(File, u64), Failure> {
    let cannot = |error: std::io::Error| Failure::could_not(format!("{}: {error}", path.display()));
    let file = File::open(path).map_err(cannot)?;
    let found = file.metadata().map_err(cannot)?;
    if found.is_dir() {
        return Err(Failure::could_not(format!(
            "{}: expected a file of rays, found a directory",
            path.display()
        )));
    }
    if is_device(&found) {
        // It may have no end, as /dev/zero.
        return Err(Failure::could_not(format!(
            "{}: expected a file of rays or a pipe, found a device",
            path.display()
        )));
    }
    let bytes = if found.is_file() { found.len() } else { 0 };
    if bytes % RAY_BYTES as u64 != 0 {
        return Err(cut_short(path, bytes));
    }
    Ok((file, bytes))
}

#[cfg(unix)]
fn is_device(found: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    let kind = found.file_type();
    kind.is_char_device() || kind.is_block_device()
}

#[cfg(not(unix))]
fn is_device(_: &Metadata) -> bool {
    false
}

fn cut_short(path: &Path, bytes: u64) -> Failure {
    Failure::could_not(format!(
        "{}: expected a multiple of {RAY_BYTES} bytes ({RAY_BYTES} a ray), found {bytes} bytes",
        path.display()
    ))
}

/// Reads rays, casts them with `cast`, and passes the encoded hits to `write`, a part at a time. Returns the counts
/// and the time of `cast`.
fn answer(
    path: &Path,
    mut rays: impl Read,
    mut write: impl FnMut(&[u8]) -> Result<(), Failure>,
    cast: impl Fn(&[u8]) -> (Vec<u8>, Counts),
) -> Result<(Counts, Duration), Failure> {
    let mut counts = Counts::default();
    let mut time = Duration::ZERO;
    let mut part = Vec::new();
    loop {
        part.clear();
        rays.by_ref()
            .take((RAYS_AT_ONCE * RAY_BYTES) as u64)
            .read_to_end(&mut part)
            .map_err(|error| Failure::could_not(format!("{}: {error}", path.display())))?;
        if part.is_empty() {
            return Ok((counts, time));
        }
        if part.len() % RAY_BYTES != 0 {
            let before = counts.rays * RAY_BYTES as u64;
            return Err(cut_short(path, before + part.len() as u64));
        }
        let started = Instant::now();
        let (hits, more) = cast(&part);
        time += started.elapsed();
        counts = counts + more;
        write(&hits)?;
    }
}

/// The hits of whole rays, in parallel on the current pool.
fn cast_all(
    kept: &Clipped<'_>,
    cull: Cull,
    rays: &[u8],
    progress: &TerminalProgress,
) -> (Vec<u8>, Counts) {
    let mut hits = vec![0; rays.len() / RAY_BYTES * HIT_BYTES];
    let counts = rays
        .par_chunks(RAYS_PER_TASK * RAY_BYTES)
        .zip(hits.par_chunks_mut(RAYS_PER_TASK * HIT_BYTES))
        .map(|(rays, hits)| {
            let mut counts = Counts::default();
            for (ray, hit) in rays
                .as_chunks::<RAY_BYTES>()
                .0
                .iter()
                .zip(hits.as_chunks_mut::<HIT_BYTES>().0)
            {
                let ray = decode_ray(ray);
                let found = if ray.is_valid() {
                    kept.cast(&ray, cull)
                } else {
                    counts.invalid += 1;
                    None
                };
                counts.hits += u64::from(found.is_some());
                *hit = encode_hit(found.as_ref());
            }
            counts.rays = (rays.len() / RAY_BYTES) as u64;
            progress.done(counts.rays);
            counts
        })
        .reduce(Counts::default, |a, b| a + b);
    (hits, counts)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rays_come_in_parts_and_stay_in_order() {
        let count = RAYS_AT_ONCE + 3;
        let rays: Vec<u8> = (0..count)
            .flat_map(|number| [(number as u32).to_le_bytes(); RAY_BYTES / 4].concat())
            .collect();
        let mut written = Vec::new();
        let (counts, _) = answer(
            Path::new("rays"),
            rays.as_slice(),
            |bytes| {
                written.extend_from_slice(bytes);
                Ok(())
            },
            |rays| {
                let firsts = rays.chunks(RAY_BYTES).flat_map(|ray| ray[..4].to_vec());
                let counts = Counts {
                    rays: (rays.len() / RAY_BYTES) as u64,
                    ..Counts::default()
                };
                (firsts.collect(), counts)
            },
        )
        .expect("whole rays");
        assert_eq!(counts.rays, count as u64);
        let expected: Vec<u8> = (0..count as u32).flat_map(u32::to_le_bytes).collect();
        assert_eq!(written, expected);
    }

    #[test]
    fn a_file_cut_short_is_refused() {
        let refused = answer(
            Path::new("rays"),
            [0u8; 33].as_slice(),
            |_| Ok(()),
            |_| (Vec::new(), Counts::default()),
        );
        let Err(failure) = refused else {
            panic!("33 bytes are no rays");
        };
        let message = failure.to_string();
        assert!(
            message.contains("33") && message.contains("32"),
            "{message}"
        );
    }
}
