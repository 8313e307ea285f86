//! Watches tiles arrive, coarse to fine and from the middle, as a window shows them:
//! `cargo run --release -p raycast-core --example tiles -- MESH.obj`.

#![allow(clippy::print_stdout, reason = "an example tells its findings")]

use raycast_core::camera::{Camera, Grid, Orbit};
use raycast_core::render::{Cancel, Passes, Settings, View};
use raycast_core::{Accel, formats};
use std::path::PathBuf;
use std::sync::{Arc, mpsc};
use std::time::Instant;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path: PathBuf = std::env::args_os().nth(1).ok_or("name a mesh")?.into();
    let scene = formats::read_scene(&path, &|_| ())?.scene;
    let size = (640, 480);
    let view = View {
        camera: Camera::fitting(&scene.bounds(), Orbit::DEFAULT_ANGLES, size)?,
        accel: Arc::new(Accel::build(&scene)?),
        scene: Arc::new(scene),
        settings: Settings::default(),
    };
    let tiles = Grid::Size(128).tiles(size.0, size.1);
    let passes = Passes::plan(8, 1);

    let started = Instant::now();
    let clock = || started.elapsed();
    let cancel = Cancel::default();
    let (sender, arrivals) = mpsc::channel();
    // Workers send owned tiles; this thread does with them what it likes, in its own time. To stop the
    // render it would call `cancel.cancel()`.
    std::thread::scope(|scope| {
        let (view, cancel) = (&view, cancel.clone());
        scope.spawn(move || {
            view.render_progressively(&tiles, &passes, &clock, &cancel, &|pass, tile| {
                // Nobody listens any more if this fails, and nobody misses the tile.
                let _ = sender.send((pass, tile));
            });
        });
        for (pass, tile) in arrivals {
            println!(
                "{:>6.1} ms: every {} rays, {} x {} pixels at ({}, {}), {} rays hit something",
                started.elapsed().as_secs_f64() * 1e3,
                pass.stride,
                tile.rect.width,
                tile.rect.height,
                tile.rect.x,
                tile.rect.y,
                tile.stats.counts.hits
            );
        }
    });
    Ok(())
}
