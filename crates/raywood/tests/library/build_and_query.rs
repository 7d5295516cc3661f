//! Bytes as a small program against the library: a geometry of any numbers, a tree by any options, every query, every change. Answers are held against those of no tree at all, and
//! trees against their invariants. The fuzz target of the same name runs this file on bytes of its own choice.

#![allow(unreachable_pub)]

use std::ops::ControlFlow;
use std::sync::Arc;

use arbitrary::Unstructured;
use raywood::{
    Aabb, Ball, BuildOptions, BuildPreset, Builder, Bvh, ClosestPoint, DynamicBvh, Face, Frustum,
    Geometry, Hit, Instance, Joined, QueryOptions, Ray, Region, SimdLevel, Spheres, Structure,
    StructureKind, Tlas, Transform, TriangleMesh, TriangleTest, UpdateOptions, Vec3,
};
use raywood_testkit::distance;

/// What is traced: triangles and spheres.
type Things = Joined<TriangleMesh, Spheres>;

/// Runs the bytes; fails if the library does.
pub fn run(bytes: &[u8]) {
    // Where the bytes end, zeros follow: reading never fails for good.
    let _ = Program { bytes: Unstructured::new(bytes), largest: 0.0 }.run();
}

/// Coordinates beyond this may overflow, and then hits may be missed: `docs/numerics.md`, "Ranges".
const LARGEST: f32 = 1e37;

/// Numbers that arithmetic stumbles over.
const ODD: [f32; 20] = [
    0.0,
    -0.0,
    1e-45,
    -1e-40,
    f32::MIN_POSITIVE,
    1e-30,
    1e-18,
    f32::EPSILON,
    1.0 - f32::EPSILON / 2.0,
    1.0 + f32::EPSILON,
    16_777_216.0,
    -148_376.0,
    1e18,
    -1e30,
    LARGEST,
    f32::MAX,
    f32::MIN,
    f32::INFINITY,
    f32::NEG_INFINITY,
    f32::NAN,
];

struct Program<'a> {
    bytes: Unstructured<'a>,
    /// The largest coordinate of the geometry.
    largest: f32,
}

type Outcome<T> = arbitrary::Result<T>;

impl Program<'_> {
    fn run(&mut self) -> Outcome<()> {
        let Some(things) = self.things()? else { return Ok(()) };
        let options = self.options()?;
        let rays = self.list(24, |program| program.ray(&things.first))?;
        let points = self.list(8, Self::point)?;

        self.every_structure(&things, &options, &rays)?;
        let Ok(mut bvh) = Bvh::build_with(things.clone(), &options) else {
            // Only what is asked for can be too much: the numbers were looked at before.
            assert!(options.memory_limit.is_some(), "a sound geometry is refused");
            return Ok(());
        };
        self.level_of(&mut bvh)?;
        self.ask(&bvh, &options, &rays, &points)?;
        self.change(bvh, &options, &rays, &points)?;
        self.instances(&things, &options, &rays)
    }

    fn byte(&mut self) -> Outcome<u8> {
        self.bytes.arbitrary()
    }

    fn below(&mut self, limit: usize) -> Outcome<usize> {
        self.bytes.int_in_range(0..=limit.max(1) - 1)
    }

    /// A number: most often a multiple of a sixteenth, so that coordinates agree; at times an odd one or any bits at all.
    fn number(&mut self) -> Outcome<f32> {
        Ok(match self.byte()? {
            0..200 => f32::from(self.bytes.arbitrary::<i8>()?) / 16.0,
            200..240 => ODD[self.below(ODD.len())?],
            _ => f32::from_bits(self.bytes.arbitrary()?),
        })
    }

    fn point(&mut self) -> Outcome<Vec3> {
        Ok(Vec3::new(self.number()?, self.number()?, self.number()?))
    }

    fn list<T>(
        &mut self,
        most: usize,
        mut each: impl FnMut(&mut Self) -> Outcome<T>,
    ) -> Outcome<Vec<T>> {
        let count = self.below(most + 1)?;
        (0..count).map(|_| each(self)).collect()
    }

    /// A point as it is, or with what is no number left out.
    fn vertex(&mut self, sound: bool) -> Outcome<Vec3> {
        let point = self.point()?;
        let sound = |x: f32| if sound && !x.is_finite() { 1.0 } else { x };
        Ok(Vec3::from(point.to_array().map(sound)))
    }

    /// A geometry; `None` if it is refused, as it must be.
    fn things(&mut self) -> Outcome<Option<Things>> {
        let sound = self.byte()? < 240;
        let positions = self.list(40, |program| program.vertex(sound))?;
        let indices = positions.len() + usize::from(!sound);
        let triangles = match indices {
            0 => Vec::new(),
            _ => self.list(60, |program| {
                let mut index = || Ok(program.below(indices)? as u32);
                Ok([index()?, index()?, index()?])
            })?,
        };
        // The same again and again, so that leaves overflow.
        let copies = if self.byte()? < 230 { 1 } else { 6 };
        let triangles = triangles.repeat(copies);
        let spheres = self.list(10, |program| {
            let center = program.vertex(sound)?;
            let radius = program.number()?;
            Ok((center, if sound && !radius.is_finite() { 0.5 } else { radius.abs() }))
        })?;

        let is_finite = positions.iter().all(|p| p.is_finite());
        let in_range = triangles.iter().flatten().all(|&i| (i as usize) < positions.len());
        let coordinates = positions.iter().map(|p| p.abs().max_element());
        let reach = spheres.iter().map(|(center, radius)| center.abs().max_element() + radius);
        self.largest = coordinates.chain(reach).fold(0.0, f32::max);
        let mesh = TriangleMesh::new(positions, triangles);
        assert_eq!(mesh.is_ok(), is_finite && in_range, "{mesh:?}");
        Ok(match (mesh, Spheres::new(spheres)) {
            (Ok(first), Ok(second)) => Some(Joined { first, second }),
            _ => None,
        })
    }

    /// Options, in their ranges and outside.
    fn options(&mut self) -> Outcome<BuildOptions> {
        let presets = BuildPreset::ALL;
        let mut options = presets[self.below(presets.len())?].options();
        if self.byte()? < 100 {
            return Ok(options);
        }
        const BUILDERS: [Builder; 7] = [
            Builder::Midpoint,
            Builder::Median,
            Builder::SahSweep,
            Builder::SahBinned,
            Builder::Lbvh,
            Builder::Hlbvh,
            Builder::Ploc,
        ];
        options.wide_builder = BUILDERS[self.below(BUILDERS.len())?];
        options.bins = self.below(40)?;
        options.max_leaf_size = self.below(40)?;
        options.wide_leaf_size = self.below(12)?;
        options.octree_leaf_size = self.below(12)?;
        options.octree_max_depth = self.below(30)?;
        options.rotation_passes = self.below(3)?;
        options.reinsertion_passes = [None, Some(0), Some(1), Some(3)][self.below(4)?];
        for place in [
            &mut options.spatial_splits,
            &mut options.node_cost,
            &mut options.primitive_cost,
            &mut options.reinsertion_share,
            &mut options.reinsertion_gain,
            &mut options.grid_density,
            &mut options.kd_empty_bonus,
        ] {
            if self.byte()? < 80 {
                *place = self.number()?;
            }
        }
        if self.byte()? > 250 {
            options.triangle_test = TriangleTest::Fast;
        }
        if self.byte()? > 250 {
            options.memory_limit = Some(self.bytes.arbitrary::<u16>()?.into());
        }
        Ok(options)
    }

    /// A ray: at vertices and edges, along axes, between points, or of any numbers.
    fn ray(&mut self, mesh: &TriangleMesh) -> Outcome<Ray> {
        let from = self.point()?;
        let kind = self.byte()?;
        let to = match (kind % 4, mesh.triangles().len()) {
            (0 | 1, count @ 1..) => {
                let [a, b, c] = mesh.corners(self.below(count)? as u32);
                [a, 0.5 * (a + b), 0.25 * (a + b) + 0.5 * c, b][usize::from(kind / 4 % 4)]
            }
            (2, _) => {
                let mut to = from;
                let axis = self.below(3)?;
                let step = if kind & 4 == 0 { 1.0 } else { -1.0 };
                match axis {
                    0 => to.x += step,
                    1 => to.y += step,
                    _ => to.z += step,
                }
                to
            }
            _ => self.point()?,
        };
        let ray = Ray::new(from, to - from);
        Ok(match kind {
            0..192 => ray,
            192..224 => ray.with_interval(0.0, 1.0),
            _ => ray.with_interval(self.number()?, self.number()?),
        })
    }

    /// Chooses vector instructions.
    fn level_of<G: Geometry>(&mut self, bvh: &mut Bvh<G>) -> Outcome<()> {
        bvh.set_simd_level(SimdLevel::ALL[self.below(SimdLevel::ALL.len())?]);
        Ok(())
    }

    /// Whether hits are promised to be those of no tree, to the bit.
    fn is_exact(&self, options: &BuildOptions) -> bool {
        let splits = options.spatial_splits > 0.0;
        self.largest <= LARGEST && !splits && options.triangle_test == TriangleTest::Watertight
    }

    /// Whether that holds of this ray too.
    fn is_in_range(ray: &Ray) -> bool {
        !ray.is_valid() || ray.origin.abs().max_element() <= LARGEST
    }

    /// Any structure: valid, and with the hits of brute force.
    fn every_structure(
        &mut self,
        things: &Things,
        options: &BuildOptions,
        rays: &[Ray],
    ) -> Outcome<()> {
        let kind = StructureKind::ALL[self.below(StructureKind::ALL.len())?];
        let Ok(structure) = Structure::build(kind, things, options) else {
            assert!(options.memory_limit.is_some(), "{kind:?}: a sound geometry is refused");
            return Ok(());
        };
        structure.validate().unwrap_or_else(|error| panic!("{kind:?}: {error}"));
        structure.stats();
        let brute = brute_force(things);
        let mut hits = vec![None; rays.len()];
        let mut occluded = vec![false; rays.len()];
        structure.intersect_batch_serial(rays, &mut hits);
        structure.occluded_batch_serial(rays, &mut occluded);
        let exact = self.is_exact(options) || kind != StructureKind::BvhWide;
        for (number, ray) in rays.iter().enumerate() {
            let hit = structure.intersect(ray);
            check_hit(things, ray, hit);
            if exact && self.largest <= LARGEST && Self::is_in_range(ray) {
                assert_eq!(hit, brute.intersect(ray), "{kind:?}: {ray:?}");
                assert_eq!(structure.occluded(ray), hit.is_some(), "{kind:?}: {ray:?}");
                assert_eq!(occluded[number], hit.is_some(), "{kind:?}: {ray:?}");
            }
            check_hit(things, ray, hits[number]);
        }
        Ok(())
    }

    /// Asks a tree everything.
    fn ask(
        &mut self,
        bvh: &Bvh<Things>,
        options: &BuildOptions,
        rays: &[Ray],
        points: &[Vec3],
    ) -> Outcome<()> {
        bvh.validate().unwrap_or_else(|error| panic!("{options:?}: {error}"));
        let things = bvh.geometry();
        let brute = brute_force(things);
        let exact = self.is_exact(options);
        let mut found = Vec::new();
        for ray in rays {
            let hit = bvh.intersect(ray);
            check_hit(things, ray, hit);
            if exact && Self::is_in_range(ray) {
                assert_eq!(hit, brute.intersect(ray), "{ray:?}");
                assert_eq!(bvh.occluded(ray), hit.is_some(), "{ray:?}");
            }
            self.ask_for_many(bvh, ray, &mut found)?;
            self.ask_with_options(bvh, ray, hit, options.triangle_test)?;
            let _ = bvh.sphere_cast(ray, self.number()?);
        }
        self.ask_in_batches(bvh, rays, points)?;
        for &point in points {
            self.ask_of_space(bvh, point)?;
        }
        self.ask_of_regions(bvh)
    }

    /// All hits, the nearest of them, how many there are.
    fn ask_for_many(&mut self, bvh: &Bvh<Things>, ray: &Ray, found: &mut Vec<Hit>) -> Outcome<()> {
        bvh.all_hits(ray, found);
        assert!(found.windows(2).all(|pair| {
            (pair[0].t, pair[0].primitive) < (pair[1].t, pair[1].primitive)
                || pair[0] == pair[1] && pair[0].primitive as usize >= bvh.geometry().first.len()
        }));
        for &hit in &*found {
            check_hit(bvh.geometry(), ray, Some(hit));
        }
        assert_eq!(bvh.crossings(ray), found.len());
        let k = self.below(6)?;
        let mut nearest = Vec::new();
        bvh.nearest_hits(ray, k, &mut nearest);
        assert_eq!(nearest, found[..k.min(found.len())], "{ray:?}");
        Ok(())
    }

    /// Queries whose hits are chosen.
    fn ask_with_options(
        &mut self,
        bvh: &Bvh<Things>,
        ray: &Ray,
        hit: Option<Hit>,
        test: TriangleTest,
    ) -> Outcome<()> {
        let all = QueryOptions::new();
        assert_eq!(bvh.intersect_with(ray, all), hit);
        let choice = self.byte()?;
        let options = match choice % 4 {
            0 => all.cull(Face::Front),
            1 => all.cull(Face::Back),
            2 => all.skip(hit.map_or(0, |hit| hit.primitive)),
            _ => all.mask(choice.into()),
        };
        let chosen = bvh.intersect_with(ray, options);
        check_hit(bvh.geometry(), ray, chosen);
        assert_eq!(bvh.occluded_with(ray, options), chosen.is_some());
        // The fast test's distances may lie before the boxes of what is hit, if that is large enough: then the order of the walk decides.
        let in_range = self.largest <= LARGEST && Self::is_in_range(ray);
        if in_range && test == TriangleTest::Watertight {
            let no_nearer = chosen.is_none_or(|chosen| hit.is_some_and(|hit| hit.t <= chosen.t));
            assert!(no_nearer, "{chosen:?} before {hit:?}: {ray:?}, up to {}", self.largest);
        }
        let odd = options.filter(|hit: &Hit| hit.primitive % 2 == 1);
        let odd = bvh.intersect_with(ray, odd);
        assert!(odd.is_none_or(|hit| hit.primitive % 2 == 1));
        bvh.all_hits_with(ray, options, &mut Vec::new());
        bvh.nearest_hits_with(ray, 2, options, &mut Vec::new());
        Ok(())
    }

    /// Batches, packets among them.
    fn ask_in_batches(&mut self, bvh: &Bvh<Things>, rays: &[Ray], points: &[Vec3]) -> Outcome<()> {
        let things = bvh.geometry();
        // The same ones often, a little turned, so that they travel together.
        let shift = self.number()?;
        let many: Vec<_> = (0..4u8)
            .flat_map(|turn| {
                rays.iter().map(move |ray| {
                    let direction = ray.direction + f32::from(turn) * shift * 1e-3 * Vec3::X;
                    Ray { direction, ..*ray }
                })
            })
            .collect();
        let (mut hits, mut occluded) = (vec![None; many.len()], vec![true; many.len()]);
        bvh.intersect_batch(&many, &mut hits);
        bvh.occluded_batch(&many, &mut occluded);
        for (number, ray) in many.iter().enumerate() {
            check_hit(things, ray, hits[number]);
            assert_eq!(occluded[number], bvh.occluded(ray), "{ray:?}");
        }
        if let Some(&eye) = points.first() {
            let directions: Vec<_> = many.iter().map(|ray| ray.direction).collect();
            let mut columns = raywood::HitColumns::default();
            bvh.intersect_from(eye, &directions, &mut columns);
            let mut shadowed = vec![false; directions.len()];
            bvh.occluded_towards(eye, 0.999, &directions, &mut shadowed);
        }
        bvh.all_hits_batch(rays);
        bvh.nearest_hits_batch(rays, 2);
        bvh.sphere_cast_batch(rays, shift, &mut vec![None; rays.len()]);
        bvh.closest_point_batch(points, shift, &mut vec![None; points.len()]);
        let solid = bvh.solid();
        solid.winding_number_batch(points, &mut vec![0.0; points.len()]);
        solid.signed_distance_batch(points, &mut vec![None; points.len()]);
        Ok(())
    }

    /// The closest point and what is inside.
    fn ask_of_space(&mut self, bvh: &Bvh<Things>, point: Vec3) -> Outcome<()> {
        let things = bvh.geometry();
        let closest = bvh.closest_point(point, f32::INFINITY);
        if let Some(ClosestPoint { primitive, distance, point: there, .. }) = closest {
            assert!((primitive as usize) < things.len() && distance >= 0.0 && there.is_finite());
            // Its own distance is no less than that of any box around it.
            let limited = bvh.closest_point(point, distance);
            assert_eq!(limited, closest, "{point:?}, up to {}", self.largest);
        }
        // Alone, triangles have an oracle.
        let small = self.largest < 1e6 && point.is_finite() && point.abs().max_element() < 1e6;
        if small && things.second.as_slice().is_empty() && !things.is_empty() {
            let expected = distance::to_mesh(point, &things.first);
            let found = closest.map_or(f64::NAN, |closest| closest.distance.into());
            let tolerance = distance::tolerance(point, &things.first, expected);
            assert!((found - expected).abs() <= tolerance, "{found}, not {expected}: {point:?}");
        }
        let _ = bvh.closest_point(point, self.number()?);
        let solid = bvh.solid();
        solid.contains(point);
        solid.signed_distance(point);
        Ok(())
    }

    /// What overlaps regions and itself.
    fn ask_of_regions(&mut self, bvh: &Bvh<Things>) -> Outcome<()> {
        let (a, b) = (self.point()?, self.point()?);
        check_region(bvh, &Aabb { min: a, max: b });
        check_region(bvh, &Aabb { min: a.min(b), max: a.max(b) });
        check_region(bvh, &Ball::new(a, b.x));
        let corners = [(); 8].map(|()| self.point().unwrap_or(Vec3::ZERO));
        check_region(bvh, &Frustum::from_corners(corners));
        let mut pairs = 0;
        let _ = bvh.overlapping_pairs(bvh, |first, second| {
            assert!((first.max(second) as usize) < bvh.geometry().len());
            pairs += 1;
            ControlFlow::Continue(())
        });
        assert_eq!(bvh.overlaps_any_of(bvh), pairs > 0);
        let mut visited = 0;
        let _ = bvh.visit(
            |_| Some(0.0),
            |primitive| {
                assert!((primitive as usize) < bvh.geometry().len());
                visited += 1;
                ControlFlow::Continue(f32::INFINITY)
            },
        );
        assert_eq!(visited, bvh.geometry().len());
        Ok(())
    }

    /// Moves vertices, lets trees follow, and asks them again.
    fn change(
        &mut self,
        mut bvh: Bvh<Things>,
        options: &BuildOptions,
        rays: &[Ray],
        points: &[Vec3],
    ) -> Outcome<()> {
        let update = UpdateOptions {
            build: options.clone(),
            max_growth: self.number()?.into(),
            max_repair_share: self.number()?.into(),
        };
        let things = bvh.geometry().clone();
        let Ok(mut followed) = DynamicBvh::build_with(things, update) else { return Ok(()) };
        for _ in 0..self.below(4)? {
            let Some(moved) = self.moved(bvh.geometry())? else { continue };
            bvh.refit(moved.clone()).expect("as many, and sound");
            self.ask(&bvh, options, rays, points)?;
            match followed.update(moved) {
                Ok(update) => assert!(!update.cost.is_nan(), "{update}"),
                Err(error) => assert!(options.memory_limit.is_some(), "{error}"),
            }
            self.ask(followed.bvh(), options, rays, points)?;
        }
        // Others in their place.
        if let Some(others) = self.things()? {
            let same = others.len() == bvh.geometry().len();
            assert_eq!(bvh.refit(others.clone()).is_ok(), same);
            if followed.update(others).is_ok() {
                self.ask(followed.bvh(), options, rays, points)?;
            }
        }
        Ok(())
    }

    /// The same with some of its vertices elsewhere; `None` if that is refused.
    fn moved(&mut self, things: &Things) -> Outcome<Option<Things>> {
        let sound = self.byte()? < 240;
        let mut positions = things.first.positions().to_vec();
        for _ in 0..self.below(10)? {
            let place = self.below(positions.len())?;
            let vertex = self.vertex(sound)?;
            if let Some(position) = positions.get_mut(place) {
                *position = vertex;
                self.largest = self.largest.max(vertex.abs().max_element());
            }
        }
        let is_finite = positions.iter().all(|p| p.is_finite());
        let first = things.first.with_positions(positions);
        assert_eq!(first.is_ok(), is_finite);
        Ok(first.ok().map(|first| Joined { first, second: things.second.clone() }))
    }

    /// A transform: of any numbers, or a sound one.
    fn transform(&mut self) -> Outcome<Transform> {
        let by = self.point()?;
        Ok(match self.byte()? % 4 {
            0 => Transform::translation(by),
            1 => Transform::scaling(by),
            2 => Transform::rotation(by, self.number()?).then(&Transform::translation(by)),
            _ => {
                let mut rows = [[0.0; 4]; 3];
                for number in rows.as_flattened_mut() {
                    *number = self.number()?;
                }
                Transform::from_rows(rows)
            }
        })
    }

    fn instance(&mut self, object: &Arc<Bvh<Things>>) -> Outcome<Instance<Bvh<Things>>> {
        let transform = self.transform()?;
        let mask = if self.byte()? < 200 { u32::MAX } else { self.byte()?.into() };
        Ok(Instance { mask, ..Instance::new(Arc::clone(object), transform) })
    }

    /// A scene of instances that move, come and go: always as one that is built anew.
    fn instances(&mut self, things: &Things, options: &BuildOptions, rays: &[Ray]) -> Outcome<()> {
        let Ok(object) = Bvh::build(things.clone()) else { return Ok(()) };
        let object = Arc::new(object);
        let instances = self.list(6, |program| program.instance(&object))?;
        let Ok(mut scene) = Tlas::build_with(instances, options) else { return Ok(()) };
        check_scene(&scene, rays);
        for _ in 0..self.below(6)? {
            let count = scene.instances().len();
            match self.byte()? % 4 {
                0 => {
                    scene.insert(self.instance(&object)?);
                }
                1 => {
                    scene.remove(self.below(count + 1)?);
                }
                _ if count > 0 => scene.set_transform(self.below(count)?, self.transform()?),
                _ => {}
            }
            // What was built before still answers.
            for ray in rays {
                assert_eq!(scene.occluded(ray), scene.intersect(ray).is_some(), "{ray:?}");
            }
            let done = match self.byte()? % 2 {
                0 => scene.rebuild().is_ok(),
                _ => scene.update(self.number()?.into()).is_ok(),
            };
            if done {
                check_scene(&scene, rays);
            }
        }
        Ok(())
    }
}

/// No tree at all.
fn brute_force(things: &Things) -> Structure<&Things> {
    let kind = StructureKind::BruteForce;
    Structure::build(kind, things, &BuildOptions::default()).expect("nothing is built")
}

/// That a hit is one of the geometry and lies in the interval; and asks for the next ray.
fn check_hit(things: &Things, ray: &Ray, hit: Option<Hit>) {
    let Some(hit) = hit else { return };
    assert!(ray.is_valid() && (hit.primitive as usize) < things.len(), "{hit:?}: {ray:?}");
    assert!(ray.t_min <= hit.t && hit.t < ray.t_max, "{hit:?}: {ray:?}");
    let point = things.surface_point(ray, &hit);
    let _ = point.spawn(Vec3::ONE);
}

/// That a region is told of primitives that there are, each once, and of some if it is said to.
fn check_region<R: Region>(bvh: &Bvh<Things>, region: &R) {
    let mut told = Vec::new();
    let _ = bvh.overlapping(region, |primitive| {
        told.push(primitive);
        ControlFlow::Continue(())
    });
    assert_eq!(bvh.overlaps(region), !told.is_empty());
    told.sort_unstable();
    assert!(told.windows(2).all(|pair| pair[0] < pair[1]), "{told:?}");
    assert!(told.last().is_none_or(|&last| (last as usize) < bvh.geometry().len()));
}

/// That a scene's hits are those of one that is built anew.
fn check_scene(scene: &Tlas<Bvh<Things>>, rays: &[Ray]) {
    let fresh = Tlas::build(scene.instances().to_vec()).expect("it was built of them before");
    for ray in rays {
        let hit = scene.intersect(ray);
        assert_eq!(hit, fresh.intersect(ray), "{ray:?}");
        assert_eq!(scene.occluded(ray), hit.is_some(), "{ray:?}");
        let masked = scene.intersect_masked(ray, 5);
        assert_eq!(scene.occluded_masked(ray, 5), masked.is_some(), "{ray:?}");
        if let Some(hit) = hit {
            let (instance, _) = scene.locate(hit.instance);
            assert!(instance < scene.instances().len());
            let _ = scene.surface_point(ray, &hit).spawn(Vec3::ONE);
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::Path;

    use raywood_testkit::Rng;

    use super::run;

    #[test]
    fn any_program_runs() {
        let mut rng = Rng::new(1);
        for length in [0, 1, 7, 60, 400, 2000] {
            for _ in 0..40 {
                let bytes: Vec<_> = (0..length).map(|_| rng.bits() as u8).collect();
                run(&bytes);
            }
        }
    }

    #[test]
    fn what_fuzzing_found_does_no_harm() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../fuzz/found/build_and_query");
        // A package on its own has no such folder.
        let Ok(entries) = fs::read_dir(&folder) else { return };
        let mut count = 0;
        for entry in entries {
            run(&fs::read(entry.expect("an entry").path()).expect("a file"));
            count += 1;
        }
        assert!(count > 10, "{count}");
    }
}
