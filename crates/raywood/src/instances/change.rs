//! Scenes of instances that change: what moves, comes and goes counts from the next update on.

use super::{Instance, InstanceError, Tlas, Traceable, Transform, place};
use crate::{Decision, Update};

impl<B: Traceable> Tlas<B> {
    /// Moves an instance, which counts from the next [`update`](Self::update) or [`rebuild`](Self::rebuild) on.
    ///
    /// # Panics
    ///
    /// If there is no such instance.
    pub fn set_transform(&mut self, instance: usize, transform: Transform) {
        self.instances[instance].transform = transform;
    }

    /// Adds an instance, which counts from the next [`update`](Self::update) or [`rebuild`](Self::rebuild) on. Returns its number: that behind all others.
    pub fn insert(&mut self, instance: Instance<B>) -> usize {
        self.instances.push(instance);
        self.instances.len() - 1
    }

    /// Takes an instance away, which counts from the next [`update`](Self::update) or [`rebuild`](Self::rebuild) on; the last one gets its number. O(1). `None` if there is no such instance.
    /// To take one away for a while, set its [mask](Instance::mask) to zero.
    pub fn remove(&mut self, instance: usize) -> Option<Instance<B>> {
        (instance < self.instances.len()).then(|| self.instances.swap_remove(instance))
    }

    /// All instances, to be changed: which counts from the next [`update`](Self::update) or [`rebuild`](Self::rebuild) on.
    pub fn instances_mut(&mut self) -> &mut Vec<Instance<B>> {
        &mut self.instances
    }

    /// Builds the top-level tree anew over the instances as they are now, with the options of the first time. O(N log N) for N instances, whatever is in them; some 2 ms for ten thousand
    /// with the options of [`BuildPreset::Fastest`](crate::BuildPreset). As nothing else can use the scene meanwhile, all rays of a batch see the same.
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build); queries then still see the scene as it was.
    pub fn rebuild(&mut self) -> Result<(), InstanceError> {
        self.built = place::place(&self.instances)?.build(&self.options)?;
        Ok(())
    }

    /// Has the scene follow its instances as they are now: with new boxes in the tree as it is if these are the same instances, and if its expected cost `Q` is then at most `max_growth` times
    /// as high as when it was built, 1.5 say; else with a new one. Returns what was decided and the costs: see [`Update`]. Hits are the same in either case.
    ///
    /// O(N), and O(N log N) if the tree is built. The decision is the same for any number of threads. As nothing else can use the scene meanwhile, all rays of a batch see the same; who
    /// wants to trace the last picture while the next is prepared clones the scene, which copies the tree and shares the objects.
    ///
    /// ```
    /// use raywood::{Bvh, Decision, Instance, Ray, Tlas, Transform, TriangleMesh};
    /// use std::sync::Arc;
    ///
    /// let mesh = TriangleMesh::new(vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], vec![[0, 1, 2]])?;
    /// let leaf = Arc::new(Bvh::build(mesh)?);
    /// let at = |x: f32| Instance::new(Arc::clone(&leaf), Transform::translation([x, 0.0, 0.0]));
    /// let mut scene = Tlas::build((0..100).map(|x| at(2.0 * x as f32)).collect())?;
    ///
    /// scene.set_transform(7, Transform::translation([14.5, 0.0, 0.0]));
    /// assert_eq!(scene.update(1.5)?.decision, Decision::Refitted);
    /// let number = scene.insert(at(-5.0));
    /// assert_eq!(scene.update(1.5)?.decision, Decision::Rebuilt);
    /// let ray = Ray::new([-4.9, 0.1, 1.0], [0.0, 0.0, -1.0]);
    /// assert_eq!(scene.intersect(&ray).map(|hit| hit.instance), Some(number as u32));
    /// # Ok::<(), Box<dyn std::error::Error>>(())
    /// ```
    ///
    /// # Errors
    ///
    /// As [`build`](Self::build); queries then still see the scene as it was.
    pub fn update(&mut self, max_growth: f64) -> Result<Update, InstanceError> {
        let placed = place::place(&self.instances)?;
        let built_cost = self.built.built_cost;
        let mut tree = self.built.tree.clone();
        let refitted = tree.refit(&placed.boxes).map(|()| tree.cost());
        if let Some(cost) = refitted.filter(|&cost| cost <= max_growth.max(1.0) * built_cost) {
            self.built = placed.under(tree, built_cost);
            let decision = Decision::Refitted;
            return Ok(Update { decision, built_cost, refitted_cost: cost, cost });
        }
        self.built = placed.build(&self.options)?;
        let cost = self.built.built_cost;
        let refitted_cost = refitted.unwrap_or(f64::INFINITY);
        Ok(Update { decision: Decision::Rebuilt, built_cost: cost, refitted_cost, cost })
    }
}
