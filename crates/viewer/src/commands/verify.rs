use super::{Failure, warn_of_reading, workers};
use crate::cli::VerifyArgs;
use crate::progress::Progress;
use crate::{output, setup};
use raycast_core::camera::{Camera, Grid, Rect};
use raycast_core::formats::SceneFile;
use raycast_core::image::{Fragment, Layers, Picture};
use raycast_core::render::Cancel;
use raycast_core::scene::Scene;
use raycast_report::Stage;
use raycast_report::verify::{Claim, Verification, WrongPixel, verify};
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Duration;

/// A picture to verify: the whole, or a rectangle of it.
struct Image {
    full_size: (u32, u32),
    rect: Rect,
    layers: Layers,
}

/// Holds a picture's pixels against the truth.
pub(super) fn run(args: &VerifyArgs) -> Result<(), Failure> {
    let (path, files) = split(&args.files)?;
    let pool = workers(args.casting.threads)?;
    let image = path.map(read).transpose()?;

    let progress = Progress::new();
    progress.loading();
    let file = setup::load(files, &args.reading, &|share| progress.loaded(share))?;
    progress.building();
    let SceneFile {
        scene,
        warnings,
        camera,
        image: file_image,
        ..
    } = file;
    let name = setup::name_of(files);
    let stage = pool.install(|| stage(&name, scene))?;
    let bounds = setup::bounds(&stage.scene, &stage.accel);
    let size = image.as_ref().map(|image| image.full_size);
    let camera = setup::camera(
        &args.camera,
        camera.as_ref(),
        size.or(file_image.size),
        &bounds,
    )
    .map_err(|error| setup::no_camera(&args.camera, &name, error))?;
    let plane = camera.plane();
    if let (Some(path), Some((columns, rows))) = (path, size)
        && (plane.columns, plane.rows) != (columns, rows)
    {
        return Err(Failure::usage(format!(
            "{} is of {columns}x{rows} pixels, the camera that was asked for makes {}x{}",
            path.display(),
            plane.columns,
            plane.rows
        )));
    }
    let image = match image {
        Some(image) => image,
        None => pool.install(|| render(args, &stage, camera, &progress))?,
    };

    let claim = Claim {
        camera,
        rect: image.rect,
        layers: &image.layers,
        cull: args.casting.cull,
    };
    let most = args.checks as usize;
    progress.counting("verifying", most.min(image.rect.area()) as u64);
    let done = |more| progress.done(more);
    let found = pool.install(|| verify(&stage, &claim, most, args.seed, &done));
    progress.clear();

    warn_of_reading(&warnings, &stage.scene, &stage.accel);
    output::print(&told(&found))?;
    if found.wrong > 0 {
        return Err(Failure::could_not(format!(
            "the picture is not what its rays meet: {} of {} pixels checked are wrong",
            found.wrong, found.checked
        )));
    }
    Ok(())
}

/// The image, if the first file is one, and the scene's files.
fn split(files: &[PathBuf]) -> Result<(Option<&Path>, &[PathBuf]), Failure> {
    let is_image = |path: &&PathBuf| {
        let extension = path.extension();
        extension.is_some_and(|extension| extension.eq_ignore_ascii_case("exr"))
    };
    let (image, scene) = match files.split_first() {
        Some((first, rest)) if is_image(&first) => (Some(first.as_path()), rest),
        _ => (None, files),
    };
    if let Some(second) = scene.iter().find(is_image) {
        return Err(Failure::usage(format!(
            "{}: one image can be verified at a time, and it comes first",
            second.display()
        )));
    }
    match image {
        Some(image) if scene.is_empty() => Err(Failure::usage(format!(
            "{}: name the meshes or the scene that it shows, too",
            image.display()
        ))),
        _ => Ok((image, scene)),
    }
}

/// Reads an EXR that RayCast wrote, whole or a fragment.
fn read(path: &Path) -> Result<Image, Failure> {
    let name = path.display().to_string();
    let cannot = |error: &dyn std::fmt::Display| Failure::could_not(format!("{name}: {error}"));
    let bytes = std::fs::read(path).map_err(|error| cannot(&error))?;
    let (picture, place) = match Fragment::decode(&name, &bytes) {
        Ok(fragment) => {
            let place = (fragment.full_size(), fragment.rect);
            (fragment.picture, Some(place))
        }
        Err(_) => (
            Picture::decode_exr(&bytes).map_err(|error| cannot(&error))?,
            None,
        ),
    };
    let (width, height) = (picture.width, picture.height);
    let whole = Rect {
        x: 0,
        y: 0,
        width,
        height,
    };
    let (full_size, rect) = place.unwrap_or(((width, height), whole));
    let layers = picture
        .layers
        .ok_or_else(|| cannot(&"it does not tell what each pixel shows"))?;
    Ok(Image {
        full_size,
        rect,
        layers,
    })
}

fn stage(name: &str, scene: Scene) -> Result<Stage, Failure> {
    let accel = setup::visible_tree(name, &scene)?;
    Ok(Stage::of_parts(Arc::new(scene), Arc::new(accel))?)
}

/// The whole picture, to be verified at once.
fn render(
    args: &VerifyArgs,
    stage: &Stage,
    camera: Camera,
    progress: &Progress,
) -> Result<Image, Failure> {
    let (columns, rows) = (camera.plane().columns, camera.plane().rows);
    let grid = Grid::default();
    let (across, down) = grid.counts(columns, rows);
    progress.counting("rendering", u64::from(across) * u64::from(down));
    let mut view = stage.view(camera, args.casting.cull);
    view.settings.precision = args.casting.precision;
    let no_clock = || Duration::ZERO;
    let picture = view.render(grid, &no_clock, &Cancel::default(), &|_| progress.done(1));
    let layers = picture.and_then(|picture| picture.layers);
    Ok(Image {
        full_size: (columns, rows),
        rect: Rect {
            x: 0,
            y: 0,
            width: columns,
            height: rows,
        },
        layers: layers.ok_or_else(|| Failure::could_not("the render was stopped"))?,
    })
}

/// What was found, in words.
fn told(found: &Verification) -> String {
    let Verification {
        pixels,
        checked,
        silhouettes,
        edges,
        wrong,
        first_wrong,
    } = found;
    let mut text = String::new();
    // Writing to a string does not fail.
    let _ = writeln!(
        text,
        "{checked} of {pixels} pixels checked: {silhouettes} where an object ends, {edges} where triangles meet, {} inside of one",
        checked - silhouettes - edges
    );
    let _ = match (wrong, checked == pixels) {
        (0, true) => writeln!(text, "0 wrong: every pixel shows what its ray meets first"),
        (0, false) => writeln!(
            text,
            "0 wrong of {checked}: with 95 % certainty, fewer than 3 in {checked} such pixels are"
        ),
        (wrong, _) => writeln!(text, "{wrong} wrong, of which the first are"),
    };
    for pixel in first_wrong {
        let WrongPixel {
            x,
            y,
            fault,
            object,
            triangle,
            depth,
            truth,
        } = pixel;
        let shown = meeting(*object, *triangle, f64::from(*depth));
        let expected = truth.map_or_else(
            || "nothing".to_owned(),
            |truth| meeting(truth.object, truth.triangle, truth.t),
        );
        let _ = writeln!(
            text,
            "  column {x}, row {y}: {fault}: expected {expected}, found {shown}"
        );
    }
    text
}

fn meeting(object: u32, triangle: u32, depth: f64) -> String {
    if (object, triangle) == (u32::MAX, u32::MAX) {
        "nothing".to_owned()
    } else {
        format!("object {object}, triangle {triangle} at {depth}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use raycast_report::Fault;

    #[test]
    fn the_image_comes_first_and_alone() {
        let paths = |names: &[&str]| names.iter().map(PathBuf::from).collect::<Vec<_>>();
        let both = paths(&["a.EXR", "b.obj"]);
        let (image, scene) = split(&both).expect("good usage");
        assert_eq!((image, scene), (Some(Path::new("a.EXR")), &both[1..]));
        let scene = paths(&["b.obj", "c.obj"]);
        assert_eq!(split(&scene), Ok((None, &scene[..])));
        for bad in [&["a.exr"][..], &["a.exr", "b.exr"], &["b.obj", "a.exr"]] {
            assert!(matches!(split(&paths(bad)), Err(Failure::Usage(_))));
        }
    }

    #[test]
    fn what_was_found_is_told_in_words() {
        let good = Verification {
            pixels: 100,
            checked: 20,
            silhouettes: 5,
            edges: 6,
            ..Verification::default()
        };
        assert!(told(&good).contains("fewer than 3 in 20"));
        let all = Verification {
            checked: 100,
            ..good.clone()
        };
        assert!(told(&all).contains("every pixel"));
        let bad = Verification {
            wrong: 1,
            first_wrong: vec![WrongPixel {
                x: 3,
                y: 4,
                fault: Fault::Hit,
                object: 1,
                triangle: 7,
                depth: 2.5,
                truth: None,
            }],
            ..good
        };
        let line = "  column 3, row 4: a hit where there is a miss: expected nothing, found object 1, triangle 7 at 2.5\n";
        assert!(told(&bad).ends_with(line), "{}", told(&bad));
    }
}
