//! The render thread: it owns the thread pool, takes the newest request, and fills the outbox.

use super::layout::Layout;
use super::mailbox::Mailbox;
use super::outbox::{Outbox, PassReport};
use super::pace::Pace;
use super::priority;
use super::{SharedClock, Wake};
use raycast_core::camera::Grid;
use raycast_core::render::{Cancel, Pass, Passes, Tile, TileStats, View};
use raycast_core::shade::Background;
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// A request to render a picture.
#[derive(Clone, Debug)]
pub struct Request {
    /// Requests are numbered in order; results of older ones are not shown.
    pub generation: u64,
    /// Identifies the scene: times measured on one do not apply to another.
    pub document: u64,
    /// The picture.
    pub view: View,
    /// Samples a pixel after nothing was requested for a fifth of a second; at most the view's number means no more
    /// samples.
    pub rest_samples: u32,
    /// Its tiles.
    pub grid: Grid,
    /// The number of threads.
    pub threads: usize,
}

/// The idle time after which a picture gets more samples. With a shorter one a hand that moves on would find the
/// cores busy; with a longer one pictures stay coarse.
const REST: Duration = Duration::from_millis(200);

/// The window's handle of the render thread.
#[derive(Debug)]
pub struct Renderer {
    mailbox: Arc<Mailbox<Request>>,
    outbox: Arc<Outbox>,
    thread: Option<JoinHandle<()>>,
}

impl Renderer {
    /// Starts the thread, which fills `outbox`. `failed` is called there with the message of a render that panicked.
    ///
    /// # Errors
    /// The system cannot start a thread.
    pub fn start(
        clock: SharedClock,
        wake: Wake,
        outbox: Arc<Outbox>,
        failed: Box<dyn Fn(String) + Send + Sync>,
    ) -> std::io::Result<Self> {
        let mailbox = Arc::new(Mailbox::default());
        let worker = Worker {
            mailbox: Arc::clone(&mailbox),
            outbox: Arc::clone(&outbox),
            clock,
            wake,
            failed,
            pool: None,
            pace: Pace::default(),
            document: 0,
            layout: (Grid::default(), Arc::default()),
        };
        let thread = std::thread::Builder::new()
            .name("raycast-render".to_owned())
            .spawn(move || worker.run())?;
        Ok(Self {
            mailbox,
            outbox,
            thread: Some(thread),
        })
    }

    /// Requests a picture, instead of any other.
    pub fn request(&self, request: Request) {
        self.outbox.expect(request.generation);
        self.mailbox.post(request);
    }

    /// The tiles.
    pub fn outbox(&self) -> &Outbox {
        &self.outbox
    }
}

impl Drop for Renderer {
    fn drop(&mut self) {
        self.mailbox.close();
        if let Some(thread) = self.thread.take() {
            // A cancelled render ends within a tile, and its panics were caught and reported.
            let _ = thread.join();
        }
    }
}

struct Worker {
    mailbox: Arc<Mailbox<Request>>,
    outbox: Arc<Outbox>,
    clock: SharedClock,
    wake: Wake,
    failed: Box<dyn Fn(String) + Send + Sync>,
    pool: Option<(usize, rayon::ThreadPool)>,
    pace: Pace,
    document: u64,
    layout: (Grid, Arc<Layout>),
}

/// The background, where it alone shows between surfaces: the ground and lines move with the camera, and a panorama may end
/// within the picture.
fn background_alone(view: &View) -> Option<Background> {
    let shading = &view.settings.shading;
    let is_alone =
        shading.ground.is_none() && shading.wireframe.is_none() && view.camera.is_filled();
    is_alone.then_some(shading.background)
}

/// Sums over a pass.
#[derive(Default)]
struct Sum {
    stats: TileStats,
    pass_started: Duration,
    reports: Vec<PassReport>,
}

impl Worker {
    fn run(mut self) {
        while let Some((request, cancel)) = self.mailbox.take() {
            let outcome = self.make(&request, &cancel);
            // Whatever the outcome, the window may request the next picture.
            self.outbox.settle(request.generation);
            self.mailbox.ripen();
            if let Err(message) = outcome {
                (self.failed)(message);
            }
            (self.wake)();
        }
    }

    /// Renders a picture until it is finished or cancelled.
    fn make(&mut self, request: &Request, cancel: &Cancel) -> Result<(), String> {
        let size = self.prepare(request);
        self.ensure_pool(request.threads)?;
        let pixels = u64::from(size.0) * u64::from(size.1);
        let passes = self.pace.plan(pixels, request.view.settings.samples);
        let sum = Mutex::new(Sum {
            pass_started: (self.clock)(),
            ..Sum::default()
        });
        let layout = Arc::clone(&self.layout.1);
        let background = background_alone(&request.view);
        let (generation, now) = (request.generation, (self.clock)());
        self.outbox
            .begin(generation, Arc::clone(&layout), background, now);
        let legend = match &self.pool {
            Some((_, pool)) => pool.install(|| request.view.legend()),
            None => request.view.legend(),
        };
        self.outbox.tell_legend(legend);
        let sink = |pass, tile| self.take_in(&sum, pass, tile);
        let view = &request.view;
        let passes_of = |passes: &[Pass]| {
            let render =
                || view.render_progressively(&layout.tiles, passes, &*self.clock, cancel, &sink);
            match &self.pool {
                Some((_, pool)) => pool.install(render),
                None => render(),
            }
        };
        let at_rest = Passes::plan(1, request.rest_samples).split_off(1);
        let render = || {
            passes_of(&passes)
                && (request.rest_samples <= view.settings.samples
                    || (self.mailbox.is_quiet_for(REST) && {
                        let mut sum = sum.lock().unwrap_or_else(PoisonError::into_inner);
                        sum.pass_started = (self.clock)();
                        drop(sum);
                        passes_of(&at_rest)
                    }))
        };
        // A panic in the core must not end the session: it is reported, and the window continues.
        let outcome = std::panic::catch_unwind(std::panic::AssertUnwindSafe(render));
        let sum = sum.into_inner().unwrap_or_else(PoisonError::into_inner);
        for report in sum.reports {
            self.pace.learn(report.pass, report.stats.rays, report.time);
        }
        match outcome {
            Ok(is_complete) => {
                if is_complete {
                    self.outbox.finish((self.clock)());
                }
                Ok(())
            }
            Err(panic) => Err(format!(
                "The picture could not be made: {}",
                super::panic_text(&*panic)
            )),
        }
    }

    /// Prepares the layout; returns the picture's size.
    fn prepare(&mut self, request: &Request) -> (u32, u32) {
        let plane = request.view.camera.plane();
        let size = (plane.columns, plane.rows);
        if self.layout.0 != request.grid || self.layout.1.size != size {
            let tiles = request.grid.tiles(size.0, size.1);
            self.layout = (request.grid, Arc::new(Layout::new(size, tiles)));
        }
        if self.document != request.document {
            self.document = request.document;
            self.pace.forget();
        }
        size
    }

    fn ensure_pool(&mut self, threads: usize) -> Result<(), String> {
        if self
            .pool
            .as_ref()
            .is_some_and(|(count, _)| *count == threads)
        {
            return Ok(());
        }
        self.pace.forget();
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(threads)
            .thread_name(|index| format!("raycast-ray-{index}"))
            .start_handler(|_| priority::give_way())
            .build()
            .map_err(|error| format!("{threads} render threads could not be started: {error}"))?;
        self.pool = Some((threads, pool));
        Ok(())
    }

    /// Posts a tile, on the pool's thread that rendered it.
    fn take_in(&self, sum: &Mutex<Sum>, pass: Pass, tile: Tile) {
        let stats = tile.stats;
        let now = (self.clock)();
        let mut sum = sum.lock().unwrap_or_else(PoisonError::into_inner);
        sum.stats += stats;
        let posted = self.outbox.put(pass, tile, now);
        if posted.pass_done {
            let report = PassReport {
                pass,
                stats: std::mem::take(&mut sum.stats),
                time: now.saturating_sub(sum.pass_started),
            };
            sum.pass_started = now;
            sum.reports.push(report);
            self.outbox.report(report);
            self.mailbox.ripen();
        }
        drop(sum);
        if posted.wake {
            (self.wake)();
        }
    }
}
