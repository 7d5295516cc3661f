//! Saved trees taken apart and put together again with right checksums, as `docs/format.md` describes them and without the library's own code: for files that no honest writer
//! writes.

use std::ops::ControlFlow;

use raywood::{Aabb, Bvh, Geometry, Ray, Vec3};

use crate::Rng;

/// The sections of a saved tree, to be changed at will.
#[derive(Clone, Debug, PartialEq)]
pub struct Forgery {
    /// The version of the format.
    pub version: u32,
    /// Names and bytes.
    pub sections: Vec<(String, Vec<u8>)>,
}

impl Forgery {
    /// Takes a saved tree apart.
    ///
    /// # Panics
    ///
    /// If it is none.
    pub fn of(file: &[u8]) -> Self {
        let number = |at: usize| u32::from_le_bytes(file[at..at + 4].try_into().expect("four"));
        let large = |at: usize| u64::from_le_bytes(file[at..at + 8].try_into().expect("eight"));
        assert_eq!(&file[..8], b"\x89RWOOD\r\n");
        assert_eq!(large(16), file.len() as u64);
        assert_eq!(number(60), crc32fast::hash(&file[..60]));
        let lines = (0..number(12) as usize).map(|line| 64 + 40 * line);
        assert_eq!(number(24), crc32fast::hash(&file[64..64 + 40 * number(12) as usize]));
        let sections = lines.map(|line| {
            let name = std::str::from_utf8(&file[line..line + 16]).expect("ASCII");
            let (start, length) = (large(line + 16) as usize, large(line + 24) as usize);
            let bytes = file[start..start + length].to_vec();
            assert_eq!(start % 64, 0);
            assert_eq!(number(line + 32), crc32fast::hash(&bytes));
            (name.trim_end_matches('\0').to_owned(), bytes)
        });
        Self { version: number(8), sections: sections.collect() }
    }

    /// Puts a file together, all checksums right.
    pub fn file(&self) -> Vec<u8> {
        let mut file = vec![0; 64 + 40 * self.sections.len()];
        for (number, (name, bytes)) in self.sections.iter().enumerate() {
            file.resize(file.len().next_multiple_of(64), 0);
            let line = 64 + 40 * number;
            file[line..line + name.len()].copy_from_slice(name.as_bytes());
            let start = file.len() as u64;
            file[line + 16..line + 24].copy_from_slice(&start.to_le_bytes());
            file[line + 24..line + 32].copy_from_slice(&(bytes.len() as u64).to_le_bytes());
            file[line + 32..line + 36].copy_from_slice(&crc32fast::hash(bytes).to_le_bytes());
            file.extend(bytes);
        }
        let length = file.len() as u64;
        file[..8].copy_from_slice(b"\x89RWOOD\r\n");
        file[8..12].copy_from_slice(&self.version.to_le_bytes());
        file[12..16].copy_from_slice(&(self.sections.len() as u32).to_le_bytes());
        file[16..24].copy_from_slice(&length.to_le_bytes());
        correct_header(&mut file);
        file
    }

    /// A section's bytes.
    ///
    /// # Panics
    ///
    /// If there is none of the name.
    pub fn section(&mut self, name: &str) -> &mut Vec<u8> {
        let found = self.sections.iter_mut().find(|(other, _)| other == name);
        &mut found.unwrap_or_else(|| panic!("a section {name}")).1
    }

    /// Puts a number into a section at a byte.
    pub fn set(&mut self, name: &str, at: usize, number: u32) {
        self.section(name)[at..at + 4].copy_from_slice(&number.to_le_bytes());
    }

    /// The number in a section at a byte.
    pub fn get(&mut self, name: &str, at: usize) -> u32 {
        u32::from_le_bytes(self.section(name)[at..at + 4].try_into().expect("four"))
    }
}

/// Makes the checksums of table and header right, if the file is long enough for them.
pub fn correct_header(file: &mut [u8]) {
    if file.len() < 64 {
        return;
    }
    let lines = u32::from_le_bytes(file[12..16].try_into().expect("four")) as usize;
    if let Some(table) = 40usize.checked_mul(lines).and_then(|size| file.get(64..64 + size)) {
        let checksum = crc32fast::hash(table);
        file[24..28].copy_from_slice(&checksum.to_le_bytes());
    }
    let checksum = crc32fast::hash(&file[..60]);
    file[60..64].copy_from_slice(&checksum.to_le_bytes());
}

/// Makes all checksums right, as far as the file is one.
pub fn correct_checksums(file: &mut [u8]) {
    let lines = file.get(12..16).map_or(0, |b| u32::from_le_bytes(b.try_into().expect("four")));
    for line in (0..lines.min(256) as usize).map(|line| 64 + 40 * line) {
        let number = |at: usize| {
            let bytes = file.get(at..at + 8)?;
            usize::try_from(u64::from_le_bytes(bytes.try_into().expect("eight"))).ok()
        };
        if let (Some(start), Some(length)) = (number(line + 16), number(line + 24))
            && let Some(bytes) = start.checked_add(length).and_then(|end| file.get(start..end))
        {
            let checksum = crc32fast::hash(bytes);
            if let Some(place) = file.get_mut(line + 32..line + 36) {
                place.copy_from_slice(&checksum.to_le_bytes());
            }
        }
    }
    correct_header(file);
}

/// Asks a tree everything that it can be asked, with rays, points and regions in and around its box: for those that must answer something, right or wrong.
pub fn ask_everything<G: Geometry>(bvh: &Bvh<G>, seed: u64) {
    let mut rng = Rng::new(seed);
    let bounds = bvh.tree().bounds();
    let (center, size) = match bounds.is_empty() {
        true => (Vec3::ZERO, Vec3::ONE),
        false => (bounds.center(), bounds.max - bounds.min + Vec3::splat(f32::MIN_POSITIVE)),
    };
    let mut point = || {
        let p = rng.in_cube();
        center + Vec3::new(p.x * size.x, p.y * size.y, p.z * size.z)
    };
    let primitives = bvh.geometry().len();
    let in_range = |primitive: u32| assert!((primitive as usize) < primitives);

    // Rays of all kinds: one by one, from one point, to one point, side by side.
    let eye = point();
    let mut rays: Vec<_> = (0..300).map(|_| Ray::between(eye, point())).collect();
    rays.extend((0..64).map(|_| Ray::between(point(), eye)));
    rays.extend((0..64).map(|_| Ray::new(point(), size)));
    rays.extend((0..64).map(|_| Ray::between(point(), point())));
    let (mut hits, mut occluded) = (vec![None; rays.len()], vec![false; rays.len()]);
    bvh.intersect_batch(&rays, &mut hits);
    bvh.occluded_batch(&rays, &mut occluded);
    for ray in &rays[280..] {
        hits.push(bvh.intersect(ray));
        bvh.occluded(ray);
        bvh.all_hits(ray, &mut Vec::new());
        bvh.sphere_cast(ray, 0.1 * size.x);
    }
    for (ray, hit) in rays.iter().zip(&hits) {
        if let Some(hit) = hit {
            in_range(hit.primitive);
            bvh.surface_point(ray, hit);
        }
    }

    let solid = bvh.solid();
    for _ in 0..16 {
        let place = point();
        if let Some(closest) = bvh.closest_point(place, f32::INFINITY) {
            in_range(closest.primitive);
        }
        solid.winding_number(place);
        let region = Aabb { min: place.min(eye), max: place.max(eye) };
        let _ = bvh.overlapping(&region, |primitive| {
            in_range(primitive);
            ControlFlow::Continue(())
        });
    }
    let _ = bvh.overlapping_pairs(bvh, |a, b| {
        in_range(a.max(b));
        ControlFlow::Continue(())
    });
    // Whether it is right is another question.
    let _ = bvh.validate();
    bvh.stats();
}
