//! The answers that all others are held against: for a sample of the questions those of brute force in double precision, for the others Raywood's, asked one by one,
//! after these were held against brute force for the sample.

use rayon::prelude::*;
use raywood::{BuildError, Bvh, Ray, TriangleMesh, Vec3};
use raywood_testkit::{distance, oracle};

use super::answers::{Answers, Expected};
use super::sets::{QuerySet, Questions};

/// How many questions of each set brute force answers: each costs a look at every triangle in double precision.
const SAMPLE: usize = 32;

/// The mesh and the tree that answers.
pub(crate) struct Reference<'a> {
    mesh: &'a TriangleMesh,
    bvh: Bvh<&'a TriangleMesh>,
}

impl<'a> Reference<'a> {
    /// Builds the tree.
    ///
    /// # Errors
    ///
    /// The mesh is too large.
    pub(crate) fn build(mesh: &'a TriangleMesh) -> Result<Self, BuildError> {
        Ok(Self { mesh, bvh: Bvh::build(mesh)? })
    }

    /// What each question of the set should be answered.
    ///
    /// # Errors
    ///
    /// Brute force says otherwise about one of the sample.
    pub(crate) fn expected(&self, set: &QuerySet) -> Result<Expected, String> {
        let answers = match &set.questions {
            Questions::ClosestPoint(points) => Answers::Distances(self.distances(points)?),
            Questions::Crossings(rays) => Answers::Crossings(self.crossings(rays)?),
        };
        let bounds = self.mesh.total_bounds();
        let reach = f64::from(bounds.min.abs().max(bounds.max.abs()).max_element());
        Ok(Expected { answers, reach })
    }

    fn distances(&self, points: &[Vec3]) -> Result<Vec<f64>, String> {
        let distance = |&point: &Vec3| {
            let closest = self.bvh.closest_point(point, f32::INFINITY);
            closest.map_or(f64::INFINITY, |closest| f64::from(closest.distance))
        };
        let mut distances: Vec<_> = points.par_iter().map(distance).collect();
        let sample: Vec<_> = sample(points.len()).collect();
        let exact: Vec<_> =
            sample.par_iter().map(|&number| distance::to_mesh(points[number], self.mesh)).collect();
        for (number, exact) in sample.into_iter().zip(exact) {
            let found = distances[number];
            let tolerance = distance::tolerance(points[number], self.mesh, exact);
            // So that NaN is wrong.
            let right = (found - exact).abs() <= tolerance;
            if !right {
                return Err(format!("{found} from {:?}, it is {exact}", points[number]));
            }
            distances[number] = exact;
        }
        Ok(distances)
    }

    fn crossings(&self, rays: &[Ray]) -> Result<Vec<usize>, String> {
        let sample: Vec<_> = sample(rays.len()).collect();
        sample.par_iter().try_for_each(|&number| {
            let mut hits = Vec::new();
            self.bvh.all_hits(&rays[number], &mut hits);
            oracle::check_all(self.mesh, &rays[number], &hits, usize::MAX)
        })?;
        Ok(rays.par_iter().map(|ray| self.bvh.crossings(ray)).collect())
    }
}

/// The numbers of a sample of so many questions, evenly spread.
fn sample(questions: usize) -> impl Iterator<Item = usize> {
    let count = SAMPLE.min(questions);
    (0..count).map(move |i| i * questions / count)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::query::sets::{QueryKind, query_sets};

    #[test]
    fn cubes_are_as_far_as_they_are_and_crossed_once_from_inside() {
        let mesh = raywood_testkit::shapes::grid_box(1, Vec3::ZERO, Vec3::new(1.0, 2.0, 3.0));
        let reference = Reference::build(&mesh).expect("a tree");
        let diagonal = mesh.total_bounds().diagonal();
        for set in query_sets(QueryKind::ALL, &mesh, diagonal, 100) {
            let expected = reference.expected(&set).expect("brute force agrees");
            match (&set.questions, &expected.answers) {
                (Questions::ClosestPoint(points), Answers::Distances(distances)) => {
                    for (point, distance) in points.iter().zip(distances) {
                        let exact = distance::to_mesh(*point, &mesh);
                        assert!((distance - exact).abs() <= 1e-6 * exact.max(1.0));
                    }
                }
                (Questions::Crossings(_), Answers::Crossings(crossings)) => {
                    assert!(crossings.iter().all(|&count| count == 1), "{crossings:?}");
                }
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn samples_are_spread_over_all_questions() {
        assert_eq!(sample(3).collect::<Vec<_>>(), [0, 1, 2]);
        assert_eq!(sample(0).count(), 0);
        let many: Vec<_> = sample(6400).collect();
        assert_eq!((many.len(), many[1], many[31]), (SAMPLE, 200, 6200));
    }
}
