//! Loads whatever bytes as a saved tree, checksums made right, and asks it everything if it loads.

#![no_main]

use libfuzzer_sys::fuzz_target;
use raywood::{Joined, SavedTree};
use raywood_testkit::saved::{ask_everything, correct_checksums};

fuzz_target!(|bytes: &[u8]| {
    let mut file = bytes.to_vec();
    correct_checksums(&mut file);
    if let Ok(saved) = SavedTree::open(file) {
        let joined = Joined { first: saved.mesh(), second: saved.spheres() };
        ask_everything(&saved.bvh(joined).expect("it is its own"), 1);
    }
});
