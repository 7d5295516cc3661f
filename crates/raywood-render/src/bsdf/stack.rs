//! A mirror under layers: how they share light.
//!
//! Most surfaces have no layers: what is asked of these is kept out of line, so that it costs the others nothing.

use raywood::Vec3;
use raywood_scene::Rgb;

use super::albedo::{Albedo, AlbedoTable, Albedos, SMOOTHEST};
use super::layer::{Coat, Layer, Sheen};

/// A mirror and the layers over it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stack {
    pub(crate) mirror: Albedos,
    pub(crate) layers: [Option<Layer>; 2],
}

/// How much light the parts of a stack send back.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Shares {
    /// The layers together.
    pub(crate) layers: f32,
    /// The mirror, through them.
    pub(crate) mirror: Albedo,
}

impl Shares {
    /// What counts as lost at least where there are no layers, to divide by.
    pub(crate) const LEAST_LOST: f32 = 1e-6;

    /// What neither sends back if facets mirror everything.
    #[inline(always)]
    pub(crate) fn lost(self) -> f32 {
        let lost = (1.0 - self.layers) - self.mirror.white;
        if lost > 0.0 { lost } else { 0.0 }
    }
}

impl Stack {
    /// Over a mirror with facets of this alpha.
    pub(crate) fn new(alpha: f32, coat: Option<Coat>, sheen: Option<Sheen>) -> Self {
        let mirror = AlbedoTable::get().of_roughness(alpha);
        let is_bare = coat.is_none() && sheen.is_none();
        let layers = if is_bare { [None; 2] } else { layers_over(alpha, coat, sheen) };
        Self { mirror, layers }
    }

    /// Whether there are no layers.
    pub(crate) fn is_bare(&self) -> bool {
        self.layers.iter().all(Option::is_none)
    }

    /// What counts as lost at least, to divide by: below smooth layers nothing is but for what tables round.
    pub(crate) fn least_lost(&self) -> f32 {
        if self.is_bare() { Shares::LEAST_LOST } else { 3e-3 }
    }

    /// Those that there are.
    pub(crate) fn layers(&self) -> impl Iterator<Item = &Layer> {
        self.layers.iter().flatten()
    }

    /// What is sent towards a direction of this cosine.
    #[inline]
    pub(crate) fn at(&self, cosine: f32) -> Shares {
        self.shares(self.mirror.at(cosine), |layer| layer.shares(cosine))
    }

    /// The mean over all directions.
    pub(crate) fn mean(&self) -> Shares {
        self.shares(self.mirror.mean(), Layer::mean_shares)
    }

    /// Those of the parts of a surface that layers cover, and of the rest.
    #[inline]
    fn shares(&self, bare: Albedo, of: impl Fn(&Layer) -> (f32, Albedo)) -> Shares {
        if self.is_bare() {
            return Shares { layers: 0.0, mirror: bare };
        }
        self.layered_shares(bare, of)
    }

    #[inline(never)]
    fn layered_shares(&self, bare: Albedo, of: impl Fn(&Layer) -> (f32, Albedo)) -> Shares {
        let mut all = Shares { layers: 0.0, mirror: bare };
        for layer in self.layers() {
            let (own, below) = of(layer);
            all.layers += layer.share * own;
            let change = below.plus(bare.times(-1.0));
            all.mirror = all.mirror.plus(change.times(layer.share));
        }
        all
    }

    /// The share that layers leave of what the mirror sends from one direction to another.
    #[inline]
    pub(crate) fn leaves(&self, cosine: f32, other: f32) -> f32 {
        if self.is_bare() { 1.0 } else { self.layers_leave(cosine, other) }
    }

    #[inline(never)]
    fn layers_leave(&self, cosine: f32, other: f32) -> f32 {
        let lost = |layer: &Layer| layer.share * (1.0 - layer.leaves(cosine, other));
        self.layers().fold(1.0, |left, layer| left - lost(layer))
    }

    /// How bright the light of each layer is towards a direction of this cosine.
    #[inline]
    pub(crate) fn layers_brightness(&self, cosine: f32) -> [f32; 2] {
        if self.is_bare() {
            return [0.0; 2];
        }
        self.layers.map(|layer| layer.map_or(0.0, |layer| layer.brightness(cosine)))
    }

    /// The light that layers send back from `wi` to `wo`, times the cosine there; all but perfect mirrors.
    #[inline(never)]
    pub(crate) fn layers_eval(&self, wo: Vec3, wi: Vec3) -> Rgb {
        self.layers().fold(Rgb::ZERO, |sum, layer| sum + layer.eval(wo, wi))
    }

    /// The density by solid angle with which layers choose `wi`, each chosen with its probability.
    #[inline(never)]
    pub(crate) fn layers_density(&self, chosen: [f32; 2], wo: Vec3, wi: Vec3) -> f32 {
        let of = |(layer, chosen): (&Option<Layer>, f32)| {
            layer.map_or(0.0, |layer| chosen * layer.density(wo, wi))
        };
        self.layers.iter().zip(chosen).map(of).sum()
    }
}

/// A coat and sheen over a mirror with facets of this alpha.
#[inline(never)]
fn layers_over(alpha: f32, coat: Option<Coat>, sheen: Option<Sheen>) -> [Option<Layer>; 2] {
    let smooth_or = |alpha: f32| if alpha < SMOOTHEST { 0.0 } else { alpha };
    let below = smooth_or(alpha);
    let coated = coat.map_or(0.0, |coat| coat.share);
    let coat = coat.map(|Coat { share, alpha }| Layer::coat(share, smooth_or(alpha), below));
    let sheen = sheen.and_then(|Sheen { color, alpha }| {
        // Where the brightest channel is less than all, fibres stand on a part of the surface.
        let most = color.max_element();
        let share = (1.0 - coated) * most;
        (share > 0.0).then(|| Layer::sheen(share, (1.0 / most) * color, alpha, below))
    });
    [coat, sheen]
}
