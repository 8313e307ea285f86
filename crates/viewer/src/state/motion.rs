//! Smooth changes of view, and the camera's history.

use super::viewpoint::Viewpoint;
use std::time::Duration;

/// The duration of a smooth change of view: long enough to see where the camera goes.
pub const LENGTH: Duration = Duration::from_millis(200);
/// Navigation within this time joins one step of the camera's history.
const PAUSE: Duration = Duration::from_millis(700);
/// The most viewpoints in the history.
const MOST: usize = 100;

/// A smooth change of view.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Motion {
    from: Viewpoint,
    to: Viewpoint,
    started: Duration,
}

impl Motion {
    /// A change that starts now.
    pub fn new(from: Viewpoint, to: Viewpoint, now: Duration) -> Self {
        Self {
            from,
            to,
            started: now,
        }
    }

    /// Its end.
    pub fn end(&self) -> Viewpoint {
        self.to
    }

    /// The viewpoint now, and whether it is the end. The speed rises and falls smoothly.
    pub fn at(&self, now: Duration) -> (Viewpoint, bool) {
        let share = now.saturating_sub(self.started).as_secs_f64() / LENGTH.as_secs_f64();
        let share = share.min(1.0);
        let eased = share * share * (3.0 - 2.0 * share);
        (self.from.towards(&self.to, eased), share >= 1.0)
    }
}

/// The camera's history: viewpoints to go back and forward to.
#[derive(Clone, Debug, Default)]
pub struct Trail {
    past: Vec<Viewpoint>,
    future: Vec<Viewpoint>,
    moved: Option<Duration>,
}

impl Trail {
    /// Records a viewpoint that the camera leaves. Moves in close succession, as in a drag, join one step.
    pub fn leave(&mut self, viewpoint: Viewpoint, now: Duration, is_gesture: bool) {
        let goes_on = self.moved.is_some_and(|moved| now < moved + PAUSE);
        self.moved = is_gesture.then_some(now);
        if (is_gesture && goes_on) || self.past.last() == Some(&viewpoint) {
            return;
        }
        self.future.clear();
        self.past.push(viewpoint);
        if self.past.len() > MOST {
            self.past.remove(0);
        }
    }

    /// Goes back; `here` is the present viewpoint.
    pub fn back(&mut self, here: Viewpoint) -> Option<Viewpoint> {
        let there = self.past.pop()?;
        self.future.push(here);
        self.moved = None;
        Some(there)
    }

    /// Goes forward, likewise.
    pub fn forward(&mut self, here: Viewpoint) -> Option<Viewpoint> {
        let there = self.future.pop()?;
        self.past.push(here);
        self.moved = None;
        Some(there)
    }

    /// Whether it can go back.
    pub fn has_past(&self) -> bool {
        !self.past.is_empty()
    }

    /// Whether it can go forward.
    pub fn has_future(&self) -> bool {
        !self.future.is_empty()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn at(yaw: f64) -> Viewpoint {
        Viewpoint::default().turned_to((yaw, 0.0))
    }

    #[test]
    fn a_drag_is_one_step_and_can_be_taken_back() {
        let ms = Duration::from_millis;
        let mut trail = Trail::default();
        for (yaw, now) in [(0.0, 0), (1.0, 16), (2.0, 33), (3.0, 2000), (4.0, 2016)] {
            trail.leave(at(yaw), ms(now), true);
        }
        assert_eq!(trail.back(at(5.0)), Some(at(3.0)));
        assert_eq!(trail.back(at(3.0)), Some(at(0.0)));
        assert_eq!(trail.back(at(0.0)), None);
        assert_eq!(trail.forward(at(0.0)), Some(at(3.0)));
        assert_eq!(trail.forward(at(3.0)), Some(at(5.0)));
        assert!(!trail.has_future() && trail.has_past());
    }

    #[test]
    fn a_motion_ends_where_it_should_and_on_time() {
        let motion = Motion::new(at(0.0), at(90.0), Duration::from_secs(1));
        assert_eq!(motion.at(Duration::from_secs(1)), (at(0.0), false));
        let (half, is_over) = motion.at(Duration::from_secs(1) + LENGTH / 2);
        assert!((half.orbit.yaw - 45.0).abs() < 1e-9 && !is_over);
        assert_eq!(motion.at(Duration::from_secs(1) + LENGTH), (at(90.0), true));
    }
}
