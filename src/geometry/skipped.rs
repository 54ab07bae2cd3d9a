//! Candidates that a search skipped, of which only those before the hit count.

/// Distances of skipped candidates, kept until it is known which of them lie before the hit.
pub(super) struct Skipped {
    t: [f64; 16],
    len: usize,
    surely: u64,
}

impl Skipped {
    /// None yet.
    #[inline(always)]
    pub fn new() -> Self {
        Self { t: [0.0; 16], len: 0, surely: 0 }
    }

    pub fn push(&mut self, t: f64, limit: f64) {
        if self.len == self.t.len() {
            let mut kept = 0;
            for i in 0..self.len {
                if self.t[i] < limit {
                    self.t[kept] = self.t[i];
                    kept += 1;
                }
            }
            self.len = kept;
        }
        match self.t.get_mut(self.len) {
            Some(place) => {
                *place = t;
                self.len += 1;
            }
            None => self.surely += 1,
        }
    }

    pub fn before(&self, t: f64) -> u64 {
        self.surely + self.t[..self.len].iter().filter(|&&s| s < t).count() as u64
    }
}
