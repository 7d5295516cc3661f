//! What overlaps regions of double precision, wherever they lie, against triangles cut off one by one.

use std::ops::ControlFlow;

use raywood::{Aabb64, Ball64, Bvh64, Frustum64, Region64};
use raywood_testkit::{Rng, distance, overlap};

use crate::doubles::{PLACES, add, bumpy, in_cube, scaled, sub};

type Point = [f64; 3];

/// What touches a region, in order.
fn touching<R: Region64>(bvh: &Bvh64, region: &R) -> Vec<u32> {
    let mut found = Vec::new();
    let flow = bvh.overlapping(region, |triangle| {
        found.push(triangle);
        ControlFlow::Continue(())
    });
    assert!(flow.is_continue());
    assert_eq!(bvh.overlaps(region), !found.is_empty());
    found.sort_unstable();
    found
}

/// The plane through three points, its normal of length one and towards another.
fn plane_through([a, b, c]: [Point; 3], inside: Point) -> (Point, f64) {
    let (u, v) = (sub(b, a), sub(c, a));
    let dot = |a: Point, b: Point| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let normal = [0, 1, 2].map(|i| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        u[j] * v[k] - u[k] * v[j]
    });
    let side = dot(normal, sub(inside, a)).signum();
    let normal = scaled(side / dot(normal, normal).sqrt(), normal);
    (normal, -dot(normal, a))
}

#[test]
fn what_touches_regions_is_that_of_brute_force_wherever_it_lies() {
    let mut rng = Rng::new(91);
    for (at, size) in PLACES {
        let mesh = bumpy(3, at, size, &mut rng);
        let bvh = Bvh64::build(mesh.clone()).expect("it builds");
        // Seen from there in units of its size, where single steps of coordinates are so large.
        let local = |p: Point| scaled(size.recip(), sub(p, at));
        let step = f64::EPSILON * at.iter().fold(0.0, |most: f64, x| most.max(x.abs())) / size;
        let margin = 1e-12 + 16.0 * step;
        let triangles: Vec<[Point; 3]> =
            (0..mesh.triangles().len() as u32).map(|n| mesh.corners(n).map(local)).collect();
        let check = |found: &[u32], by: &dyn Fn(f64, &[Point; 3]) -> bool| {
            for (number, corners) in (0..).zip(&triangles) {
                let told = found.binary_search(&number).is_ok();
                let is_right = if told { by(margin, corners) } else { !by(-margin, corners) };
                assert!(is_right, "{number} at {at:?}: {told}");
            }
            usize::from(!found.is_empty() && found.len() < triangles.len())
        };
        let in_planes = |planes: &[(Point, f64)], by: f64, corners: &[Point; 3]| {
            let planes: Vec<_> = planes.iter().map(|&(n, offset)| (n, offset + by)).collect();
            overlap::polygon_in_planes(corners, &planes)
        };

        let (mut boxes, mut balls, mut frustums) = (0, 0, 0);
        let mut all_balls = Vec::new();
        for _ in 0..40 {
            let center = add(at, scaled(1.2 * size, in_cube(&mut rng)));
            let half = in_cube(&mut rng).map(|x| 0.5 * size * x.abs());
            let (min, max) = (sub(center, half), add(center, half));
            let found = touching(&bvh, &Aabb64::new(min, max));
            let (low, high) = (local(min), local(max));
            let axis = |i: usize, sign: f64| [0, 1, 2].map(|j| if i == j { sign } else { 0.0 });
            let sides = [0, 1, 2].map(|i| [(axis(i, 1.0), -low[i]), (axis(i, -1.0), high[i])]);
            boxes += check(&found, &|by, corners| in_planes(sides.as_flattened(), by, corners));

            let radius = f64::from(rng.unit());
            let ball = Ball64::new(center, radius * size);
            all_balls.push(ball);
            let middle = local(center);
            balls += check(&touching(&bvh, &ball), &|by, corners| {
                distance::of_triangle(corners.map(|p| sub(p, middle))) <= radius + by
            });

            // A pyramid without its tip, askew.
            let eye = scaled(1.5, in_cube(&mut rng));
            let (forwards, right) = (in_cube(&mut rng), in_cube(&mut rng));
            let up = plane_through([[0.0; 3], forwards, right], [0.0; 3]).0;
            let Some(up) = Some(up).filter(|up| up.iter().all(|x| x.is_finite())) else { continue };
            let corner = |(x, y): (f64, f64), far: f64| {
                let aside = add(scaled(0.5 * x, right), scaled(0.5 * y, up));
                let p = add(eye, scaled(far, add(scaled(2.0, forwards), aside)));
                add(at, scaled(size, p))
            };
            let around = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
            let [a, b, c, d] = around.map(|side| corner(side, 0.125));
            let [e, f, g, h] = around.map(|side| corner(side, 1.0));
            let corners = [a, b, c, d, e, f, g, h];
            let found = touching(&bvh, &Frustum64::from_corners(corners));
            let seen = corners.map(local);
            let inside = scaled(0.125, seen.into_iter().fold([0.0; 3], add));
            let faces = [[0, 1, 2], [4, 5, 6], [0, 1, 5], [1, 2, 6], [2, 3, 7], [3, 0, 4]];
            let planes = faces.map(|face| plane_through(face.map(|n| seen[n]), inside));
            // Steps of corners near each other turn planes that reach far.
            let slack = 1e3 * step;
            frustums +=
                check(&found, &|by, corners| in_planes(&planes, by + by.signum() * slack, corners));
        }
        assert!(boxes > 10 && balls > 10 && frustums > 10, "{boxes}, {balls}, {frustums}");

        let mut answers = vec![false; all_balls.len()];
        bvh.overlaps_batch(&all_balls, &mut answers);
        assert!(all_balls.iter().zip(answers).all(|(ball, told)| bvh.overlaps(ball) == told));
    }
}

#[test]
fn regions_without_end_hold_everything_and_those_that_are_none_nothing() {
    let mesh = bumpy(2, [1e7; 3], 1.0, &mut Rng::new(92));
    let count = mesh.triangles().len();
    let bvh = Bvh64::build(mesh).expect("it builds");
    let (nan, inf) = (f64::NAN, f64::INFINITY);
    assert_eq!(touching(&bvh, &Aabb64::new([-inf; 3], [inf; 3])).len(), count);
    assert_eq!(touching(&bvh, &Ball64::new([0.0; 3], inf)).len(), count);
    let half = touching(&bvh, &Aabb64::new([1e7, -inf, -inf], [inf; 3])).len();
    assert!(0 < half && half < count, "{half}");

    let boxes = [([1.0; 3], [0.0; 3]), ([nan, 0.0, 0.0], [inf; 3]), ([0.0; 3], [nan; 3])];
    for (min, max) in boxes.into_iter().chain([([inf; 3], [inf; 3]), ([-inf; 3], [-inf; 3])]) {
        assert!(touching(&bvh, &Aabb64::new(min, max)).is_empty(), "{min:?}, {max:?}");
    }
    for (center, radius) in [([1e7; 3], nan), ([1e7; 3], -1.0), ([nan; 3], inf), ([inf; 3], inf)] {
        assert!(touching(&bvh, &Ball64::new(center, radius)).is_empty(), "{center:?}, {radius}");
    }
    let all = [([0.0, 0.0, 1.0], [0.0; 3]); 6];
    assert_eq!(touching(&bvh, &Frustum64::from_planes(all)).len(), count);
    for bad in [nan, inf, 1e200] {
        let mut planes = all;
        planes[3].0[1] = bad;
        assert!(touching(&bvh, &Frustum64::from_planes(planes)).is_empty(), "{bad}");
    }
    for bad in [nan, inf] {
        let mut planes = all;
        planes[3].1[1] = bad;
        assert!(touching(&bvh, &Frustum64::from_planes(planes)).is_empty(), "{bad}");
    }
}

#[test]
fn a_search_ends_where_one_ends_it() {
    let bvh = Bvh64::build(bumpy(2, [0.0; 3], 1.0, &mut Rng::new(93))).expect("it builds");
    let mut told = 0;
    let flow = bvh.overlapping(&Ball64::new([0.0; 3], 2.0), |_| {
        told += 1;
        if told == 3 { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
    });
    assert!(flow.is_break() && told == 3);
}
