//! Heat maps: pictures of how much work the structure does for each pixel.
//!
//! ```
//! use raywood_render::{HeatMap, HeatQuantity, PreparedScene, Progress, RenderOptions, heat_map};
//!
//! # let scene = raywood_scene::builtin("sphereflake?depth=2").unwrap();
//! # let prepared = PreparedScene::new(&scene).unwrap();
//! # let camera = raywood_render::default_view(&prepared, 1.6).camera;
//! # let options = RenderOptions { width: 80, height: 50, ..RenderOptions::default() };
//! let map = heat_map(&prepared, &camera, &options, HeatQuantity::Nodes, &Progress::new())?;
//! let maximum = HeatMap::common_maximum([&map]);              // of several maps: one scale for all
//! let picture = map.picture(maximum);                         // as large as the map
//! let png = map.with_legend(&picture, maximum).to_png();      // a strip with numbers below it
//! # assert!(png.is_ok());
//! # Ok::<(), raywood_render::RenderError>(())
//! ```

mod colors;
mod font;
mod legend;
mod measure;
mod quantity;
mod scale;

pub use measure::{HeatMap, heat_map};
pub use quantity::HeatQuantity;
