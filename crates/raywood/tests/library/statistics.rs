//! Statistics of every structure: they add up, and `Q` is what rays cost that it is said to be.

use raywood::{Aabb, BuildOptions, Counts, Geometry, Hit, Level, PreparedRay, PrimitiveHit, Ray};
use raywood::{Structure, StructureKind, SurfacePoint, TriangleMesh, Vec3};
use raywood_testkit::{Rng, nasty, shapes};

/// A mesh that no ray hits, so that every ray goes through to the end.
struct Ghost(TriangleMesh);

impl Geometry for Ghost {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        self.0.bounds(primitive)
    }

    fn clipped_bounds(&self, primitive: u32, cell: &Aabb) -> Aabb {
        self.0.clipped_bounds(primitive, cell)
    }

    fn intersect(&self, _: u32, _: &PreparedRay) -> Option<PrimitiveHit> {
        None
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.0.surface_point(ray, hit)
    }
}

/// A line through a box, such that it meets a convex body in the box as often as the body's surface is large: from a point evenly
/// spread over the box's surface, inwards, by Lambert's law.
fn line_through(bounds: &Aabb, rng: &mut Rng) -> Ray {
    let e = bounds.extent();
    let areas = [e.y * e.z, e.z * e.x, e.x * e.y];
    let mut chosen = rng.unit() * areas.iter().sum::<f32>();
    let mut axis = 0;
    while axis < 2 && chosen >= areas[axis] {
        chosen -= areas[axis];
        axis += 1;
    }
    let mut origin = [0, 1, 2].map(|a| rng.range(bounds.min[a], bounds.max[a]));
    let upper = rng.unit() < 0.5;
    origin[axis] = if upper { bounds.max[axis] } else { bounds.min[axis] };

    let mut inwards = [0.0; 3];
    inwards[axis] = if upper { -1.0 } else { 1.0 };
    let direction = Vec3::from(inwards) + rng.direction();
    // From a little outside, so that rounding leaves no box behind the ray.
    Ray::new(Vec3::from(origin) - direction, direction)
}

#[test]
fn levels_add_up_for_every_structure_and_nasty_mesh() {
    for nasty in nasty::all() {
        for &kind in StructureKind::ALL {
            let structure = Structure::build(kind, &nasty.mesh, &BuildOptions::default());
            let structure = structure.expect("it builds");
            let stats = structure.stats();
            let what = format!("{}, {}: {stats}", kind.name(), nasty.name);
            let sum = |part: fn(&Level) -> usize| stats.levels.iter().map(part).sum::<usize>();
            assert_eq!(stats.primitives, nasty.mesh.len(), "{what}");
            assert_eq!(stats.nodes, sum(|level| level.nodes), "{what}");
            assert_eq!(stats.leaves, sum(|level| level.leaves), "{what}");
            assert_eq!(stats.references, sum(|level| level.references), "{what}");
            assert!(stats.references >= stats.primitives, "{what}");
            assert_eq!(stats.depth, stats.levels.len(), "{what}");
            assert_eq!(stats.depth == 0, nasty.mesh.is_empty(), "{what}");
            assert!(stats.levels.iter().all(|level| level.nodes > 0), "{what}");
            assert!(stats.q.is_finite() && stats.q >= 0.0, "{what}");

            // Parents come first, and have something inside.
            let (mut seen, mut above) = (vec![0; stats.depth + 1], 0);
            structure.visit_nodes(&mut |node| {
                assert!(node.level == 0 || seen[node.level - 1] > 0, "{what}: {node:?}");
                seen[node.level] += 1;
                above = above.max(node.level + usize::from(node.references.is_none()));
            });
            assert!(above < stats.depth.max(1), "{what}: a node without leaves below");
        }
    }
}

#[test]
fn q_is_what_a_ray_costs_that_hits_nothing() {
    let ghost = Ghost(shapes::soup(3000, 0.08, 5));
    for &kind in StructureKind::ALL {
        let structure = Structure::build(kind, &ghost, &BuildOptions::default()).expect("built");
        let stats = structure.stats();
        let mut root = None;
        structure.visit_nodes(&mut |node| root = root.or(Some(node.bounds)));
        let root = root.expect("a root");

        let (rays, mut rng, mut counts) = (20_000, Rng::new(1), Counts::default());
        for _ in 0..rays {
            let ray = line_through(&root, &mut rng);
            assert_eq!(structure.intersect_probed(&ray, &mut counts), None);
        }
        let nodes = counts.nodes as f64 / f64::from(rays);
        let primitives = counts.primitives as f64 / f64::from(rays);

        // What Q expects, in its two parts.
        let (mut q_nodes, mut q_primitives) = (0.0, 0.0);
        structure.visit_nodes(&mut |node| {
            let probability = node.bounds.half_area() / root.half_area();
            q_nodes += probability;
            q_primitives += probability * node.references.unwrap_or(0) as f64;
        });
        let what = format!(
            "{}: {nodes:.2} nodes and {primitives:.2} primitives a ray, Q {q_nodes:.2} + {q_primitives:.2}",
            kind.name()
        );
        assert!((stats.q - q_nodes - q_primitives).abs() < 1e-6 * stats.q, "{what}");
        assert!((nodes / q_nodes - 1.0).abs() < 0.03, "{what}");
        // In cells, a ray tests a primitive once that it meets many times.
        let ratio = primitives / q_primitives;
        let divides_space = stats.references > stats.primitives;
        let expected = if divides_space { 0.2..1.0 } else { 0.97..1.03 };
        assert!(expected.contains(&ratio), "{what}");
    }
}
