//! Adding shapes.

use super::action::{Action, Menu};
use super::when::has_scene;
use crate::state::command::Command;
use raycast_core::scene::Shape;

macro_rules! shape {
    ($index:literal, $id:literal, $name:literal, $does:literal) => {
        Action::of(Menu::Add, $id, $name, $does, &[], |_| {
            Command::AddShape(Shape::ALL[$index])
        })
        .when(has_scene)
    };
}

/// In the order of their menu, which is that of [`Shape::ALL`].
pub(super) static ACTIONS: &[Action] = &[
    shape!(0, "add.cube", "Cube", "Put a cube where one orbits about"),
    shape!(
        1,
        "add.plane",
        "Plane",
        "Put a square where one orbits about"
    ),
    shape!(
        2,
        "add.sphere",
        "Sphere",
        "Put a ball where one orbits about"
    ),
    shape!(3, "add.cone", "Cone", "Put a cone where one orbits about"),
    shape!(
        4,
        "add.cylinder",
        "Cylinder",
        "Put a cylinder where one orbits about"
    ),
    shape!(5, "add.torus", "Torus", "Put a ring where one orbits about"),
    shape!(6, "add.disc", "Disc", "Put a disc where one orbits about"),
    shape!(
        7,
        "add.monkey",
        "Monkey",
        "Put a monkey's head where one orbits about"
    ),
    shape!(
        8,
        "add.dahlia",
        "Dahlia",
        "Put a dahlia where one orbits about"
    ),
];

#[cfg(test)]
mod tests {
    use super::*;
    use crate::state::State;

    #[test]
    fn each_puts_in_the_shape_that_it_is_called() {
        for action in ACTIONS {
            let Command::AddShape(shape) = (action.command)(&State::default()) else {
                panic!("{}", action.id);
            };
            assert_eq!(action.id, format!("add.{}", shape.name()));
            assert_eq!(action.name.to_lowercase(), shape.name());
        }
    }
}
