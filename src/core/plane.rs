//! Vectors in the plane, and the size of vectors of any length.

use std::borrow::Borrow;

/// a + b.
pub fn plus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] + b[0], a[1] + b[1]]
}

/// a − b.
pub fn minus(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] - b[0], a[1] - b[1]]
}

/// a · b.
pub fn dot(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// The component of a × b out of the plane.
pub fn cross(a: [f64; 2], b: [f64; 2]) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

/// `hypot` is ten times slower and unnecessary: squared lengths of a scene neither overflow nor underflow.
pub fn length(v: [f64; 2]) -> f64 {
    dot(v, v).sqrt()
}

/// The direction of a vector; `None` for zero.
pub fn unit(v: [f64; 2]) -> Option<[f64; 2]> {
    let length = length(v);
    (length > 0.0).then(|| v.map(|x| x / length))
}

/// The larger of two numbers; `most` if `other` is NaN. In a loop this is much faster than [`f64::max`], which treats NaN on both sides.
pub fn larger(most: f64, other: f64) -> f64 {
    if other > most { other } else { most }
}

/// The largest magnitude of some numbers; 0 for none.
pub fn max_abs(values: impl IntoIterator<Item: Borrow<f64>>) -> f64 {
    values
        .into_iter()
        .fold(0.0, |most, x| larger(most, x.borrow().abs()))
}

/// The smallest and the largest of some numbers; ∞ and -∞ for none.
pub fn range(values: impl IntoIterator<Item = f64>) -> [f64; 2] {
    let none = [f64::INFINITY, f64::NEG_INFINITY];
    values
        .into_iter()
        .fold(none, |[least, most], x| [least.min(x), most.max(x)])
}

/// The distance of a point from the segment from a to b.
pub fn distance_to_segment(point: [f64; 2], a: [f64; 2], b: [f64; 2]) -> f64 {
    let (along, to) = (minus(b, a), minus(point, a));
    let part = dot(to, along) / dot(along, along).max(f64::MIN_POSITIVE);
    let part = part.clamp(0.0, 1.0);
    length(minus(to, along.map(|x| part * x)))
}

/// The distance of a point from a closed outline with its inside on the left, if the point is inside; otherwise 0.
pub fn depth_inside(outline: &[[[f64; 2]; 2]], point: [f64; 2]) -> f64 {
    let turn = |&[a, b]: &[[f64; 2]; 2]| {
        let side = cross(minus(b, a), minus(point, a));
        match (a[1] <= point[1], b[1] <= point[1]) {
            (true, false) if side > 0.0 => 1,
            (false, true) if side < 0.0 => -1,
            _ => 0,
        }
    };
    if outline.iter().map(turn).sum::<i32>() == 0 {
        return 0.0;
    }
    let distances = outline
        .iter()
        .map(|[a, b]| distance_to_segment(point, *a, *b));
    distances.fold(f64::INFINITY, f64::min)
}

/// The distance of two points.
pub fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn depth_is_the_distance_from_the_outline_and_zero_outside() {
        let corners = [[0.0, 0.0], [2.0, 0.0], [2.0, 1.0], [0.0, 1.0]];
        let square: Vec<_> = (0..4).map(|k| [corners[k], corners[(k + 1) % 4]]).collect();
        assert_eq!(depth_inside(&square, [1.0, 0.25]), 0.25);
        assert_eq!(depth_inside(&square, [1.9, 0.5]), 0.10000000000000009);
        for outside in [[-0.1, 0.5], [1.0, 1.2], [3.0, 0.0], [1.0, -0.3]] {
            assert_eq!(depth_inside(&square, outside), 0.0);
        }
    }
}
