//! Shows the picture by copying its pixels, where painting a textured rectangle would cost more than casting the rays.
//!
//! Without a GPU, Mesa's llvmpipe runs a small program for each pixel of a textured rectangle. Moving
//! the same pixels from a texture of the window's own format is a copy of memory.

#![allow(
    unsafe_code,
    reason = "OpenGL's functions ask for a current context and for pointers to as many bytes as they say"
)]

use eframe::glow::{self, HasContext};
use egui::{ColorImage, PaintCallbackInfo, Rect, Shape};
use raycast_core::camera;
use std::sync::{Arc, Mutex, PoisonError};

/// The part of the texture that is out of date.
#[derive(Debug, Default, PartialEq)]
pub enum Dirty {
    /// None.
    #[default]
    Nothing,
    /// Some rectangles.
    Tiles(Vec<camera::Rect>),
    /// Everything.
    All,
}

/// A picture on its way to the window.
pub struct Presenter {
    shared: Arc<Mutex<Shared>>,
}

#[derive(Default)]
struct Shared {
    image: Arc<ColorImage>,
    dirty: Dirty,
    texture: Option<(glow::Texture, glow::Framebuffer, [usize; 2])>,
}

impl Presenter {
    /// A presenter, if OpenGL runs on the CPU and has the required functions.
    pub fn new(gl: &glow::Context) -> Option<Self> {
        // SAFETY: eframe makes its context current before it makes the window's state.
        let (renderer, version) = unsafe {
            (
                gl.get_parameter_string(glow::RENDERER),
                gl.get_parameter_string(glow::VERSION),
            )
        };
        let emulated = renderer.contains("llvmpipe") && !version.contains("ES");
        emulated.then(|| Self {
            shared: Arc::default(),
        })
    }

    /// Sets the picture. Its pixels are blue, green, red, alpha; alpha is ignored. `dirty` is what has changed since
    /// the last call.
    pub fn hand_over(&self, image: Arc<ColorImage>, dirty: Dirty) {
        let mut shared = self.shared.lock().unwrap_or_else(PoisonError::into_inner);
        shared.image = image;
        // Earlier changes may not have been painted yet.
        shared.dirty = match (std::mem::take(&mut shared.dirty), dirty) {
            (Dirty::Nothing, new) => new,
            (old, Dirty::Nothing) => old,
            (Dirty::Tiles(mut old), Dirty::Tiles(new)) => {
                old.extend(new);
                Dirty::Tiles(old)
            }
            _ => Dirty::All,
        };
    }

    /// The paint callback that shows the picture unscaled. It shows the picture that was set last before painting.
    pub fn shape(&self, rect: Rect) -> Shape {
        let shared = Arc::clone(&self.shared);
        let paint = move |info: PaintCallbackInfo, painter: &eframe::egui_glow::Painter| {
            let mut shared = shared.lock().unwrap_or_else(PoisonError::into_inner);
            shared.paint(&info, painter.gl());
            // Releases the pixels, so that the next picture can be written without a copy.
            shared.image = Arc::default();
        };
        Shape::Callback(egui::PaintCallback {
            rect,
            callback: Arc::new(eframe::egui_glow::CallbackFn::new(paint)),
        })
    }
}

impl Shared {
    fn paint(&mut self, info: &PaintCallbackInfo, gl: &glow::Context) {
        let [width, height] = self.image.size;
        let Some((_, framebuffer)) = self.texture(gl) else {
            return;
        };
        self.upload(gl);
        let place = info.viewport_in_pixels();
        let (left, top) = (place.left_px, place.from_bottom_px + place.height_px);
        let (width, height) = (width as i32, height as i32);
        // SAFETY: egui calls this with its context current. The framebuffer is of that context and
        // has the picture's texture in it.
        unsafe {
            gl.bind_framebuffer(glow::READ_FRAMEBUFFER, Some(framebuffer));
            gl.disable(glow::SCISSOR_TEST);
            // The first row of memory is the picture's top.
            gl.blit_framebuffer(
                0,
                height,
                width,
                0,
                left,
                top - height,
                left + width,
                top,
                glow::COLOR_BUFFER_BIT,
                glow::NEAREST,
            );
            gl.enable(glow::SCISSOR_TEST);
            gl.bind_framebuffer(glow::READ_FRAMEBUFFER, None);
        }
    }

    /// The texture of the picture's size, and the framebuffer that it is read through.
    fn texture(&mut self, gl: &glow::Context) -> Option<(glow::Texture, glow::Framebuffer)> {
        let size = self.image.size;
        if let Some((texture, framebuffer, of)) = self.texture
            && of == size
        {
            return Some((texture, framebuffer));
        }
        self.dirty = Dirty::All;
        // SAFETY: egui's context is current; no pixels are handed over.
        unsafe {
            if let Some((texture, framebuffer, _)) = self.texture.take() {
                gl.delete_framebuffer(framebuffer);
                gl.delete_texture(texture);
            }
            let texture = gl.create_texture().ok()?;
            gl.bind_texture(glow::TEXTURE_2D, Some(texture));
            // Blue first, as in the window's pixels: otherwise each pixel would be converted.
            gl.tex_image_2d(
                glow::TEXTURE_2D,
                0,
                glow::RGBA as i32,
                size[0] as i32,
                size[1] as i32,
                0,
                glow::BGRA,
                glow::UNSIGNED_INT_8_8_8_8_REV,
                glow::PixelUnpackData::Slice(None),
            );
            for filter in [glow::TEXTURE_MIN_FILTER, glow::TEXTURE_MAG_FILTER] {
                gl.tex_parameter_i32(glow::TEXTURE_2D, filter, glow::NEAREST as i32);
            }
            let framebuffer = gl.create_framebuffer().ok()?;
            gl.bind_framebuffer(glow::READ_FRAMEBUFFER, Some(framebuffer));
            gl.framebuffer_texture_2d(
                glow::READ_FRAMEBUFFER,
                glow::COLOR_ATTACHMENT0,
                glow::TEXTURE_2D,
                Some(texture),
                0,
            );
            gl.bind_framebuffer(glow::READ_FRAMEBUFFER, None);
            self.texture = Some((texture, framebuffer, size));
            Some((texture, framebuffer))
        }
    }

    /// Updates the texture.
    fn upload(&mut self, gl: &glow::Context) {
        let Some((texture, ..)) = self.texture else {
            return;
        };
        let [width, height] = self.image.size;
        let whole = camera::Rect {
            x: 0,
            y: 0,
            width: width as u32,
            height: height as u32,
        };
        let rects = match std::mem::take(&mut self.dirty) {
            Dirty::Nothing => return,
            Dirty::Tiles(rects) => rects,
            Dirty::All => vec![whole],
        };
        // SAFETY: egui's context is current. Of each rectangle's rows, `width` pixels apart, the last
        // one's end is within the picture, so that what is read is within the slice.
        unsafe {
            gl.bind_texture(glow::TEXTURE_2D, Some(texture));
            gl.pixel_store_i32(glow::UNPACK_ROW_LENGTH, width as i32);
            for rect in rects {
                if rect.right() > whole.width || rect.bottom() > whole.height {
                    continue;
                }
                let first = rect.y as usize * width + rect.x as usize;
                let pixels: &[u8] = bytemuck::cast_slice(&self.image.pixels[first..]);
                gl.tex_sub_image_2d(
                    glow::TEXTURE_2D,
                    0,
                    rect.x as i32,
                    rect.y as i32,
                    rect.width as i32,
                    rect.height as i32,
                    glow::BGRA,
                    glow::UNSIGNED_INT_8_8_8_8_REV,
                    glow::PixelUnpackData::Slice(Some(pixels)),
                );
            }
            gl.pixel_store_i32(glow::UNPACK_ROW_LENGTH, 0);
        }
    }
}
