//! A tree that follows a geometry which changes from picture to picture, and looks after its own quality. When a tree is to be built anew follows Lauterbach, Yoon, Tuft and
//! Manocha, "RT-DEFORM: Interactive Ray Tracing of Dynamic Scenes using BVHs", 2006: not after so many pictures, but when the cost by the surface area heuristic has grown.

use super::{Decision, RefitError, Update, UpdateOptions, check_primitives};
use crate::structures::AccelerationStructure;
use crate::structures::wide::Measured;
use crate::{BuildError, Bvh, Geometry, SimdLevel, WideBvh};

/// A [`Bvh`] over a geometry that changes.
///
/// [`update`](Self::update) does what is needed to follow it: most often new boxes, which takes a twentieth of the time of a build; where the tree has become bad in places, these are built
/// anew; and all of it, if it is bad in general or too much has come and gone. What it has decided by which numbers it tells.
///
/// ```
/// use raywood::{Decision, DynamicBvh, Ray, TriangleMesh};
///
/// let mesh = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
/// let mut scene = DynamicBvh::build(mesh)?;
/// for step in 1..4 {
///     let x = step as f32;
///     let moved = scene.bvh().geometry().with_positions(vec![[x, 0.0, 0.0], [x + 1.0, 0.0, 0.0], [x, 1.0, 0.0]])?;
///     let update = scene.update(moved)?;
///     assert_eq!(update.decision, Decision::Refitted);
///     assert!(scene.bvh().occluded(&Ray::new([x + 0.2, 0.2, 1.0], [0.0, 0.0, -1.0])));
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// # Rays in other threads
///
/// An update takes the tree for itself (`&mut self`), so no batch of rays sees one half changed. Who wants to trace the last picture while the next is prepared clones the
/// [`Bvh`], which shares memory instead of copying it: `let snapshot = Arc::new(scene.bvh().clone())`. As long as a snapshot lives, updates leave its memory alone and make their
/// own; once the last is dropped they change the tree in place again. Two trees that take turns never copy.
#[derive(Clone, Debug)]
pub struct DynamicBvh<G> {
    bvh: Bvh<G>,
    options: UpdateOptions,
    /// What the tree cost when it was last built, of what was repaired since then the cost then; and what its parts added to that.
    built: Measured,
    /// How many primitives were in what was repaired since all was built.
    repaired: usize,
    /// The number of the first primitive that has come since all was built: they are all kept together.
    first_new: usize,
}

/// A tree in which primitives were exchanged.
struct Exchange {
    tree: WideBvh,
    decision: Decision,
    /// What the tree counts as having cost when it was built.
    built: Measured,
    /// How many primitives were in what was repaired then.
    repaired: usize,
}

impl<G: Geometry> DynamicBvh<G> {
    /// Builds the tree with good defaults.
    ///
    /// # Errors
    ///
    /// As [`Bvh::build`].
    pub fn build(geometry: G) -> Result<Self, BuildError> {
        Self::build_with(geometry, UpdateOptions::default())
    }

    /// Builds the tree with the given options.
    ///
    /// # Errors
    ///
    /// As [`Bvh::build`].
    pub fn build_with(geometry: G, options: UpdateOptions) -> Result<Self, BuildError> {
        let bvh = Bvh::build_with(geometry, &options.build)?;
        let built = bvh.tree().measured();
        let first_new = bvh.geometry().len();
        Ok(Self { bvh, options, built, repaired: 0, first_new })
    }

    /// The tree with its geometry and all queries.
    pub fn bvh(&self) -> &Bvh<G> {
        &self.bvh
    }

    /// The tree, no longer looked after.
    pub fn into_bvh(self) -> Bvh<G> {
        self.bvh
    }

    /// Has other vector instructions trace the tree, as [`Bvh::set_simd_level`] does, also after it is built anew.
    pub fn set_simd_level(&mut self, level: SimdLevel) {
        self.bvh.set_simd_level(level);
    }

    /// How it is decided what to do.
    pub fn options(&self) -> &UpdateOptions {
        &self.options
    }

    /// Puts a geometry in the place of the one before, and has the tree follow. Hits are those of a tree that is built over it, whatever is decided.
    ///
    /// There may be more primitives than before or fewer: these have the highest numbers, and all others keep theirs and are where they were or have moved. So who takes one out puts the last one in its
    /// place, which then has moved. If few come or go, only the parts of the tree that they are in are built anew, which is told as [`Decision::Repaired`].
    ///
    /// ```
    /// use raywood::{Decision, DynamicBvh, Ray, Spheres, Vec3};
    ///
    /// let mut balls: Vec<_> = (0..1000).map(|i| (Vec3::new(3.0 * (i % 30) as f32, 3.0 * (i / 30) as f32, 0.0), 1.0)).collect();
    /// let mut scene = DynamicBvh::build(Spheres::new(balls.clone())?)?;
    ///
    /// balls.push((Vec3::new(-5.0, 0.0, 0.0), 1.0));
    /// let update = scene.update(Spheres::new(balls.clone())?)?;
    /// assert!(matches!(update.decision, Decision::Repaired { .. }));
    /// let ray = Ray::new([-5.0, 0.0, 9.0], [0.0, 0.0, -1.0]);
    /// assert_eq!(scene.bvh().intersect(&ray).map(|hit| hit.primitive), Some(1000));
    ///
    /// balls.pop();
    /// scene.update(Spheres::new(balls)?)?;
    /// assert!(!scene.bvh().occluded(&ray));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// O(N) in parallel in the caller's rayon pool for new boxes and the measurement that goes with them; O(N) and O(k log k) for `k` primitives in subtrees that are built anew; O(N log N)
    /// for all of them. The decision, and the tree, is the same for any number of threads.
    ///
    /// # Errors
    ///
    /// As [`Bvh::build`]. Of a geometry with a box that is empty or not finite nothing is taken on. If memory is too short to build anew, or not allowed, the tree has taken on
    /// the geometry with new boxes alone if there are as many primitives as before; else it stays as it was.
    pub fn update(&mut self, geometry: G) -> Result<Update, BuildError> {
        if geometry.len() != self.bvh.geometry.len() {
            return self.update_others(geometry);
        }
        let refitted = match self.bvh.tree.refit_measured(&geometry) {
            Ok(refitted) => refitted,
            Err(RefitError::BadBounds { primitive, bounds }) => {
                return Err(BuildError::BadBounds { primitive, bounds });
            }
            // A tree that was never one.
            Err(_) => {
                self.bvh.tree = self.built_over(&geometry)?;
                self.bvh.geometry = geometry;
                return Ok(self.rebuilt(f64::INFINITY));
            }
        };
        self.bvh.geometry = geometry;
        let cost = refitted.cost;
        if cost <= self.limit(self.built.cost) {
            let built_cost = self.built.cost;
            let decision = Decision::Refitted;
            return Ok(Update { decision, built_cost, refitted_cost: cost, cost });
        }
        if let Some(update) = self.repair(&refitted)? {
            return Ok(update);
        }
        self.bvh.tree = self.built_over(&self.bvh.geometry)?;
        Ok(self.rebuilt(refitted.cost))
    }

    /// Takes on a geometry with more or fewer primitives.
    fn update_others(&mut self, geometry: G) -> Result<Update, BuildError> {
        if let Err(RefitError::BadBounds { primitive, bounds }) =
            check_primitives(&geometry, geometry.len())
        {
            return Err(BuildError::BadBounds { primitive, bounds });
        }
        let Some(Exchange { mut tree, decision, built, repaired }) = self.exchange(&geometry)?
        else {
            self.bvh.tree = self.built_over(&geometry)?;
            self.bvh.geometry = geometry;
            return Ok(self.rebuilt(f64::INFINITY));
        };
        // What is in other parts of the tree may have moved.
        let refitted = tree.refit_measured(&geometry);
        let Some(Measured { cost, .. }) =
            refitted.ok().filter(|refitted| refitted.cost <= self.limit(built.cost))
        else {
            self.bvh.tree = self.built_over(&geometry)?;
            self.bvh.geometry = geometry;
            return Ok(self.rebuilt(f64::INFINITY));
        };
        let count = geometry.len();
        self.first_new = self.first_new.min(count);
        (self.bvh.tree, self.bvh.geometry) = (tree, geometry);
        let built_cost = built.cost;
        (self.built, self.repaired) = (built, repaired);
        Ok(Update { decision, built_cost, refitted_cost: f64::INFINITY, cost })
    }

    /// A tree without the primitives that are gone and with those that are new, all others still where they were; `None` if too much of it would be built.
    fn exchange(&self, geometry: &G) -> Result<Option<Exchange>, BuildError> {
        let (before, now) = (self.bvh.geometry.len(), geometry.len());
        let build = &self.options.build;
        // Who limits the memory wants to be asked before it is taken.
        if now > BuildError::MAX_PRIMITIVES || build.memory_limit.is_some() {
            return Ok(None);
        }
        // What is new comes together with what was new before: one tree of all that, not one beside the other.
        let tree = &self.bvh.tree;
        let from = if now > before { self.first_new } else { now };
        let chosen = tree.cuttings_from(from as u32);
        let mut primitives = tree.primitives_in(&chosen);
        primitives.retain(|&primitive| (primitive as usize) < now);
        primitives.extend(before as u32..now as u32);
        let repaired = self.repaired + primitives.len();
        if repaired as f64 > self.options.max_repair_share * now as f64 {
            return Ok(None);
        }
        let cost_before = tree.measured().cost;
        let Some(tree) = tree.with_new_bough(geometry, (&chosen, &primitives), build)? else {
            return Ok(None);
        };

        // By how much the tree has become worse since it was built does not change with what comes and goes.
        let Measured { cost, cuttings } = tree.measured();
        let built = Measured { cost: cost * (self.built.cost / cost_before), cuttings };
        let subtrees = chosen.iter().filter(|is_chosen| **is_chosen).count();
        let decision = Decision::Repaired { subtrees, primitives: primitives.len() };
        Ok(Some(Exchange { tree, decision, built, repaired }))
    }

    /// How much may be expected of what cost so much when it was built.
    fn limit(&self, built: f64) -> f64 {
        // What is not a number allows nothing beyond.
        self.options.max_growth.max(1.0) * built
    }

    /// Builds anew what is in the parts that have become too bad; `None`, and nothing changes, if that is too much or does not help.
    fn repair(&mut self, refitted: &Measured) -> Result<Option<Update>, BuildError> {
        let (tree, geometry) = (&self.bvh.tree, &self.bvh.geometry);
        let costs = || refitted.cuttings.iter().zip(&self.built.cuttings);
        // Less is allowed to each than to the whole, or what is left of all of them would soon be too much.
        let limit = self.limit(1.0).sqrt();
        let chosen: Vec<_> = costs().map(|(now, built)| *now > limit * built).collect();
        let subtrees = chosen.iter().filter(|is_chosen| **is_chosen).count();
        let primitives = tree.primitives_in(&chosen);
        // Every repair leaves trees beside each other that a build would make one of. Of a limit that is no number nothing is allowed.
        let repaired = self.repaired + primitives.len();
        let is_allowed = repaired as f64 <= self.options.max_repair_share * geometry.len() as f64;
        if subtrees == 0 || !is_allowed {
            return Ok(None);
        }
        let options = &self.options.build;
        let tree = tree.with_new_bough(geometry, (&chosen, &primitives), options)?;
        let Some(tree) = tree else { return Ok(None) };

        // What is new is measured by what it costs now, what is left by what it cost when it was built.
        let Measured { cost, cuttings } = tree.measured();
        let left = costs().zip(&chosen).filter(|(_, is_chosen)| !**is_chosen);
        let growth: f64 = left.map(|((now, built), _)| now - built).sum();
        let built_cost = cost - growth;
        if cost > self.limit(built_cost) {
            return Ok(None);
        }
        self.bvh.tree = tree;
        self.built = Measured { cost: built_cost, cuttings };
        self.repaired = repaired;
        let decision = Decision::Repaired { subtrees, primitives: primitives.len() };
        Ok(Some(Update { decision, built_cost, refitted_cost: refitted.cost, cost }))
    }

    /// A new tree, traced by the same instructions.
    fn built_over(&self, geometry: &G) -> Result<WideBvh, BuildError> {
        let mut tree = WideBvh::build(geometry, &self.options.build)?;
        tree.set_simd_level(self.bvh.simd_level());
        Ok(tree)
    }

    /// What is told of a tree that was built anew just now.
    fn rebuilt(&mut self, refitted_cost: f64) -> Update {
        self.built = self.bvh.tree.measured();
        self.repaired = 0;
        self.first_new = self.bvh.geometry.len();
        let cost = self.built.cost;
        Update { decision: Decision::Rebuilt, built_cost: cost, refitted_cost, cost }
    }
}
