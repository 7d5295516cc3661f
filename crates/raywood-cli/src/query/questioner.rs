//! Asks a scene of rays and points, many at a time on all cores.

use rayon::prelude::*;
use raywood::{Bvh, Geometry, Ray, Solid, Vec3};
use raywood_render::{PreparedScene, Surfaces};
use raywood_scene::Scene;

use super::field::Field;
use super::kind::Kind;
use super::records::{self, Record};
use super::table::{Column, Lists, Table, Values};

/// The tree over all surfaces of a scene.
pub(crate) type SceneTree<'a> = Bvh<Surfaces<'a>>;

/// A question that rows of numbers are put to, a piece at a time.
pub(crate) struct Questioner<'a> {
    pub(crate) kind: Kind,
    /// The columns to answer in.
    pub(crate) fields: &'a [Field],
    /// Closest points further away do not count.
    pub(crate) max_distance: f32,
    /// Of lists of hits, only so many, the nearest.
    pub(crate) max_hits: Option<usize>,
    scene: &'a Scene,
    tree: &'a SceneTree<'a>,
    /// The scene as a solid, where the question needs that.
    solid: Option<Solid<'a, Surfaces<'a>>>,
}

impl<'a> Questioner<'a> {
    /// Makes what the question needs of a tree over the [surfaces](PreparedScene::surfaces) of a scene.
    pub(crate) fn new(
        kind: Kind,
        fields: &'a [Field],
        max_distance: f32,
        max_hits: Option<usize>,
        scene: &'a Scene,
        tree: &'a SceneTree<'a>,
    ) -> Self {
        debug_assert_eq!(tree.geometry().len(), PreparedScene::surfaces(scene).len());
        let solid = matches!(kind, Kind::Inside | Kind::SignedDistance).then(|| tree.solid());
        Self { kind, fields, max_distance, max_hits, scene, tree, solid }
    }

    /// The answers to rows of so many numbers: 3 of points; 6 or 8 of rays. `first` is the number of the first row.
    pub(crate) fn ask(&self, numbers: &[f32], width: usize, first: u64) -> Table {
        match self.kind {
            Kind::Closest => self.closest(&rays(numbers, width)),
            Kind::Any => self.any(&rays(numbers, width)),
            Kind::All => self.all(&rays(numbers, width), first),
            Kind::Count => self.count(&rays(numbers, width)),
            Kind::ClosestPoint => self.closest_point(&points(numbers)),
            Kind::Inside => self.inside(&points(numbers)),
            Kind::SignedDistance => self.signed_distance(&points(numbers)),
        }
    }

    fn closest(&self, rays: &[Ray]) -> Table {
        let mut hits = vec![None; rays.len()];
        self.tree.intersect_batch(rays, &mut hits);
        self.records(rays.len(), None, |row| {
            Record::of_hit(self.tree, &rays[row], hits[row].as_ref())
        })
    }

    fn any(&self, rays: &[Ray]) -> Table {
        let mut occluded = vec![false; rays.len()];
        self.tree.occluded_batch(rays, &mut occluded);
        let successes = occluded.iter().filter(|&&occluded| occluded).count();
        self.table(rays.len(), successes, |_| Values::Bool(occluded.clone()))
    }

    fn all(&self, rays: &[Ray], first: u64) -> Table {
        let lists = match self.max_hits {
            Some(most) => self.tree.nearest_hits_batch(rays, most),
            None => self.tree.all_hits_batch(rays),
        };
        let (hits, offsets) = lists.into_parts();
        let lists = Lists { first, offsets };
        let ray_of: Vec<_> = lists.questions().map(|row| (row - first) as usize).collect();
        self.records(hits.len(), Some(lists), |row| {
            Record::of_hit(self.tree, &rays[ray_of[row]], Some(&hits[row]))
        })
    }

    fn count(&self, rays: &[Ray]) -> Table {
        let count = |ray: &Ray| i32::try_from(self.tree.crossings(ray)).unwrap_or(i32::MAX);
        let counts: Vec<_> = rays.par_iter().with_min_len(64).map(count).collect();
        let successes = counts.iter().map(|&count| count as usize).sum();
        self.table(rays.len(), successes, |_| Values::I32(counts.clone()))
    }

    fn closest_point(&self, points: &[Vec3]) -> Table {
        let mut closest = vec![None; points.len()];
        self.tree.closest_point_batch(points, self.max_distance, &mut closest);
        self.records(points.len(), None, |row| Record::of_closest(closest[row].as_ref()))
    }

    fn inside(&self, points: &[Vec3]) -> Table {
        let mut winding = vec![0.0; points.len()];
        if let Some(solid) = &self.solid {
            solid.winding_number_batch(points, &mut winding);
        }
        // As `Solid::contains` has it.
        let is_inside = |&winding: &f32| winding >= 0.5;
        let successes = winding.iter().filter(|winding| is_inside(winding)).count();
        self.table(points.len(), successes, |field| match field {
            Field::WindingNumber => Values::F32(winding.clone()),
            _ => Values::Bool(winding.iter().map(is_inside).collect()),
        })
    }

    fn signed_distance(&self, points: &[Vec3]) -> Table {
        let mut distances = vec![None; points.len()];
        if let Some(solid) = &self.solid {
            solid.signed_distance_batch(points, &mut distances);
        }
        let successes = distances.iter().flatten().count();
        let numbers = distances.iter().map(|distance| distance.unwrap_or(f32::NAN));
        self.table(points.len(), successes, |_| Values::F32(numbers.clone().collect()))
    }

    /// A table of records.
    fn records(
        &self,
        rows: usize,
        lists: Option<Lists>,
        record: impl Fn(usize) -> Record + Send + Sync,
    ) -> Table {
        let (columns, successes) = records::columns(self.fields, self.scene, rows, record);
        Table { rows, columns, lists, successes }
    }

    /// A table of other columns.
    fn table(&self, rows: usize, successes: usize, values: impl Fn(Field) -> Values) -> Table {
        let column = |&field: &Field| Column { field, values: values(field) };
        let columns = self.fields.iter().map(column).collect();
        Table { rows, columns, lists: None, successes: successes as u64 }
    }
}

/// Rays of rows of 6 or 8 numbers.
fn rays(numbers: &[f32], width: usize) -> Vec<Ray> {
    let ray = |row: &[f32]| {
        let ray = Ray::new([row[0], row[1], row[2]], [row[3], row[4], row[5]]);
        if width == 8 { ray.with_interval(row[6], row[7]) } else { ray }
    };
    numbers.par_chunks_exact(width).with_min_len(4096).map(ray).collect()
}

/// Points of rows of 3 numbers.
fn points(numbers: &[f32]) -> Vec<Vec3> {
    numbers.chunks_exact(3).map(|row| Vec3::new(row[0], row[1], row[2])).collect()
}
