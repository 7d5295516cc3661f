//! Materials with textures: what they are made of, and what becomes of a material where its textures show something.

use raywood::Hit;
use raywood_scene::{LightShares, Material, MetallicRoughness, Rgb, SurfaceTextures};
use raywood_scene::{TexelGrid, Texture, TextureImage};

use crate::PreparedScene;
use crate::prepared::Which;
use crate::surface_material::SurfaceMaterial;

/// What a texture is for: the place of what it shows among what all show.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Slot {
    Color,
    Emission,
    OpacityMap,
    Normal,
    MetallicRoughness,
    Occlusion,
    Glossiness,
    SpecularColor,
    Specular,
    Transmission,
    // Those of layers come last.
    Clearcoat,
    ClearcoatRoughness,
    SheenColor,
    SheenRoughness,
}

/// What all textures of a material show at a point: ones where there is none.
pub(crate) type Shown = [[f32; 4]; 14];

/// A texture with its image.
pub(crate) struct Layer<'a> {
    pub(crate) slot: Slot,
    pub(crate) texture: &'a Texture,
    pub(crate) image: &'a TextureImage,
    /// Where the texture finds the image's texels.
    pub(crate) grid: TexelGrid,
    /// Whether it is read where the one before is.
    pub(crate) follows: bool,
}

impl Layer<'_> {
    /// Whether it is read over all that a ray stands for; numbers are read once.
    #[inline(always)]
    pub(crate) fn is_color(&self) -> bool {
        matches!(self.slot, Slot::Color | Slot::Emission | Slot::OpacityMap)
    }

    fn is_of_coat_or_sheen(&self) -> bool {
        use Slot::{Clearcoat, ClearcoatRoughness, SheenColor, SheenRoughness};
        matches!(self.slot, Clearcoat | ClearcoatRoughness | SheenColor | SheenRoughness)
    }

    /// Whether where one is read the other is too.
    fn is_read_as(&self, other: &Self) -> bool {
        let place = |layer: &Self| Texture { image: 0, ..*layer.texture };
        let size = |layer: &Self| (layer.image.width(), layer.image.height());
        self.is_color() == other.is_color()
            && place(self) == place(other)
            && size(self) == size(other)
    }
}

/// A material with textures, and these with their images.
pub(crate) struct TexturedMaterial<'a> {
    material: &'a Material,
    pub(crate) textures: &'a SurfaceTextures,
    /// Those that have an image, those that are read in the same places one after the other.
    pub(crate) layers: Vec<Layer<'a>>,
    /// Whether it is not all there everywhere.
    pub(crate) is_perforated: bool,
    /// Whether its coat or its sheen has a texture.
    has_textured_layers: bool,
}

impl<'a> TexturedMaterial<'a> {
    /// The textures of a material, if it has any; those without an image are left out.
    pub(crate) fn new(material: &'a Material, images: &'a [TextureImage]) -> Option<Self> {
        let textures = material.textures.as_deref()?;
        let named = [
            (Slot::Color, textures.color.as_ref()),
            (Slot::Emission, textures.emission.as_ref()),
            (Slot::OpacityMap, textures.opacity_map.as_ref()),
            (Slot::Normal, textures.normal.as_ref().map(|(texture, _)| texture)),
            (Slot::MetallicRoughness, textures.metallic_roughness.as_ref()),
            (Slot::Occlusion, textures.occlusion.as_ref().map(|(texture, _)| texture)),
            (Slot::Glossiness, textures.glossiness.as_ref()),
            (Slot::SpecularColor, textures.specular_color.as_ref()),
            (Slot::Specular, textures.specular.as_ref()),
            (Slot::Transmission, textures.transmission.as_ref()),
            (Slot::Clearcoat, textures.clearcoat.as_ref()),
            (Slot::ClearcoatRoughness, textures.clearcoat_roughness.as_ref()),
            (Slot::SheenColor, textures.sheen_color.as_ref()),
            (Slot::SheenRoughness, textures.sheen_roughness.as_ref()),
        ];
        let with_image = |(slot, texture): (Slot, Option<&'a Texture>)| {
            let image = images.get(texture?.image as usize)?;
            let grid = TexelGrid::new(texture?, [image.width(), image.height()]);
            Some(Layer { slot, texture: texture?, image, grid, follows: false })
        };
        let mut layers: Vec<_> = named.into_iter().filter_map(with_image).collect();
        for second in 1..layers.len() {
            layers[second].follows = layers[second].is_read_as(&layers[second - 1]);
        }
        let is_perforated = is_perforated(textures, &layers);
        let has_textured_layers = layers.iter().any(Layer::is_of_coat_or_sheen);
        Some(Self { material, textures, layers, is_perforated, has_textured_layers })
    }

    /// The texture for something, if it has one.
    #[inline]
    pub(crate) fn layer(&self, slot: Slot) -> Option<&Layer<'a>> {
        self.layers.iter().find(|layer| layer.slot == slot)
    }

    /// How much of a surface is there where its colour and its map of opacity show this.
    #[inline(always)]
    pub(crate) fn opacity(&self, color: [f32; 4], map: [f32; 4]) -> f32 {
        let Some(factor) = self.textures.opacity else { return 1.0 };
        let [r, g, b, _] = map;
        (factor * color[3] * ((r + g + b) / 3.0)).clamp(0.0, 1.0)
    }

    /// The texture that gives normals, and by how much it bends them.
    pub(crate) fn normal(&self) -> Option<(&'a Texture, f32)> {
        let (texture, scale) = self.textures.normal.as_ref()?;
        self.layer(Slot::Normal).map(|_| (texture, *scale))
    }

    /// The light that it sends out in the mean over its texture, if it has one.
    pub(crate) fn mean_emission(&self) -> Rgb {
        let mean = self.layer(Slot::Emission).map_or(Rgb::ONE, |layer| {
            // The last level is one texel, the mean of all.
            let last = layer.image.last_level();
            rgb(layer.image.show(last, &layer.grid.blend(last, [0.5; 2])))
        });
        self.material.emission * mean
    }

    /// Ones, in all places that [`apply`](Self::apply) looks at.
    #[inline(always)]
    pub(crate) fn clear(&self, shown: &mut [Shown]) {
        if self.has_textured_layers {
            shown.fill([[1.0; 4]; _]);
        } else {
            // Few materials have more.
            for shown in shown {
                shown[..Slot::Clearcoat as usize].fill([1.0; 4]);
            }
        }
    }

    /// Makes of the material what it is where its textures show that, and vertices have a colour; tells what it is made of, if its description by metal
    /// and roughness says so.
    #[inline(always)]
    pub(crate) fn apply(
        &self,
        found: &mut SurfaceMaterial,
        shown: &Shown,
        vertex_color: Rgb,
    ) -> Option<MetallicRoughness> {
        let of = |slot: Slot| shown[slot as usize];
        found.opacity = self.opacity(of(Slot::Color), of(Slot::OpacityMap));
        found.emission = found.emission * rgb(of(Slot::Emission));
        if let Some((_, strength)) = &self.textures.occlusion {
            found.ambient = 1.0 + strength * (of(Slot::Occlusion)[0] - 1.0);
        }

        if self.has_textured_layers {
            found.coat.strength *= of(Slot::Clearcoat)[0];
            found.coat.roughness *= of(Slot::ClearcoatRoughness)[1];
            found.sheen.color = found.sheen.color * rgb(of(Slot::SheenColor));
            found.sheen.roughness *= of(Slot::SheenRoughness)[3];
            found.make_layers_safe();
        }

        let tint = rgb(of(Slot::Color)) * vertex_color;
        let specular = of(Slot::Specular)[3] * rgb(of(Slot::SpecularColor));
        let Some(mut surface) = self.material.metallic_roughness else {
            found.diffuse = self.material.diffuse * tint;
            found.specular = self.material.specular * specular;
            found.mirror = self.material.mirror * specular;
            found.make_safe();
            return None;
        };
        let [_, rough, metal, _] = of(Slot::MetallicRoughness);
        let glossy = of(Slot::Glossiness);
        surface.base = surface.base * tint;
        surface.reflectance = surface.reflectance * specular * rgb(glossy);
        surface.metallic *= metal;
        surface.roughness = 1.0 - (1.0 - surface.roughness * rough) * glossy[3];
        surface.transmission *= of(Slot::Transmission)[0];
        let shares = surface.light_shares();
        let LightShares { diffuse, specular, shininess, mirror, grazing, transmission } = shares;
        (found.diffuse, found.specular, found.shininess) = (diffuse, specular, shininess);
        (found.mirror, found.grazing, found.transmission) = (mirror, grazing, transmission);
        found.make_safe();
        Some(surface)
    }
}

/// Whether a surface with these textures is not all there everywhere.
fn is_perforated(textures: &SurfaceTextures, layers: &[Layer<'_>]) -> bool {
    let Some(opacity) = textures.opacity else { return false };
    let has_holes = |layer: &Layer<'_>| match layer.slot {
        Slot::Color => !layer.image.is_opaque(),
        slot => slot == Slot::OpacityMap,
    };
    opacity < 1.0 || layers.iter().any(has_holes)
}

#[inline(always)]
fn rgb([r, g, b, _]: [f32; 4]) -> Rgb {
    Rgb::new(r, g, b)
}

fn opacity_of(material: &TexturedMaterial<'_>, shown: &Shown) -> f32 {
    material.opacity(shown[Slot::Color as usize], shown[Slot::OpacityMap as usize])
}

/// How much of a surface is there at a hit, as close up: for shadow rays.
pub(crate) fn opacity_at(scene: &PreparedScene<'_>, hit: &Hit) -> f32 {
    let is_wanted = |slot: Slot| matches!(slot, Slot::Color | Slot::OpacityMap);
    show_close_up(scene, hit, is_wanted)
        .map_or(1.0, |(material, shown)| opacity_of(material, &shown))
}

/// The light that a surface sends out at a hit, as close up: for whoever chooses points on lights. What is not there sends out none.
pub(crate) fn emission_at(scene: &PreparedScene<'_>, hit: &Hit) -> Rgb {
    let whole = scene.material_of(hit).emission;
    let is_wanted = |slot: Slot| matches!(slot, Slot::Color | Slot::OpacityMap | Slot::Emission);
    show_close_up(scene, hit, is_wanted).map_or(whole, |(material, shown)| {
        opacity_of(material, &shown) * (whole * rgb(shown[Slot::Emission as usize]))
    })
}

/// What some of the textures of a material show at a hit, as close up; `None` if it has none.
fn show_close_up<'a>(
    scene: &'a PreparedScene<'_>,
    hit: &Hit,
    is_wanted: impl Fn(Slot) -> bool,
) -> Option<(&'a TexturedMaterial<'a>, Shown)> {
    let material = scene.textured_material(scene.material_index(hit) as u32)?;
    let Which::Triangle(triangle) = scene.which(hit.primitive) else { return None };
    let mesh = &scene.scene().mesh;
    let corners = mesh.triangles.triangles()[triangle as usize];
    let mut shown = [[1.0; 4]; _];
    for Layer { slot, texture, image, grid, .. } in &material.layers {
        if is_wanted(*slot) {
            let coordinates = &mesh.texture_coordinates[usize::from(texture.set.min(1))];
            let point = texture.point_on(coordinates, corners, [hit.u, hit.v]);
            shown[*slot as usize] = image.show(0, &grid.blend(0, point));
        }
    }
    Some((material, shown))
}
