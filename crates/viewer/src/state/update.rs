//! The one place that executes commands.

use super::command::Command;
use super::effect::Effect;
use super::manipulator;
use super::measure::Kind;
use super::pick::Pinned;
use super::texture_requests;
use super::thumbnail::{ShownImage, TexturePart};
use super::viewpoint::fov_range;
use super::{Palette, PromptKind, Resolution, SAMPLES_LIMIT, State};
use super::{
    as_command, bookmarks, cut, files, groups, history, inspect, list_order, navigate, objects,
    parents, plane, preferences, shapes,
};
use raycast_core::ranges::{FURTHEST_SHIFT, WIDEST_LINE};
use raycast_core::scene::{TextureProjection, UpAxis};
use raycast_core::shade::{Mode, Wireframe};
use std::collections::BTreeSet;

pub use super::names::suggested_name;

/// Executes a command. Changes of the document can be undone.
pub fn update(state: &mut State, command: Command) -> Option<Effect> {
    let uses_mouse = command.moves_camera() || matches!(command, Command::Pin { .. });
    state.preferences.knows_mouse |= uses_mouse && state.document.is_some();
    let places_point = matches!(command, Command::Pin { .. } | Command::SetPivot { .. });
    let measures = places_point && state.measuring.tool.is_some();
    let edit = command.edit().or(measures.then_some(("Measure", false)));
    let is_step = edit.is_some() || matches!(command, Command::Undo | Command::Redo);
    // A drag in progress becomes a step of its own.
    let released = match is_step && state.manipulating.drag.is_some() {
        true => manipulator::release(state),
        false => None,
    };
    let Some((name, goes_on)) = edit else {
        return carry_out(state, command).or(released);
    };
    let kind: Option<history::Continued> =
        goes_on.then(|| (std::mem::discriminant(&command), command.object()));
    let name = match &command {
        Command::SetTransform(object, to) => objects::step_to(state, *object, to).unwrap_or(name),
        _ => name,
    };
    let before = state.snapshot();
    let effect = carry_out(state, command);
    let now = state.now;
    if let Some((before, after)) = before.zip(state.snapshot())
        && !before.is(&after)
    {
        state.history.record(name, kind, (before, &after), now);
    }
    effect.or(released)
}

fn carry_out(state: &mut State, command: Command) -> Option<Effect> {
    match command {
        Command::Orbit { yaw, pitch } => {
            navigate::leave(state);
            state.viewpoint.orbit.turn(yaw, pitch);
        }
        Command::Grab { at } => navigate::grab(state, at),
        Command::Pan { dx, dy } => {
            navigate::leave(state);
            navigate::pan(state, dx, dy);
        }
        Command::Zoom { at, factor } => {
            navigate::leave(state);
            navigate::zoom(state, at, factor);
        }
        Command::Push { at, notches } => {
            navigate::leave(state);
            navigate::push(state, at, notches);
        }
        Command::Roll(degrees) => navigate::roll(state, degrees),
        Command::SetPivot { .. } if state.measuring.tool == Some(Kind::Path) => {
            state.measuring.end_path();
        }
        Command::SetPivot { at } => {
            navigate::leave(state);
            navigate::set_pivot(state, at);
        }
        Command::Fit => navigate::fit(state),
        Command::ResetView => navigate::go(state, state.home),
        Command::Look(view) => navigate::look(state, view),
        Command::LookBack => navigate::look_back(state),
        Command::ViewBack => navigate::back(state),
        Command::ViewForward => navigate::forward(state),

        Command::SetWalk(on) => navigate::set_walk(state, on),
        Command::Walk { way, seconds } => navigate::walk(state, way, seconds),
        Command::ScaleWalk(factor) => navigate::scale_walk(state, factor),
        Command::LookAround { yaw, pitch } => navigate::look_around(state, yaw, pitch),
        Command::AddBookmark => bookmarks::add(state),
        Command::GoToBookmark(number) => bookmarks::go(state, number),
        Command::RemoveBookmark(number) => bookmarks::remove(state, number),
        Command::CopyCamera => return bookmarks::copy(state),
        Command::PasteCamera(text) => bookmarks::paste(state, &text),
        Command::SetPose { eye, target } => navigate::place(state, eye, target),

        Command::SetStep(step) => plane::set_step(state, step),
        Command::ScaleStep(factor) => plane::scale_step(state, factor),
        Command::SetSize(columns, rows) => {
            plane::set_resolution(state, Resolution::Fixed(columns.max(1), rows.max(1)));
        }
        Command::FitWindow => state.resolution = Resolution::Window { density: 1.0 },
        Command::SetFov(fov) if fov.is_finite() => {
            navigate::leave(state);
            let (narrowest, widest) = fov_range(state.viewpoint.projection);
            state.viewpoint.fov = fov.clamp(narrowest, widest);
        }
        Command::SetFov(_) => {}
        Command::SetFrame(height) => {
            navigate::leave(state);
            plane::set_frame(state, height);
        }
        Command::SetLock(lock) => state.lock = lock,
        Command::SetProjection(projection) => {
            navigate::leave(state);
            navigate::set_projection(state, projection);
        }
        Command::SetSamples(samples) => {
            state.samples = samples.map(|samples| samples.clamp(1, SAMPLES_LIMIT));
        }
        Command::SetPixelFilter(filter) => state.settings.pixel_filter = filter,
        Command::SetShift(shift) => {
            let within = |part: f64| part.clamp(-FURTHEST_SHIFT, FURTHEST_SHIFT);
            if shift.iter().all(|part| part.is_finite()) {
                state.shift = shift.map(within);
            }
        }

        Command::SetGrid(grid) => state.grid = plane::limited(grid, state.size()),
        Command::SetBorders(on) => state.overlay.borders = on,
        Command::SetOrder(on) => state.overlay.order = on,
        Command::SetTint(tint) => state.overlay.tint = tint,

        Command::SetMode(mode) => {
            let shading = &mut state.settings.shading;
            // Depth in greys on grey is hard to read: it starts with a color map.
            if mode == Mode::Depth && shading.mode != Mode::Depth {
                shading.scale.get_or_insert_default();
            }
            shading.mode = mode;
            if let Some(why) = nothing_to_show(state) {
                state.tell(why);
            }
        }
        Command::SetCrease(degrees) => {
            state.settings.shading.crease = degrees.clamp(0.0, 180.0);
        }
        Command::SetLights(lights) => state.settings.shading.lights = lights,
        Command::SetPlainColor(color) => state.settings.shading.plain_color = color,
        Command::SetColorScale(scale) => state.settings.shading.scale = scale,
        Command::SetWireframe(on) => {
            state.settings.shading.wireframe = on.then(Wireframe::default);
        }
        Command::SetWireframeWidth(width) => {
            wireframe(state).width = width.clamp(0.25, WIDEST_LINE);
        }
        Command::SetWireframeColor(color) => wireframe(state).color = color,
        Command::SetWireframeEdges(edges) => wireframe(state).edges = edges,
        Command::SetWireframeHidden(share) => wireframe(state).hidden = share.clamp(0.0, 1.0),
        Command::SetBlend(blend) => state.settings.shading.blend = blend.clamp(0.0, 1.0),
        Command::SetFilter(filter) => state.settings.shading.filter = filter,
        Command::SetTextureProjection(projection) => {
            state.settings.shading.projection = projection;
            if projection == TextureProjection::Camera {
                return objects::take_photographs(state, |object| {
                    object.mapping.photograph.is_none()
                });
            }
        }
        Command::SetObjectProjection(which, projection) => {
            let effect = objects::change(state, Some(which), |object| {
                object.mapping.projection = projection;
            });
            let is_camera = Some(TextureProjection::Camera);
            let taken = objects::take_photographs(state, |object| {
                object.mapping.projection == is_camera && object.mapping.photograph.is_none()
            });
            return taken.or(effect);
        }
        Command::TakePhotographs => return objects::take_photographs(state, |_| true),
        Command::SetCull(cull) => state.settings.cull = cull,
        Command::SetXRayOpacity(opacity) => {
            state.settings.shading.x_ray_opacity = opacity.clamp(0.0, 1.0);
        }
        Command::SetGround(ground) => state.settings.shading.ground = ground,
        Command::SetBackFaces(color) => state.settings.shading.back_faces = color,
        Command::SetBackground(background) => state.settings.shading.background = background,
        Command::SetColorRule(which, rule) => {
            return objects::change(state, which, |object| object.color = rule.clone());
        }
        Command::RemoveTexture(which) => {
            return objects::change(state, which, |object| {
                object.texture = None;
                object.texture_source = None;
            });
        }

        Command::Select(which) => {
            state.selected = which;
            return which.map(Effect::Weigh);
        }
        Command::SetVisible(which, visible) => {
            return objects::edit_one(state, which, |object| object.visible = visible);
        }
        Command::Isolate(which) => return objects::isolate(state, which),
        Command::ShowAll => {
            return objects::edit_each(state, |_, object| {
                object.visible = true;
                object.hide_groups(BTreeSet::new());
            });
        }
        Command::SetGroupVisible {
            object,
            group,
            visible,
        } => return groups::set_visible(state, object, &group, visible),
        Command::IsolateGroup { object, group } => return groups::isolate(state, object, &group),
        Command::EditName(which) => {
            state.naming = which.filter(|&which| objects::is_free(state, which));
            state.panel |= which.is_some();
        }
        Command::Rename(which, name) => {
            state.naming = None;
            let name = name.trim().to_owned();
            if !name.is_empty() {
                return objects::change(state, Some(which), |object| object.name = name.clone());
            }
        }
        Command::SetLocked(which, locked) => objects::lock(state, which, locked),
        Command::SetTransform(which, transform) => {
            return objects::set_transform(state, which, transform);
        }
        Command::SetParent(which, parent) => return parents::set(state, which, parent),
        Command::Reorder(which, to) => return list_order::insert(state, which, to),
        Command::Turn(which, axis) => return objects::turn(state, which, axis),
        Command::SetTurning(turning) => {
            if turning.degrees.is_finite() {
                state.turning = turning;
            }
        }
        Command::AddShape(shape) => return shapes::add(state, shape),
        Command::SetShape(which, shape) => return shapes::set(state, which, shape),
        Command::Duplicate(which) => return objects::duplicate(state, which),
        Command::Delete(which) => return objects::delete(state, which),

        Command::SetManipulator(tool) => {
            state.cutting = None;
            state.measuring.tool = None;
            state.manipulating.tool = tool;
            if tool.is_some() {
                tell_of_handles(state);
            }
        }
        Command::GrabHandle { handle, at, length } => {
            manipulator::grab(state, handle, at, length);
        }
        Command::DragHandle { to, snaps } => return manipulator::drag(state, to, snaps),
        Command::ReleaseHandle => return manipulator::release(state),

        Command::AddPlane(by) => cut::add(state, by),
        Command::SetPlane(index, plane) => cut::set(state, index, plane),
        Command::RemovePlane(index) => cut::remove(state, index),
        Command::SetCutting(on) => {
            state.cutting = on.then(Vec::new);
            state.measuring.tool = None;
            state.manipulating.tool = None;
        }

        Command::SetTool(tool) => {
            state.cutting = None;
            state.measuring.points.clear();
            state.measuring.tool = tool;
            state.manipulating.tool = None;
        }
        Command::SetUnit(unit) => state.preferences.unit = unit,
        Command::SetSnaps(on) => state.measuring.snaps = on,
        Command::TakePointBack => {
            state.measuring.points.pop();
        }
        Command::EndPath => state.measuring.end_path(),
        Command::RemoveMeasurement(number) => state.measuring.remove(number),
        Command::ClearMeasurements => state.measuring.list = Default::default(),
        Command::Check { deep } => return inspect::check(state, deep),
        Command::ShowFault(shown) => inspect::show(state, shown),

        Command::Pin { at: (x, y), .. } if state.cutting.is_some() => {
            let point = state.pick(x, y)?.point;
            let points = cut::take(state, point)?;
            return update(state, Command::AddPlane(cut::PlaneBy::Points(points)));
        }
        Command::Pin { at: (x, y), .. } if state.measuring.tool.is_some() => {
            if let Some(target) = state.target(x, y) {
                state.measuring.add(target.point);
            }
        }
        Command::Pin { at: (x, y), beside } => {
            let pick = state.pick(x, y);
            let document = state.document.as_ref()?;
            let pinned = pick.and_then(|pick| Pinned::of(document, pick));
            match pinned {
                None if beside => return None,
                Some(pinned) if beside => {
                    if !state.picks.add(pinned) {
                        state.tell("No more picks are kept: Esc lets go of all");
                    }
                }
                pinned => state.picks.set(pinned),
            }
            return select_picked(state);
        }
        Command::ChoosePick(index) => {
            state.picks.choose(index);
            return select_picked(state);
        }
        Command::RemovePick(index) => state.picks.remove(index),
        Command::Unpin => state.picks = Default::default(),
        Command::Copy(text) => {
            let first = text.lines().next().unwrap_or_default();
            let more = if text.lines().count() > 1 { " …" } else { "" };
            state.tell(format!("Copied {first}{more}"));
            return Some(Effect::Copy(text));
        }

        Command::CopyPicture if state.document.is_none() => {}
        Command::CopyPicture => return Some(Effect::RenderCopy),
        Command::CopyCommand => return as_command::copy(state),

        Command::Undo | Command::Redo => {
            let here = state.snapshot()?;
            let (what, step) = match command {
                Command::Undo => ("Undone", state.history.undo(here)),
                _ => ("Done again", state.history.redo(here)),
            };
            let (name, there) = step?;
            state.tell(format!("{what}: {name}"));
            return objects::restore(state, there);
        }

        Command::SetThreads(threads) => state.threads = threads.clamp(1, 256),

        Command::Ask(PromptKind::Picture | PromptKind::SceneCopy | PromptKind::Meshes)
            if state.document.is_none() => {}
        Command::Ask(PromptKind::Measurements) if state.measuring.list.is_empty() => {}
        Command::Ask(PromptKind::Outline(plane)) if plane >= state.settings.clip.all().len() => {}
        Command::Ask(kind) => return Some(files::ask(state, kind)),
        Command::Tell(text) => state.tell(text),
        Command::LoseKeyboard => {
            if let Some(prompt) = &mut state.prompt {
                prompt.has_lost_keyboard = true;
            }
        }
        Command::SetAdding(adding) => {
            if let Some(prompt) = &mut state.prompt {
                prompt.kind = if adding {
                    PromptKind::Add
                } else {
                    PromptKind::Open
                };
            }
        }
        Command::TypePath(text) => return files::type_path(state, text),
        Command::ConfirmPath => return files::confirm(state),
        Command::Open(paths) => {
            state.typed = None;
            return files::open(state, paths);
        }
        Command::Add(paths) => {
            state.typed = None;
            return files::add(state, paths);
        }
        Command::OpenNeighbor(step) => {
            let document = state.document.as_ref()?;
            let first = document.paths.first()?.clone();
            // Past files that could not be opened, and not back to the one that is open.
            state.neighbor += step;
            if state.neighbor == 0 {
                state.neighbor = step;
            }
            return Some(Effect::OpenNeighbor(first, state.neighbor));
        }
        Command::Reload => return files::reload(state),
        Command::OpenCase(name) => return Some(Effect::OpenCase(name)),
        Command::CancelLoad => {
            state.typed = None;
            return Some(Effect::CancelLoad);
        }
        Command::LoadTexture(path, which) => {
            (state.prompt, state.typed) = (None, None);
            return texture_requests::ask(state, path, which, TexturePart::default());
        }
        Command::SetTexturePart(which, part) => {
            if !objects::is_free(state, which) {
                return None;
            }
            let object = state.document.as_ref()?.scene.objects.get(which)?;
            let path = object.texture_source.clone()?;
            return texture_requests::ask(state, path, Some(which), part);
        }
        Command::ShowImage(path) => {
            let found = Ok(None);
            state.image = Some(ShownImage {
                path: path.clone(),
                found,
            });
            return Some(Effect::ReadThumbnail(path));
        }
        Command::DropPicture(path) => {
            state.prompt = None;
            let recent = state.preferences.recent.clone();
            return Some(Effect::OpenPicture(path, recent));
        }
        Command::SavePicture(path) => {
            state.typed = None;
            return files::save_picture(state, path, false);
        }
        Command::SaveScene => return files::save_scene(state),
        Command::SaveSceneAs(path) => return files::save_scene_as(state, path, false),
        Command::Replace => return files::replace(state),
        Command::Answer(answer) => return files::answer(state, answer),
        Command::Close => return files::close(state),

        Command::SetTheme(theme) => state.preferences.theme = theme,
        Command::SetScale(scale) if scale.is_finite() => {
            let (least, most) = preferences::SCALE_RANGE;
            state.preferences.scale = scale.clamp(least, most);
        }
        Command::SetScale(_) => {}
        Command::SetMouse(mouse) => state.preferences.mouse = mouse,
        Command::SetSmooth(on) => state.preferences.smooth = on,
        Command::SetRefine(on) => state.preferences.refine = on,
        Command::SetZUp(on) => {
            state.preferences.z_up = on;
            state.limits.up_axis = if on { UpAxis::Z } else { UpAxis::Y };
            return files::read_turned(state);
        }
        Command::SetWatch(on) => state.preferences.watch = on,

        Command::ToggleFullScreen => return Some(Effect::ToggleFullScreen),
        Command::TogglePanel => state.panel = !state.panel,
        Command::OpenPart(part) => {
            state.panel = true;
            state.part = (Some(part), state.part.1 + 1);
        }
        Command::ToggleHelp => state.help = !state.help,
        Command::FocusMenu => return Some(Effect::FocusMenu),
        Command::About => state.tell(concat!(
            "RayCast ",
            env!("CARGO_PKG_VERSION"),
            ", under the MIT or the Apache 2.0 license"
        )),
        Command::OpenKeysFile => return Some(Effect::OpenKeysFile),
        Command::ReloadKeys => return Some(Effect::ReadKeysFile),
        Command::TogglePalette => {
            state.palette = match state.palette {
                Some(_) => None,
                None => Some(Palette::default()),
            };
        }
        Command::TypeAhead(text) if state.palette.is_some() => {
            state.palette = Some(Palette { text, marked: 0 });
        }
        Command::TypeAhead(text) => return files::type_ahead(state, text),
        Command::TypePalette(text) => state.palette = Some(Palette { text, marked: 0 }),
        Command::MarkPalette(marked) => {
            if let Some(palette) = &mut state.palette {
                palette.marked = marked;
            }
        }
        Command::Dismiss if state.manipulating.drag.is_some() => {
            return manipulator::cancel(state);
        }
        Command::Dismiss => return dismiss(state),
        Command::DismissError(index) => {
            if index < state.errors.len() {
                state.errors.remove(index);
            }
        }
    }
    None
}

/// Shows a message if the requested handles cannot be shown.
fn tell_of_handles(state: &mut State) {
    let why = if state.selected.is_none() {
        "Mark an object, in the list or by a click: its handles appear"
    } else if state.viewpoint.projection.panorama().is_some() {
        "Panoramas have no handles: the numbers in the panel move objects here too"
    } else {
        return;
    };
    state.tell(why);
}

/// What the mode needs and no object has.
fn nothing_to_show(state: &State) -> Option<&'static str> {
    let objects = &state.document.as_ref()?.scene.objects;
    match state.settings.shading.mode {
        Mode::Uv if !objects.iter().any(|object| object.mesh.has_uvs()) => {
            Some("No mesh has texture coordinates: all is shown as (0, 0)")
        }
        Mode::Texture if !objects.iter().any(|object| object.has_texture()) => {
            Some("No object has a texture: colors are shown without light")
        }
        _ => None,
    }
}

/// Advances smooth motion; returns whether it goes on.
pub fn advance(state: &mut State) -> bool {
    navigate::advance(state)
}

/// The wireframe's settings, switched on if they were not.
fn wireframe(state: &mut State) -> &mut Wireframe {
    let shading = &mut state.settings.shading;
    let usual = match shading.mode {
        Mode::Wireframe => Wireframe::ALONE,
        _ => Wireframe::default(),
    };
    shading.wireframe.get_or_insert(usual)
}

/// Closes the topmost of what is open, or cancels what is under way.
fn dismiss(state: &mut State) -> Option<Effect> {
    if state.palette.is_some() {
        state.palette = None;
    } else if state.help {
        state.help = false;
    } else if state.question.is_some() {
        files::answer(state, super::Answer::Stay);
    } else if state.replacing.is_some() {
        state.replacing = None;
        state.forget_pending();
        files::ask_again(state);
    } else if state.prompt.is_some() {
        state.prompt = None;
        state.typed = None;
        state.forget_pending();
    } else if state.naming.is_some() {
        state.naming = None;
    } else if state.is_loading {
        state.typed = None;
        return Some(Effect::CancelLoad);
    } else if state.errors.pop().is_some() {
    } else if state.walk.is_some() {
        state.walk = None;
    } else if state.cutting.is_some() {
        state.cutting = None;
    } else if !state.measuring.points.is_empty() {
        state.measuring.points.clear();
    } else if state.measuring.tool.is_some() {
        state.measuring.tool = None;
    } else if state.manipulating.tool.is_some() {
        state.manipulating.tool = None;
    } else if state.inspection.shown.is_some() {
        state.inspection.shown = None;
    } else if state.picks.current().is_some() {
        state.picks = Default::default();
    } else {
        state.selected = None;
    }
    None
}

/// Selects the object of the current pick.
fn select_picked(state: &mut State) -> Option<Effect> {
    // While a tree is being built, its indices are those before the edit.
    let document = state.document.as_ref()?;
    let pinned = state.picks.current().filter(|_| document.is_built());
    state.selected = pinned.map(|pinned| pinned.pick.hit.object as usize);
    state.selected.map(Effect::Weigh)
}

/// The middle of the picture, for keys that act on a place.
pub fn middle(state: &State) -> (f64, f64) {
    let (columns, rows) = state.size();
    (f64::from(columns) * 0.5, f64::from(rows) * 0.5)
}
