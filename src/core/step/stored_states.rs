//! Tree of the states of an attached solver, for programs that store what the solver continues from: [`StoredStates`].
//!
//! A place is the result of one iteration. It has a number, [`ExternalState::place`], the place before that iteration, and the changes
//! made there; the same changes at the same place give the same place. Place 0 is the start.
//!
//! [`ExternalState::place`]: super::state::ExternalState::place

use crate::Intervention;

/// The places of a solver, each with its stored data.
#[derive(Debug, Clone, PartialEq)]
pub struct StoredStates<T> {
    all: Vec<StoredState<T>>,
}

#[derive(Debug, Clone, PartialEq)]
struct StoredState<T> {
    from: Option<(u64, Vec<Intervention>)>,
    led_to: Vec<u64>,
    kept: T,
}

impl<T> StoredStates<T> {
    /// Only the start.
    pub fn new(start: T) -> Self {
        StoredStates {
            all: vec![StoredState {
                from: None,
                led_to: Vec::new(),
                kept: start,
            }],
        }
    }

    fn place(&self, place: u64) -> Option<&StoredState<T>> {
        self.all.get(usize::try_from(place).ok()?)
    }

    /// Data of a place; `None` if the place does not exist.
    pub fn get(&self, place: u64) -> Option<&T> {
        Some(&self.place(place)?.kept)
    }

    /// Mutable data of a place.
    pub fn get_mut(&mut self, place: u64) -> Option<&mut T> {
        let place = self.all.get_mut(usize::try_from(place).ok()?)?;
        Some(&mut place.kept)
    }

    /// Data of all places, by number.
    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut T> {
        self.all.iter_mut().map(|place| &mut place.kept)
    }

    /// The previous place, and the changes made there; `None` at the start.
    pub fn from(&self, place: u64) -> Option<(u64, &[Intervention])> {
        let (from, asked) = self.place(place)?.from.as_ref()?;
        Some((*from, asked))
    }

    /// The place that an iteration reached from another after these changes; `None` if it was not done yet.
    pub fn follows(&self, from: u64, asked: &[Intervention]) -> Option<u64> {
        self.place(from)?
            .led_to
            .iter()
            .copied()
            .find(|&place| self.from(place).is_some_and(|(_, before)| before == asked))
    }

    /// Adds the place that an iteration reached from another after these changes, and returns its number.
    pub fn add(&mut self, from: u64, asked: Vec<Intervention>, kept: T) -> u64 {
        let place = self.all.len() as u64;
        if let Some(from) = self.all.get_mut(from as usize) {
            from.led_to.push(place);
        }
        self.all.push(StoredState {
            from: Some((from, asked)),
            led_to: Vec::new(),
            kept,
        });
        place
    }

    /// The places from this one back to the start, including both.
    pub fn back(&self, place: u64) -> impl Iterator<Item = u64> {
        std::iter::successors(Some(place), |&place| Some(self.from(place)?.0))
    }

    /// Number of iterations from the start to a place.
    pub fn depth(&self, place: u64) -> usize {
        self.back(place).count() - 1
    }

    /// The places without successors, except the start, in the order in which they were reached.
    pub fn ends(&self) -> impl Iterator<Item = u64> {
        self.all
            .iter()
            .zip(0_u64..)
            .skip(1)
            .filter(|(place, _)| place.led_to.is_empty())
            .map(|(_, number)| number)
    }

    /// The steps from the start to a place: iterations (`None`) and changes.
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
        let mut places = StoredStates::new("start");
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
