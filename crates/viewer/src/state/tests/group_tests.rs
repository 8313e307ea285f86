//! Tests of hiding groups of an object's mesh.

use super::*;
use raycast_core::scene::Groups;

/// Four triangles, in the groups a, b, a and none.
fn grouped() -> Mesh {
    let corners = |x: f64| [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + DVec3::X * 2.0 * x);
    let names = ["a", "b"].map(str::to_owned).to_vec();
    let groups = [Some(0), Some(1), Some(0), None];
    Mesh::new(MeshData {
        positions: (0..4).flat_map(|x| corners(f64::from(x))).collect(),
        triangles: (0..4).map(|n| [3 * n, 3 * n + 1, 3 * n + 2]).collect(),
        groups: Groups::of_triangles(names, groups).expect("two names"),
        ..MeshData::default()
    })
}

fn open(keep: Keep) -> News {
    let mut object = Object::new("parts", Arc::new(grouped()));
    object.source = Some(std::env::temp_dir().join("mesh.obj"));
    let scene = Arc::new(Scene {
        objects: vec![object],
    });
    let document = Document {
        paths: vec!["mesh.obj".into()],
        ..Document::new(1, "mesh.obj", Arc::clone(&scene), tree(&scene))
    };
    News::Loaded(Box::new(Loaded {
        keep,
        ..Loaded::new(document)
    }))
}

fn opened_groups() -> State {
    let mut state = State::default();
    receive(&mut state, open(Keep::Nothing), Duration::ZERO);
    state
}

fn kept(state: &State) -> Vec<u32> {
    document(state).scene.objects[0].kept().to_vec()
}

fn set(group: &str, visible: bool) -> Command {
    Command::SetGroupVisible {
        object: 0,
        group: group.to_owned(),
        visible,
    }
}

fn isolate(group: &str) -> Command {
    Command::IsolateGroup {
        object: 0,
        group: group.to_owned(),
    }
}

#[test]
fn groups_are_hidden_shown_isolated_and_brought_back() {
    let mut state = opened_groups();
    assert_eq!(update(&mut state, set("a", false)), Some(Effect::Build));
    assert_eq!(kept(&state), [1, 3]);
    assert_eq!(state.history.undo_name(), Some("Hide group"));
    // What is hidden already is no step.
    update(&mut state, set("a", false));
    update(&mut state, set("", false));
    assert_eq!(kept(&state), [1]);
    build(&mut state);
    assert_eq!(document(&state).accel.len(), 1);
    assert_eq!(document(&state).bounds.min.x, 2.0);
    update(&mut state, Command::Undo);
    assert_eq!(kept(&state), [1, 3]);
    update(&mut state, Command::Undo);
    assert!(kept(&state).len() == 4 && !state.has_unsaved());
    update(&mut state, Command::Redo);
    update(&mut state, set("a", true));
    assert!(document(&state).scene.objects[0].hidden_groups.is_none());

    update(&mut state, isolate("b"));
    assert_eq!(kept(&state), [1]);
    update(&mut state, isolate("a"));
    assert_eq!(kept(&state), [0, 2]);
    update(&mut state, isolate("a"));
    assert_eq!(kept(&state).len(), 4, "alone already: all are shown");
    update(&mut state, isolate(""));
    assert_eq!(kept(&state), [3]);
    update(&mut state, Command::ShowAll);
    assert_eq!(kept(&state).len(), 4);
    assert_eq!(update(&mut state, Command::ShowAll), None);
    // An object that is not there.
    let nowhere = Command::SetGroupVisible {
        object: 7,
        group: "a".to_owned(),
        visible: false,
    };
    assert_eq!(update(&mut state, nowhere), None);
}

#[test]
fn a_file_read_again_hides_the_same_groups_also_in_steps_to_undo() {
    let mut state = opened_groups();
    update(&mut state, set("a", false));
    update(&mut state, set("b", false));
    receive(&mut state, open(Keep::All), Duration::ZERO);
    assert_eq!(kept(&state), [3]);
    update(&mut state, Command::Undo);
    assert_eq!(kept(&state), [1, 3]);
    update(&mut state, Command::Undo);
    assert_eq!(kept(&state).len(), 4);
}
