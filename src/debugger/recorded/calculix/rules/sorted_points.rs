//! Points sorted along an axis, and the extent of some numbers.

use nalgebra::Vector3;
use stickslip_core::plane::range;

/// A position or direction.
pub type Vector = Vector3<f64>;

/// Points sorted along the axis of their largest extent, to find near ones without a look at all of them.
#[derive(Debug, Clone)]
pub struct SortedPoints {
    points: Vec<Vector>,
    axis: usize,
    /// Coordinate and index of each point, ascending.
    keys: Vec<(f64, usize)>,
}

impl SortedPoints {
    /// Sorts points.
    pub fn new(points: Vec<Vector>) -> SortedPoints {
        let extents = Vector::from_fn(|axis, _| extent(points.iter().map(|point| point[axis])));
        let axis = (0..3).max_by(|a, b| extents[*a].total_cmp(&extents[*b]));
        let axis = axis.unwrap_or(0);
        let keys = points.iter().map(|point| point[axis]);
        let mut keys: Vec<(f64, usize)> = keys.zip(0..).collect();
        keys.sort_by(|a, b| a.0.total_cmp(&b.0));
        SortedPoints { points, axis, keys }
    }

    /// The direction to the nearest point; `None` if there is none, or it is at the same place.
    pub fn towards(&self, point: Vector) -> Option<Vector> {
        let mut best: Option<(f64, Vector)> = None;
        for (along, k) in self.from(point) {
            if best.is_some_and(|(known, _)| along >= known) {
                break;
            }
            let to = self.points[k] - point;
            if best.is_none_or(|(known, _)| to.norm() < known) {
                best = Some((to.norm(), to));
            }
        }
        best?.1.try_normalize(0.0)
    }

    /// The points by their distance along the axis, nearest first: this distance and the index.
    pub fn from(&self, point: Vector) -> impl Iterator<Item = (f64, usize)> {
        let at = point[self.axis];
        let start = self.keys.partition_point(|(key, _)| *key < at);
        let (mut below, mut above) = (start, start);
        std::iter::from_fn(move || {
            let key = |&(key, k): &(f64, usize)| ((key - at).abs(), k);
            let down = self.keys[..below].last().map(key);
            let up = self.keys.get(above).map(key);
            if down.is_some_and(|down| up.is_none_or(|up| down.0 <= up.0)) {
                below -= 1;
                return down;
            }
            above += 1;
            up
        })
    }
}

/// The difference between the largest and the smallest of some numbers.
pub fn extent(numbers: impl Iterator<Item = f64>) -> f64 {
    let [least, most] = range(numbers);
    most - least
}
