//! The textures of a scene file's objects.

use super::error::FormatError;
use super::files::beside;
use super::scene_text::Reader;
use super::scene_toml::ObjectToml;
use super::texture;
use crate::scene::{Crop, Texture, Wrap};
use std::collections::{BTreeMap, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use toml::Spanned;

/// The textures that objects share: each image is read once, and each part of it made once.
#[derive(Default)]
pub(super) struct Textures {
    images: HashMap<PathBuf, Arc<Texture>>,
    parts: HashMap<Part, Arc<Texture>>,
    /// Images that were decoded before they were asked for; `None` until the first is.
    ahead: Option<HashMap<PathBuf, Result<Texture, FormatError>>>,
}

/// An image's file, its crop and its wrapping.
type Part = (PathBuf, Option<[u32; 4]>, [Wrap; 2]);

impl Reader<'_> {
    /// The texture that an object names, and its file. The first call decodes the images that the tables from its own on
    /// name all at once.
    pub(super) fn texture(
        &self,
        table: &ObjectToml,
        tables: &[Spanned<ObjectToml>],
        textures: &mut Textures,
        warnings: &mut Vec<String>,
    ) -> Result<Option<(Arc<Texture>, PathBuf)>, FormatError> {
        let Some(named) = &table.texture else {
            let expected = "a `texture` beside what says how it lies";
            return match &table.crop {
                Some(crop) => Err(self.fault(crop, expected, "none")),
                None => Ok(None),
            };
        };
        let path = beside(self.path, named.get_ref());
        let source = self.files.source(&path);
        let budget = self.files.budget();
        let image = match textures.images.get(&source) {
            Some(image) => Arc::clone(image),
            None => {
                let ahead = textures.ahead.get_or_insert_with(|| self.decoded(tables));
                let ahead = ahead.remove(&source);
                let image = Arc::new(self.image_or_stand_in(named, &path, ahead, warnings)?);
                textures.images.insert(source.clone(), Arc::clone(&image));
                image
            }
        };
        let crop = table.crop.as_ref().map(|crop| *crop.get_ref());
        let wrap = table
            .wrap
            .map_or(image.wrap(), |wrap| wrap.map(|wrap| wrap.0));
        if crop.is_none() && wrap == image.wrap() {
            return Ok(Some((image, source)));
        }
        let key = (source.clone(), crop, wrap);
        if let Some(part) = textures.parts.get(&key) {
            return Ok(Some((Arc::clone(part), source)));
        }
        if image.is_stand_in() {
            let [x, y, width, height] = crop.unwrap_or_default();
            let crop = crop.map(|_| Crop {
                x,
                y,
                width,
                height,
            });
            return Ok(Some((Arc::new(Texture::stand_in(crop, wrap)), source)));
        }
        let (width, height) = (image.width(), image.height());
        let [x, y, columns, rows] = crop.unwrap_or([0, 0, width, height]);
        let bytes = 4 * u64::from(columns.min(width)) * u64::from(rows.min(height));
        let share = budget.share(self.path, "a part of an image", bytes)?;
        let part = match &table.crop {
            None => Texture::clone(&image),
            Some(value) => {
                let crop = Crop {
                    x,
                    y,
                    width: columns,
                    height: rows,
                };
                image.cropped(crop).ok_or_else(|| {
                    let expected = format!("a part of an image of {width}x{height}");
                    self.fault(value, &expected, &format!("{:?}", value.get_ref()))
                })?
            }
        };
        share.keep(bytes);
        let part = Arc::new(part.wrapped(wrap));
        textures.parts.insert(key, Arc::clone(&part));
        Ok(Some((part, source)))
    }

    /// The images that tables name, decoded all at once, under their objects' [`Files::source`](super::files::Files::source).
    /// Those that cannot be read are left out, and all where memory does not suffice.
    fn decoded(
        &self,
        tables: &[Spanned<ObjectToml>],
    ) -> HashMap<PathBuf, Result<Texture, FormatError>> {
        let named = tables
            .iter()
            .filter_map(|table| table.get_ref().texture.as_ref());
        let mut files: BTreeMap<PathBuf, (PathBuf, &Spanned<String>)> = BTreeMap::new();
        for named in named {
            let path = beside(self.path, named.get_ref());
            files
                .entry(self.files.source(&path))
                .or_insert((path, named));
        }
        if files.len() < 2 {
            return HashMap::new();
        }
        let mut found = Vec::new();
        for (source, (path, named)) in &files {
            match self.bytes(named, path, &|_| ()) {
                Ok(bytes) => found.push((source, path, bytes)),
                Err(error) if error.is_of_budget() => return HashMap::new(),
                Err(_) => {}
            }
        }
        let read = found
            .iter()
            .map(|(source, path, bytes)| (*source, path.as_path(), &**bytes));
        let decoded = texture::decode_ahead(&read.collect::<Vec<_>>(), self.files.budget());
        let decoded = decoded.into_iter();
        decoded
            .map(|(source, read)| (source.clone(), read))
            .collect()
    }

    /// The image in a file that the scene names, which may have been decoded ahead, or what stands in for it.
    fn image_or_stand_in(
        &self,
        named: &Spanned<String>,
        path: &Path,
        ahead: Option<Result<Texture, FormatError>>,
        warnings: &mut Vec<String>,
    ) -> Result<Texture, FormatError> {
        let budget = self.files.budget();
        let read = || {
            let bytes = self.bytes(named, path, &|_| ())?;
            texture::decode(path, &bytes, budget)
        };
        match ahead.unwrap_or_else(read) {
            Err(error) if budget.limits().stand_ins => {
                budget.check_cancelled(path)?;
                warnings.push(format!("{error}; a checkerboard stands in for it"));
                Ok(Texture::stand_in(None, [Wrap::Repeat; 2]))
            }
            read => read,
        }
    }
}
