//! Increments of the load factor along the path, whole or cut: into halves, or once by the golden section.

use crate::Model;
use serde::{Deserialize, Serialize};

/// An increment, or a part of it after cuts into halves.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
pub struct SubIncrement {
    /// Load factor at the start of the whole increment.
    pub from: f64,
    /// Load factor at its end.
    pub to: f64,
    /// Number of times it was halved.
    pub cut: u32,
    /// Which of the 2^cut parts this is, from 0.
    pub part: u32,
    /// Load factor at the end of the increment of which this is the first part, cut off by the golden section. `None` if it is
    /// not such a part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rest: Option<f64>,
}

/// The smaller part of the golden section, (3 − √5)/2.
const SECTION: f64 = 0.381_966_011_250_105_2;

impl SubIncrement {
    /// The whole increment from a load factor on a leg of the path.
    pub fn whole(model: &Model, (from, leg): (f64, usize), increment: f64) -> Self {
        SubIncrement {
            from,
            to: next_load_factor(&model.path, (from, leg), increment),
            cut: 0,
            part: 0,
            rest: None,
        }
    }

    /// The rest of the whole increment from a load factor on, in one piece.
    pub fn rest(self, from: f64) -> Self {
        SubIncrement {
            from,
            cut: 0,
            part: 0,
            ..self
        }
    }

    /// Remainder of this part from the load factor `from`, which its halves have reached. Its successor is that of this part.
    pub fn remaining(self, from: f64) -> Self {
        let begin = match self.part {
            0 => self.from,
            part => SubIncrement {
                part: part - 1,
                ..self
            }
            .target(),
        };
        if from == begin {
            return self;
        }
        let to = self.target();
        let end = self.rest.unwrap_or(self.to);
        SubIncrement {
            from,
            to,
            cut: 0,
            part: 0,
            rest: (to != end).then_some(end),
        }
    }

    /// The first part of its golden section; the other one follows.
    pub fn section(self) -> Self {
        SubIncrement {
            to: self.from + SECTION * (self.to - self.from),
            rest: self.rest.or(Some(self.to)),
            ..self
        }
    }

    /// Load factor at its end.
    pub fn target(&self) -> f64 {
        let parts = 2_u64.pow(self.cut);
        if u64::from(self.part) + 1 == parts {
            return self.to;
        }
        self.from + (self.to - self.from) * f64::from(self.part + 1) / parts as f64
    }

    /// Size.
    pub fn size(&self) -> f64 {
        (self.to - self.from).abs() / 2_f64.powi(self.cut as i32)
    }

    /// Its first half.
    pub fn halved(self) -> Self {
        SubIncrement {
            cut: self.cut + 1,
            part: 2 * self.part,
            ..self
        }
    }

    /// The next part, as large as the halves allow. `None` if the whole increment is done.
    pub fn next(mut self) -> Option<Self> {
        self.part += 1;
        while self.cut > 0 && self.part.is_multiple_of(2) {
            (self.cut, self.part) = (self.cut - 1, self.part / 2);
        }
        match (self.cut, self.rest) {
            (0, None) => None,
            (0, Some(to)) => Some(SubIncrement {
                from: self.to,
                to,
                part: 0,
                rest: None,
                cut: 0,
            }),
            _ => Some(self),
        }
    }
}

/// The load factor one increment further along the path; the end of the leg if that is close.
///
/// After whole increments it is a multiple of the increment from the start of the leg, so that round-off does not add up.
fn next_load_factor(path: &[f64], (from, leg): (f64, usize), increment: f64) -> f64 {
    let (begin, target) = (path[leg], path[leg + 1]);
    let left = target - from;
    if left.abs() <= increment * (1.0 + 1e-9) {
        return target;
    }
    let size = path.iter().fold(from.abs(), |m, p| m.max(p.abs()));
    let after = |start: f64, count: f64| start + increment * count * left.signum();
    let whole = ((from - begin) / increment).abs().round();
    let next = match (after(begin, whole) - from).abs() <= 4.0 * f64::EPSILON * size {
        true => after(begin, whole + 1.0),
        false => after(from, 1.0),
    };
    tidy(next, size)
}

/// Rounds to 13 digits of the largest load factor if that changes no more than round-off, so that 0.07 is not
/// 0.07000000000000002, but a third stays a third.
fn tidy(load_factor: f64, size: f64) -> f64 {
    let unit = 10f64.powi(13 - size.log10().ceil() as i32);
    let rounded = (load_factor * unit).round() / unit;
    if (rounded - load_factor).abs() <= 4.0 * f64::EPSILON * size {
        rounded
    } else {
        load_factor
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Load factors at the ends of the increments of a path.
    fn walk(path: &[f64], increment: f64) -> Vec<f64> {
        let mut ends = vec![path[0]];
        for leg in 0..path.len() - 1 {
            while ends.last() != Some(&path[leg + 1]) {
                let from = ends[ends.len() - 1];
                ends.push(next_load_factor(path, (from, leg), increment));
            }
        }
        ends
    }

    #[test]
    fn load_factors_are_multiples_of_the_increment_whether_it_has_a_decimal_form_or_not() {
        for parts in [3, 6, 7, 60, 600, 7000] {
            let ends = walk(&[0.0, 1.0, 0.0], 1.0 / f64::from(parts));
            assert_eq!(ends.len(), 2 * parts as usize + 1);
            for (k, end) in ends.iter().enumerate() {
                let exact = f64::from(parts - (k as i32 - parts).abs()) / f64::from(parts);
                assert!((end - exact).abs() <= 2.3e-16, "{k}/{parts}: {end}");
            }
        }
        for (parts, middle) in [(6, 3), (60, 30), (600, 300), (7000, 3500)] {
            assert_eq!(walk(&[0.0, 1.0], 1.0 / f64::from(parts))[middle], 0.5);
        }
        // Decimals are exact, also on a leg that begins elsewhere and after an increment of another size.
        for (k, end) in walk(&[0.0, 0.25, -0.1], 0.01).iter().enumerate() {
            let hundredths = if k <= 25 { k as f64 } else { 50.0 - k as f64 };
            assert_eq!(*end, hundredths / 100.0);
        }
        assert_eq!(next_load_factor(&[0.0, 1.0], (0.03, 0), 0.07), 0.1);
        assert_eq!(
            next_load_factor(&[0.0, 1.0], (1.0 / 3.0, 0), 0.25),
            1.0 / 3.0 + 0.25
        );
    }

    #[test]
    fn what_is_left_of_a_part_begins_where_its_halves_have_come_to_and_never_before() {
        let quarter = SubIncrement {
            from: 1.0,
            to: 2.0,
            cut: 2,
            part: 1,
            rest: None,
        };
        assert_eq!(quarter.remaining(1.25), quarter);
        let mut left = quarter.remaining(1.375);
        assert_eq!((left.target(), left.size()), (1.5, 0.125));
        left = left.halved();
        let mut ends = vec![left.target()];
        while let Some(next) = left.next() {
            ends.push(next.target());
            left = next;
        }
        assert_eq!(ends, [1.4375, 1.5, 2.0]);
        let last = SubIncrement { part: 3, ..quarter };
        assert_eq!(last.remaining(1.875).next(), None);
    }

    #[test]
    fn a_section_and_what_follows_it_make_up_the_increment_however_it_is_cut() {
        let whole = SubIncrement {
            from: 0.25,
            to: 0.5,
            ..SubIncrement::default()
        };
        // A quarter of it is done when it fails.
        let left = SubIncrement {
            cut: 4,
            part: 4,
            ..whole
        }
        .rest(0.3125);
        assert_eq!((left.from, left.target(), left.cut), (0.3125, 0.5, 0));
        let mut piece = left.section().halved();
        let mut ends = Vec::new();
        loop {
            ends.push(piece.target());
            match piece.next() {
                Some(next) => piece = next,
                None => break,
            }
        }
        let golden = 0.3125 + 0.1875 * 0.5 * (3.0 - 5_f64.sqrt());
        assert_eq!(ends.len(), 3);
        assert!((ends[0] - 0.5 * (0.3125 + golden)).abs() < 1e-15);
        assert!((ends[1] - golden).abs() < 1e-15);
        assert_eq!(ends[2], 0.5);
        // A section of the remaining part ends where that part ends.
        assert_eq!(left.section().section().rest, Some(0.5));
    }
}
