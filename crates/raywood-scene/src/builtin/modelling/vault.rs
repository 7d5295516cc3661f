//! Groin vaults: two barrels that cross, as over a bay of a nave.

use std::f32::consts::PI;

use raywood::Vec3;

use super::{Cells, Part, PathPoint};

/// A vault over a rectangular bay centred on the vertical axis: barrels along x and z, equally high, that meet in the
/// groins over the diagonals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GroinVault {
    /// Half the bay's extent along x.
    pub half_x: f32,
    /// Half the bay's extent along z.
    pub half_z: f32,
    /// The height at which the barrels begin.
    pub spring: f32,
    /// The height from there to the crown.
    pub rise: f32,
}

impl GroinVault {
    /// The point of the underside over a place in plan (inside the bay), and the unit normal there, down into the room.
    pub fn surface(&self, x: f32, z: f32) -> (Vec3, Vec3) {
        let (u, v) = (x / self.half_x, z / self.half_z);
        // The higher barrel counts; which one it is changes at the groins.
        let nearer = if u.abs() < v.abs() { u } else { v };
        let height = (1.0 - nearer * nearer).max(0.0).sqrt();
        let out = if u.abs() < v.abs() {
            Vec3::new(u / self.half_x, height / self.rise, 0.0)
        } else {
            Vec3::new(0.0, height / self.rise, v / self.half_z)
        };
        (Vec3::new(x, self.spring + self.rise * height, z), -out.normalize_or_zero())
    }

    /// The path of a groin across the whole vault; `sign` (1 or -1) tells which diagonal. Up is down into the room,
    /// where ribs go.
    pub fn groin_path(&self, sign: f32, segments: usize) -> Vec<PathPoint> {
        (0..=segments)
            .map(|i| {
                let (sin, cos) = (PI * i as f32 / segments as f32).sin_cos();
                let out = Vec3::new(cos * self.half_x, self.rise * sin, sign * cos * self.half_z);
                PathPoint {
                    position: out + Vec3::new(0.0, self.spring, 0.0),
                    up: -Vec3::new(out.x, out.y.max(0.2 * self.rise), out.z),
                }
            })
            .collect()
    }
}

/// The underside of a groin vault; each barrel's arc is cut into `segments` (even, so that one lies on the crown).
pub fn groin_vault(vault: &GroinVault, segments: usize) -> Part {
    // Along the crown a barrel is straight, so few cells do.
    let across = (segments / 16).max(2);
    let mut part = Part::default();
    for (along_x, sign) in [(true, 1.0), (true, -1.0), (false, 1.0), (false, -1.0)] {
        part.add_grid(Cells::open(across), Cells::open(segments), |i, j| {
            let (sin, cos) = (PI * j as f32 / segments as f32).sin_cos();
            let t = i as f32 / across as f32;
            // Walk from groin to edge or back, whichever turns the front down.
            let t = if (sign > 0.0) == along_x { 1.0 - t } else { t };
            let out = sign * (cos.abs() + (1.0 - cos.abs()) * t);
            let (x, z) = if along_x { (out, cos) } else { (cos, out) };
            Vec3::new(x * vault.half_x, vault.spring + vault.rise * sin, z * vault.half_z)
        });
    }
    part
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_vault_looks_down_everywhere_and_touches_its_crown() {
        let vault = GroinVault { half_x: 3.0, half_z: 2.0, spring: 6.0, rise: 2.5 };
        let part = groin_vault(&vault, 24);
        assert!(part.normals.iter().all(|n| n.y <= 1e-3 && (n.length() - 1.0).abs() < 1e-4));
        let top = part.positions.iter().map(|p| p.y).fold(0.0, f32::max);
        assert!((top - 8.5).abs() < 1e-5);
        for p in &part.positions {
            assert!((vault.surface(p.x, p.z).0 - *p).length() < 2e-2, "{p:?}");
        }
    }
}
