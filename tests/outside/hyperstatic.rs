//! Friction problems of hyperstatic structures, the same every time: contacts of bodies that are held by more of them than
//! they have motions, so that the compliance W = H M⁻¹ Hᵀ is singular and forces are not unique.
//!
//! With u = W r + q, q = H v for the velocities v of the bodies without contact, there is an answer whatever the friction
//! (Anitescu and Potra, Nonlinear Dynamics 14, 1997): forces that move nothing take no energy from q.

use stickslip::step::stepper::Stepper;
use stickslip_exchange::problem::{Local, Matrix};

/// Numbers from 0 to 1, the same every time (Knuth's MMIX generator).
pub struct Numbers(pub u64);

impl Numbers {
    pub fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6364136223846793005)
            .wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }
}

/// Numbers of contacts.
const CONTACTS: [usize; 6] = [30, 40, 50, 80, 120, 200];

/// Problem k: friction 0.6 to 2; of three, two have a matrix H without zeros, and one has discs that touch each other and the
/// ground; M = 1.
pub fn problem(k: usize) -> Local {
    let mut numbers = Numbers((k as u64).wrapping_mul(0x9E37_79B9_7F4A_7C15) ^ 0x5DEE_CE66);
    for _ in 0..4 {
        numbers.next();
    }
    let contacts = CONTACTS[k % CONTACTS.len()];
    let mu = numbers.between(0.6, 2.0);
    let h = match k % 3 {
        0 => discs(&mut numbers, contacts),
        _ => full(&mut numbers, contacts),
    };
    let motions = h[0].len();
    let v: Vec<f64> = (0..motions).map(|_| numbers.between(-1.0, 1.0)).collect();
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let row = |a: &Vec<f64>| h.iter().map(|b| product(a, b)).collect();
    Local {
        w: Matrix::from_rows(&h.iter().map(row).collect::<Vec<_>>()),
        q: h.iter().map(|row| product(row, &v)).collect(),
        mu: vec![mu; contacts],
    }
}

/// H of bodies that all contacts move, with fewer motions than contacts have components.
fn full(numbers: &mut Numbers, contacts: usize) -> Vec<Vec<f64>> {
    let motions = (2.0 * contacts as f64 * numbers.between(0.25, 0.95)) as usize;
    let size = 1.0 / (motions as f64).sqrt();
    (0..2 * contacts)
        .map(|_| {
            (0..motions)
                .map(|_| size * numbers.between(-1.0, 1.0))
                .collect()
        })
        .collect()
}

/// H of discs with three motions each. A contact joins two discs, or one to the ground: along its normal, and along its
/// tangent with the turning of both.
fn discs(numbers: &mut Numbers, contacts: usize) -> Vec<Vec<f64>> {
    let discs = (contacts as f64 * numbers.between(0.35, 0.6)) as usize;
    let mut h = Vec::with_capacity(2 * contacts);
    for contact in 0..contacts {
        let one = contact % discs;
        let other = (numbers.next() * (discs + 1) as f64) as usize;
        let (sine, cosine) = numbers.between(0.0, std::f64::consts::TAU).sin_cos();
        let [mut normal, mut tangential] = [vec![0.0; 3 * discs], vec![0.0; 3 * discs]];
        for (disc, sign) in [(one, 1.0), (other, -1.0)] {
            if disc < discs && (sign > 0.0 || other != one) {
                (normal[3 * disc], normal[3 * disc + 1]) = (sign * cosine, sign * sine);
                (tangential[3 * disc], tangential[3 * disc + 1]) = (-sign * sine, sign * cosine);
                // Both turn it the same way.
                tangential[3 * disc + 2] = -1.0;
            }
        }
        h.extend([normal, tangential]);
    }
    h
}

/// Forces of a run, n and t of each contact in turn.
pub fn forces(stepper: &Stepper) -> Vec<f64> {
    let nodes = stepper.state().nodes.iter();
    nodes.flat_map(|node| [node.f_n, node.f_t]).collect()
}

/// By how much forces break u = W r + q, 0 <= u_n ⊥ r_n >= 0, |r_t| <= mu r_n, and r_t at that bound against u_t where it
/// slips: over the largest of q and of r.
pub fn broken(problem: &Local, r: &[f64]) -> f64 {
    let largest = |values: &[f64]| values.iter().fold(f64::MIN_POSITIVE, |m, x| m.max(x.abs()));
    let (length, force) = (largest(&problem.q), largest(r));
    let rows = problem.w.dense();
    let motion = |i: usize| {
        let sum: f64 = rows[i].iter().zip(r).map(|(w, r)| w * r).sum();
        (sum + problem.q[i]) / length
    };
    let worst = problem.mu.iter().enumerate().map(|(k, mu)| {
        let (u_n, u_t) = (motion(2 * k), motion(2 * k + 1));
        let (r_n, r_t) = (r[2 * k] / force, r[2 * k + 1] / force);
        let limit = mu * r_n.max(0.0);
        let slides = u_t.abs().min((r_t + u_t.signum() * limit).abs());
        let all = [-u_n, -r_n, u_n.min(r_n).abs(), r_t.abs() - limit, slides];
        all.into_iter().fold(0.0, f64::max)
    });
    match r.iter().all(|x| x.is_finite()) {
        true => worst.fold(0.0, f64::max),
        false => f64::INFINITY,
    }
}
