//! Where the tool has been lowest, with what it was before a trial.

/// Where the tool has been lowest next to each node.
pub(super) struct Been {
    places: Vec<Option<[f64; 3]>>,
    /// What places were since a trial began.
    before: Option<Vec<(usize, Option<[f64; 3]>)>>,
}

impl Been {
    pub fn nowhere(nodes: usize) -> Self {
        Self { places: vec![None; nodes], before: None }
    }

    pub fn of_node(&self, k: usize) -> Option<[f64; 3]> {
        self.places[k]
    }

    /// The tool is at a place next to a node.
    pub fn at(&mut self, k: usize, place: [f64; 3]) {
        let own = self.places[k];
        if own.is_some_and(|b| b[2] < place[2]) {
            return;
        }
        if let Some(before) = &mut self.before {
            before.push((k, own));
        }
        self.places[k] = Some(place);
    }

    pub fn try_out(&mut self) {
        self.before = Some(Vec::new());
    }

    pub fn restore(&mut self) {
        for (k, place) in self.before.take().unwrap_or_default().into_iter().rev() {
            self.places[k] = place;
        }
    }
}
