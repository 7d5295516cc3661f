//! Scenes with instances as scenes without: every instance becomes triangles of its own.

use std::fmt;

use raywood::{Transform, TriangleMesh, Vec3};

use crate::{Instance, Instances, Mesh, Rgb, Scene};

/// Why a scene is not written out: it shows more triangles than are allowed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TooManyTriangles {
    /// How many it shows.
    pub visible: u64,
    /// How many are allowed.
    pub most: u64,
}

impl fmt::Display for TooManyTriangles {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { visible, most } = self;
        write!(
            f,
            "its instances show {visible} triangles in all, of which at most {most} are copied"
        )
    }
}

impl std::error::Error for TooManyTriangles {}

impl Scene {
    /// How many triangles there are to be seen, those of instances counted as often as they are shown.
    pub fn visible_triangles(&self) -> u64 {
        let own = self.instances.own_triangles(&self.mesh.triangles);
        u64::from(own) + self.instances.visible_triangles()
    }

    /// Copies the objects to all places where they stand, so that the mesh holds all that is to be seen and there are no instances. Triangles of mirrored instances have their corners in
    /// the other order, so that they face the same way. Instances with a [tint](Instance::tint) get it as colours of vertices.
    ///
    /// # Errors
    ///
    /// That would be more than `most` triangles; the scene stays as it was.
    pub fn flatten(&mut self, most: u64) -> Result<(), TooManyTriangles> {
        if self.instances.is_empty() {
            return Ok(());
        }
        let visible = self.visible_triangles();
        let most = most.min(u64::from(u32::MAX));
        if visible > most {
            return Err(TooManyTriangles { visible, most });
        }
        let instances = std::mem::take(&mut self.instances);
        self.mesh = Flattening::of(&self.mesh, &instances).finish();
        Ok(())
    }
}

/// A mesh that grows.
struct Flattening<'a> {
    mesh: &'a Mesh,
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// All but positions and triangles.
    rest: Mesh,
    /// The new number of each vertex of the mesh, as of the object that is being copied; [`NOT_YET`] where it is not copied.
    numbers: Vec<u32>,
    has_colors: bool,
}

const NOT_YET: u32 = u32::MAX;

impl<'a> Flattening<'a> {
    fn of(mesh: &'a Mesh, instances: &Instances) -> Self {
        let mut all = Self {
            mesh,
            positions: Vec::new(),
            triangles: Vec::new(),
            rest: Mesh::default(),
            numbers: vec![NOT_YET; mesh.triangles.positions().len()],
            has_colors: !mesh.colors.is_empty()
                || instances.placed().iter().any(|instance| instance.tint != Rgb::ONE),
        };
        let own = instances.own_triangles(&mesh.triangles);
        let objects: Vec<_> = instances.objects().collect();
        all.add(0..own, &Instance::new(0, Transform::IDENTITY));
        for instance in instances.placed() {
            all.add(objects[instance.object as usize].clone(), instance);
        }
        all
    }

    /// Adds the triangles of an object where an instance has them.
    fn add(&mut self, triangles: std::ops::Range<u32>, instance: &Instance) {
        let mesh = self.mesh;
        let to_world = &instance.transform;
        let normals = to_world.for_normals();
        let mirrored = to_world.mirrors();
        let mut copied = Vec::new();
        for triangle in triangles {
            let Some(corners) = mesh.triangles.triangles().get(triangle as usize) else { break };
            let mut numbers = corners.map(|vertex| {
                let place = vertex as usize;
                if self.numbers[place] != NOT_YET {
                    return self.numbers[place];
                }
                let number = self.positions.len() as u32;
                self.numbers[place] = number;
                copied.push(vertex);
                self.positions.push(to_world.point(mesh.triangles.positions()[place]));
                let rest = &mut self.rest;
                rest.normals.extend(
                    mesh.normals
                        .get(place)
                        .map(|&normal| normals.vector(normal).normalize_or_zero()),
                );
                if self.has_colors {
                    let color = mesh.colors.get(place).copied().unwrap_or(Rgb::ONE);
                    rest.colors.push(color * instance.tint);
                }
                for (set, coordinates) in mesh.texture_coordinates.iter().enumerate() {
                    rest.texture_coordinates[set].extend(coordinates.get(place));
                }
                rest.tangents.extend(mesh.tangents.get(place).map(|&[x, y, z, sign]| {
                    let along = to_world.vector([x, y, z]).normalize_or_zero();
                    [along.x, along.y, along.z, if mirrored { -sign } else { sign }]
                }));
                number
            });
            if mirrored {
                numbers.swap(1, 2);
            }
            self.triangles.push(numbers);
            let own = mesh.materials.get(triangle as usize).copied();
            self.rest.materials.extend(instance.material.or(own));
        }
        for vertex in copied {
            self.numbers[vertex as usize] = NOT_YET;
        }
    }

    fn finish(self) -> Mesh {
        // Instances may reach beyond the largest number: what does so is not seen by rays either.
        let positions: Vec<_> = self
            .positions
            .into_iter()
            .map(|position| if position.is_finite() { position } else { Vec3::ZERO })
            .collect();
        let triangles = TriangleMesh::new(positions, self.triangles)
            .expect("positions are finite, and indices count them");
        Mesh { triangles, ..self.rest }
    }
}
