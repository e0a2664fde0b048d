//! Cycles of major iterations: a node that alternates between two elements, or modes that change back and forth with the
//! geometry, so that the increment never converges.

use crate::interface::cycle;
use crate::{ContactState, Mode, SurfacePoint};
use serde::{Deserialize, Serialize};

/// Numbers of two major iterations with a smaller relative difference are equal.
const REPEATED: f64 = 1e-10;
/// Numbers with a larger relative difference are different; between the two limits, the iteration may still converge.
const DIFFERENT: f64 = 1e-7;

/// State of the slave nodes at the start of every major iteration of the current increment.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct MajorHistory {
    /// One entry per slave node, iteration after iteration.
    entries: Vec<MajorEntry>,
}

/// State of one slave node at the start of a major iteration.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct MajorEntry {
    mode: Mode,
    spot: Option<SurfacePoint>,
    f_n: f64,
    f_t: f64,
    /// Position of the node.
    at: [f64; 2],
}

/// A cycle of major iterations.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct MajorCycle {
    /// Major iteration from which it repeats.
    pub start: u32,
    /// Period in major iterations, at least 2.
    pub period: u32,
    /// Contact nodes (by slave number) that change within the cycle, with the stops of each during one period.
    pub members: Vec<(usize, Vec<Stop>)>,
}

/// Mode of a slave node, and the master element (surface, element) of S*.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stop {
    /// Mode.
    pub mode: Mode,
    /// Numbers of surface and element. `None` beyond the ends of all surfaces.
    pub element: Option<(usize, usize)>,
}

/// Scales of forces and lengths.
#[derive(Debug, Clone, Copy)]
pub struct RepeatScales {
    /// Force scale.
    pub force: f64,
    /// Length scale.
    pub length: f64,
}

impl MajorCycle {
    /// The members that change their mode or element. The others follow them; if there are none, only numbers change.
    pub fn changing(&self) -> impl Iterator<Item = &(usize, Vec<Stop>)> {
        let changes = |stops: &[Stop]| stops.windows(2).any(|pair| pair[0] != pair[1]);
        let members = self.members.iter();
        members.filter(move |(_, stops)| changes(stops))
    }
}

impl MajorEntry {
    fn from_node(node: &ContactState, at: [f64; 2]) -> Self {
        MajorEntry {
            at,
            mode: node.mode,
            spot: node.spot,
            f_n: node.f_n,
            f_t: node.f_t,
        }
    }

    fn stop(&self) -> Stop {
        Stop {
            mode: self.mode,
            element: self.spot.map(|s| (s.surface, s.element)),
        }
    }

    /// Whether the stops are equal and the numbers differ by less than `limit`, in units of the scales.
    fn within(&self, other: &MajorEntry, scales: RepeatScales, limit: f64) -> bool {
        let along = match (self.spot, other.spot) {
            (Some(a), Some(b)) => (a.xi - b.xi).abs(),
            _ => 0.0,
        };
        self.stop() == other.stop()
            && along <= limit
            && (self.f_n - other.f_n).abs() <= limit * scales.force
            && (self.f_t - other.f_t).abs() <= limit * scales.force
            && (0..2).all(|k| (self.at[k] - other.at[k]).abs() <= limit * scales.length)
    }
}

impl MajorHistory {
    /// Removes all entries, but keeps the memory.
    pub fn clear(&mut self) {
        self.entries.clear();
    }

    /// Whether no iteration is recorded.
    pub fn is_empty(&self) -> bool {
        self.entries.is_empty()
    }

    /// Records the start of the next major iteration, with the positions of the slave nodes.
    pub fn push(&mut self, nodes: &[ContactState], positions: impl Iterator<Item = [f64; 2]>) {
        let nodes = nodes.iter().zip(positions);
        self.entries
            .extend(nodes.map(|(node, at)| MajorEntry::from_node(node, at)));
    }

    /// The cycle that ends if the last recorded iteration, the major iteration `major`, starts from the same state as an earlier
    /// one, with a different state in between.
    pub fn cycle(&self, slaves: usize, major: u32, scales: RepeatScales) -> Option<MajorCycle> {
        let width = slaves.max(1);
        let count = self.entries.len() / width;
        let of = |k: usize| &self.entries[k * width..(k + 1) * width];
        let here = count.checked_sub(1)?;
        let all_within = |then: usize, limit: f64| {
            of(then)
                .iter()
                .zip(of(here))
                .all(|(a, b)| a.within(b, scales, limit))
        };
        let same = |then: usize| all_within(then, REPEATED);
        let round = cycle::closed(here, 2, same, |then| !all_within(then, DIFFERENT))?;
        let stops = |s: usize| round.clone().map(move |k| of(k)[s]);
        let takes_part =
            |s: &usize| stops(*s).any(|entry| !entry.within(&of(here)[*s], scales, DIFFERENT));
        let period = round.len() as u32;
        Some(MajorCycle {
            start: major - period,
            period,
            members: (0..slaves)
                .filter(takes_part)
                .map(|s| (s, stops(s).map(|entry| entry.stop()).collect()))
                .collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::state::ContactState;

    const HERE: [[f64; 2]; 1] = [[0.0; 2]];
    const ONE: RepeatScales = RepeatScales {
        force: 1.0,
        length: 1.0,
    };

    fn nodes(xi: f64, element: usize) -> Vec<ContactState> {
        let spot = SurfacePoint {
            surface: 0,
            element,
            xi,
        };
        let mut node = ContactState::new(Mode::Sliding, &Default::default());
        node.spot = Some(spot);
        vec![node]
    }

    #[test]
    fn passing_to_and_fro_between_two_elements_is_a_cycle_of_majors() {
        let mut rounds = MajorHistory::default();
        for k in 0..5 {
            rounds.push(&nodes(0.3, k % 2), HERE.into_iter());
            let cycle = rounds.cycle(1, k as u32 + 1, ONE);
            assert_eq!(cycle.is_some(), k >= 2, "{k}");
            if let Some(cycle) = cycle {
                assert_eq!((cycle.start, cycle.period), (k as u32 - 1, 2));
                assert_eq!(cycle.members.len(), 1);
            }
        }
    }

    /// Two nodes: the first moves for a while and then rests, the second cycles through elements and modes.
    fn planted(transient: usize, period: usize, k: usize) -> Vec<ContactState> {
        let along = 0.1 * transient.saturating_sub(k) as f64;
        let mut two = nodes(along, 7);
        let round = (k + 3 * period - transient) % period;
        let mut goes = nodes(0.2, round / 2);
        goes[0].mode = [Mode::Sliding, Mode::Fixed][round % 2];
        goes[0].f_n = 1.0 + 0.5 * round as f64;
        two.append(&mut goes);
        two
    }

    #[test]
    fn a_planted_round_of_majors_is_found_with_its_start_period_and_stops() {
        for (transient, period) in [(0, 2), (0, 3), (1, 4), (2, 5), (3, 7)] {
            let mut rounds = MajorHistory::default();
            for k in 0..=transient + period {
                let places = [[0.0; 2], [1.0, 0.0]];
                rounds.push(&planted(transient, period, k), places.into_iter());
                let found = rounds.cycle(2, k as u32 + 1, ONE);
                assert_eq!(found.is_some(), k == transient + period, "{period}: {k}");
                let Some(found) = found else { continue };
                let at = (found.start as usize, found.period as usize);
                assert_eq!(at, (transient + 1, period));
                let [(slave, stops)] = found.members.as_slice() else {
                    panic!("{found:?}")
                };
                assert_eq!((*slave, stops.len()), (1, period));
                for (round, stop) in stops.iter().enumerate() {
                    assert_eq!(stop.element, Some((0, round / 2)));
                    assert_eq!(stop.mode, [Mode::Sliding, Mode::Fixed][round % 2]);
                }
            }
        }
    }

    #[test]
    fn standing_still_and_drifting_away_are_no_cycles() {
        let (mut still, mut drifting) = (MajorHistory::default(), MajorHistory::default());
        for k in 0..20 {
            still.push(&nodes(0.3, 0), HERE.into_iter());
            assert_eq!(still.cycle(1, k + 1, ONE), None);
            let away = nodes(1e-6 * f64::from(k), (k % 2) as usize);
            drifting.push(&away, HERE.into_iter());
            assert_eq!(drifting.cycle(1, k + 1, ONE), None);
        }
    }

    #[test]
    fn converging_to_and_fro_is_no_cycle() {
        let mut rounds = MajorHistory::default();
        for k in 0..60 {
            let xi = 0.5_f64.powi(k) * if k % 2 == 0 { 1.0 } else { -1.0 };
            rounds.push(&nodes(xi, 0), HERE.into_iter());
            assert_eq!(rounds.cycle(1, k as u32 + 1, ONE), None, "{k}");
        }
    }
}
