//! The tree of the states that a solver of another's has had, for whoever keeps what the solver goes on from: [`Places`].
//!
//! A place is what one iteration led to. It has a number, [`Outside::place`], the place that it came from, and what was changed
//! there before the iteration; the same change at the same place leads to the same place. Place 0 is the start.
//!
//! [`Outside::place`]: super::state::Outside::place

use crate::step::intervention::Intervention;

/// The places of a solver, each with what is kept of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Places<T> {
    all: Vec<Place<T>>,
}

#[derive(Debug, Clone, PartialEq)]
struct Place<T> {
    from: Option<(u64, Vec<Intervention>)>,
    led_to: Vec<u64>,
    kept: T,
}

impl<T> Places<T> {
    /// The start alone.
    pub fn new(start: T) -> Self {
        Places {
            all: vec![Place {
                from: None,
                led_to: Vec::new(),
                kept: start,
            }],
        }
    }

    fn place(&self, place: u64) -> Option<&Place<T>> {
        self.all.get(usize::try_from(place).ok()?)
    }

    /// What is kept of a place; `None` where there is no such place.
    pub fn get(&self, place: u64) -> Option<&T> {
        Some(&self.place(place)?.kept)
    }

    /// The same, to be changed.
    pub fn get_mut(&mut self, place: u64) -> Option<&mut T> {
        let place = self.all.get_mut(usize::try_from(place).ok()?)?;
        Some(&mut place.kept)
    }

    /// What is kept of all places, by number.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut T> {
        self.all.iter_mut().map(|place| &mut place.kept)
    }

    /// The place that one came from, and what was changed there before; `None` at the start.
    pub fn from(&self, place: u64) -> Option<(u64, &[Intervention])> {
        let (from, asked) = self.place(place)?.from.as_ref()?;
        Some((*from, asked))
    }

    /// The place that an iteration led to from another, after these changes; `None` where it was not done yet.
    pub fn follows(&self, from: u64, asked: &[Intervention]) -> Option<u64> {
        let mut places = self.place(from)?.led_to.iter().copied();
        places.find(|&place| self.from(place).is_some_and(|(_, before)| before == asked))
    }

    /// A new place, that an iteration led to from another after these changes: its number.
    pub fn add(&mut self, from: u64, asked: Vec<Intervention>, kept: T) -> u64 {
        let place = self.all.len() as u64;
        if let Some(from) = self.all.get_mut(from as usize) {
            from.led_to.push(place);
        }
        self.all.push(Place {
            from: Some((from, asked)),
            led_to: Vec::new(),
            kept,
        });
        place
    }

    /// The places from one back to the start, itself first.
    pub fn back(&self, place: u64) -> impl Iterator<Item = u64> {
        std::iter::successors(Some(place), |&place| Some(self.from(place)?.0))
    }

    /// Number of iterations from the start to a place.
    pub fn depth(&self, place: u64) -> usize {
        self.back(place).count() - 1
    }

    /// The places from which nothing followed, but for the start, in the order in which they were reached.
    pub fn ends(&self) -> impl Iterator<Item = u64> {
        let numbered = self.all.iter().zip(0_u64..).skip(1);
        let ends = numbered.filter(|(place, _)| place.led_to.is_empty());
        ends.map(|(_, number)| number)
    }

    /// What leads from the start to a place: an iteration (`None`), or a change.
    pub fn steps(&self, place: u64) -> Vec<Option<Intervention>> {
        let mut steps = Vec::new();
        for place in self.back(place) {
            if let Some((_, asked)) = self.from(place) {
                steps.push(None);
                steps.extend(asked.iter().rev().cloned().map(Some));
            }
        }
        steps.reverse();
        steps
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::Mode;

    #[test]
    fn the_same_change_at_the_same_place_leads_to_the_same_place() {
        let forced = Intervention::Force {
            slave: 0,
            mode: Mode::Fixed,
            hold: false,
        };
        let mut places = Places::new("start");
        let one = places.add(0, Vec::new(), "one");
        let two = places.add(one, Vec::new(), "two");
        let other = places.add(one, vec![forced.clone()], "other");
        assert_eq!(places.follows(one, &[]), Some(two));
        assert_eq!(
            places.follows(one, std::slice::from_ref(&forced)),
            Some(other)
        );
        assert_eq!(places.follows(0, std::slice::from_ref(&forced)), None);
        assert_eq!((places.depth(0), places.depth(other)), (0, 2));
        assert_eq!(places.ends().collect::<Vec<_>>(), [two, other]);
        assert_eq!(places.steps(other), [None, Some(forced), None]);
        assert_eq!(places.get(9), None);
    }
}
