//! When the window is painted.
//!
//! A window that is painted by the CPU may not be limited by the display's rate: it is ready for its next frame at
//! once. A frame shortly before a picture is complete would show nothing new and take processor time from the picture.
//! So a frame starts when there is something to show, or 37 ms after the start of the last one. In between the window
//! sleeps, and handles events as usual.

use crate::worker::outbox::Outbox;
use crate::worker::{SharedClock, Wake, pace};
use eframe::{EframeWinitApplication, UserEvent};
use std::sync::Arc;
use std::time::{Duration, Instant};
use winit::application::ApplicationHandler;
use winit::event::{DeviceEvent, DeviceId, StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::WindowId;

/// The longest time between the starts of two frames while a picture is awaited: the longest that its first pass is
/// meant to take. A frame in between would delay the picture.
const LONGEST: Duration = pace::LONGEST;

/// A callback that ends the delay of a frame, from any thread. A repaint request would not: egui has requested the
/// frame already, and requests it once.
pub fn nudge(event_loop: &EventLoop<UserEvent>) -> Wake {
    let proxy = event_loop.create_proxy();
    Arc::new(move || {
        // A repaint request of a past pass is ignored, but it wakes the event loop. Sending fails only after the window
        // is closed.
        let _ = proxy.send_event(UserEvent::RequestRepaint {
            viewport_id: egui::ViewportId::ROOT,
            when: Instant::now(),
            cumulative_pass_nr: 0,
        });
    })
}

/// The delay of the next frame, when the last one started at `begun`; `None` for no delay.
fn pause(begun: Option<Duration>, now: Duration, is_awaited: bool) -> Option<Duration> {
    let pause = (begun? + LONGEST).checked_sub(now)?;
    (is_awaited && !pause.is_zero()).then_some(pause)
}

/// eframe's window, with frames that are delayed until pictures are ready.
pub struct Frames<'a> {
    window: EframeWinitApplication<'a>,
    outbox: Arc<Outbox>,
    clock: SharedClock,
    /// A requested frame that is delayed. There is one window.
    held: Option<WindowId>,
    /// The start of the last frame.
    begun: Option<Duration>,
}

impl<'a> Frames<'a> {
    /// The frames of `window`, which shows what comes through `outbox`.
    pub fn new(
        window: EframeWinitApplication<'a>,
        outbox: Arc<Outbox>,
        clock: SharedClock,
    ) -> Self {
        Self {
            window,
            outbox,
            clock,
            held: None,
            begun: None,
        }
    }

    fn pause(&self) -> Option<Duration> {
        let now = (self.clock)();
        pause(self.begun, now, self.outbox.is_awaited(now))
    }

    fn begin(&mut self, event_loop: &ActiveEventLoop, window: WindowId) {
        self.held = None;
        self.begun = Some((self.clock)());
        self.window
            .window_event(event_loop, window, WindowEvent::RedrawRequested);
    }
}

impl ApplicationHandler<UserEvent> for Frames<'_> {
    fn window_event(&mut self, event_loop: &ActiveEventLoop, window: WindowId, event: WindowEvent) {
        if event != WindowEvent::RedrawRequested {
            self.window.window_event(event_loop, window, event);
        } else if self.pause().is_some() {
            self.held = Some(window);
        } else {
            self.begin(event_loop, window);
        }
    }

    /// Called last in each iteration of the event loop: sets how long it sleeps.
    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        self.window.about_to_wait(event_loop);
        let Some(window) = self.held else {
            return;
        };
        let Some(pause) = self.pause() else {
            self.begin(event_loop, window);
            return;
        };
        let due = Instant::now() + pause;
        let sooner = match event_loop.control_flow() {
            ControlFlow::Poll => true,
            ControlFlow::WaitUntil(other) => other < due,
            ControlFlow::Wait => false,
        };
        if !sooner {
            event_loop.set_control_flow(ControlFlow::WaitUntil(due));
        }
    }

    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        self.window.resumed(event_loop);
    }

    fn new_events(&mut self, event_loop: &ActiveEventLoop, cause: StartCause) {
        self.window.new_events(event_loop, cause);
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, event: UserEvent) {
        self.window.user_event(event_loop, event);
    }

    fn device_event(&mut self, event_loop: &ActiveEventLoop, device: DeviceId, event: DeviceEvent) {
        self.window.device_event(event_loop, device, event);
    }

    fn suspended(&mut self, event_loop: &ActiveEventLoop) {
        self.window.suspended(event_loop);
    }

    fn exiting(&mut self, event_loop: &ActiveEventLoop) {
        self.window.exiting(event_loop);
    }

    fn memory_warning(&mut self, event_loop: &ActiveEventLoop) {
        self.window.memory_warning(event_loop);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_waits_for_a_picture_but_not_for_long() {
        let ms = Duration::from_millis;
        assert_eq!(pause(None, ms(5), true), None, "the first");
        assert_eq!(pause(Some(ms(5)), ms(5), false), None, "nothing is awaited");
        assert_eq!(pause(Some(ms(5)), ms(5), true), Some(LONGEST));
        assert_eq!(pause(Some(ms(5)), ms(15), true), Some(LONGEST - ms(10)));
        assert_eq!(pause(Some(ms(5)), ms(5) + LONGEST, true), None);
        assert_eq!(pause(Some(ms(5)), ms(500), true), None);
    }
}
