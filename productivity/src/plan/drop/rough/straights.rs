//! Straight ways on layers that were asked of the faces already.

use std::collections::HashMap;
use std::sync::{Mutex, PoisonError};

/// A layer's floor, and both ends across the axis.
type Key = [u64; 5];

/// Ways that were asked for, each without its end; None where the tool may not be, and up walls.
#[derive(Default)]
pub(super) struct Straights {
    known: Mutex<HashMap<Key, Option<Vec<[f64; 3]>>>>,
}

impl Straights {
    pub fn of(&self, key: Key, way: impl FnOnce() -> Option<Vec<[f64; 3]>>) -> Option<Vec<[f64; 3]>> {
        let lock = || self.known.lock().unwrap_or_else(PoisonError::into_inner);
        let known = lock().get(&key).cloned();
        known.unwrap_or_else(|| {
            let way = way();
            lock().insert(key, way.clone());
            way
        })
    }
}
