//! Handles in the picture to move, rotate and scale the selected object (Conner et al., "Three-Dimensional Widgets",
//! 1992).
//!
//! A drag is computed from its start, not from step to step: rounding does not add up, and a cursor that returns to the
//! start restores the object.

use super::State;
use super::effect::Effect;
use super::handle::{Amount, Handle, Tool};
use super::history::Snapshot;
use super::objects;
use super::turn::{axis_in, rotation, turned};
use raycast_core::camera::{Camera, Panorama, Projection};
use raycast_core::glam::{DAffine3, DVec3};
use raycast_core::math;
use raycast_core::scene::Transform;

/// The angle in degrees whose multiples a rotation snaps to.
const SNAP_DEGREES: f64 = 15.0;
/// The number whose multiples a scale factor snaps to.
const SNAP_FACTOR: f64 = 0.1;
/// The least scale factor of one drag: an object is neither mirrored by accident nor scaled to zero.
const LEAST_FACTOR: f64 = 0.01;
/// A move snaps to multiples of the least round number of scene units that is at least so many pixels of the picture.
const SNAP_PIXELS: f64 = 12.0;
/// The least sine of the angle between the view and the plane of a drag: at a flatter angle a pixel of the picture is
/// more than eight in the plane.
pub const FLATTEST: f64 = 0.125;

/// A drag of a handle.
#[derive(Clone, Debug)]
pub struct Drag {
    /// The dragged handle.
    pub handle: Handle,
    /// Its progress.
    pub amount: Amount,
    /// Whether it snaps.
    pub snaps: bool,
    object: usize,
    tool: Tool,
    /// The cursor's place in the picture at the start.
    at: (f64, f64),
    /// The handles at the start.
    manipulator: Manipulator,
    /// The object's transform at the start, and its index.
    start: Transform,
    /// The handles' length, in pixels of the picture.
    length: f64,
    /// The angle of rotation so far before snapping, which may exceed a full turn.
    degrees: f64,
    before: Snapshot,
}

/// The handles' kind, and the drag of one.
#[derive(Clone, Debug, Default)]
pub struct Manipulating {
    /// What the handles do; `None` hides them.
    pub tool: Option<Tool>,
    /// The drag in progress.
    pub drag: Option<Drag>,
    /// Whether the button is down on a handle: also after Escape, until it is released.
    pub is_held: bool,
}

/// The handles of an object in world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Manipulator {
    /// The middle of the object's box, in world space.
    pub center: DVec3,
    /// Unit vectors in world space.
    pub axes: [DVec3; 3],
    /// The size of a pixel of the picture at the middle, in scene units.
    pub pixel: f64,
    /// From the eye to the middle: a unit vector.
    pub view: DVec3,
    camera: Camera,
    world_from_parent: DAffine3,
    /// The middle in the object's space.
    middle: DVec3,
    /// Whether the axes are the object's own rather than the scene's.
    own: bool,
}

impl Manipulator {
    /// The point at a `share` of the length of a handle along an axis.
    pub fn along(&self, axis: usize, pixels: f64) -> DVec3 {
        self.center + self.axes[axis] * (self.pixel * pixels)
    }

    /// The coordinate along an axis of the point nearest to the ray through a place of the picture. `None` where the
    /// view is along the axis.
    fn on_axis(&self, axis: DVec3, (x, y): (f64, f64)) -> Option<f64> {
        let ray = self.camera.ray(x, y);
        let direction = ray.direction.try_normalize()?;
        let apart = self.center - ray.origin;
        let cosine = axis.dot(direction);
        let square = 1.0 - cosine * cosine;
        let along = (cosine * direction.dot(apart) - axis.dot(apart)) / square;
        (square >= FLATTEST * FLATTEST && along.is_finite()).then_some(along)
    }

    /// The vector from the middle to the intersection of the ray through a place of the picture with the plane across
    /// `normal`. `None` where there is none, or the view is along the plane.
    fn on_plane(&self, normal: DVec3, (x, y): (f64, f64)) -> Option<DVec3> {
        let ray = self.camera.ray(x, y);
        let t = (self.center - ray.origin).dot(normal) / ray.direction.dot(normal);
        let is_met = self.view.dot(normal).abs() >= FLATTEST && t.is_finite() && t > 0.0;
        is_met.then(|| ray.at(t) - self.center)
    }

    fn normal(&self, handle: Handle) -> DVec3 {
        match handle {
            Handle::Axis(axis) | Handle::Across(axis) => self.axes[axis],
            Handle::All if self.camera.projection().panorama().is_some() => self.view,
            Handle::All => self.camera.forward(),
        }
    }
}

impl State {
    /// The handles of the selected object. `None` while clicks have another purpose, and for a hidden or locked object.
    pub fn manipulator(&self) -> Option<Manipulator> {
        let tool = self.manipulating.tool?;
        let number = self.selected?;
        let is_busy = self.measuring.tool.is_some() || self.cutting.is_some();
        if is_busy || self.walk.is_some() || self.is_locked(number) {
            return None;
        }
        let camera = self.camera()?;
        let scene = &self.document.as_ref()?.scene;
        let object = scene.objects.get(number).filter(|object| object.visible)?;
        let bounds = object.mesh.bounds();
        let world_from_parent = match object.parent {
            Some(parent) => scene.world_from_object(parent).ok()?,
            None => DAffine3::IDENTITY,
        };
        let middle = bounds.center();
        let center = (scene.world_from_object(number).ok()?).transform_point3(middle);
        let apart = center - camera.pose().eye;
        let (view, depth) = match camera.projection() {
            Projection::Orthographic => (camera.forward(), camera.distance()),
            Projection::Panoramic(panorama) if !matches!(panorama, Panorama::Lens(_)) => {
                // A pixel is an angle.
                (apart.try_normalize()?, apart.length())
            }
            _ => (apart.try_normalize()?, apart.dot(camera.forward())),
        };
        let share = depth / camera.distance();
        let pixel = camera.plane().step * share;
        // Scaling along axes that are not the object's own would shear it.
        let own = self.turning.own || tool == Tool::Scale;
        let turn = rotation(object.transform.rotate);
        let axes = DVec3::AXES.map(|axis| match own {
            true => (world_from_parent.matrix3 * (turn * axis)).normalize_or(axis),
            false => axis,
        });
        let is_seen = !bounds.is_empty() && center.is_finite() && pixel > 0.0;
        is_seen.then_some(Manipulator {
            center,
            axes,
            pixel,
            view,
            camera,
            world_from_parent,
            middle,
            own,
        })
    }
}

/// Starts dragging a handle of so many pixels at a place of the picture.
pub(super) fn grab(state: &mut State, handle: Handle, at: (f64, f64), length: f64) {
    let found = state.manipulator().zip(state.snapshot());
    let (Some((manipulator, before)), Some(tool), Some(object)) =
        (found, state.manipulating.tool, state.selected)
    else {
        return;
    };
    let Some(start) = before.scene.objects.get(object).map(|o| o.transform) else {
        return;
    };
    state.manipulating.is_held = true;
    state.manipulating.drag = Some(Drag {
        handle,
        amount: match tool {
            Tool::Move => Amount::Moved(DVec3::ZERO),
            Tool::Turn => Amount::Turned(0.0),
            Tool::Scale => Amount::Scaled(DVec3::ONE),
        },
        snaps: false,
        object,
        tool,
        at,
        manipulator,
        start,
        length,
        degrees: 0.0,
        before,
    });
}

/// Moves the object with the cursor; undo records nothing yet.
pub(super) fn drag(state: &mut State, to: (f64, f64), snaps: bool) -> Option<Effect> {
    let drag = state.manipulating.drag.as_mut()?;
    drag.snaps = snaps;
    let amount = match drag.tool {
        Tool::Move => drag.moved(to).map(Amount::Moved),
        Tool::Turn => drag.turned(to).map(Amount::Turned),
        Tool::Scale => drag.scaled(to).map(Amount::Scaled),
    };
    drag.amount = amount?;
    let (object, transform) = (drag.object, drag.transform());
    put(state, object, transform)
}

/// Ends the drag: all of it is one step of undo.
pub(super) fn release(state: &mut State) -> Option<Effect> {
    state.manipulating.is_held = false;
    let after = state.snapshot()?;
    let drag = state.manipulating.drag.take()?;
    if !drag.before.is(&after) {
        let (now, name) = (state.now, drag.tool.name());
        state.history.record(name, None, (drag.before, &after), now);
    }
    Some(Effect::Weigh(drag.object))
}

/// Cancels the drag: the object returns to its start.
pub(super) fn cancel(state: &mut State) -> Option<Effect> {
    let drag = state.manipulating.drag.take()?;
    // Changes that came from elsewhere meanwhile are no part of the drag.
    let here = state.snapshot()?;
    let scene = drag.before.scene;
    objects::restore(state, Snapshot { scene, ..here })
}

fn put(state: &mut State, object: usize, transform: Transform) -> Option<Effect> {
    let effect = objects::set_transform(state, object, transform);
    // Its size is measured at the end of the drag.
    effect.filter(|effect| !matches!(effect, Effect::Weigh(_)))
}

impl Drag {
    /// The translation so far, along the axes.
    fn moved(&self, to: (f64, f64)) -> Option<DVec3> {
        let m = &self.manipulator;
        let [x, y, z] = m.axes;
        let moved = match self.handle {
            Handle::Axis(axis) => {
                let from_to = [self.at, to].map(|at| m.on_axis(m.axes[axis], at));
                let mut moved = DVec3::ZERO;
                moved[axis] = from_to[1]? - from_to[0]?;
                moved
            }
            handle => {
                let normal = m.normal(handle);
                let way = m.on_plane(normal, to)? - m.on_plane(normal, self.at)?;
                let mut moved = DVec3::new(way.dot(x), way.dot(y), way.dot(z));
                if let Handle::Across(axis) = handle {
                    moved[axis] = 0.0;
                }
                moved
            }
        };
        if !self.snaps {
            return Some(moved);
        }
        let step = round_number(SNAP_PIXELS * m.pixel);
        Some((moved / step).round() * step)
    }

    /// The rotation so far, in degrees.
    fn turned(&mut self, to: (f64, f64)) -> Option<f64> {
        let m = &self.manipulator;
        let normal = m.normal(self.handle);
        let degrees = match m.on_plane(normal, self.at).zip(m.on_plane(normal, to)) {
            Some((from, to)) => {
                let angle = math::atan2(normal.dot(from.cross(to)), from.dot(to)).to_degrees();
                // Of the equivalent angles, the nearest to the last one.
                angle + 360.0 * ((self.degrees - angle) / 360.0).round()
            }
            // Seen edge-on a ring is a line: its near side follows the cursor.
            None => {
                let across = normal.cross(-m.view).try_normalize()?;
                let way = m.on_axis(across, to)? - m.on_axis(across, self.at)?;
                (way / (self.length * m.pixel)).to_degrees()
            }
        };
        self.degrees = degrees;
        Some(match self.snaps {
            true => (degrees / SNAP_DEGREES).round() * SNAP_DEGREES,
            false => degrees,
        })
    }

    /// The scale factors so far, along the axes.
    fn scaled(&self, to: (f64, f64)) -> Option<DVec3> {
        let m = &self.manipulator;
        let factor = match self.handle {
            Handle::Axis(axis) => {
                let [from, to] = [self.at, to].map(|at| m.on_axis(m.axes[axis], at));
                to? / from?
            }
            Handle::Across(axis) => {
                let [from, to] = [self.at, to].map(|at| m.on_plane(m.axes[axis], at));
                let from = from?;
                to?.dot(from) / from.length_squared()
            }
            // The factor doubles for each length of a handle to the right or up.
            Handle::All => {
                let way = (to.0 - self.at.0) + (self.at.1 - to.1);
                math::pow(2.0, (way / self.length).clamp(-16.0, 16.0))
            }
        };
        // The drag started in the middle, or at a handle that is seen edge-on.
        if !factor.is_finite() {
            return None;
        }
        let factor = match self.snaps {
            true => ((factor / SNAP_FACTOR).round() * SNAP_FACTOR).max(SNAP_FACTOR),
            false => factor.max(LEAST_FACTOR),
        };
        let factors = match self.handle {
            Handle::Axis(along) => DVec3::ONE.with_axis(along, factor),
            Handle::Across(across) => DVec3::splat(factor).with_axis(across, 1.0),
            Handle::All => DVec3::splat(factor),
        };
        factors.is_finite().then_some(factors)
    }

    /// The object's transform after this progress of the drag.
    fn transform(&self) -> Transform {
        let m = &self.manipulator;
        let start = &self.start;
        match self.amount {
            Amount::Moved(by) => {
                let in_world: DVec3 = (0..3).map(|axis| m.axes[axis] * by[axis]).sum();
                let way = m.world_from_parent.matrix3.inverse() * in_world;
                Transform {
                    translate: start.translate + way,
                    ..*start
                }
            }
            Amount::Turned(degrees) => match self.handle {
                Handle::Axis(axis) | Handle::Across(axis) if m.own => {
                    turned(start, DVec3::AXES[axis], true, degrees, m.middle)
                }
                handle => {
                    let axis = axis_in(&m.world_from_parent, m.normal(handle));
                    turned(start, axis, false, degrees, m.middle)
                }
            },
            Amount::Scaled(factors) => {
                let mut next = Transform {
                    scale: start.scale * factors,
                    ..*start
                };
                let place = |t: &Transform| t.parent_from_object().transform_point3(m.middle);
                let moved = place(start) - place(&next);
                if moved.is_finite() {
                    next.translate += moved;
                }
                next
            }
        }
    }
}

/// A vector with one component changed.
trait WithAxis {
    fn with_axis(self, axis: usize, value: f64) -> Self;
}

impl WithAxis for DVec3 {
    fn with_axis(mut self, axis: usize, value: f64) -> Self {
        self[axis] = value;
        self
    }
}

/// The least of 1, 2 and 5 times a power of ten that is at least `length`.
fn round_number(length: f64) -> f64 {
    let power = math::pow(
        10.0,
        (math::log2(length) / std::f64::consts::LOG2_10).floor(),
    );
    let steps = [1.0, 2.0, 5.0, 10.0].map(|digit| digit * power);
    steps
        .into_iter()
        .find(|step| *step >= length)
        .unwrap_or(length)
}
