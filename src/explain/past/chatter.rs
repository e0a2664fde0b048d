//! Who closes and opens again while a run iterates.

use super::round::changed;
use stickslip_exchange::calculix::past::PastRun;

/// How often a slave switched: from one iteration to the next of the same attempt it closed, opened, went to another master
/// face, or, a slave face, had more or fewer of its points in contact.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Chatter {
    /// The slave, by its position in the run.
    pub slave: usize,
    /// How often in the whole run.
    pub switches: usize,
    /// Attempts in which it switched, by their position in the run, with how often.
    pub attempts: Vec<(usize, usize)>,
}

impl Chatter {
    /// Most switches in one attempt.
    pub fn most(&self) -> usize {
        self.attempts
            .iter()
            .map(|(_, switches)| *switches)
            .max()
            .unwrap_or(0)
    }

    /// Whether it chatters: it switched more than once in one attempt, so that it came back or went on and on.
    pub fn chatters(&self) -> bool {
        self.most() > 1
    }
}

/// All slaves that switched: who did most often in one attempt comes first, then who did most often at all.
pub fn all(run: &PastRun) -> Vec<Chatter> {
    let fresh = |slave| Chatter {
        slave,
        switches: 0,
        attempts: Vec::new(),
    };
    let mut all: Vec<Chatter> = (0..run.slaves.len()).map(fresh).collect();
    for (index, attempt) in run.attempts.iter().enumerate() {
        for k in attempt.iterations.clone().skip(1) {
            let (Some(before), Some(now)) = (run.closed(k - 1), run.closed(k)) else {
                continue;
            };
            for slave in changed(before, now) {
                let chatter = &mut all[slave];
                chatter.switches += 1;
                match chatter.attempts.last_mut() {
                    Some((last, switches)) if *last == index => *switches += 1,
                    _ => chatter.attempts.push((index, 1)),
                }
            }
        }
    }
    all.retain(|chatter| chatter.switches > 0);
    all.sort_by_key(|chatter| {
        (
            usize::MAX - chatter.most(),
            usize::MAX - chatter.switches,
            chatter.slave,
        )
    });
    all
}
