//! What is known of each pixel beside its colour, as layers of a picture file: arbitrary output variables, as the field calls them.

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

