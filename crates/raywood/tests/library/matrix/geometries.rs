//! The axis of geometries: some primitives of every kind, each of them twice, and what they are by themselves.

use std::sync::Arc;

use raywood::{
    Aabb, Assembly, Boxes, Capsule, Capsules, Cylinder, Cylinders, Disc, Discs, Geometry, Hit,
    Joined, MeshPart, MeshView, PreparedRay, PrimitiveHit, Quads, Ray, Spheres, Strided,
    SurfacePoint, TriangleMesh, Vec3,
};
use raywood_testkit::reference::{Shape, in_double};
use raywood_testkit::solids::Solid;
use raywood_testkit::{Rng, shapes};

/// Any geometry: so that everything is compiled once.
pub(crate) type Shared = Arc<dyn Geometry + Send>;

/// A primitive, its groups, and whether its geometry tells of closest points.
#[derive(Clone, Copy)]
pub(crate) struct Primitive {
    pub(crate) shape: Shape,
    pub(crate) mask: u32,
    pub(crate) tells_points: bool,
}

/// A geometry and its primitives by themselves.
pub(crate) struct Case {
    pub(crate) name: &'static str,
    pub(crate) geometry: Shared,
    pub(crate) primitives: Vec<Primitive>,
}

/// Points of this lattice are the same in every placement.
pub(crate) fn on_lattice(p: Vec3) -> Vec3 {
    p.to_array().map(|x| (256.0 * x).round() / 256.0).into()
}

/// A box, triangles all over it, a line and a point.
pub(crate) fn triangles() -> Vec<[Vec3; 3]> {
    let cube = shapes::grid_box(1, Vec3::splat(-0.5), Vec3::splat(0.5));
    let soup = shapes::soup(12, 0.9, 3);
    let all = (0..12).map(|n| cube.corners(n)).chain((0..12).map(|n| soup.corners(n)));
    let mut all: Vec<_> = all.map(|corners| corners.map(on_lattice)).collect();
    let [a, b, _] = all[14];
    all.extend([[a, b, b], [a; 3]]);
    all
}

/// Vertices and their numbers, three for each triangle.
fn vertices(triangles: &[[Vec3; 3]]) -> (Vec<Vec3>, Vec<[u32; 3]>) {
    // Corners of the box are shared, so that its edges are.
    let mut positions: Vec<Vec3> = Vec::new();
    let mut number = |p: Vec3| {
        let known = positions.iter().position(|&other| other == p);
        known.unwrap_or_else(|| {
            positions.push(p);
            positions.len() - 1
        }) as u32
    };
    let indices = triangles.iter().map(|corners| corners.map(&mut number)).collect();
    (positions, indices)
}

fn solids(kind: usize) -> Vec<Solid> {
    let mut rng = Rng::new(50 + kind as u64);
    let one = |number: usize| {
        let center = on_lattice(0.8 * rng.in_cube());
        let size = 2f32.powi(-((number % 4) as i32)) * rng.range(0.2, 0.4);
        let axis = if number.is_multiple_of(3) { Vec3::Y } else { rng.direction() };
        let end = center + rng.range(0.3, 1.0) * axis;
        match kind {
            0 => Solid::Ball(center, size),
            1 => Solid::Disc(Disc {
                normal: axis.normalize_or_zero(),
                ..Disc::new(center, axis, size)
            }),
            2 => Solid::Capsule(Capsule::new(center, end, 0.5 * size)),
            3 => Solid::Cylinder(Cylinder::new(center, end, 0.5 * size)),
            _ => {
                let reach = on_lattice(size * Vec3::new(1.0, rng.range(0.2, 1.0), 0.75));
                Solid::Box(Aabb::new(center - reach, center + reach))
            }
        }
    };
    (0..10).map(one).collect()
}

/// Every second time all of them again.
fn twice<T: Clone>(list: &[T]) -> Vec<T> {
    [list, list].concat()
}

/// Geometry and primitives of solids of a kind.
fn of_solids(kind: usize) -> (Shared, Vec<Solid>) {
    let all = twice(&solids(kind));
    macro_rules! pick {
        ($pattern:pat => $value:expr) => {
            all.iter()
                .filter_map(|solid| match *solid {
                    $pattern => Some($value),
                    _ => None,
                })
                .collect()
        };
    }
    let geometry: Shared = match kind {
        0 => Arc::new(Spheres::new(pick!(Solid::Ball(c, r) => (c, r))).expect("spheres")),
        1 => Arc::new(Discs::new(pick!(Solid::Disc(disc) => disc)).expect("discs")),
        2 => Arc::new(Capsules::new(pick!(Solid::Capsule(capsule) => capsule)).expect("capsules")),
        3 => Arc::new(Cylinders::new(pick!(Solid::Cylinder(c) => c)).expect("cylinders")),
        _ => Arc::new(Boxes::new(pick!(Solid::Box(corners) => corners)).expect("boxes")),
    };
    (geometry, all)
}

/// A user's own type that says no more than it must: spheres that nobody knows to be some, in groups.
struct Least(Spheres);

impl Geometry for Least {
    fn len(&self) -> usize {
        self.0.len()
    }

    fn bounds(&self, primitive: u32) -> Aabb {
        self.0.bounds(primitive)
    }

    fn intersect(&self, primitive: u32, ray: &PreparedRay) -> Option<PrimitiveHit> {
        self.0.intersect(primitive, ray)
    }

    fn mask(&self, primitive: u32) -> u32 {
        1 << (primitive % 3)
    }

    fn surface_point(&self, ray: &Ray, hit: &Hit) -> SurfacePoint {
        self.0.surface_point(ray, hit)
    }
}

/// All of them.
pub(crate) fn all() -> Vec<Case> {
    let corners = twice(&triangles());
    let (positions, indices) = vertices(&corners);
    let mesh = || TriangleMesh::new(positions.clone(), indices.clone()).expect("a mesh");
    let told = |shape| Primitive { shape, mask: u32::MAX, tells_points: true };
    let of_triangles = |corners: &[[Vec3; 3]]| -> Vec<Primitive> {
        corners.iter().map(|c| told(Shape::Triangle(c.map(in_double)))).collect()
    };
    let of_list = |solids: &[Solid]| -> Vec<Primitive> {
        solids.iter().map(|&solid| told(Shape::Solid(solid))).collect()
    };
    let mut all = Vec::new();
    let mut add = |name, geometry: Shared, primitives| {
        all.push(Case { name, geometry, primitives });
    };

    // Triangles however they are stored.
    add("triangle mesh", Arc::new(mesh()), of_triangles(&corners));
    let arrays: Vec<[f32; 3]> = positions.iter().map(|p| p.to_array()).collect();
    let short: Vec<u16> = indices.iter().flatten().map(|&index| index as u16).collect();
    let view = MeshView::new(arrays.clone(), short).expect("a mesh");
    add("arrays with u16 indices", Arc::new(view), of_triangles(&corners));
    let tiny: Vec<[u8; 3]> = indices.iter().map(|t| t.map(|index| index as u8)).collect();
    // With a number of two bytes before and one of three behind each vertex.
    let mut bytes = Vec::new();
    for p in &arrays {
        bytes.extend([1, 2]);
        bytes.extend(p.iter().flat_map(|x| x.to_ne_bytes()));
        bytes.extend([3, 4, 5]);
    }
    let strided = Strided::of_bytes(bytes, 2, 17).expect("vertices");
    let view = MeshView::new(strided, tiny).expect("a mesh");
    add("strided bytes with u8 triples", Arc::new(view), of_triangles(&corners));
    let floats: Vec<f32> = arrays.iter().flat_map(|&[x, y, z]| [x, y, z, 0.5, -7.0]).collect();
    let strided = Strided::of_floats(floats, 0, 5).expect("vertices");
    let view = MeshView::new(strided, indices.clone()).expect("a mesh");
    add("strided floats with u32 triples", Arc::new(view), of_triangles(&corners));
    let soup: Vec<glam::Vec3> =
        corners.as_flattened().iter().map(|p| glam::Vec3::from(p.to_array())).collect();
    add("points of glam without indices", Arc::new(MeshView::soup(soup).expect("a soup")), {
        of_triangles(&corners)
    });
    // It must outlive everything: once for each run of the tests.
    let whole: &'static TriangleMesh = Box::leak(Box::new(mesh()));
    let part = MeshPart::new(whole, 4..40);
    add("part of a mesh", Arc::new(part), of_triangles(&corners[4..40]));

    // Quads are two triangles each.
    let mut rng = Rng::new(9);
    let mut point = || on_lattice(rng.in_cube());
    let quads: Vec<[Vec3; 4]> = (0..10).map(|_| [(); 4].map(|()| point())).collect();
    let quads = twice(&quads);
    let halves: Vec<_> = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, d], [c, d, b]]).collect();
    let numbers = (0..20).map(|q| [4 * q, 4 * q + 1, 4 * q + 2, 4 * q + 3]).collect();
    let geometry = Quads::new(quads.concat(), numbers).expect("quads");
    add("quads", Arc::new(geometry), of_triangles(&halves));

    for (kind, name) in
        ["spheres", "discs", "capsules", "cylinders", "boxes"].into_iter().enumerate()
    {
        let (geometry, list) = of_solids(kind);
        add(name, geometry, of_list(&list));
    }

    // Several kinds together.
    let balls = twice(&solids(0));
    let spheres = |balls: &[Solid]| {
        let list = balls.iter().filter_map(|solid| match *solid {
            Solid::Ball(center, radius) => Some((center, radius)),
            _ => None,
        });
        Spheres::new(list.collect()).expect("spheres")
    };
    let joined = Joined { first: mesh(), second: spheres(&balls) };
    add("two kinds joined", Arc::new(joined), {
        [of_triangles(&corners), of_list(&balls)].concat()
    });
    let (mut assembly, mut list) = (Assembly::new(), Vec::new());
    for (kind, mask) in [0b001, 0b010, 0b111, 0b110, 0b100].into_iter().enumerate() {
        let (geometry, solids) = of_solids(kind);
        assembly.add_masked(geometry, mask);
        list.extend(of_list(&solids[..]).into_iter().map(|p| Primitive { mask, ..p }));
    }
    assembly.add_masked(mesh(), 0b011);
    list.extend(of_triangles(&corners).into_iter().map(|p| Primitive { mask: 0b011, ..p }));
    add("an assembly of all kinds", Arc::new(assembly), list);

    let least = of_list(&balls).into_iter().zip(0..);
    let least =
        least.map(|(p, number)| Primitive { mask: 1 << (number % 3), tells_points: false, ..p });
    add("a user's own type", Arc::new(Least(spheres(&balls))), least.collect());
    all
}
