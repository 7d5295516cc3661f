//! Textures of glTF: images, samplers and transforms (`KHR_texture_transform`).

use std::borrow::Cow;

use gltf_json::extensions::texture::TextureTransform as Source;
use gltf_json::texture::{Info, MagFilter, WrappingMode};
use gltf_json::validation::Checked;
use gltf_json::{Root, Value, deserialize};

use super::document::Document;
use crate::error::{LoadError, Place};
use crate::formats::images::{ImageRequests, Use};
use crate::formats::notes::{Notes, counted};
use crate::{Magnification, Texture, TextureImage, TextureTransform, Wrap};

/// Extensions by which a texture names an image in another format.
const OTHER_FORMATS: [&str; 4] =
    ["KHR_texture_basisu", "EXT_texture_webp", "EXT_texture_avif", "MSFT_texture_dds"];

/// Where a material names a texture, in any of the forms of glTF.
pub(super) struct Named<'a> {
    index: usize,
    set: u32,
    transform: Option<Cow<'a, Source>>,
}

impl<'a> Named<'a> {
    /// Where most textures are named.
    pub(super) fn info(info: &'a Info) -> Self {
        let extensions = info.extensions.as_ref();
        let transform = extensions.and_then(|e| e.texture_transform.as_ref()).map(Cow::Borrowed);
        Self { index: info.index.value(), set: info.tex_coord, transform }
    }

    /// Where those of normals and of occlusion are, whose transforms the reader of the JSON leaves as they are.
    pub(super) fn other(index: usize, set: u32, transform: Option<&Value>) -> Self {
        let transform = transform.and_then(|value| deserialize::from_value(value.clone()).ok());
        Self { index, set, transform: transform.map(Cow::Owned) }
    }
}

/// The images that the textures of a file name.
pub(super) struct Textures<'a> {
    root: &'a Root,
    images: ImageRequests<usize>,
    /// How many textures have no image.
    empty: usize,
    /// Whether a texture asks for more sets of texture coordinates than there are here.
    more_sets: bool,
}

impl<'a> Textures<'a> {
    pub(super) fn new(root: &'a Root) -> Self {
        Self { root, images: ImageRequests::default(), empty: 0, more_sets: false }
    }

    /// A texture for a use; `None` if it names no image.
    pub(super) fn texture(&mut self, named: Named<'_>, use_: Use) -> Option<Texture> {
        let source = self.root.textures.get(named.index)?;
        let others = source.extensions.as_ref().map(|e| &e.others);
        let other = |name: &&str| Some(others?.get(*name)?.get("source")?.as_u64()? as usize);
        let sources = [Some(source.source.value()), OTHER_FORMATS.iter().find_map(other)];
        let is_there = |image: &usize| *image < self.root.images.len();
        let Some(image) = sources.into_iter().flatten().find(is_there) else {
            self.empty += 1;
            return None;
        };

        let transform = named.transform.as_deref();
        let set = transform.and_then(|t| t.tex_coord).unwrap_or(named.set);
        let Some(set) = u8::try_from(set).ok().filter(|&set| set < 2) else {
            self.more_sets = true;
            return None;
        };
        let sampler = source.sampler.and_then(|sampler| self.root.samplers.get(sampler.value()));
        let wrap = |mode: Checked<WrappingMode>| match mode {
            Checked::Valid(WrappingMode::ClampToEdge) => Wrap::Clamp,
            Checked::Valid(WrappingMode::MirroredRepeat) => Wrap::Mirror,
            _ => Wrap::Repeat,
        };
        let nearest = Some(Checked::Valid(MagFilter::Nearest));
        Some(Texture {
            image: self.images.ask(image, use_),
            set,
            transform: transform.map_or(TextureTransform::IDENTITY, |t| {
                TextureTransform::new(t.offset.0, t.rotation.0, t.scale.0)
            }),
            wrap: sampler.map_or([Wrap::Repeat; 2], |s| [wrap(s.wrap_s), wrap(s.wrap_t)]),
            magnification: match sampler {
                Some(sampler) if sampler.mag_filter == nearest => Magnification::Nearest,
                _ => Magnification::Linear,
            },
        })
    }

    /// All images that were asked for.
    pub(super) fn load(
        self,
        document: &Document<'_>,
        notes: &mut Notes,
    ) -> Result<Vec<TextureImage>, LoadError> {
        if self.empty > 0 {
            let verb = if self.empty == 1 { "has" } else { "have" };
            let textures = counted(self.empty, "texture");
            notes.say(format!("{textures} {verb} no image, left out"));
        }
        if self.more_sets {
            notes.say("textures that use a third set of texture coordinates are left out");
        }
        let place = |&image: &usize| Place::Json(format!("images[{image}]"));
        let error = |place, message| document.error_at(place, message);
        self.images.load(|&image| document.image(image), place, error, notes)
    }
}
