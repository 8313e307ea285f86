//! Commands: panels and keys emit them, `update` executes them.

use super::cut::PlaneBy;
use super::handle::{Handle, Tool};
use super::insertion::Insertion;
use super::inspection::Shown;
use super::measure::Kind;
use super::part::Part;
use super::preferences::{Mouse, Theme};
use super::thumbnail::TexturePart;
use super::turn::Turning;
use super::viewpoint::StandardView;
use super::{Answer, PromptKind, Tint};
use raycast_core::Cull;
use raycast_core::camera::{FrameLock, Grid, PixelFilter, Projection};
use raycast_core::formats::LengthUnit;
use raycast_core::glam::DVec3;
use raycast_core::scene::{
    ClippingPlane, Color, ColorRule, ColorScale, Shape, TextureProjection, Transform,
};
use raycast_core::shade::{Background, EdgeKinds, Filter, Ground, LightSet, Mode};
use std::path::PathBuf;

/// A command. Places are in pixels of the picture from its top left corner.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Orbit about the pivot, in degrees.
    Orbit {
        /// About the vertical axis.
        yaw: f64,
        /// Up from the horizon.
        pitch: f64,
    },
    /// Start panning: the point seen at a place follows the cursor.
    Grab {
        /// The place.
        at: (f64, f64),
    },
    /// Pan by so many pixels of the picture.
    Pan {
        /// To the right.
        dx: f64,
        /// Downwards.
        dy: f64,
    },
    /// Zoom in (a factor below one) or out; the point seen at a place stays there.
    Zoom {
        /// The place.
        at: (f64, f64),
        /// The new distance over the old.
        factor: f64,
    },
    /// Move the eye towards what is seen at a place, and through it.
    Push {
        /// The place.
        at: (f64, f64),
        /// Notches of the wheel; backwards where negative.
        notches: f64,
    },
    /// Roll the camera to the right about its view axis, in degrees.
    Roll(f64),
    /// Make the point seen at a place the pivot, and centre it.
    SetPivot {
        /// The place.
        at: (f64, f64),
    },
    /// Fit all visible objects into the picture.
    Fit,
    /// Go to the scene file's view, or the one that the scene was first shown from.
    ResetView,
    /// Look from a standard direction.
    Look(StandardView),
    /// Look from the opposite side of the pivot.
    LookBack,
    /// Go back in the camera's history.
    ViewBack,
    /// Go forward in the camera's history.
    ViewForward,

    /// Start or stop walking.
    SetWalk(bool),
    /// Walk for one frame.
    Walk {
        /// To the right, up and forwards: 1 is the walking speed.
        way: DVec3,
        /// The frame's duration.
        seconds: f64,
    },
    /// Multiply the walking speed.
    ScaleWalk(f64),
    /// Turn the view about the eye, in degrees.
    LookAround {
        /// About the vertical axis.
        yaw: f64,
        /// Up from the horizon.
        pitch: f64,
    },
    /// Bookmark the view.
    AddBookmark,
    /// Go to a bookmark, by its index.
    GoToBookmark(usize),
    /// Remove a bookmark, by its index.
    RemoveBookmark(usize),
    /// Copy the camera as text.
    CopyCamera,
    /// Go to the camera that a text describes.
    PasteCamera(String),
    /// Look from a place at another, upright.
    SetPose {
        /// The eye.
        eye: DVec3,
        /// The target.
        target: DVec3,
    },

    /// Set the step, the distance between neighbouring rays, in scene units.
    SetStep(f64),
    /// Multiply the step by a factor.
    ScaleStep(f64),
    /// Set columns and rows.
    SetSize(u32, u32),
    /// Cast one ray for each pixel of the window.
    FitWindow,
    /// Set the vertical field of view, in degrees.
    SetFov(f64),
    /// Set the height of an orthographic frame, in scene units.
    SetFrame(f64),
    /// Set what stays when the step changes.
    SetLock(FrameLock),
    /// Set the projection.
    SetProjection(Projection),
    /// Set the samples a pixel; `None` refines a still picture by itself.
    SetSamples(Option<u32>),
    /// Set the pixel filter.
    SetPixelFilter(PixelFilter),
    /// Set the frame's shift off the view axis, to the right and up, in heights of the frame.
    SetShift([f64; 2]),

    /// Set the split into tiles.
    SetGrid(Grid),
    /// Show tile borders.
    SetBorders(bool),
    /// Show the tiles' order of arrival.
    SetOrder(bool),
    /// Set the statistic that colours tiles.
    SetTint(Tint),

    /// Set the shading mode.
    SetMode(Mode),
    /// Draw edges over the mode.
    SetWireframe(bool),
    /// Set the lines' width, in pixels.
    SetWireframeWidth(f32),
    /// Set the lines' colour.
    SetWireframeColor(Color),
    /// Set the kinds of edges that are drawn.
    SetWireframeEdges(EdgeKinds),
    /// Set how strongly hidden lines show, 0 to 1.
    SetWireframeHidden(f32),
    /// Set the share of the texture in the colour, from 0 to 1.
    SetBlend(f32),
    /// Set the texture filter.
    SetFilter(Filter),
    /// Set the texture projection.
    SetTextureProjection(TextureProjection),
    /// Set an object's own texture projection; `None`: that of the picture.
    SetObjectProjection(usize, Option<TextureProjection>),
    /// Project textures as photographs from the present camera.
    TakePhotographs,
    /// Set the culling.
    SetCull(Cull),
    /// Set the opacity of surfaces in x-ray mode, 0 to 1.
    SetXRayOpacity(f32),
    /// Set the colour of back faces; `None` for that of the front.
    SetBackFaces(Option<Color>),
    /// Set the ground grid.
    SetGround(Option<Ground>),
    /// Set the background.
    SetBackground(Background),
    /// Set the crease angle, below which edges are shaded smoothly, in degrees.
    SetCrease(f32),
    /// Set the lights.
    SetLights(LightSet),
    /// Set the colour of triangles without one.
    SetPlainColor(Color),
    /// Set the colour scale; `None` for the default, with depth in greys.
    SetColorScale(Option<ColorScale>),
    /// Set the colour rule of an object; of all, for `None`.
    SetColorRule(Option<usize>, ColorRule),
    /// Remove the texture of an object; of all, for `None`.
    RemoveTexture(Option<usize>),

    /// Select an object, or none.
    Select(Option<usize>),
    /// Show or hide an object.
    SetVisible(usize, bool),
    /// Hide or show a group of an object's mesh.
    SetGroupVisible {
        /// The object's number.
        object: usize,
        /// The group's name; empty for the triangles in no group.
        group: String,
        /// Whether it is shown.
        visible: bool,
    },
    /// Show a group of an object's mesh alone, or all of them again.
    IsolateGroup {
        /// The object's number.
        object: usize,
        /// The group's name.
        group: String,
    },
    /// Isolate an object; show all if it is isolated already.
    Isolate(usize),
    /// Show all objects.
    ShowAll,
    /// Start or stop editing an object's name.
    EditName(Option<usize>),
    /// Rename an object.
    Rename(usize, String),
    /// Add a shape to the scene.
    AddShape(Shape),
    /// Change the parameters of an object that is a shape.
    SetShape(usize, Shape),
    /// Duplicate an object, beside the original.
    Duplicate(usize),
    /// Delete an object and its descendants.
    Delete(usize),
    /// Lock or unlock an object.
    SetLocked(usize, bool),
    /// Set an object's transform.
    SetTransform(usize, Transform),
    /// Set or remove an object's parent; it keeps its place in the scene.
    SetParent(usize, Option<usize>),
    /// Move an object in the list; it keeps its place in the scene.
    Reorder(usize, Insertion),
    /// Turn an object about this axis (0 to 2) by the angle that [`SetTurning`](Self::SetTurning) set.
    Turn(usize, usize),
    /// Set how objects are turned and scaled.
    SetTurning(Turning),

    /// Set what the selected object's handles do; `None` hides them.
    SetManipulator(Option<Tool>),
    /// Start dragging a handle.
    GrabHandle {
        /// The handle.
        handle: Handle,
        /// At this place.
        at: (f64, f64),
        /// The handles' length, in pixels of the picture.
        length: f64,
    },
    /// Drag the handle to a place.
    DragHandle {
        /// The place.
        to: (f64, f64),
        /// Whether it snaps to round numbers.
        snaps: bool,
    },
    /// End the drag of a handle.
    ReleaseHandle,

    /// Add a clipping plane.
    AddPlane(PlaneBy),
    /// Replace a clipping plane, by its index.
    SetPlane(usize, ClippingPlane),
    /// Remove a clipping plane, by its index.
    RemovePlane(usize),
    /// Start or stop taking clicks as the three points of a clipping plane.
    SetCutting(bool),

    /// Set what clicks on the picture measure; `None` to pick.
    SetTool(Option<Kind>),
    /// Set the unit in which lengths are shown; `None` for that of the files.
    SetUnit(Option<LengthUnit>),
    /// Set whether measured points snap to vertices.
    SetSnaps(bool),
    /// Remove the last point of the measurement in progress.
    TakePointBack,
    /// End the path that is being measured.
    EndPath,
    /// Remove a measurement, by its index.
    RemoveMeasurement(usize),
    /// Remove all measurements.
    ClearMeasurements,
    /// Check the selected object's mesh, or all if none is selected.
    Check {
        /// Whether to search for self-intersections, too.
        deep: bool,
    },
    /// Show one fault of a mesh, or none.
    ShowFault(Option<Shown>),

    /// Pick what is seen at a place, or nothing. While measuring, take the place as the next point.
    Pin {
        /// The place.
        at: (f64, f64),
        /// Whether to keep the earlier picks.
        beside: bool,
    },
    /// Show one of the picks, by its index.
    ChoosePick(usize),
    /// Remove one of the picks, by its index.
    RemovePick(usize),
    /// Remove all picks.
    Unpin,
    /// Copy text to the clipboard.
    Copy(String),
    /// Copy the picture to the clipboard.
    CopyPicture,
    /// Copy the command that makes this picture.
    CopyCommand,

    /// Undo the last change.
    Undo,
    /// Redo the last undone change.
    Redo,

    /// Set the number of render threads.
    SetThreads(usize),

    /// Ask for a path, by the desktop's dialog and by the path line in the window.
    Ask(PromptKind),
    /// Tell the user something.
    Tell(&'static str),
    /// Note that the window has lost the keyboard.
    LoseKeyboard,
    /// Set whether the requested files are added to the scene instead of replacing it.
    SetAdding(bool),
    /// Set the text of the path line.
    TypePath(String),
    /// Accept the path line's text.
    ConfirmPath,
    /// Open files as one scene.
    Open(Vec<PathBuf>),
    /// Add files to the scene.
    Add(Vec<PathBuf>),
    /// Open the folder's next file (1) or the one before (−1).
    OpenNeighbor(i32),
    /// Reload the files of the scene.
    Reload,
    /// Open the hard case of this name.
    OpenCase(&'static str),
    /// Cancel loading.
    CancelLoad,
    /// Use an image as the texture of an object; of all, for `None`.
    LoadTexture(PathBuf, Option<usize>),
    /// Show a part of its image file as the texture of an object.
    SetTexturePart(usize, TexturePart),
    /// Read an image file's thumbnail.
    ShowImage(PathBuf),
    /// Restore the camera and look from a picture's recipe; without a recipe, use it as the texture of all objects.
    DropPicture(PathBuf),
    /// Save the picture; the name's ending gives the format. An existing file is replaced only after a question.
    SavePicture(PathBuf),
    /// Save the scene to its file; ask for a path if it has none.
    SaveScene,
    /// Save the scene to a file. An existing file is replaced only after a question.
    SaveSceneAs(PathBuf),
    /// Replace the existing file that was asked about.
    Replace,
    /// Answer the question about unsaved changes.
    Answer(Answer),
    /// Close the window.
    Close,

    /// Set the theme.
    SetTheme(Theme),
    /// Set the scale of the interface.
    SetScale(f32),
    /// Set what drags of the mouse do.
    SetMouse(Mouse),
    /// Set whether the camera moves smoothly between views.
    SetSmooth(bool),
    /// Set whether still pictures get more samples.
    SetRefine(bool),
    /// Set whether z is up in files that do not say which axis is, and read them again.
    SetZUp(bool),
    /// Set whether files are reloaded when they change.
    SetWatch(bool),

    /// Fill the screen with the window, or no longer.
    ToggleFullScreen,
    /// Show or hide the side panel.
    TogglePanel,
    /// Open a part of the side panel, and bring it into view.
    OpenPart(Part),
    /// Show or hide the help.
    ToggleHelp,
    /// Give the keyboard to the menu bar.
    FocusMenu,
    /// Tell the version.
    About,
    /// Open the key bindings file in the desktop's editor.
    OpenKeysFile,
    /// Reload the key bindings file.
    ReloadKeys,
    /// Show or hide the command palette.
    TogglePalette,
    /// Begin the text of the palette or of the path line that was opened in this frame.
    TypeAhead(String),
    /// Set the palette's text.
    TypePalette(String),
    /// Select a line of the palette.
    MarkPalette(usize),
    /// Close the topmost of help, question, path line and error.
    Dismiss,
    /// Dismiss one error, by its index.
    DismissError(usize),
}

impl Command {
    /// Whether it only moves the camera.
    pub fn moves_camera(&self) -> bool {
        matches!(
            self,
            Self::Orbit { .. }
                | Self::Grab { .. }
                | Self::Pan { .. }
                | Self::Zoom { .. }
                | Self::Push { .. }
                | Self::Roll(_)
                | Self::Walk { .. }
                | Self::LookAround { .. }
        )
    }

    /// The name of its undo step if it changes the document, and whether repetitions, as during a drag, join one step.
    pub(super) fn edit(&self) -> Option<(&'static str, bool)> {
        let (name, goes_on) = match self {
            Self::SetStep(_) | Self::ScaleStep(_) => ("Change of step", true),
            Self::SetSize(..) => ("Change of size", true),
            Self::FitWindow => ("Fit to window", false),
            Self::SetSamples(_) => ("Change of samples", true),
            Self::SetPixelFilter(_) => ("Change of pixel filter", false),
            Self::SetShift(_) => ("Change of shift", true),
            Self::SetMode(_) => ("Change of mode", false),
            Self::SetWireframe(_) => ("Wireframe", false),
            Self::SetWireframeWidth(_) => ("Change of lines", true),
            Self::SetWireframeColor(_) => ("Color of lines", true),
            Self::SetWireframeEdges(_) => ("Choice of edges", false),
            Self::SetWireframeHidden(_) => ("Hidden lines", true),
            Self::SetBlend(_) => ("Change of blend", true),
            Self::SetFilter(_) => ("Change of filter", false),
            Self::SetTextureProjection(_) | Self::SetObjectProjection(..) => {
                ("Change of mapping", false)
            }
            Self::TakePhotographs => ("Change of photograph", false),
            Self::SetCull(_) => ("Change of faces", false),
            Self::SetXRayOpacity(_) => ("Opacity of x-ray", true),
            Self::SetBackFaces(_) => ("Color of back faces", true),
            Self::SetGround(_) => ("Ground grid", false),
            Self::SetBackground(_) => ("Change of background", true),
            Self::SetCrease(_) => ("Change of crease angle", true),
            Self::SetLights(_) => ("Change of lights", false),
            Self::SetPlainColor(_) => ("Change of plain color", true),
            Self::SetColorScale(_) => ("Change of color scale", true),
            Self::SetColorRule(..) => ("Change of color", true),
            Self::RemoveTexture(None) => ("Remove textures", false),
            Self::RemoveTexture(Some(_)) => ("Remove texture", false),
            Self::SetVisible(_, true) | Self::ShowAll => ("Show", false),
            Self::SetVisible(_, false) => ("Hide", false),
            Self::Isolate(_) => ("Isolate", false),
            Self::SetGroupVisible { visible: true, .. } => ("Show group", false),
            Self::SetGroupVisible { visible: false, .. } => ("Hide group", false),
            Self::IsolateGroup { .. } => ("Isolate group", false),
            Self::Rename(..) => ("Rename", false),
            Self::AddShape(_) => ("Add", false),
            Self::SetShape(..) => ("Change of shape", true),
            Self::Duplicate(_) => ("Duplicate", false),
            Self::Delete(_) => ("Delete", false),
            Self::SetLocked(_, true) => ("Lock", false),
            Self::SetLocked(_, false) => ("Unlock", false),
            Self::SetTransform(..) => ("Move", true),
            Self::SetParent(..) => ("Change of parent", false),
            Self::Reorder(..) => ("Change of order", false),
            Self::Turn(..) => ("Turn", false),
            Self::AddPlane(_) => ("Cut", false),
            Self::SetPlane(..) => ("Change of clipping plane", true),
            Self::RemovePlane(_) => ("Remove clipping plane", false),
            Self::EndPath => ("Measure", false),
            Self::RemoveMeasurement(_) => ("Remove measurement", false),
            Self::ClearMeasurements => ("Clear measurements", false),
            _ => return None,
        };
        Some((name, goes_on))
    }

    /// The index of the object or plane that it changes, if it is one: repetitions for another start a new step.
    pub(super) fn object(&self) -> Option<usize> {
        match self {
            Self::SetColorRule(object, _) => *object,
            Self::SetTransform(object, _) | Self::SetShape(object, _) => Some(*object),
            // Or the one plane.
            Self::SetPlane(plane, _) => Some(*plane),
            _ => None,
        }
    }
}
