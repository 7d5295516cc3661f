//! The surfaces that a wave hit, in columns, ready for shading: what all hits need is computed with vectors.

use raywood::{Ray, SurfacePoint, Vec3};
use raywood_scene::{MetallicRoughness, Pattern, Rgb};

use super::columns::{Column, Columns, ZERO, get, set};
use super::textured_surfaces::vertex_color;
use super::{Traced, WAVE};
use crate::PreparedScene;
use crate::prepared::{Element, Which};
use crate::shading::{Surface, bent_normal};
use crate::surface_material::SurfaceMaterial;

/// The surfaces that the rays of one wave hit, in the order of the rays; those that hit nothing are left out.
pub(crate) struct Surfaces {
    count: usize,
    /// The number of the ray in its wave.
    rays: [u32; WAVE],
    /// The number of what it hit.
    primitives: [u32; WAVE],
    /// The number of the instance.
    instances: [u32; WAVE],
    /// When the rays looked; only of scenes in which something moves.
    times: Column,
    /// The number of the material in its scene.
    pub(crate) materials: [u32; WAVE],
    /// Where along the ray, and where on the triangle.
    distances: Column,
    pub(crate) weights: [Column; 2],
    /// The directions of the rays, unit length.
    pub(crate) directions: Columns,
    /// The corners of the triangles, and what the mesh gives there.
    pub(crate) corners: [Columns; 3],
    corner_normals: [Columns; 3],
    pub(crate) positions: Columns,
    /// The surfaces' own normals.
    pub(super) own_normals: Columns,
    clearances: Column,
    /// Where rays start that leave to the side that the wave came from.
    pub(crate) origins: Columns,
    /// Unit normals on the side that the wave came from: the geometric ones, those for shading.
    pub(crate) geometric_normals: Columns,
    pub(crate) normals: Columns,
    /// The diffuse colours there.
    pub(crate) diffuse: Columns,
    /// How long the ways from the eye are; only of scenes with textures.
    pub(crate) lengths: Column,
    /// The materials of textured surfaces, each with a number after those of the scene.
    pub(crate) textured: Vec<SurfaceMaterial>,
    /// What textured surfaces are made of, as far as it is described by metal and roughness; only for who asks.
    pub(super) made_of: Option<Vec<Option<MetallicRoughness>>>,
}

impl Default for Surfaces {
    fn default() -> Self {
        Self {
            count: 0,
            rays: [0; WAVE],
            primitives: [0; WAVE],
            instances: [0; WAVE],
            times: [0.0; WAVE],
            materials: [0; WAVE],
            distances: [0.0; WAVE],
            weights: [[0.0; WAVE]; 2],
            directions: ZERO,
            corners: [ZERO; 3],
            corner_normals: [ZERO; 3],
            positions: ZERO,
            own_normals: ZERO,
            clearances: [0.0; WAVE],
            origins: ZERO,
            geometric_normals: ZERO,
            normals: ZERO,
            diffuse: ZERO,
            lengths: [0.0; WAVE],
            textured: Vec::new(),
            made_of: None,
        }
    }
}

impl Surfaces {
    /// How many rays hit something, at most a wave.
    #[inline(always)]
    pub(crate) fn count(&self) -> usize {
        self.count.min(WAVE)
    }

    /// The number of the ray that hit a surface.
    #[inline(always)]
    pub(crate) fn ray(&self, number: usize) -> usize {
        self.rays[number] as usize
    }

    /// The number of the primitive that was hit.
    #[inline(always)]
    pub(crate) fn primitive(&self, number: usize) -> u32 {
        self.primitives[number]
    }

    /// What was hit.
    #[inline(always)]
    pub(crate) fn element(&self, number: usize) -> Element {
        Element { primitive: self.primitives[number], instance: self.instances[number] }
    }

    /// When the ray looked that hit a surface; of no meaning in scenes in which nothing moves.
    #[inline(always)]
    pub(crate) fn time(&self, number: usize) -> f32 {
        self.times[number]
    }

    /// How far along its ray a surface is.
    #[inline(always)]
    pub(crate) fn distance(&self, number: usize) -> f32 {
        self.distances[number]
    }

    /// The point that was hit.
    #[inline(always)]
    pub(crate) fn point(&self, number: usize) -> SurfacePoint {
        SurfacePoint {
            position: get(&self.positions, number),
            normal: get(&self.own_normals, number),
            clearance: self.clearances[number],
        }
    }

    /// Whether a ray came from the side that the surface's own normal points to.
    #[inline(always)]
    pub(crate) fn outside(&self, number: usize) -> bool {
        is_outside(get(&self.directions, number), get(&self.own_normals, number))
    }

    /// The material there.
    #[inline(always)]
    pub(crate) fn material<'a>(
        &'a self,
        scene: &'a PreparedScene<'_>,
        number: usize,
    ) -> &'a SurfaceMaterial {
        match self.materials[number].checked_sub(scene.material_count()) {
            None => scene.material(self.materials[number]),
            Some(own) => &self.textured[own as usize],
        }
    }

    /// A surface by itself.
    #[inline(always)]
    pub(crate) fn get<'a>(&'a self, scene: &'a PreparedScene<'_>, number: usize) -> Surface<'a> {
        Surface {
            outside: self.outside(number),
            point: self.point(number),
            material: self.material(scene, number),
            geometric_normal: get(&self.geometric_normals, number),
            normal: get(&self.normals, number),
            diffuse: get(&self.diffuse, number),
        }
    }

    /// Finds the surfaces that a wave hit, and has `miss` look at the rays that hit nothing.
    #[inline(always)]
    pub(crate) fn find(
        &mut self,
        scene: &PreparedScene<'_>,
        wave: &impl Traced,
        mut miss: impl FnMut(usize),
    ) {
        self.gather(scene, wave, &mut miss);
        let count = self.count();

        // Where the points lie; the few on spheres, which the loop got wrong, one by one.
        for number in 0..count {
            let corners = [
                get(&self.corners[0], number),
                get(&self.corners[1], number),
                get(&self.corners[2], number),
            ];
            let point = SurfacePoint::on_triangle(
                corners,
                self.weights[0][number],
                self.weights[1][number],
            );
            set(&mut self.positions, number, point.position);
            set(&mut self.own_normals, number, point.normal);
            self.clearances[number] = point.clearance;
        }
        if !scene.scene().spheres.as_slice().is_empty() {
            self.find_on_spheres(scene, wave);
        }
        if scene.has_instances() {
            self.find_on_instances(scene, wave);
        }

        // Turn the normals to the side that the rays came from, and move off to there.
        for number in 0..count {
            let normal = get(&self.own_normals, number);
            let outside = is_outside(get(&self.directions, number), normal);
            let turned = if outside { normal } else { -normal };
            let position = get(&self.positions, number);
            let point = SurfacePoint { position, normal, clearance: self.clearances[number] };
            set(&mut self.geometric_normals, number, turned);
            set(&mut self.origins, number, point.origin_towards(turned));
        }

        // Interpolate the normals that the mesh gives per vertex.
        if scene.scene().mesh.normals.is_empty() {
            self.normals = self.geometric_normals;
        } else {
            for number in 0..count {
                let [u, v] = [self.weights[0][number], self.weights[1][number]];
                let normal = (1.0 - u - v) * get(&self.corner_normals[0], number)
                    + u * get(&self.corner_normals[1], number)
                    + v * get(&self.corner_normals[2], number);
                let geometric = get(&self.geometric_normals, number);
                set(&mut self.normals, number, bent_normal(normal, geometric));
            }
        }
        self.find_colors(scene, wave);
    }

    /// Has it kept in mind what textured surfaces are made of.
    pub(crate) fn keep_what_all_is_made_of(&mut self) {
        self.made_of.get_or_insert_default();
    }

    /// What a surface is made of, if it is described by metal and roughness. Of textured surfaces only where that is kept in mind.
    pub(crate) fn made_of(
        &self,
        scene: &PreparedScene<'_>,
        number: usize,
    ) -> Option<MetallicRoughness> {
        let material = self.materials[number];
        if let Some(own) = material.checked_sub(scene.material_count()) {
            return self.made_of.as_ref()?.get(own as usize).copied().flatten();
        }
        let made_of = scene.scene().materials.get(material as usize)?.metallic_roughness?;
        let base = made_of.base * vertex_color(scene, self, number);
        Some(MetallicRoughness { base, ..made_of })
    }

    /// Finds how long the ways from the eye to the surfaces are.
    #[inline(always)]
    pub(crate) fn find_lengths(&mut self, wave: &impl Traced) {
        for number in 0..self.count() {
            self.lengths[number] = wave.travelled(self.ray(number)) + self.distances[number];
        }
    }

    /// Gathers from all over the scene what the rays hit.
    #[inline(always)]
    fn gather(
        &mut self,
        scene: &PreparedScene<'_>,
        wave: &impl Traced,
        miss: &mut impl FnMut(usize),
    ) {
        let mesh = &scene.scene().mesh;
        let mut count = 0;
        for ray in 0..wave.len().min(WAVE) {
            let Some(hit) = wave.hit(ray) else {
                miss(ray);
                continue;
            };
            self.rays[count] = ray as u32;
            self.primitives[count] = hit.primitive;
            self.instances[count] = hit.instance;
            self.distances[count] = hit.t;
            self.weights[0][count] = hit.u;
            self.weights[1][count] = hit.v;
            set(&mut self.directions, count, wave.direction(ray));
            count += 1;
        }
        self.count = count;

        // One array after the other, so that the waits for memory overlap.
        let count = self.count();
        let mut corners = [[0; WAVE]; 3];
        for number in 0..count {
            self.materials[number] = scene.material_index(self.element(number)) as u32;
        }
        for number in 0..count {
            let triangle = match scene.which(self.primitives[number]) {
                Which::Triangle(triangle) => mesh.triangles.triangles()[triangle as usize],
                Which::Sphere(_) => [u32::MAX; 3],
            };
            for (corners, vertex) in corners.iter_mut().zip(triangle) {
                corners[number] = vertex;
            }
        }
        gather_vertices(mesh.triangles.positions(), &corners, count, &mut self.corners);
        if !mesh.normals.is_empty() {
            gather_vertices(&mesh.normals, &corners, count, &mut self.corner_normals);
        }
        if scene.moves() {
            for number in 0..count {
                self.times[number] = wave.time(self.ray(number));
            }
        }
        if scene.has_instances() {
            self.place(scene);
        }
    }

    /// Takes what was gathered of instances from their objects' spaces into the world.
    fn place(&mut self, scene: &PreparedScene<'_>) {
        let has_normals = !scene.scene().mesh.normals.is_empty();
        for number in 0..self.count() {
            let Some(placed) = scene.placed(self.instances[number]) else { continue };
            let way = placed.way(self.time(number));
            for corner in 0..3 {
                let position = get(&self.corners[corner], number);
                set(&mut self.corners[corner], number, way.to_world.point(position));
                if has_normals {
                    let normal = get(&self.corner_normals[corner], number);
                    set(&mut self.corner_normals[corner], number, way.normal(normal));
                }
            }
        }
    }

    /// Finds the points on instances, to all digits: corners in the world are rounded, and face the other way where they are mirrored.
    fn find_on_instances(&mut self, scene: &PreparedScene<'_>, wave: &impl Traced) {
        for number in 0..self.count() {
            if scene.placed(self.instances[number]).is_none() {
                continue;
            }
            let ray = self.ray(number);
            let Some(hit) = wave.hit(ray) else { continue };
            let ray = Ray::new(wave.origin(ray), wave.direction(ray));
            let point = scene.tracer().surface_point(&ray, &hit, self.time(number));
            set(&mut self.positions, number, point.position);
            set(&mut self.own_normals, number, point.normal);
            self.clearances[number] = point.clearance;
        }
    }

    #[inline(always)]
    fn find_on_spheres(&mut self, scene: &PreparedScene<'_>, wave: &impl Traced) {
        for number in 0..self.count() {
            let ray = self.ray(number);
            let Some(hit) = wave.hit(ray) else { continue };
            let Which::Sphere(sphere) = scene.which(hit.primitive) else { continue };
            let (center, radius) = scene.scene().spheres.as_slice()[sphere as usize];
            let (origin, direction) = (wave.origin(ray), wave.direction(ray));
            let point = SurfacePoint::on_sphere(center, radius, origin, direction, hit.t);
            set(&mut self.positions, number, point.position);
            set(&mut self.own_normals, number, point.normal);
            self.clearances[number] = point.clearance;
        }
    }

    /// Finds the diffuse colours: those of the materials, their patterns, times what the mesh gives per vertex.
    #[inline(always)]
    fn find_colors(&mut self, scene: &PreparedScene<'_>, wave: &impl Traced) {
        let mut patterned = [0; WAVE];
        let mut left = 0;
        for number in 0..self.count() {
            let SurfaceMaterial { diffuse, pattern, .. } = scene.material(self.materials[number]);
            set(&mut self.diffuse, number, *diffuse);
            patterned[left] = number as u8;
            left += usize::from(*pattern != Pattern::Plain);
        }

        // All points of one pattern together.
        while left > 0 {
            let material = self.materials[patterned[0] as usize];
            let mut same = [0; WAVE];
            let (mut same_count, mut others) = (0, 0);
            let mut points = ZERO;
            for entry in 0..left {
                let number = patterned[entry];
                let is_same = self.materials[number as usize] == material;
                set(&mut points, same_count, get(&self.positions, number as usize));
                same[same_count] = number;
                patterned[others] = number;
                same_count += usize::from(is_same);
                others += usize::from(!is_same);
            }
            left = others;

            let SurfaceMaterial { diffuse, pattern, .. } = scene.material(material);
            let mut colors = ZERO;
            pattern.colors(*diffuse, &points, &mut colors, same_count);
            for (place, &number) in same[..same_count].iter().enumerate() {
                set(&mut self.diffuse, number as usize, get(&colors, place));
            }
        }

        let mesh = &scene.scene().mesh;
        if !mesh.colors.is_empty() {
            for number in 0..self.count() {
                let Some(hit) = wave.hit(self.ray(number)) else { continue };
                let Which::Triangle(triangle) = scene.which(hit.primitive) else { continue };
                let [a, b, c] = mesh.triangles.triangles()[triangle as usize];
                let color =
                    |vertex: u32| mesh.colors.get(vertex as usize).copied().unwrap_or(Rgb::ONE);
                let color = (1.0 - hit.u - hit.v) * color(a) + hit.u * color(b) + hit.v * color(c);
                let diffuse = get(&self.diffuse, number) * color;
                set(&mut self.diffuse, number, diffuse);
            }
        }
        if scene.has_instances() {
            for number in 0..self.count() {
                if let Some(placed) = scene.placed(self.instances[number]) {
                    let diffuse = get(&self.diffuse, number) * placed.tint;
                    set(&mut self.diffuse, number, diffuse);
                }
            }
        }
    }
}

/// Gathers what a mesh has at the corners of triangles; zeros where it has nothing.
#[inline(always)]
fn gather_vertices(
    vertices: &[Vec3],
    corners: &[[u32; WAVE]; 3],
    count: usize,
    gathered: &mut [Columns; 3],
) {
    for (corners, gathered) in corners.iter().zip(gathered) {
        for (number, &vertex) in corners[..count].iter().enumerate() {
            let found = vertices.get(vertex as usize).copied().unwrap_or(Vec3::ZERO);
            set(gathered, number, found);
        }
    }
}

/// Whether a ray comes from the side that a surface's own normal points to.
#[inline(always)]
fn is_outside(direction: Vec3, normal: Vec3) -> bool {
    direction.dot(normal) <= 0.0
}
