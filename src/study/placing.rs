//! Places labels in a drawing, so that they do not overlap each other or markers, and stay inside.

/// A rectangle on a sheet; in pixels, y downwards.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// Its upper left corner.
    pub from: (f64, f64),
    /// Its lower right corner.
    pub to: (f64, f64),
}

impl Patch {
    /// The patch of this size around a point.
    pub fn about((x, y): (f64, f64), (width, height): (f64, f64)) -> Patch {
        Patch {
            from: (x - 0.5 * width, y - 0.5 * height),
            to: (x + 0.5 * width, y + 0.5 * height),
        }
    }

    /// Whether two patches share more than a border.
    pub fn meets(&self, other: &Patch) -> bool {
        self.from.0 < other.to.0
            && other.from.0 < self.to.0
            && self.from.1 < other.to.1
            && other.from.1 < self.to.1
    }

    fn holds(&self, other: &Patch) -> bool {
        self.from.0 <= other.from.0
            && self.from.1 <= other.from.1
            && self.to.0 >= other.to.0
            && self.to.1 >= other.to.1
    }

    /// Centre.
    pub fn middle(&self) -> (f64, f64) {
        (
            0.5 * (self.from.0 + self.to.0),
            0.5 * (self.from.1 + self.to.1),
        )
    }
}

/// The occupied parts of a window.
#[derive(Debug, Clone, PartialEq)]
pub struct OccupiedArea {
    window: Patch,
    taken: Vec<Patch>,
}

/// Directions in which a label is tried: next to the point first, then above and below.
const DIRECTIONS: [(f64, f64); 8] = [
    (1.0, -1.0),
    (1.0, 1.0),
    (-1.0, -1.0),
    (-1.0, 1.0),
    (1.0, 0.0),
    (-1.0, 0.0),
    (0.0, -1.0),
    (0.0, 1.0),
];

impl OccupiedArea {
    /// An empty window.
    pub fn within(window: Patch) -> OccupiedArea {
        OccupiedArea {
            window,
            taken: Vec::new(),
        }
    }

    /// Occupies a patch, whether free or not.
    pub fn take(&mut self, patch: Patch) {
        self.taken.push(patch);
    }

    /// Occupies the area of a line, in pieces.
    pub fn take_line(&mut self, from: (f64, f64), to: (f64, f64)) {
        const PIECE: f64 = 8.0;
        let length = (to.0 - from.0).hypot(to.1 - from.1);
        if !length.is_finite() {
            return;
        }
        let pieces = (length / PIECE).ceil().clamp(1.0, 400.0) as usize;
        for k in 0..=pieces {
            let part = k as f64 / pieces as f64;
            let at = (
                from.0 + part * (to.0 - from.0),
                from.1 + part * (to.1 - from.1),
            );
            self.take(Patch::about(at, (3.0, 3.0)));
        }
    }

    /// Finds and occupies a place for a label next to a point: the closest free one within `reach`. `None` if
    /// there is none.
    pub fn place(&mut self, at: (f64, f64), size: (f64, f64), reach: f64) -> Option<Patch> {
        /// Distance between a point and its label, and between two tries.
        const AIR: f64 = 7.0;
        let mut away = AIR;
        while away <= reach {
            for (right, down) in DIRECTIONS {
                let middle = (
                    at.0 + right * (away + 0.5 * size.0),
                    at.1 + down * (away + 0.5 * size.1 - 0.3 * AIR),
                );
                let patch = Patch::about(middle, size);
                let free = || !self.taken.iter().any(|other| other.meets(&patch));
                if self.window.holds(&patch) && free() {
                    self.take(patch);
                    return Some(patch);
                }
            }
            away += AIR;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_do_not_overlap_and_stay_inside() {
        let window = Patch {
            from: (0.0, 0.0),
            to: (300.0, 200.0),
        };
        let mut placing = OccupiedArea::within(window);
        let points: Vec<(f64, f64)> = (0..12)
            .map(|k| (20.0 + 3.0 * f64::from(k), 100.0))
            .collect();
        for &point in &points {
            placing.take(Patch::about(point, (8.0, 8.0)));
        }
        let mut found: Vec<Patch> = Vec::new();
        for &point in &points {
            let patch = placing.place(point, (40.0, 12.0), 200.0).unwrap();
            assert!(window.holds(&patch));
            assert!(found.iter().all(|other| !other.meets(&patch)), "{patch:?}");
            assert!(
                points
                    .iter()
                    .all(|p| !Patch::about(*p, (8.0, 8.0)).meets(&patch))
            );
            found.push(patch);
        }
        assert_eq!(placing.place((150.0, 100.0), (400.0, 12.0), 1e3), None);
    }
}
