//! The thread that renders: it owns the pool, takes the newest request, and fills the outbox.

use super::layout::Layout;
use super::mailbox::Mailbox;
use super::outbox::{Outbox, PassReport};
use super::pace::Pace;
use super::priority;
use super::{SharedClock, Wake};
use raycast_core::camera::Grid;
use raycast_core::render::{Cancel, Pass, Passes, Tile, TileStats, View};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// A picture to make.
#[derive(Clone, Debug)]
pub struct Request {
    /// Requests count up; what belongs to an older one is not shown.
    pub generation: u64,
    /// Names the scene: times learnt on one say nothing about another.
    pub document: u64,
    /// The picture.
    pub view: View,
    /// Rays a pixel once nothing has been asked for during a fifth of a second; no more than the view has, for none.
    pub rest_samples: u32,
    /// Its tiles.
    pub grid: Grid,
    /// Threads to make it with.
    pub threads: usize,
}

/// How long nothing must be asked for until a picture gets more samples by itself: a hand that moves on does
/// not find the cores busy.
const REST: Duration = Duration::from_millis(200);

/// The render thread, as the window sees it.
#[derive(Debug)]
pub struct Renderer {
    mailbox: Arc<Mailbox<Request>>,
    outbox: Arc<Outbox>,
    thread: Option<JoinHandle<()>>,
}

impl Renderer {
    /// Starts the thread, which fills `outbox`. `failed` is told, from there, of a render that broke.
    ///
    /// # Errors
    /// The system's refusal to start a thread.
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

    /// Asks for a picture in place of any other.
    pub fn request(&self, request: Request) {
        self.outbox.expect(request.generation);
        self.mailbox.post(request);
    }

    /// Where the tiles are.
    pub fn outbox(&self) -> &Outbox {
        &self.outbox
    }
}

impl Drop for Renderer {
    fn drop(&mut self) {
        self.mailbox.close();
        if let Some(thread) = self.thread.take() {
            // A render ends within a tile of being cancelled. Its panics were caught and told.
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

/// What is summed up over a pass.
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
            // Whatever came of it, the window may ask for the next one.
            self.outbox.settle(request.generation);
            self.mailbox.ripen();
            if let Err(message) = outcome {
                (self.failed)(message);
            }
            (self.wake)();
        }
    }

    /// Makes a picture, as far as it is not cancelled.
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
        let background = request.view.settings.shading.background;
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
        // A fault in the core must not end the session: it is told, and the window goes on.
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

    /// Makes the layout ready; the picture's size.
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

    /// Takes in a tile, on the pool's thread that made it.
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
