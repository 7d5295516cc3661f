//! The sets of points and rays that are asked about, made so that anybody can make them again.

use raywood::{Ray, TriangleMesh, Vec3};
use raywood_testkit::Rng;

/// The kinds of sets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum QueryKind {
    /// The closest point from near the surface.
    SurfaceNear,
    /// The closest point from anywhere in the box around all triangles.
    Box,
    /// The closest point from far away.
    Far,
    /// How often rays cross the surface.
    Crossings,
}

impl QueryKind {
    /// All kinds.
    pub(crate) const ALL: &[Self] = &[Self::SurfaceNear, Self::Box, Self::Far, Self::Crossings];

    /// Its name on the command line and in tables.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::SurfaceNear => "surface-near",
            Self::Box => "box",
            Self::Far => "far",
            Self::Crossings => "crossings",
        }
    }
}

/// Questions of one kind, in random order.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct QuerySet {
    pub(crate) kind: QueryKind,
    pub(crate) questions: Questions,
}

/// What is asked.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Questions {
    /// Which point of the mesh is closest to each of these?
    ClosestPoint(Vec<Vec3>),
    /// How often does each of these cross the mesh?
    Crossings(Vec<Ray>),
}

impl QuerySet {
    /// How many questions there are.
    pub(crate) fn len(&self) -> usize {
        match &self.questions {
            Questions::ClosestPoint(points) => points.len(),
            Questions::Crossings(rays) => rays.len(),
        }
    }
}

/// How far points near the surface are off it at most, as a share of the diagonal.
const NEAR: f32 = 0.01;

/// How far away far points are from the box's centre, in diagonals.
const FAR: [f32; 2] = [1.0, 3.0];

/// Sets of so many questions about a mesh of at least one triangle. By `diagonal` go distances; where it is shorter than that of the box around all triangles, the box
/// is cut to a cube of that size around its centre.
pub(crate) fn query_sets(
    kinds: &[QueryKind],
    mesh: &TriangleMesh,
    diagonal: f32,
    count: usize,
) -> Vec<QuerySet> {
    let bounds = mesh.total_bounds();
    let half = (0.5 * bounds.extent()).min(Vec3::splat(0.5 * diagonal));
    let in_box = |rng: &mut Rng| {
        let Vec3 { x, y, z } = rng.in_cube();
        bounds.center() + Vec3::new(half.x * x, half.y * y, half.z * z)
    };
    // Every triangle is as likely as every other: details count more than large plain walls.
    let near_surface = |rng: &mut Rng| {
        let [a, b, c] = mesh.corners(rng.below(mesh.triangles().len()) as u32);
        let (root, v) = (rng.unit().sqrt(), rng.unit());
        let on_surface = (1.0 - root) * a + root * (1.0 - v) * b + root * v * c;
        on_surface + rng.range(0.0, NEAR * diagonal) * rng.direction()
    };
    let far =
        |rng: &mut Rng| bounds.center() + diagonal * rng.range(FAR[0], FAR[1]) * rng.direction();

    let make = |&kind: &QueryKind| {
        let mut rng = Rng::new(kind as u64 + 1);
        let mut points = |point: &dyn Fn(&mut Rng) -> Vec3| {
            Questions::ClosestPoint((0..count).map(|_| point(&mut rng)).collect())
        };
        let questions = match kind {
            QueryKind::SurfaceNear => points(&near_surface),
            QueryKind::Box => points(&in_box),
            QueryKind::Far => points(&far),
            QueryKind::Crossings => {
                let ray = |_| Ray::new(in_box(&mut rng), rng.direction());
                Questions::Crossings((0..count).map(ray).collect())
            }
        };
        QuerySet { kind, questions }
    };
    kinds.iter().map(make).collect()
}

#[cfg(test)]
mod tests {
    use raywood_testkit::distance::to_mesh;

    use super::*;

    /// A square of 6 by 8 in the plane z = 1, and the sets of it for a diagonal.
    fn sets(diagonal: f32) -> (TriangleMesh, Vec<QuerySet>) {
        let positions = vec![[0.0, 0.0, 1.0], [6.0, 0.0, 1.0], [6.0, 8.0, 1.0], [0.0, 8.0, 1.0]];
        let mesh = TriangleMesh::new(positions, vec![[0, 1, 2], [0, 2, 3]]).expect("a mesh");
        let sets = query_sets(QueryKind::ALL, &mesh, diagonal, 500);
        (mesh, sets)
    }

    fn points(set: &QuerySet) -> &[Vec3] {
        match &set.questions {
            Questions::ClosestPoint(points) => points,
            Questions::Crossings(_) => panic!("rays"),
        }
    }

    #[test]
    fn points_are_where_their_sets_say() {
        let (mesh, sets) = sets(10.0);
        assert!(sets.iter().map(|set| set.kind).eq(QueryKind::ALL.iter().copied()));
        assert!(sets.iter().all(|set| set.len() == 500));
        let off: Vec<_> = points(&sets[0]).iter().map(|point| to_mesh(*point, &mesh)).collect();
        let most = off.iter().copied().fold(0.0, f64::max);
        assert!(most > 0.05 && most < 0.100001, "{most}");
        let corner = points(&sets[1]).iter().copied().reduce(Vec3::max).expect("points");
        assert!((5.9..=6.0).contains(&corner.x) && (7.9..=8.0).contains(&corner.y), "{corner:?}");
        for point in points(&sets[2]) {
            let away = (*point - Vec3::new(3.0, 4.0, 1.0)).length();
            assert!((9.999..30.001).contains(&away), "{away}");
        }
        assert!(matches!(&sets[3].questions, Questions::Crossings(rays)
            if rays.iter().all(|ray| ray.is_valid() && ray.t_max == f32::INFINITY)));
    }

    #[test]
    fn a_box_larger_than_the_diagonal_is_cut() {
        let (_, sets) = sets(2.0);
        let within = |point: &Vec3| (*point - Vec3::new(3.0, 4.0, 1.0)).abs().max_element() <= 1.0;
        assert!(points(&sets[1]).iter().all(within));
    }

    #[test]
    fn sets_are_the_same_every_time() {
        assert_eq!(sets(10.0).1, sets(10.0).1);
    }
}
