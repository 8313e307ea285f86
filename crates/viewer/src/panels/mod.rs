//! Parts of the window, one a file: each shows state and emits commands.
