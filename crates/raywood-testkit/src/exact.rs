//! An oracle for meshes of double precision that is never wrong: every number is an integer, and nothing is rounded.

use num_bigint::{BigInt, Sign};
use raywood::{Hit64, Ray64, TriangleMesh64};

/// How exact distances and weights must be.
const TOLERANCE: f64 = 1e-12;

/// Coordinates are multiples of 2^-UNIT.
const UNIT: i32 = 400;

type Point = [BigInt; 3];

/// A number as a multiple of `2^-UNIT`.
///
/// # Panics
///
/// If it is none.
fn integer(x: f64) -> BigInt {
    let bits = x.to_bits();
    let exponent = (bits >> 52 & 0x7ff) as i32;
    if x == 0.0 {
        return BigInt::ZERO;
    }
    assert!(exponent != 0 && exponent != 0x7ff, "{x} is no usual number");
    let mantissa = (bits & ((1 << 52) - 1)) | 1 << 52;
    let shift = exponent - 1075 + UNIT;
    assert!(shift >= 0, "{x} is too small for the oracle");
    let size = BigInt::from(mantissa) << shift;
    if x < 0.0 { -size } else { size }
}

fn point(p: [f64; 3]) -> Point {
    p.map(integer)
}

fn sub(a: &Point, b: &Point) -> Point {
    [&a[0] - &b[0], &a[1] - &b[1], &a[2] - &b[2]]
}

fn cross(a: &Point, b: &Point) -> Point {
    [&a[1] * &b[2] - &a[2] * &b[1], &a[2] * &b[0] - &a[0] * &b[2], &a[0] * &b[1] - &a[1] * &b[0]]
}

fn dot(a: &Point, b: &Point) -> BigInt {
    &a[0] * &b[0] + &a[1] * &b[1] + &a[2] * &b[2]
}

/// A share of two integers, the second of which is positive.
#[derive(Clone, Debug)]
struct Ratio(BigInt, BigInt);

impl Ratio {
    fn new(numerator: BigInt, denominator: BigInt) -> Self {
        match denominator.sign() {
            Sign::Minus => Self(-numerator, -denominator),
            _ => Self(numerator, denominator),
        }
    }

    /// The nearest number, but for some units in the last place.
    fn value(&self) -> f64 {
        // So many bits of each as are wanted.
        let top = |x: &BigInt| {
            let shift = x.bits().saturating_sub(100) as i32;
            ((x >> shift).to_string().parse::<f64>().expect("a number"), shift)
        };
        let ((a, shift_a), (b, shift_b)) = (top(&self.0), top(&self.1));
        a / b * f64::from(shift_a - shift_b).exp2()
    }

    /// This less a number.
    fn minus(&self, x: f64) -> Self {
        let unit = BigInt::from(1) << UNIT;
        Self((&self.0 * &unit) - integer(x) * &self.1, &self.1 * unit)
    }

    fn is_less(&self, other: &Self) -> bool {
        &self.0 * &other.1 < &other.0 * &self.1
    }
}

/// Where a ray hits a triangle.
#[derive(Clone, Debug)]
struct Crossing {
    t: Ratio,
    u: Ratio,
    v: Ratio,
    /// Whether it passes through an edge or a vertex.
    on_edge: bool,
}

impl Crossing {
    /// Whether it lies within a ray's interval that is longer at both ends by such a share of these.
    fn is_within(&self, ray: &Ray64, share: f64) -> bool {
        let t = self.t.value();
        ray.t_min - share * ray.t_min.abs() <= t
            && (t < ray.t_max + share * ray.t_max.abs() || ray.t_max == f64::INFINITY)
    }

    /// Whether rounding cannot take it for none. Where a mesh ends, an edge counts or not.
    fn is_certain(&self, ray: &Ray64) -> bool {
        !self.on_edge && self.is_within(ray, -TOLERANCE)
    }
}

/// A mesh in integers.
pub struct ExactMesh {
    corners: Vec<[Point; 3]>,
}

impl ExactMesh {
    /// The same mesh.
    pub fn new(mesh: &TriangleMesh64) -> Self {
        let count = mesh.triangles().len() as u32;
        Self { corners: (0..count).map(|number| mesh.corners(number).map(point)).collect() }
    }

    /// Where the line of a ray crosses a triangle, edges included; `None` also where it lies in its plane.
    fn crossing(&self, number: usize, ray: &Ray64) -> Option<Crossing> {
        let [a, b, c] = &self.corners[number];
        let (o, d) = (point(ray.origin), point(ray.direction));
        let (e, f, s) = (sub(b, a), sub(c, a), sub(&o, a));
        let p = cross(&d, &f);
        let determinant = dot(&e, &p);
        if determinant == BigInt::ZERO {
            return None;
        }
        let q = cross(&s, &e);
        let ratio = |numerator: BigInt| Ratio::new(numerator, determinant.clone());
        let (u, v) = (ratio(dot(&s, &p)), ratio(dot(&d, &q)));
        let w = &u.1 - &u.0 - &v.0;
        let signs = [u.0.sign(), v.0.sign(), w.sign()];
        let t = ratio(dot(&f, &q));
        let on_edge = signs.contains(&Sign::NoSign);
        (!signs.contains(&Sign::Minus)).then_some(Crossing { t, u, v, on_edge })
    }

    /// Where a ray crosses triangles within its interval, ends included that rounding may take for inside.
    fn hits(&self, ray: &Ray64) -> Vec<(usize, Crossing)> {
        if !ray.is_valid() {
            return Vec::new();
        }
        let numbers = 0..self.corners.len();
        let crossings = numbers.filter_map(|number| Some((number, self.crossing(number, ray)?)));
        crossings.filter(|(_, crossing)| crossing.is_within(ray, TOLERANCE)).collect()
    }

    /// Checks an answer to a closest-hit query; an error says what is wrong with it.
    pub fn check_closest(&self, ray: &Ray64, answer: Option<Hit64>) -> Result<(), String> {
        let hits = self.hits(ray);
        let Some(hit) = answer else {
            let missed = hits.iter().find(|(_, crossing)| crossing.is_certain(ray));
            return missed.map_or(Ok(()), |(number, crossing)| {
                let t = crossing.t.value();
                Err(format!("missed triangle {number} at {t} with {ray:?}"))
            });
        };
        self.check_place(ray, &hit)?;

        // None may be nearer than rounding can tell.
        let counting = hits.iter().filter(|(_, crossing)| crossing.is_within(ray, 0.0));
        let closest = counting.map(|(_, crossing)| &crossing.t);
        let closest = closest.reduce(|a, b| if b.is_less(a) { b } else { a });
        // At an end of the interval the hit itself may be none in truth.
        let Some(closest) = closest else { return Ok(()) };
        let ahead = closest.minus(hit.t).value();
        if ahead < -2.0 * TOLERANCE * hit.t.abs() {
            return Err(format!("{hit:?} behind one at {} with {ray:?}", closest.value()));
        }
        Ok(())
    }

    /// Checks where a hit is said to be.
    fn check_place(&self, ray: &Ray64, hit: &Hit64) -> Result<(), String> {
        let own = self.crossing(hit.primitive as usize, ray);
        let Some(own) = own else {
            return Err(format!("{hit:?} with a triangle that is not met by {ray:?}"));
        };
        let t_error = own.t.minus(hit.t).value().abs();
        let errors = [&own.u, &own.v]
            .into_iter()
            .zip([hit.u, hit.v])
            .map(|(exact, told)| exact.minus(told).value().abs());
        if t_error > TOLERANCE * hit.t.abs() || errors.into_iter().any(|error| error > TOLERANCE) {
            let exact = [&own.t, &own.u, &own.v].map(Ratio::value);
            return Err(format!("{hit:?} instead of {exact:?} with {ray:?}"));
        }
        if !(ray.t_min <= hit.t && hit.t < ray.t_max) {
            return Err(format!("{hit:?} outside of the interval of {ray:?}"));
        }
        Ok(())
    }

    /// Checks an answer to a query for all hits; an error says what is wrong with it. Which of the triangles around an edge or a vertex are crossed there is not looked at.
    pub fn check_all(&self, ray: &Ray64, answer: &[Hit64]) -> Result<(), String> {
        for hit in answer {
            self.check_place(ray, hit)?;
        }
        let order = |hit: &Hit64| (hit.t, hit.primitive);
        if !answer.windows(2).all(|pair| order(&pair[0]) < order(&pair[1])) {
            return Err(format!("not in order: {answer:?} with {ray:?}"));
        }
        let mut told: Vec<u32> = answer.iter().map(|hit| hit.primitive).collect();
        told.sort_unstable();
        if told.windows(2).any(|pair| pair[0] == pair[1]) {
            return Err(format!("the same twice: {answer:?} with {ray:?}"));
        }
        let hits = self.hits(ray);
        let missed = hits.iter().find(|(number, crossing)| {
            crossing.is_certain(ray) && told.binary_search(&(*number as u32)).is_err()
        });
        missed.map_or(Ok(()), |(number, crossing)| {
            Err(format!("missed triangle {number} at {} with {ray:?}", crossing.t.value()))
        })
    }

    /// Whether a ray comes from the side of a triangle that its normal points to; `None` where it runs along it.
    pub fn meets_front(&self, primitive: u32, ray: &Ray64) -> Option<bool> {
        let [a, b, c] = &self.corners[primitive as usize];
        let rise = dot(&cross(&sub(b, a), &sub(c, a)), &point(ray.direction));
        match rise.sign() {
            Sign::Minus => Some(true),
            Sign::NoSign => None,
            Sign::Plus => Some(false),
        }
    }

    /// Checks an answer to an any-hit query; an error says what is wrong with it.
    pub fn check_occluded(&self, ray: &Ray64, answer: bool) -> Result<(), String> {
        let hits = self.hits(ray);
        match answer {
            true if hits.is_empty() => Err(format!("blocked by nothing: {ray:?}")),
            false if hits.iter().any(|(_, crossing)| crossing.is_certain(ray)) => {
                Err(format!("not blocked: {ray:?}"))
            }
            _ => Ok(()),
        }
    }
}
