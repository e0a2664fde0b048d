//! A run that is over, with its cycles and who chattered, and who is in contact in which iteration.

use super::chatter::{self, Chatter};
use super::round::{self, Round};
use stickslip_exchange::calculix::cel::{Closed, Slave};
use stickslip_exchange::calculix::cvg::Norms;
use stickslip_exchange::calculix::past::PastRun;

/// A run that is over.
#[derive(Debug, Clone, PartialEq)]
pub struct Past {
    /// The .cel, as it was named.
    pub name: String,
    /// What the files hold.
    pub run: PastRun,
    /// The first cycle of each attempt, if it has one.
    pub rounds: Vec<Option<Round>>,
    /// Who switched, most often first.
    pub chatter: Vec<Chatter>,
    /// Attempt of every iteration.
    attempts: Vec<usize>,
    /// Most contact elements that each slave ever had at once.
    most: Vec<u32>,
}

/// A slave in an iteration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Touch {
    /// No file tells.
    Unknown,
    /// It has no contact element.
    Open,
    /// It has some.
    Closed,
    /// It has some on other master faces than in the iteration before.
    Moved,
    /// A slave face, of whose integration points only so many tenths are in contact, as measured by most that ever were:
    /// 1 to 9.
    Part(u8),
}

/// Residual (percent) that an increment must get under by CalculiX's defaults (`*CONTROLS`: R_n = 0.005, and R_p = 0.02 after
/// I_p = 9 iterations), and the correction (C_n = 0.01). Files of a run do not tell whether its deck changed them.
pub fn limits(iteration: u32) -> [f64; 2] {
    let residual = if iteration <= 9 { 0.5 } else { 2.0 };
    [residual, 1.0]
}

impl Past {
    /// Finds out what cycled, and who chattered.
    pub fn new(name: impl Into<String>, run: PastRun) -> Past {
        let mut attempts = vec![0; run.iterations.len()];
        for (index, attempt) in run.attempts.iter().enumerate() {
            attempts[attempt.iterations.clone()].fill(index);
        }
        let mut most = vec![0; run.slaves.len()];
        for k in 0..run.iterations.len() {
            for part in run
                .closed(k)
                .unwrap_or_default()
                .chunk_by(|a, b| a.slave == b.slave)
            {
                let most = &mut most[part[0].slave as usize];
                *most = elements(part).max(*most);
            }
        }
        let of = |attempt| round::first(&run, attempt);
        Past {
            name: name.into(),
            rounds: run.attempts.iter().map(of).collect(),
            chatter: chatter::all(&run),
            run,
            attempts,
            most,
        }
    }

    /// Number of iterations.
    pub fn len(&self) -> usize {
        self.run.iterations.len()
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.run.iterations.is_empty()
    }

    /// The attempt that an iteration belongs to.
    pub fn attempt(&self, iteration: usize) -> usize {
        self.attempts[iteration]
    }

    /// Residuals of an iteration, where they are known.
    pub fn norms(&self, iteration: usize) -> Option<Norms> {
        self.run.iterations[iteration].norms
    }

    /// Number of slaves in contact in an iteration; `None` where no file tells.
    pub fn closed(&self, iteration: usize) -> Option<usize> {
        let closed = self.run.closed(iteration)?;
        Some(closed.chunk_by(|a, b| a.slave == b.slave).count())
    }

    /// The contact elements of a slave in an iteration, by master; `None` where no file tells.
    pub fn contact(&self, iteration: usize, slave: usize) -> Option<&[Closed]> {
        let closed = self.run.closed(iteration)?;
        let from = closed.partition_point(|c| (c.slave as usize) < slave);
        let to = closed.partition_point(|c| c.slave as usize <= slave);
        Some(&closed[from..to])
    }

    /// How a slave is in an iteration.
    pub fn touch(&self, iteration: usize, slave: usize) -> Touch {
        let Some(now) = self.contact(iteration, slave) else {
            return Touch::Unknown;
        };
        if now.is_empty() {
            return Touch::Open;
        }
        let (part, whole) = (u64::from(elements(now)), u64::from(self.most[slave]));
        if part < whole {
            return Touch::Part((10 * part / whole).clamp(1, 9) as u8);
        }
        let first = iteration == self.run.attempts[self.attempt(iteration)].iterations.start;
        let before = match first {
            true => None,
            false => self.contact(iteration - 1, slave),
        };
        let masters = |closed: &[Closed]| closed.iter().map(|c| c.master).collect::<Vec<_>>();
        match before.filter(|before| !before.is_empty()) {
            Some(before) if masters(before) != masters(now) => Touch::Moved,
            _ => Touch::Closed,
        }
    }

    /// Whether a slave's contact elements are others than in the iteration before of the same attempt.
    pub fn switches(&self, iteration: usize, slave: usize) -> bool {
        let start = self.run.attempts[self.attempt(iteration)].iterations.start;
        iteration > start
            && match (
                self.contact(iteration - 1, slave),
                self.contact(iteration, slave),
            ) {
                (Some(before), Some(now)) => before != now,
                _ => false,
            }
    }

    /// What a slave is called: `node 9`; slave faces are counted.
    pub fn slave(&self, slave: usize) -> String {
        match self.run.slaves[slave] {
            Slave::Node(node) => format!("node {node}"),
            Slave::Face(_) => format!("face {}", slave + 1),
        }
    }

    /// The corners of a slave face.
    pub fn corners(&self, slave: usize) -> Option<String> {
        match &self.run.slaves[slave] {
            Slave::Node(_) => None,
            Slave::Face(corners) => Some(face(corners)),
        }
    }

    /// The slave after this one whose name, or a corner of which, holds a text; round from the end.
    pub fn find(&self, text: &str, after: usize) -> Option<usize> {
        let count = self.run.slaves.len();
        let text = text.trim().to_lowercase();
        let holds = |slave: &usize| {
            let corners = self.corners(*slave).unwrap_or_default();
            self.slave(*slave).contains(&text) || corners.contains(&text)
        };
        (1..=count).map(|k| (after + k) % count).find(holds)
    }
}

fn elements(closed: &[Closed]) -> u32 {
    closed
        .iter()
        .fold(0, |sum, closed| sum.saturating_add(closed.elements))
}

/// A face by its corners; a triangle has three.
pub fn face(corners: &[u32; 4]) -> String {
    let [a, b, c, d] = corners;
    match c == d {
        true => format!("{a} {b} {c}"),
        false => format!("{a} {b} {c} {d}"),
    }
}
