//! Where plants stand: at random, but none nearer to another than it can live, as in Poisson discs (Cook, "Stochastic Sampling in Computer Graphics", 1986).

use super::random::Rng;

/// A place on the ground and the room that is kept around it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    pub(super) x: f32,
    pub(super) z: f32,
    /// To others at least half of the sum of both.
    pub(super) room: f32,
}

/// Spots around a centre out to a distance, those in the middle first: tried in random order, and kept where there is room. `room` tells how much a plant at a place needs, at most `most`;
/// `None` where none grows.
pub(super) fn spots(
    [x, z]: [f32; 2],
    reach: f32,
    most: f32,
    rng: &mut Rng,
    room: impl Fn(f32, f32, &mut Rng) -> Option<f32>,
) -> Vec<Spot> {
    // Lists by squares as large as any room: what may be too near lies in nine of them.
    let side = (2.0 * reach / most).ceil() as usize + 1;
    let mut squares: Vec<Vec<Spot>> = vec![Vec::new(); side * side];
    let tries = (9.0 * (reach / most) * (reach / most) * 4.0) as usize;
    let mut found = Vec::new();
    for _ in 0..tries {
        let (dx, dz) = (rng.between(-reach, reach), rng.between(-reach, reach));
        let wanted = room(x + dx, z + dz, rng);
        let Some(room) = wanted.filter(|_| dx * dx + dz * dz < reach * reach) else { continue };
        let [column, row] = [dx, dz].map(|d| (((d + reach) / most) as usize).min(side - 1));
        let is_near = |other: &Spot| {
            let (dx, dz) = (other.x - x - dx, other.z - z - dz);
            let least = 0.5 * (room + other.room);
            dx * dx + dz * dz < least * least
        };
        let rows = row.saturating_sub(1)..(row + 2).min(side);
        let columns = column.saturating_sub(1)..(column + 2).min(side);
        let is_taken = rows.flat_map(|row| columns.clone().map(move |column| row * side + column));
        if is_taken.into_iter().any(|square| squares[square].iter().any(is_near)) {
            continue;
        }
        let spot = Spot { x: x + dx, z: z + dz, room };
        squares[row * side + column].push(spot);
        found.push(spot);
    }
    let away = |spot: &Spot| (spot.x - x) * (spot.x - x) + (spot.z - z) * (spot.z - z);
    found.sort_by(|a, b| away(a).total_cmp(&away(b)));
    found
}
