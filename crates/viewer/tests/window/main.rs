//! The window's parts through their accessibility tree: found by name, clicked, typed into. No GPU
//! and no display. What a click asks for goes through the one place that carries commands out.

mod bench;
mod camera;
mod files;
mod groups;
mod keys;
mod look;
mod objects;
mod tasks;
mod tools;
