//! Tests of the objects' textures.

use super::*;
use crate::state::thumbnail::{TexturePart, Thumbnail};
use raycast_core::scene::{Crop, Wrap};
use std::path::Path;

const SKIN: &str = "/tmp/skin.png";

fn image(columns: u32) -> Texture {
    let texels = vec![[9, 8, 7, 255]; columns as usize];
    Texture::new(columns, 1, texels).expect("texels")
}

fn column(x: u32) -> Crop {
    Crop {
        x,
        y: 0,
        width: 1,
        height: 1,
    }
}

/// Asks for a texture: the request's number, and the part that is to be read.
fn ask(state: &mut State, command: Command) -> Option<(u64, TexturePart)> {
    match update(state, command)? {
        Effect::LoadTexture { number, part, .. } => Some((number, part)),
        effect => panic!("{effect:?}"),
    }
}

/// The part of an image of four texels arrives.
fn arrive(state: &mut State, (number, part): (u64, TexturePart)) -> Option<Effect> {
    let whole = image(4);
    let shown = match part.crop {
        Some(crop) => whole.cropped(crop).expect("a part"),
        None => whole,
    };
    let news = News::Texture {
        number: Some(number),
        path: PathBuf::from(SKIN),
        found: Ok(Arc::new(shown.wrapped(part.wrap))),
    };
    receive(state, news, Duration::ZERO)
}

fn parts(state: &State) -> Vec<Option<TexturePart>> {
    let objects = document(state).scene.objects.iter();
    let part = |object: &Object| object.texture.as_deref().map(TexturePart::of);
    objects.map(part).collect()
}

#[test]
fn a_texture_lies_on_the_object_that_it_was_loaded_for() {
    let mut state = opened(2);
    let kind = PromptKind::TextureOf(1);
    assert_eq!(
        update(&mut state, Command::Ask(kind)),
        Some(Effect::Dialog(kind))
    );
    update(&mut state, Command::TypePath(SKIN.to_owned()));
    let load = Effect::LoadTexture {
        number: 1,
        path: PathBuf::from(SKIN),
        part: TexturePart::default(),
    };
    assert_eq!(update(&mut state, Command::ConfirmPath), Some(load));
    let whole = Some(TexturePart::default());
    arrive(&mut state, (1, TexturePart::default()));
    assert_eq!(parts(&state), [None, whole]);
    update(&mut state, Command::RemoveTexture(Some(1)));
    assert_eq!(parts(&state), [None, None]);
    update(&mut state, Command::Undo);
    assert_eq!(parts(&state), [None, whole]);
}

#[test]
fn a_thumbnail_is_shown_for_its_own_image() {
    let mut state = opened(2);
    let path = PathBuf::from(SKIN);
    let show = update(&mut state, Command::ShowImage(path.clone()));
    assert_eq!(show, Some(Effect::ReadThumbnail(path.clone())));
    let found = |state: &State| state.image.as_ref().map(|shown| shown.found.clone());
    assert_eq!(found(&state), Some(Ok(None)));
    let small = Arc::new(Thumbnail {
        of: (8, 4),
        size: [1, 1],
        texels: vec![[1, 2, 3, 255]],
    });
    let other = News::Thumbnail(PathBuf::from("/tmp/b.png"), Err("no file".to_owned()));
    receive(&mut state, other, Duration::ZERO);
    assert_eq!(found(&state), Some(Ok(None)), "another image's");
    let news = News::Thumbnail(path, Ok(Arc::clone(&small)));
    receive(&mut state, news, Duration::ZERO);
    assert_eq!(found(&state), Some(Ok(Some(small))));
}

#[test]
fn a_part_of_an_image_is_read_from_its_file() {
    let mut state = opened(2);
    let part = TexturePart {
        crop: Some(column(1)),
        wrap: [Wrap::Mirror, Wrap::Clamp],
    };
    let choose = Command::SetTexturePart(1, part);
    assert_eq!(ask(&mut state, choose.clone()), None, "it has no image");
    let load = Command::LoadTexture(PathBuf::from(SKIN), Some(1));
    let whole = ask(&mut state, load).expect("a request");
    arrive(&mut state, whole);
    let asked = ask(&mut state, choose.clone()).expect("a request");
    assert_eq!(asked.1, part);
    arrive(&mut state, asked);
    assert_eq!(parts(&state), [None, Some(part)]);
    update(&mut state, Command::Undo);
    assert_eq!(parts(&state), [None, Some(TexturePart::default())]);
    update(&mut state, Command::SetLocked(1, true));
    assert_eq!(ask(&mut state, choose), None, "locked");
}

#[test]
fn of_two_choices_the_last_one_holds_whichever_is_read_first() {
    let path = Path::new(SKIN);
    let wanted = |state: &State| state.textures.part(&document(state).scene, 1, path);
    for last_is_first in [false, true] {
        let mut state = opened(2);
        let load = Command::LoadTexture(path.to_owned(), None);
        let whole = ask(&mut state, load).expect("a request");
        arrive(&mut state, whole);
        assert_eq!(wanted(&state), None);
        let first = TexturePart {
            crop: Some(column(2)),
            ..TexturePart::default()
        };
        let first = ask(&mut state, Command::SetTexturePart(1, first)).expect("a request");
        // The next choice starts from what was chosen, not from what is still shown.
        let mut second = wanted(&state).expect("a part that is being read");
        second.wrap[0] = Wrap::Clamp;
        let second = ask(&mut state, Command::SetTexturePart(1, second)).expect("a request");
        assert_eq!(second.1.crop, first.1.crop);
        let order = match last_is_first {
            true => [second, first],
            false => [first, second],
        };
        for asked in order {
            arrive(&mut state, asked);
        }
        assert_eq!(
            parts(&state),
            [Some(TexturePart::default()), Some(second.1)]
        );
        assert_eq!(wanted(&state), None);
    }
}

#[test]
fn a_texture_that_cannot_be_read_is_asked_for_no_longer() {
    let mut state = opened(1);
    let load = Command::LoadTexture(PathBuf::from(SKIN), Some(0));
    let (number, _) = ask(&mut state, load).expect("a request");
    let news = News::Texture {
        number: Some(number),
        path: PathBuf::from(SKIN),
        found: Err("skin.png: no image".to_owned()),
    };
    receive(&mut state, news, Duration::ZERO);
    assert_eq!(state.errors, ["skin.png: no image"]);
    let scene = &document(&state).scene;
    assert_eq!(state.textures.part(scene, 0, Path::new(SKIN)), None);
}

#[test]
fn a_texture_that_is_read_late_finds_its_object_or_none() {
    let load = || Command::LoadTexture(PathBuf::from(SKIN), Some(1));
    // Its number is another now.
    let mut state = opened(3);
    let asked = ask(&mut state, load()).expect("a request");
    update(&mut state, Command::Delete(0));
    build(&mut state);
    arrive(&mut state, asked);
    assert_eq!(parts(&state), [Some(TexturePart::default()), None]);
    // It is gone.
    let mut state = opened(3);
    let asked = ask(&mut state, load()).expect("a request");
    update(&mut state, Command::Delete(1));
    build(&mut state);
    arrive(&mut state, asked);
    assert_eq!(parts(&state), [None, None]);
    // Another scene was opened.
    let mut state = opened(2);
    let asked = ask(&mut state, load()).expect("a request");
    let other = document(&opened(2)).clone();
    arrival::show(&mut state, Loaded::new(other));
    arrive(&mut state, asked);
    assert_eq!(parts(&state), [None, None]);
}

#[test]
fn an_object_has_a_mapping_of_its_own() {
    let mut state = opened(3);
    for number in [0, 1] {
        let load = Command::LoadTexture(PathBuf::from(SKIN), Some(number));
        let asked = ask(&mut state, load).expect("a request");
        arrive(&mut state, asked);
    }
    let mappings = |state: &State| {
        let objects = document(state).scene.objects.iter();
        let mapping = |object: &Object| {
            let mapping = &object.mapping;
            (mapping.projection, mapping.photograph.is_some())
        };
        objects.map(mapping).collect::<Vec<_>>()
    };
    let set = |state: &mut State, projection| {
        update(state, Command::SetObjectProjection(1, projection));
    };
    set(&mut state, Some(TextureProjection::Sphere));
    let sphere = (Some(TextureProjection::Sphere), false);
    assert_eq!(mappings(&state), [(None, false), sphere, (None, false)]);
    // A photograph is one from here.
    set(&mut state, Some(TextureProjection::Camera));
    let camera = (Some(TextureProjection::Camera), true);
    assert_eq!(mappings(&state), [(None, false), camera, (None, false)]);
    update(&mut state, Command::Undo);
    assert_eq!(mappings(&state)[1], sphere);
    set(&mut state, None);
    assert_eq!(mappings(&state), [(None, false); 3]);
    update(&mut state, Command::SetLocked(1, true));
    set(&mut state, Some(TextureProjection::Plane));
    assert_eq!(mappings(&state)[1], (None, false), "locked");
}
