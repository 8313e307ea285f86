//! The demo scene: the monkey on a pedestal, a dahlia, a ring in leopard skin and the cube.

/// The scene file's text.
pub(crate) fn demo() -> String {
    format!("# RayCast's demo scene. {}\n{SCENE}", crate::MADE_BY)
}

/// The scene file's text after its first line.
const SCENE: &str = r##"
[camera]
projection = "perspective"
eye = [1.2, 3.3, 12.0]
target = [0.0, 0.98, 0.0]
up = [0.0, 1.0, 0.0]
fov = 25.0

[image]
size = [1280, 720]
background = ["#20242c", "#3a4454"]

[shading]
mode = "smooth"
wireframe = false

[[object]]
name = "plinth"
mesh = "plinth.obj"
color = "file"
scale = [3.3, 3.3, 3.3]

[[object]]
name = "pedestal"
mesh = "plinth.obj"
color = "file"
translate = [0.0, 0.3, 0.0]
scale = [0.95, 3.0, 0.95]

[[object]]
name = "monkey"
mesh = "monkey.obj"
color = "file"
translate = [0.0, 1.3, 0.0]
rotate = [-3.0, 5.0, 0.0]
scale = [1.15, 1.15, 1.15]

[[object]]
name = "dahlia"
mesh = "dahlia.obj"
color = "file"
translate = [-2.15, 1.02, 0.6]
rotate = [48.0, -12.0, 6.0]
scale = [0.95, 0.95, 0.95]

[[object]]
name = "leopard ring"
mesh = "torus.obj"
color = "file"
texture = "leopard.png"
translate = [2.1, 1.09, -0.4]
rotate = [90.0, -20.0, 0.0]
scale = [0.78, 0.78, 0.78]

[[object]]
name = "cube"
mesh = "cube.obj"
color = "file"
translate = [1.75, 0.38, 1.5]
rotate = [0.0, 40.0, 0.0]
scale = [0.38, 0.38, 0.38]
"##;
