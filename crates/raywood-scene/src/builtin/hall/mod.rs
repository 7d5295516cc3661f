//! hall
use super::{Builtin, Values};
use crate::Scene;
pub(super) const ENTRY: Builtin = Builtin { name: "hall", description: "x", parameters: &[], build };
fn build(_: &Values) -> Scene { Scene::default() }
