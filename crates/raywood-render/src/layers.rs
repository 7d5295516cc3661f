//! What is known of each pixel beside its colour, as layers of a picture file: arbitrary output variables, as the field calls them.

use raywood_scene::Rgb;

use crate::film::Film;
use crate::integrators::Features;
use crate::part::Region;

/// Numbers that belong together, for each pixel.
#[derive(Clone, Debug, PartialEq)]
pub struct Layer {
    /// Its name, such as `normal`.
    pub name: &'static str,
    /// The channels and their names, such as `X`; row after row from the top, as many values each as the picture has pixels.
    pub channels: Vec<(&'static str, Values)>,
}

/// The values of a channel, and how exactly they are kept.
#[derive(Clone, Debug, PartialEq)]
pub enum Values {
    /// As exactly as the picture's light.
    Short(Vec<f32>),
    /// As single floats.
    Exact(Vec<f32>),
    /// Whole numbers.
    Whole(Vec<u32>),
}

impl Layer {
    /// The pixels in a rectangle alone, which must lie in a picture of this width.
    #[must_use]
    pub fn cropped(&self, width: u32, region: Region) -> Self {
        let crop = |(name, values): &(&'static str, Values)| {
            let values = match values {
                Values::Short(values) => Values::Short(cropped(values, width, region)),
                Values::Exact(values) => Values::Exact(cropped(values, width, region)),
                Values::Whole(values) => Values::Whole(cropped(values, width, region)),
            };
            (*name, values)
        };
        Self { name: self.name, channels: self.channels.iter().map(crop).collect() }
    }
}

/// What lies in a rectangle of rows of this width.
fn cropped<T: Copy>(values: &[T], width: u32, region: Region) -> Vec<T> {
    let columns = region.x as usize..(region.x + region.width) as usize;
    let rows = values.chunks_exact(width as usize);
    let rows = rows.skip(region.y as usize).take(region.height as usize);
    rows.flat_map(|row| &row[columns.clone()]).copied().collect()
}

/// What a layer may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Aov {
    /// [`Features::albedo`].
    Albedo,
    /// [`Features::normals`].
    Normal,
    /// [`Features::positions`].
    Position,
    /// [`Features::depths`].
    Depth,
    /// The numbers of primitives, materials and instances: [`primitive_ids`](crate::primitive_ids).
    Ids,
    /// How many samples a pixel has.
    Samples,
    /// The variance of a pixel's luminance: [`FilmPixel::variance`](crate::FilmPixel::variance).
    Variance,
}

/// What layers are made from, as far as it is there; of a picture's size.
#[derive(Clone, Copy, Debug, Default)]
pub struct LayerSources<'a> {
    /// For most.
    pub features: Option<&'a Features>,
    /// For [`Aov::Ids`].
    pub ids: Option<&'a [[u32; 3]]>,
    /// For [`Aov::Samples`] and [`Aov::Variance`].
    pub film: Option<&'a Film>,
}

impl Aov {
    /// All of them.
    pub const ALL: [Self; 7] = [
        Self::Albedo,
        Self::Normal,
        Self::Position,
        Self::Depth,
        Self::Ids,
        Self::Samples,
        Self::Variance,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Albedo => "albedo",
            Self::Normal => "normal",
            Self::Position => "position",
            Self::Depth => "depth",
            Self::Ids => "ids",
            Self::Samples => "samples",
            Self::Variance => "variance",
        }
    }

    /// What it is, in a line.
    pub fn help(self) -> &'static str {
        match self {
            Self::Albedo => "the share of the light that surfaces send back",
            Self::Normal => "normals for shading, on the side of the eye",
            Self::Position => "where surfaces are, in the axes of the scene",
            Self::Depth => "how far in front of the eye they are",
            Self::Ids => {
                "the numbers of primitives, materials and instances in the middle of a pixel"
            }
            Self::Samples => "how many rays a pixel has",
            Self::Variance => "the variance of a pixel's brightness, as far as passes tell",
        }
    }

    /// The one of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|aov| aov.name() == name)
    }

    /// Whether it is told by [`Features`].
    pub fn is_feature(self) -> bool {
        matches!(self, Self::Albedo | Self::Normal | Self::Position | Self::Depth)
    }

    /// Whether it is told by a [`Film`].
    pub fn is_of_film(self) -> bool {
        matches!(self, Self::Samples | Self::Variance)
    }

    /// Its layers; none if there is nothing to make them from.
    pub fn layers(self, sources: &LayerSources<'_>) -> Vec<Layer> {
        let LayerSources { features, ids, film } = *sources;
        let axes =
            |values: &[Rgb], axis: usize| values.iter().map(|v| v.to_array()[axis]).collect();
        let triple = |names: [&'static str; 3], values: &[Rgb], keep: fn(Vec<f32>) -> Values| {
            let channels = names.into_iter().enumerate();
            channels.map(|(axis, name)| (name, keep(axes(values, axis)))).collect()
        };
        let layer = |channels| vec![Layer { name: self.name(), channels }];
        match (self, features, ids, film) {
            (Self::Albedo, Some(features), ..) => {
                layer(triple(["R", "G", "B"], &features.albedo, Values::Short))
            }
            (Self::Normal, Some(features), ..) => {
                layer(triple(["X", "Y", "Z"], &features.normals, Values::Short))
            }
            (Self::Position, Some(features), ..) => {
                layer(triple(["X", "Y", "Z"], &features.positions, Values::Exact))
            }
            (Self::Depth, Some(features), ..) => {
                layer(vec![("Z", Values::Exact(features.depths.clone()))])
            }
            (Self::Ids, _, Some(ids), _) => ["primitive", "material", "instance"]
                .into_iter()
                .enumerate()
                .map(|(place, name)| {
                    let numbers = ids.iter().map(|ids| ids[place]).collect();
                    Layer { name, channels: vec![("id", Values::Whole(numbers))] }
                })
                .collect(),
            (Self::Samples, .., Some(film)) => {
                let samples = film.pixels().iter().map(|pixel| pixel.samples).collect();
                layer(vec![("N", Values::Whole(samples))])
            }
            (Self::Variance, .., Some(film)) => {
                let variances = film.pixels().iter().map(|pixel| pixel.variance()).collect();
                layer(vec![("Y", Values::Exact(variances))])
            }
            _ => Vec::new(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rectangle_is_cut_out_of_every_channel() {
        let numbers = Values::Whole((0..12).collect());
        let layer = Layer { name: "ids", channels: vec![("A", numbers.clone()), ("B", numbers)] };
        let part = layer.cropped(4, Region { x: 1, y: 1, width: 2, height: 2 });
        let expected = Values::Whole(vec![5, 6, 9, 10]);
        assert_eq!(part.channels, [("A", expected.clone()), ("B", expected)]);
    }
}
