//! Who pushed whom in an attached solver: from the numbers that it told of two iterations, and the interface problem between them.
//!
//! With total forces f, w = (gap, u) = W f + q is linear, and each contact's mode says which two numbers its equations fix: f_n and
//! f_t where it is free, gap and u where it is fixed, gap and f_t (or f_t ∓ μ f_n) where it slides. With M the matrix of these
//! equations in the later iteration, and δ_j by how much their values at contact j differ between the two iterations, the
//! forces differ by `Σ_j M⁻¹ e_j δ_j`: each term is what contact j's change did. What a fixed contact sticks to, or at which bound
//! one slides, need not be known: the numbers that were told say it.
//!
//! It is told only where W f + q gives the gaps of both iterations, and nothing but modes and friction bounds has changed
//! between them. See [`influence`](super::influence) for solvers of our own.

use super::influence::{Influence, Push};
use crate::contact::record::ContactRecord;
use crate::model::{Mode, Model};
use crate::step::event::Event;
use crate::step::solver::{GoesBack, Offers, Posed, PosedForm};
use crate::step::state::State;
use nalgebra::{DMatrix, DVector};
use std::sync::Arc;

/// Most contacts whose problem is asked for at every look: its numbers go through a pipe, as text.
const MOST: usize = 100;
/// What numbers may differ by that should be equal, in parts of the largest of their kind.
const SAME: f64 = 1e-6;

/// Two minor iterations in the same frozen problem, one after the other.
pub struct Iterations {
    /// The state that the later one started from.
    pub start: Box<State>,
    /// What each of the two found.
    pub found: [Arc<Event>; 2],
}

/// Whether a solver is asked for its problem at every look: it offers it, goes back to any state, and has not too many contacts.
pub fn are_told(model: &Model, offers: &Offers) -> bool {
    let few = model.contacts.len() <= MOST;
    offers.problem && offers.goes_back == GoesBack::ToAny && few
}

/// What pushed a contact from one iteration to the next, where `posed` is the problem at the start of the later one. `None`
/// where the problem gives other numbers than the solver told.
pub fn pushes(posed: &Posed, found: &[Arc<Event>; 2], slave: usize) -> Option<Vec<Push>> {
    let place = posed.contacts.iter().position(|&known| known == slave);
    let Some(target) = place else {
        // What the problem leaves out, nothing pushes that is in it.
        return Some(Vec::new());
    };
    let (w, q) = compliance(posed)?;
    let earlier = Told::new(posed, &w, &q, &found[0].nodes)?;
    let later = Told::new(posed, &w, &q, &found[1].nodes)?;
    let consistent = earlier.follows_law(posed) && later.follows_law(posed);
    let equations = later.equations(posed, &w, consistent);
    let scales = [later.scales(), earlier.scales()];
    let length = scales[0][0].max(scales[1][0]);
    let force = scales[0][1].max(scales[1][1]);
    let changes = equations.values(&later) - equations.values(&earlier);
    let matrix = equations.matrix.clone().lu();
    let mut pushes = Vec::new();
    for from in 0..posed.contacts.len() {
        let modes = [earlier.modes[from], later.modes[from]];
        let counts = |row: usize| {
            let scale = [length, force][usize::from(!equations.is_length(row))];
            modes[0] != modes[1] || changes[row].abs() > SAME * scale
        };
        let mut own = DVector::zeros(changes.len());
        for row in [2 * from, 2 * from + 1]
            .into_iter()
            .filter(|row| counts(*row))
        {
            own[row] = changes[row];
        }
        let bound = own[2 * from] == 0.0 && modes[0] == Mode::Sliding;
        match modes[0] == modes[1] {
            true if own.iter().all(|&change| change == 0.0) => continue,
            // Something has changed that is no mode and no bound.
            true if !bound => return None,
            _ => {}
        }
        let forces = matrix.solve(&own)?;
        let motion = &w * &forces;
        let (n, t) = (2 * target, 2 * target + 1);
        let influence = Influence {
            from,
            gap: motion[n],
            // The motion u is that of the node along t, and slip the way that it leaves behind.
            slip: -motion[t],
            f_n: forces[n],
            f_t: forces[t],
        };
        let tiny = f64::EPSILON * 64.0;
        let moves = influence.gap.abs().max(influence.slip.abs()) > tiny * length;
        if moves || influence.f_n.abs().max(influence.f_t.abs()) > tiny * force {
            let slave = posed.contacts[from];
            pushes.push(Push {
                slave,
                modes,
                influence,
            });
        }
    }
    Some(pushes)
}

/// W and q of a problem, whichever it tells; `None` where K has no inverse.
fn compliance(posed: &Posed) -> Option<(DMatrix<f64>, DVector<f64>)> {
    let size = posed.q.len();
    let told = DMatrix::from_fn(size, size, |i, j| posed.matrix[i][j]);
    let q = DVector::from_column_slice(&posed.q);
    match posed.form {
        PosedForm::Compliance => Some((told, q)),
        PosedForm::Stiffness => {
            let w = told.try_inverse()?;
            let q = q + &w * DVector::from_column_slice(&posed.load);
            Some((w, q))
        }
    }
}

/// What an iteration told of the problem's contacts.
struct Told {
    modes: Vec<Mode>,
    /// f_n and f_t of each.
    forces: DVector<f64>,
    /// gap and u of each, by the problem.
    motion: DVector<f64>,
}

impl Told {
    /// `None` where forces were not told, or the problem gives other gaps.
    fn new(
        posed: &Posed,
        w: &DMatrix<f64>,
        q: &DVector<f64>,
        nodes: &[ContactRecord],
    ) -> Option<Told> {
        let records: Vec<&ContactRecord> = posed
            .contacts
            .iter()
            .map(|&slave| nodes.get(slave))
            .collect::<Option<_>>()?;
        let forces = records.iter().flat_map(|record| [record.f_n, record.f_t]);
        let forces = DVector::from_iterator(2 * records.len(), forces);
        let pushed = w * &forces;
        let scale = pushed.amax().max(q.amax());
        let motion = pushed + q;
        let other = |(place, record): (usize, &&ContactRecord)| {
            (record.gap - motion[2 * place]).abs() > SAME * scale
        };
        let sound = forces.iter().all(|force| force.is_finite());
        (sound && !records.iter().enumerate().any(other)).then(|| Told {
            modes: records
                .iter()
                .map(|record| record.decision.before)
                .collect(),
            forces,
            motion,
        })
    }

    /// The largest length and the largest force.
    fn scales(&self) -> [f64; 2] {
        [self.motion.amax(), self.forces.amax()]
    }

    /// Whether all contacts that slide do so at f_t = ± (μ f_n + c), with the present normal force.
    fn follows_law(&self, posed: &Posed) -> bool {
        let force = self.scales()[1];
        let slides = |place: &usize| self.modes[*place] == Mode::Sliding;
        (0..self.modes.len()).filter(slides).all(|place| {
            let friction = posed.friction[place];
            let bound = friction.coefficient() * self.forces[2 * place] + friction.cohesion;
            (self.forces[2 * place + 1].abs() - bound).abs() <= SAME * force
        })
    }

    /// The equations that its modes stand for; with a consistent bound, f_t ∓ μ f_n is what a contact slides at.
    fn equations(&self, posed: &Posed, w: &DMatrix<f64>, consistent: bool) -> Equations {
        let size = self.forces.len();
        let unit = |k: usize| DMatrix::from_fn(1, size, |_, j| f64::from(u8::from(j == k)));
        let mut matrix = DMatrix::zeros(size, size);
        let mut fixes = Vec::with_capacity(size);
        for (place, mode) in self.modes.iter().enumerate() {
            let (n, t) = (2 * place, 2 * place + 1);
            let slope = match *mode == Mode::Sliding && consistent {
                true => posed.friction[place].coefficient().copysign(self.forces[t]),
                false => 0.0,
            };
            let normal = if *mode == Mode::Free {
                Fixes::Force(0.0)
            } else {
                Fixes::Motion
            };
            let tangential = if *mode == Mode::Fixed {
                Fixes::Motion
            } else {
                Fixes::Force(slope)
            };
            for (k, fixed) in [(n, normal), (t, tangential)] {
                let row = match fixed {
                    Fixes::Motion => w.rows(k, 1).into_owned(),
                    Fixes::Force(slope) => unit(k) - unit(n) * slope,
                };
                matrix.set_row(k, &row.row(0));
                fixes.push(fixed);
            }
        }
        Equations { matrix, fixes }
    }
}

/// What an equation gives a value to.
#[derive(Clone, Copy)]
enum Fixes {
    /// A gap or motion.
    Motion,
    /// A force, less the normal force times this.
    Force(f64),
}

/// The equations of an iteration in its forces, two a contact.
struct Equations {
    matrix: DMatrix<f64>,
    fixes: Vec<Fixes>,
}

impl Equations {
    fn is_length(&self, row: usize) -> bool {
        matches!(self.fixes[row], Fixes::Motion)
    }

    /// What the fixed numbers are in an iteration.
    fn values(&self, told: &Told) -> DVector<f64> {
        let all = self.fixes.iter().enumerate().map(|(k, fixed)| match fixed {
            Fixes::Motion => told.motion[k],
            Fixes::Force(slope) => told.forces[k] - slope * told.forces[k - k % 2],
        });
        DVector::from_iterator(self.fixes.len(), all)
    }
}
