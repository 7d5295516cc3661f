//! What tells one scene from another without keeping either: checksums of what is in them, from the bytes that saved scenes have.

use raywood::TriangleMesh;

use super::stored::Stored;
use crate::{Environment, Instance, Instances, Light, Mesh, Scene};

/// CRC-32 of values as they are [saved](crate::save_scene), without keeping their bytes.
#[derive(Default)]
struct Checksum {
    hasher: crc32fast::Hasher,
    buffer: Vec<u8>,
}

impl Checksum {
    /// As many bytes are collected, so that they are summed many at a time.
    const BUFFER: usize = 1 << 16;

    /// Adds how many values there are, and each.
    fn add_all<'a, T: Stored + 'a>(&mut self, values: impl ExactSizeIterator<Item = &'a T>) {
        self.add(&(values.len() as u32));
        values.for_each(|value| self.add(value));
    }

    fn add(&mut self, value: &impl Stored) {
        value.put(&mut self.buffer);
        if self.buffer.len() >= Self::BUFFER {
            self.flush();
        }
    }

    fn flush(&mut self) {
        self.hasher.update(&self.buffer);
        self.buffer.clear();
    }

    fn finish(mut self) -> u32 {
        self.flush();
        self.hasher.finalize()
    }
}

impl Scene {
    /// What the scene's surfaces and surroundings are, by names in words and checksums: scenes with the same ones are, but for one in billions, the same. Lights and cameras, which a picture may have of
    /// its own, do not count, nor names. O(size of the scene).
    pub fn checksums(&self) -> Vec<(&'static str, u32)> {
        // All fields, so that a new one is not forgotten.
        let Self {
            name: _,
            mesh:
                Mesh {
                    triangles,
                    normals,
                    colors,
                    texture_coordinates,
                    tangents,
                    materials: of_triangles,
                },
            instances,
            spheres,
            sphere_materials,
            materials,
            images,
            lights: _,
            cameras: _,
            up,
            background,
            environment,
            warnings: _,
        } = self;
        let of = |add: &dyn Fn(&mut Checksum)| {
            let mut checksum = Checksum::default();
            add(&mut checksum);
            checksum.finish()
        };
        let vertices = |sum: &mut Checksum| {
            sum.add_all(normals.iter());
            sum.add_all(colors.iter());
            texture_coordinates.iter().for_each(|set| sum.add_all(set.iter()));
            sum.add_all(tangents.iter());
        };
        let spheres = |sum: &mut Checksum| {
            sum.add_all(spheres.as_slice().iter());
        };
        let materials = |sum: &mut Checksum| {
            sum.add_all(materials.iter());
            sum.add_all(of_triangles.iter());
            sum.add_all(sphere_materials.iter());
        };
        let surroundings = |sum: &mut Checksum| {
            sum.add(up);
            sum.add(background);
            sum.add_all(environment.as_slice().iter());
        };
        vec![
            ("triangles", of(&|sum| add_triangles(sum, triangles))),
            ("normals, colours and texture coordinates", of(&vertices)),
            ("instances", of(&|sum| add_instances(sum, instances))),
            ("spheres", of(&spheres)),
            ("materials", of(&materials)),
            ("textures", of(&|sum| sum.add_all(images.iter()))),
            ("surroundings", of(&surroundings)),
        ]
    }
}

impl Environment {
    /// A checksum of the panorama.
    pub fn checksum(&self) -> u32 {
        let mut sum = Checksum::default();
        sum.add(self);
        sum.finish()
    }
}

impl Light {
    /// A checksum of some lights.
    pub fn checksum(lights: &[Self]) -> u32 {
        let mut sum = Checksum::default();
        sum.add_all(lights.iter());
        sum.finish()
    }
}

fn add_triangles(sum: &mut Checksum, triangles: &TriangleMesh) {
    sum.add_all(triangles.positions().iter());
    sum.add_all(triangles.triangles().iter());
}

fn add_instances(sum: &mut Checksum, instances: &Instances) {
    for triangles in instances.objects() {
        sum.add(&[triangles.start, triangles.end]);
    }
    for Instance { object, transform, later, material, tint } in instances.placed() {
        sum.add(object);
        transform.rows().iter().for_each(|row| sum.add(row));
        // Of what stands still as it was before anything moved, so that films of such scenes can go on.
        if let Some(later) = later {
            sum.add(&1u32);
            later.rows().iter().for_each(|row| sum.add(row));
        }
        sum.add(material);
        sum.add(tint);
    }
}

#[cfg(test)]
mod tests {
    use raywood::{Transform, Vec3};

    use super::*;
    use crate::{Background, Material, Rgb};

    fn scene() -> Scene {
        let corners = vec![[0.0; 3], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let triangles = TriangleMesh::new(corners, vec![[0, 1, 2]]).expect("a triangle");
        let placed = vec![Instance::new(0, Transform::IDENTITY)];
        Scene {
            mesh: Mesh { triangles, normals: vec![Vec3::Z; 3], ..Mesh::default() },
            instances: Instances::new(vec![0], 1, placed).expect("instances"),
            materials: vec![Material::default()],
            ..Scene::default()
        }
    }

    fn changed(change: impl FnOnce(&mut Scene)) -> Vec<&'static str> {
        let mut other = scene();
        change(&mut other);
        let pairs = scene().checksums().into_iter().zip(other.checksums());
        pairs.filter(|(one, other)| one != other).map(|((name, _), _)| name).collect()
    }

    #[test]
    fn what_changes_is_named_and_nothing_else() {
        assert_eq!(changed(|scene| scene.name = "another".to_owned()), [""; 0]);
        assert_eq!(
            changed(|scene| scene.mesh.normals[1].x = 1e-9),
            ["normals, colours and texture coordinates"]
        );
        assert_eq!(changed(|scene| scene.materials[0].ior = 1.4), ["materials"]);
        assert_eq!(changed(|scene| scene.sphere_materials.push(0)), ["materials"]);
        assert_eq!(changed(|scene| scene.up = Some(Vec3::Z)), ["surroundings"]);
        let background = Background { nadir: Rgb::ZERO, ..Background::default() };
        assert_eq!(changed(|scene| scene.background = background), ["surroundings"]);
        let moved = Instance::new(0, Transform::translation([1.0, 0.0, 0.0]));
        let instances = Instances::new(vec![0], 1, vec![moved]).expect("instances");
        assert_eq!(changed(|scene| scene.instances = instances), ["instances"]);
        let moved = Transform::translation([1.0, 0.0, 0.0]);
        let moving = Instance { later: Some(moved), ..Instance::new(0, Transform::IDENTITY) };
        let instances = Instances::new(vec![0], 1, vec![moving]).expect("instances");
        assert_eq!(changed(|scene| scene.instances = instances), ["instances"]);
        let corners = vec![[0.0; 3], [2.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        let triangles = TriangleMesh::new(corners, vec![[0, 1, 2]]).expect("a triangle");
        assert_eq!(changed(|scene| scene.mesh.triangles = triangles), ["triangles"]);
    }
}
