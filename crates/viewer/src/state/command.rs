//! What a person can ask for. Panels and keys make commands; `update` carries them out.

use super::cut::PlaneBy;
use super::handle::{Handle, Tool};
use super::insertion::Insertion;
use super::inspection::Shown;
use super::measure::Kind;
use super::preferences::{Mouse, Theme};
use super::turn::Turning;
use super::viewpoint::StandardView;
use super::{Answer, PromptKind, Tint};
use raycast_core::Cull;
use raycast_core::camera::{FrameLock, Grid, PixelFilter, Projection};
use raycast_core::formats::LengthUnit;
use raycast_core::glam::DVec3;
use raycast_core::scene::{ClippingPlane, Color, ColorRule, ColorScale, Shape, Transform};
use raycast_core::shade::{
    Background, EdgeKinds, Filter, Ground, LightSet, Mode, TextureProjection,
};
use std::path::PathBuf;

/// One wish. Places are in the picture's pixels, from its top left corner.
#[derive(Clone, Debug, PartialEq)]
pub enum Command {
    /// Turn about the pivot, in degrees.
    Orbit {
        /// About the vertical axis.
        yaw: f64,
        /// Up from the horizon.
        pitch: f64,
    },
    /// Take hold of the point seen at a place, to pan.
    Grab {
        /// The place.
        at: (f64, f64),
    },
    /// Move what was grabbed, in pixels of the picture.
    Pan {
        /// To the right.
        dx: f64,
        /// Downwards.
        dy: f64,
    },
    /// Come nearer (a factor below one) or go away, keeping what is seen at a place.
    Zoom {
        /// The place.
        at: (f64, f64),
        /// The new distance over the old.
        factor: f64,
    },
    /// Roll the camera to the right about its view axis, in degrees.
    Roll(f64),
    /// Turn about the point seen at a place from now on, and bring it to the middle.
    SetPivot {
        /// The place.
        at: (f64, f64),
    },
    /// Bring everything into view.
    Fit,
    /// The scene's own view, or the one that it was first shown from.
    ResetView,
    /// Look from a standard direction.
    Look(StandardView),
    /// Look from the other side.
    LookBack,
    /// The view before.
    ViewBack,
    /// The view that was come back from.
    ViewForward,

    /// Begin to walk, or stop.
    SetWalk(bool),
    /// Walk for a while.
    Walk {
        /// To the right, up and forwards, each from −1 to 1.
        way: DVec3,
        /// For so long.
        seconds: f64,
    },
    /// Walk so many times as fast.
    ScaleWalk(f64),
    /// Turn where one stands, in degrees.
    LookAround {
        /// About the vertical axis.
        yaw: f64,
        /// Up from the horizon.
        pitch: f64,
    },
    /// Keep the view.
    AddBookmark,
    /// Go to a view that was kept, by its place in the list.
    GoToBookmark(usize),
    /// Forget a view.
    RemoveBookmark(usize),
    /// Copy the camera as text.
    CopyCamera,
    /// Go where a text says.
    PasteCamera(String),
    /// Look from a place at another, upright.
    SetPlacement {
        /// From.
        eye: DVec3,
        /// At.
        target: DVec3,
    },

    /// Another ray spacing, in scene units.
    SetStep(f64),
    /// The ray spacing, times a factor.
    ScaleStep(f64),
    /// Columns and rows.
    SetSize(u32, u32),
    /// A ray for each pixel of the window.
    FitWindow,
    /// The vertical field of view in degrees.
    SetFov(f64),
    /// The frame's height in scene units.
    SetFrame(f64),
    /// What stays when the step changes.
    SetLock(FrameLock),
    /// How rays leave the camera.
    SetProjection(Projection),
    /// Rays a pixel; as many as there is time for, for `None`.
    SetSamples(Option<u32>),
    /// How samples are weighed by their place.
    SetPixelFilter(PixelFilter),
    /// How far the frame is off the view axis, to the right and up, in its heights.
    SetShift([f64; 2]),

    /// How the picture is split.
    SetGrid(Grid),
    /// Lines between tiles.
    SetBorders(bool),
    /// Numbers on tiles.
    SetOrder(bool),
    /// Colours on tiles.
    SetTint(Tint),

    /// What the picture shows.
    SetMode(Mode),
    /// Lines along edges, over any mode.
    SetWireframe(bool),
    /// Their width in pixels.
    SetWireframeWidth(f32),
    /// Their colour.
    SetWireframeColor(Color),
    /// Which edges have them.
    SetWireframeEdges(EdgeKinds),
    /// How strongly hidden ones show.
    SetWireframeHidden(f32),
    /// From the object's colours (0) to its texture (1).
    SetBlend(f32),
    /// Between texels.
    SetFilter(Filter),
    /// How surfaces find their place in textures.
    SetTextureProjection(TextureProjection),
    /// Take textures for photographs from where the camera stands.
    TakePhotographs,
    /// Which faces rays meet.
    SetCull(Cull),
    /// In x-ray, how much of what lies behind it a surface covers.
    SetXRayOpacity(f32),
    /// The colour of triangles seen from behind; `None` for the same as in front.
    SetBackFaces(Option<Color>),
    /// Lines on a level plane.
    SetGround(Option<Ground>),
    /// What lies behind everything.
    SetBackground(Background),
    /// Below which angle between triangles edges are smooth, in degrees.
    SetCrease(f32),
    /// Where light comes from.
    SetLights(LightSet),
    /// The colour of what has none.
    SetPlainColor(Color),
    /// How numbers become colours; `None` for the usual way, and depth in greys.
    SetColorScale(Option<ColorScale>),
    /// How an object's triangles get their colours; all objects' for `None`.
    SetColorRule(Option<usize>, ColorRule),
    /// Take the texture off an object; off all, for `None`.
    RemoveTexture(Option<usize>),

    /// Mark an object, or none.
    Select(Option<usize>),
    /// Show an object, or hide it.
    SetVisible(usize, bool),
    /// Show this object alone; all, if it is alone already.
    Isolate(usize),
    /// Show all objects.
    ShowAll,
    /// Begin to give an object another name, or stop.
    EditName(Option<usize>),
    /// Give an object another name.
    Rename(usize, String),
    /// Put a cube, a ball or their kind into the scene.
    AddShape(Shape),
    /// Give an object that is one other numbers.
    SetShape(usize, Shape),
    /// Put a copy of an object beside it.
    Duplicate(usize),
    /// Take an object away, and those that move with it.
    Delete(usize),
    /// Keep an object as it is until it is unlocked.
    SetLocked(usize, bool),
    /// Put an object elsewhere.
    SetTransform(usize, Transform),
    /// Let an object move with another, or with none; it stays where it is.
    SetParent(usize, Option<usize>),
    /// Put an object elsewhere in the list; it stays where it is in the scene.
    Reorder(usize, Insertion),
    /// Turn an object, as [`SetTurning`](Self::SetTurning) says, about this axis (0 to 2).
    Turn(usize, usize),
    /// How objects are turned and scaled.
    SetTurning(Turning),

    /// What the handles in the picture do to the marked object; there are none, for `None`.
    SetManipulator(Option<Tool>),
    /// Take hold of a handle.
    GrabHandle {
        /// Which.
        handle: Handle,
        /// At this place.
        at: (f64, f64),
        /// How long the handles are, in pixels of the picture.
        length: f64,
    },
    /// Bring the handle that is held to a place.
    DragHandle {
        /// The place.
        to: (f64, f64),
        /// Whether it comes to round numbers alone.
        snaps: bool,
    },
    /// Let go of it.
    ReleaseHandle,

    /// Cut away what is before a new plane.
    AddPlane(PlaneBy),
    /// Put another clipping plane in the place of one, by its place in the list.
    SetPlane(usize, ClippingPlane),
    /// Take a clipping plane away.
    RemovePlane(usize),
    /// Take clicks as the points of a clipping plane, or stop.
    SetCutting(bool),

    /// What clicks on the picture measure; nothing, if they pick.
    SetTool(Option<Kind>),
    /// In which unit lengths are told; in that of the files, for `None`.
    SetUnit(Option<LengthUnit>),
    /// Whether measured points snap to vertices.
    SetSnaps(bool),
    /// Take back the last point of what is being measured.
    TakePointBack,
    /// End the path that is being measured.
    EndPath,
    /// Forget what was measured, by its place in the list.
    RemoveMeasurement(usize),
    /// Forget all that was measured.
    ClearMeasurements,
    /// Look the marked object over, or all if none is.
    Check {
        /// Also for triangles that pass through one another.
        deep: bool,
    },
    /// Look at one fault of a mesh, or at none.
    ShowFault(Option<Shown>),

    /// Keep what is seen at a place to be read; nothing, if nothing is there. While something is measured, take
    /// the place as its next point.
    Pin {
        /// The place.
        at: (f64, f64),
        /// Beside what is kept already, rather than in its place.
        beside: bool,
    },
    /// Look at one of the picks.
    ChoosePick(usize),
    /// Let go of one of the picks.
    RemovePick(usize),
    /// Let go of all of them.
    Unpin,
    /// Put text on the clipboard.
    Copy(String),
    /// Copy the command that makes this picture.
    CopyCommand,

    /// Take the last change back.
    Undo,
    /// Make it again.
    Redo,

    /// Render threads.
    SetThreads(usize),

    /// Ask for a path: by the desktop's dialog, and in the window.
    Ask(PromptKind),
    /// Whether the files that are asked for come beside what is open.
    SetAdding(bool),
    /// What was typed in the path line.
    TypePath(String),
    /// Take the path line's text.
    ConfirmPath,
    /// Open files as one scene.
    Open(Vec<PathBuf>),
    /// Put files beside what is open.
    Add(Vec<PathBuf>),
    /// Open the folder's next file (1) or the one before (−1).
    OpenNeighbor(i32),
    /// Read what is open once more.
    Reload,
    /// Put the hard case of this name on screen.
    OpenCase(&'static str),
    /// Stop loading.
    CancelLoad,
    /// Put an image on an object; on every one, for `None`.
    LoadTexture(PathBuf, Option<usize>),
    /// Show what a picture was made of, if it tells; else put it on every object.
    DropPicture(PathBuf),
    /// Write the picture to a file; its name says which kind. Where one is there already, ask first.
    SavePicture(PathBuf),
    /// Write the scene to its file; ask for one if it has none.
    SaveScene,
    /// Write the scene to a file. Where one is there already, ask first.
    SaveSceneAs(PathBuf),
    /// Write what was to be written in place of what is there.
    Replace,
    /// What to do with changes that no file has.
    Answer(Answer),
    /// Close the window.
    Close,

    /// Light or dark.
    SetTheme(Theme),
    /// How large the interface is.
    SetScale(f32),
    /// What drags of the mouse do.
    SetMouse(Mouse),
    /// Whether the camera takes its time from one view to another.
    SetSmooth(bool),
    /// Whether pictures get more samples while nothing moves.
    SetRefine(bool),
    /// Whether files that change are read again.
    SetWatch(bool),

    /// Show or hide the side panel.
    TogglePanel,
    /// Show or hide the keys.
    ToggleHelp,
    /// Open the file that changes keys, in the desktop's editor.
    OpenKeysFile,
    /// Read that file again.
    ReloadKeys,
    /// Show or hide the list of all commands.
    TogglePalette,
    /// What was typed there.
    TypePalette(String),
    /// Another line of it is marked.
    MarkPalette(usize),
    /// Close the topmost of: keys, question, path line, error.
    Dismiss,
    /// Close one error.
    DismissError(usize),
}

impl Command {
    /// Whether it moves the camera, and does nothing else.
    pub fn moves_camera(&self) -> bool {
        matches!(
            self,
            Self::Orbit { .. }
                | Self::Grab { .. }
                | Self::Pan { .. }
                | Self::Zoom { .. }
                | Self::Roll(_)
                | Self::Walk { .. }
                | Self::LookAround { .. }
        )
    }

    /// What undo calls it, if it changes the document; and whether it comes many times over while a hand moves.
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
            Self::SetTextureProjection(_) => ("Change of mapping", false),
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
            _ => return None,
        };
        Some((name, goes_on))
    }

    /// The one object that it changes.
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
