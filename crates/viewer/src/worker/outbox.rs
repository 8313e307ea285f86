//! Rendered tiles that wait for the window.
//!
//! The outbox is bounded without making workers wait: a tile of a finer pass replaces the coarser one that was not
//! fetched, so that at most one picture waits, and the first pass of the one before it. A slow or hidden window costs
//! nothing and misses nothing.

use super::layout::Layout;
use raycast_core::render::{Pass, Tile, TileStats};
use raycast_core::shade::{Background, Legend};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

/// How long tiles of a first pass are held back until it is complete, so that a moving camera shows whole pictures.
/// With a longer time slow pictures would appear late instead of filling in.
pub const HOLD: Duration = super::pace::LONGEST;

/// The interval at which the window fetches tiles while a slow first pass fills in.
const FILLING: Duration = Duration::from_millis(50);
/// The interval at which it fetches tiles while a complete picture is refined.
const REFINED: Duration = Duration::from_millis(100);

/// Statistics of a finished pass.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PassReport {
    /// The pass.
    pub pass: Pass,
    /// Rays, hits and worker times of all its tiles.
    pub stats: TileStats,
    /// From its first ray to its last.
    pub time: Duration,
}

/// What the window fetches: tiles and reports of one picture.
#[derive(Debug)]
pub struct Batch {
    /// The request that it belongs to.
    pub generation: u64,
    /// Its tiles.
    pub layout: Arc<Layout>,
    /// The background, where it alone shows between surfaces.
    pub background: Option<Background>,
    /// The picture's legend.
    pub legend: Option<Arc<Legend>>,
    /// The tiles, in order of arrival.
    pub tiles: Vec<Arrival>,
    /// Passes that were finished.
    pub reports: Vec<PassReport>,
    /// Whether the picture is complete.
    pub complete: bool,
    /// From the request to its last tile so far.
    pub elapsed: Duration,
}

/// A tile as it arrived.
#[derive(Debug)]
pub struct Arrival {
    /// Its index in the layout.
    pub place: usize,
    /// How many tiles of its pass arrived before it.
    pub order: u32,
    /// Its pass.
    pub pass: Pass,
    /// The tile.
    pub tile: Tile,
}

/// Tiles on their way to the window.
#[derive(Debug, Default)]
pub struct Outbox {
    inner: Mutex<Inner>,
}

#[derive(Debug, Default)]
struct Inner {
    /// The newest picture that was requested, and the newest that is complete or given up.
    expected: u64,
    settled: u64,
    ready: Option<Current>,
    current: Option<Current>,
}

#[derive(Debug)]
struct Current {
    generation: u64,
    layout: Arc<Layout>,
    background: Option<Background>,
    legend: Option<Arc<Legend>>,
    slots: Vec<Option<Arrival>>,
    waiting: Vec<usize>,
    reports: Vec<PassReport>,
    started: Duration,
    elapsed: Duration,
    arrived: u32,
    pass: Option<Pass>,
    first_pass_done: bool,
    complete: bool,
    news: bool,
    /// Whether any of it was fetched.
    seen: bool,
    woken: Duration,
}

/// The result of posting a tile.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Posted {
    /// It was the last of its pass.
    pub pass_done: bool,
    /// Whether the window should fetch.
    pub wake: bool,
}

impl Outbox {
    /// Records that a picture was requested.
    pub fn expect(&self, generation: u64) {
        self.lock().expected = generation;
    }

    /// Records that a picture can be shown, or never will be.
    pub fn settle(&self, generation: u64) {
        self.lock().settle(generation);
    }

    /// Whether the newest requested picture is neither complete for the first time nor given up.
    pub fn is_busy(&self) -> bool {
        self.lock().is_busy()
    }

    /// Whether there is nothing new to show now, but soon: the outbox is [busy](Self::is_busy), and has no tiles to
    /// show except leftovers of a picture that was shown.
    pub fn is_awaited(&self, now: Duration) -> bool {
        let inner = self.lock();
        let is_new =
            |of: &Current| of.has_tiles(now) && !(of.seen && of.generation < inner.expected);
        inner.is_busy()
            && ![&inner.ready, &inner.current]
                .into_iter()
                .flatten()
                .any(is_new)
    }

    /// Sets the legend of the current picture.
    pub fn tell_legend(&self, legend: Option<Legend>) {
        if let Some(current) = &mut self.lock().current {
            current.legend = legend.map(Arc::new);
        }
    }

    /// Starts a picture. Waiting tiles of the last one stay only if its first pass is complete.
    pub fn begin(
        &self,
        generation: u64,
        layout: Arc<Layout>,
        background: Option<Background>,
        now: Duration,
    ) {
        let mut inner = self.lock();
        if let Some(last) = inner.current.take()
            && last.first_pass_done
            && last.news
        {
            inner.ready = Some(last);
        }
        inner.current = Some(Current {
            generation,
            slots: layout.tiles.iter().map(|_| None).collect(),
            layout,
            background,
            legend: None,
            waiting: Vec::new(),
            reports: Vec::new(),
            started: now,
            elapsed: Duration::ZERO,
            arrived: 0,
            pass: None,
            first_pass_done: false,
            complete: false,
            news: false,
            seen: false,
            woken: now,
        });
    }

    /// Posts a tile. All tiles of a pass must be posted before the next pass's first.
    pub fn put(&self, pass: Pass, tile: Tile, now: Duration) -> Posted {
        let mut inner = self.lock();
        let Some(current) = &mut inner.current else {
            return Posted::default();
        };
        let Some(place) = current.layout.place(tile.rect) else {
            return Posted::default();
        };
        if current.pass != Some(pass) {
            current.pass = Some(pass);
            current.arrived = 0;
        }
        let order = current.arrived;
        current.arrived += 1;
        current.news = true;
        current.elapsed = now.saturating_sub(current.started);
        let arrival = Arrival {
            place,
            order,
            pass,
            tile,
        };
        if current.slots[place].replace(arrival).is_none() {
            current.waiting.push(place);
        }
        let pass_done = current.arrived as usize == current.layout.tiles.len();
        let first_picture = pass_done && !current.first_pass_done;
        current.first_pass_done |= pass_done;
        // Each fetch costs the window a frame, painted by the same cores where there is no GPU.
        let pause = if current.first_pass_done {
            REFINED
        } else {
            FILLING
        };
        let due = first_picture
            || (now.saturating_sub(current.woken) >= pause && current.can_be_seen(now));
        if due {
            current.woken = now;
        }
        if pass_done {
            let generation = current.generation;
            inner.settle(generation);
        }
        Posted {
            pass_done,
            wake: due,
        }
    }

    /// Records a finished pass.
    pub fn report(&self, report: PassReport) {
        if let Some(current) = &mut self.lock().current {
            current.reports.push(report);
            current.news = true;
        }
    }

    /// Records that the picture is finished.
    pub fn finish(&self, now: Duration) {
        if let Some(current) = &mut self.lock().current {
            current.complete = true;
            current.elapsed = now.saturating_sub(current.started);
            current.news = true;
        }
    }

    /// Removes and returns what there is to show, oldest first, up to a picture whose size does not fit.
    pub fn fetch(&self, now: Duration, fits: impl Fn((u32, u32)) -> bool) -> Vec<Batch> {
        let mut inner = self.lock();
        let mut batches = Vec::new();
        if let Some(ready) = &inner.ready
            && !fits(ready.layout.size)
        {
            return batches;
        }
        if let Some(mut ready) = inner.ready.take() {
            batches.push(ready.drain());
        }
        if let Some(current) = &mut inner.current
            && current.news
            && current.can_be_seen(now)
            && fits(current.layout.size)
        {
            batches.push(current.drain());
        }
        batches
    }

    fn lock(&self) -> MutexGuard<'_, Inner> {
        self.inner.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Inner {
    fn is_busy(&self) -> bool {
        self.expected > self.settled
    }

    fn settle(&mut self, generation: u64) {
        self.settled = self.settled.max(generation);
    }
}

impl Current {
    fn has_tiles(&self, now: Duration) -> bool {
        !self.waiting.is_empty() && self.can_be_seen(now)
    }

    fn can_be_seen(&self, now: Duration) -> bool {
        self.first_pass_done || now.saturating_sub(self.started) >= HOLD
    }

    fn drain(&mut self) -> Batch {
        self.news = false;
        self.seen = true;
        let tiles = std::mem::take(&mut self.waiting)
            .into_iter()
            .filter_map(|place| self.slots[place].take())
            .collect();
        Batch {
            generation: self.generation,
            layout: Arc::clone(&self.layout),
            background: self.background,
            legend: self.legend.clone(),
            tiles,
            reports: std::mem::take(&mut self.reports),
            complete: self.complete,
            elapsed: self.elapsed,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_core::camera::Grid;

    const COARSE: Pass = Pass {
        stride: 2,
        samples: 1,
    };
    const FINE: Pass = Pass {
        stride: 1,
        samples: 1,
    };

    fn begin(outbox: &Outbox, generation: u64, layout: Arc<Layout>, now: Duration) {
        outbox.begin(generation, layout, Some(Background::default()), now);
    }

    fn layout() -> Arc<Layout> {
        Arc::new(Layout::new((8, 4), Grid::Size(4).tiles(8, 4)))
    }

    fn tile(layout: &Layout, place: usize, value: u8) -> Tile {
        let rect = layout.tiles[place];
        Tile {
            rect,
            pixels: vec![[value; 4]; rect.area()],
            layers: None,
            stats: TileStats::default(),
        }
    }

    #[test]
    fn a_first_pass_is_held_until_it_is_whole() {
        let (outbox, layout) = (Outbox::default(), layout());
        let now = Duration::from_millis(1);
        begin(&outbox, 1, Arc::clone(&layout), Duration::ZERO);
        assert!(!outbox.put(COARSE, tile(&layout, 1, 1), now).pass_done);
        assert!(outbox.fetch(now, |_| true).is_empty());
        assert!(outbox.put(COARSE, tile(&layout, 0, 1), now).pass_done);
        let batches = outbox.fetch(now, |_| true);
        assert_eq!(batches.len(), 1);
        let orders: Vec<_> = batches[0]
            .tiles
            .iter()
            .map(|a| (a.place, a.order))
            .collect();
        assert_eq!(orders, [(1, 0), (0, 1)]);
        assert!(
            outbox.fetch(now, |_| true).is_empty(),
            "each tile is handed over once"
        );
    }

    #[test]
    fn a_picture_is_awaited_from_its_request_until_tiles_are_there() {
        let (outbox, layout) = (Outbox::default(), layout());
        let now = Duration::from_millis(1);
        let state = |now| (outbox.is_busy(), outbox.is_awaited(now));
        assert_eq!(state(now), (false, false), "nothing was asked for");
        for generation in 1..3 {
            outbox.expect(generation);
            assert_eq!(state(now), (true, true), "asked for");
            begin(&outbox, generation, Arc::clone(&layout), Duration::ZERO);
            outbox.put(COARSE, tile(&layout, 0, 1), now);
            assert_eq!(state(now), (true, true), "held back");
            assert_eq!(state(HOLD), (true, false), "slow, and seen to fill in");
            outbox.put(COARSE, tile(&layout, 1, 1), now);
            assert_eq!(state(now), (false, false), "there");
            outbox.fetch(now, |_| true);
            assert_eq!(state(now), (false, false), "it may get finer");
        }
        outbox.put(FINE, tile(&layout, 0, 2), now);
        outbox.expect(3);
        assert_eq!(state(now), (true, true), "leftovers are nothing new");
        outbox.settle(2);
        assert_eq!(state(now), (true, true), "another one");
        outbox.settle(3);
        assert_eq!(state(now), (false, false), "it will never be there");
    }

    #[test]
    fn a_picture_of_another_size_waits() {
        let (outbox, layout) = (Outbox::default(), layout());
        let now = Duration::from_millis(1);
        let finish = |generation| {
            begin(&outbox, generation, Arc::clone(&layout), Duration::ZERO);
            for place in 0..2 {
                outbox.put(COARSE, tile(&layout, place, 1), now);
            }
        };
        finish(1);
        finish(2);
        assert!(outbox.fetch(now, |size| size == (9, 4)).is_empty());
        let batches = outbox.fetch(now, |size| size == (8, 4));
        let generations: Vec<_> = batches.iter().map(|batch| batch.generation).collect();
        assert_eq!(generations, [1, 2]);
    }

    #[test]
    fn quick_passes_after_the_first_do_not_wake_the_window() {
        let (outbox, layout) = (Outbox::default(), layout());
        begin(&outbox, 1, Arc::clone(&layout), Duration::ZERO);
        let wakes: Vec<_> = [(COARSE, 0, 1), (COARSE, 1, 2), (FINE, 0, 3), (FINE, 1, 103)]
            .into_iter()
            .map(|(pass, place, ms)| {
                let now = Duration::from_millis(ms);
                outbox.put(pass, tile(&layout, place, 1), now).wake
            })
            .collect();
        assert_eq!(wakes, [false, true, false, true]);
    }

    #[test]
    fn a_slow_first_pass_is_seen_to_fill_in() {
        let (outbox, layout) = (Outbox::default(), layout());
        begin(&outbox, 1, Arc::clone(&layout), Duration::ZERO);
        outbox.put(COARSE, tile(&layout, 0, 1), HOLD);
        assert_eq!(outbox.fetch(HOLD, |_| true).len(), 1);
    }

    #[test]
    fn finer_tiles_take_the_place_of_coarser_ones() {
        let (outbox, layout) = (Outbox::default(), layout());
        begin(&outbox, 1, Arc::clone(&layout), Duration::ZERO);
        for (pass, value) in [(COARSE, 1), (FINE, 2)] {
            for place in 0..2 {
                outbox.put(pass, tile(&layout, place, value), Duration::ZERO);
            }
        }
        outbox.finish(Duration::from_millis(5));
        let batches = outbox.fetch(Duration::ZERO, |_| true);
        assert_eq!(batches[0].tiles.len(), 2, "one picture waits, not two");
        assert!(batches[0].tiles.iter().all(|a| a.tile.pixels[0] == [2; 4]));
        assert!(batches[0].complete);
    }

    #[test]
    fn a_whole_first_pass_survives_the_next_request_and_a_torn_one_does_not() {
        let (outbox, layout) = (Outbox::default(), layout());
        begin(&outbox, 1, Arc::clone(&layout), Duration::ZERO);
        outbox.put(COARSE, tile(&layout, 0, 1), Duration::ZERO);
        outbox.put(COARSE, tile(&layout, 1, 1), Duration::ZERO);
        begin(&outbox, 2, Arc::clone(&layout), Duration::ZERO);
        outbox.put(COARSE, tile(&layout, 0, 2), Duration::ZERO);
        begin(&outbox, 3, Arc::clone(&layout), Duration::ZERO);
        let generations: Vec<_> = outbox
            .fetch(Duration::ZERO, |_| true)
            .iter()
            .map(|b| b.generation)
            .collect();
        assert_eq!(generations, [1]);
    }

    #[test]
    fn tiles_of_another_layout_are_refused() {
        let (outbox, layout) = (Outbox::default(), layout());
        begin(&outbox, 1, Arc::clone(&layout), Duration::ZERO);
        let mut stranger = tile(&layout, 0, 1);
        stranger.rect.width = 3;
        assert_eq!(outbox.put(FINE, stranger, HOLD), Posted::default());
        assert!(outbox.fetch(HOLD, |_| true).is_empty());
    }
}
