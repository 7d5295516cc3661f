//! The plan of the hall: its measures, in metres. The nave runs along z, away from the eye (towards -z); x is
//! across, y up.

use super::super::modelling::{Arch, GroinVault};

/// From one pillar of a row to the next.
pub(super) const BAY: f32 = 4.4;
/// How many bays the nave is long.
pub(super) const BAYS: usize = 9;
/// Where the first pillars stand, behind the eye.
pub(super) const FIRST_Z: f32 = 8.8;
/// Where the last pillars stand, in the end wall.
pub(super) const LAST_Z: f32 = FIRST_Z - BAY * BAYS as f32;

/// From the middle of the nave to the pillars' axes.
pub(super) const PILLAR_X: f32 = 3.3;
/// Half the thickness of the walls over the pillars.
pub(super) const ARCADE_HALF_THICKNESS: f32 = 0.35;
/// From the middle of the nave to the inner face of the outer walls.
pub(super) const OUTER_X: f32 = 7.3;
/// The thickness of the outer walls.
pub(super) const OUTER_THICKNESS: f32 = 0.6;

/// The top of the capitals, where the arcade's arches and the aisles' vaults begin.
pub(super) const ARCADE_SPRING: f32 = 4.4;
/// The cornice between arcade and clerestory.
pub(super) const CORNICE: f32 = 6.75;
/// Where the nave's vault begins.
pub(super) const VAULT_SPRING: f32 = 7.1;
/// The upper edge of the walls, above the vaults.
pub(super) const WALL_TOP: f32 = 10.2;
/// The upper edge of the outer walls.
pub(super) const AISLE_TOP: f32 = 6.6;

/// The arches from pillar to pillar.
pub(super) const ARCADE: Arch = Arch::round(1.72, ARCADE_SPRING);
/// The windows of the outer walls, and their sill.
pub(super) const WINDOW: Arch = Arch::round(1.45, 3.80);
pub(super) const WINDOW_SILL: f32 = 0.55;
/// The windows of the clerestory, above the cornice.
pub(super) const CLERESTORY: Arch = Arch { half_width: 1.62, spring: 7.35, rise: 1.95 };
/// The door to the sea in the end wall.
pub(super) const DOOR: Arch = Arch::round(1.75, 3.6);
/// The round window above it: the height of its middle, and its radius.
pub(super) const ROSE: (f32, f32) = (7.95, 1.30);

/// The vault over a bay of the nave.
pub(super) const NAVE_VAULT: GroinVault = GroinVault {
    half_x: PILLAR_X - ARCADE_HALF_THICKNESS,
    half_z: 0.5 * BAY,
    spring: VAULT_SPRING,
    rise: 2.6,
};
/// The vault over a bay of an aisle.
pub(super) const AISLE_VAULT: GroinVault = GroinVault {
    half_x: 0.5 * (OUTER_X - PILLAR_X - ARCADE_HALF_THICKNESS),
    half_z: 0.5 * BAY,
    spring: ARCADE_SPRING,
    rise: 1.72,
};
/// From the middle of the nave to the middle of an aisle.
pub(super) const AISLE_X: f32 = 0.5 * (OUTER_X + PILLAR_X + ARCADE_HALF_THICKNESS);

/// Where the pillars of a row stand along z, first to last.
pub(super) fn pillar_rows() -> impl Iterator<Item = f32> {
    (0..=BAYS).map(|k| FIRST_Z - BAY * k as f32)
}

/// Where the bays have their middle along z, first to last.
pub(super) fn bay_middles() -> impl Iterator<Item = f32> {
    (0..BAYS).map(|k| FIRST_Z - BAY * (k as f32 + 0.5))
}
