//! Packings of discs between walls as interface problems, and a measure of their forces that shares nothing with the solver.
//!
//! ```text
//!      | o o o o |      discs of diameter 1 in a hexagonal packing, of random mass,
//!      |o o o o o|      that start downwards with some sideways motion:
//!      | o o o o |      u = W r + q,   W = Hᵀ M⁻¹ H,   q = Hᵀ v
//!      ===========
//! ```
#![allow(dead_code)]

use stickslip_exchange::problem::{Global, Local, Matrix};

const RADIUS: f64 = 0.5;

/// Numbers from 0 to 1 that are the same each time (a linear congruential generator).
struct Numbers(u64);

impl Numbers {
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }
}

/// The packing in all unknowns: x, y and rotation of each disc.
pub fn global(columns: usize, rows: usize, mu: f64) -> Global {
    let places: Vec<[f64; 2]> = (0..rows)
        .flat_map(|j| (0..columns - j % 2).map(move |i| (i, j)))
        .map(|(i, j)| {
            let (x, y) = (i as f64 + 0.5 * (j % 2) as f64, j as f64);
            [x, RADIUS + y * 0.75_f64.sqrt()]
        })
        .collect();
    let discs = places.len();
    let mut contacts: Vec<(usize, Option<usize>, [f64; 2])> = Vec::new();
    for a in 0..discs {
        for b in a + 1..discs.min(a + 2 * columns) {
            let to = [0, 1].map(|k| places[a][k] - places[b][k]);
            let distance = to[0].hypot(to[1]);
            if distance < 1.0001 {
                contacts.push((a, Some(b), to.map(|x| x / distance)));
            }
        }
    }
    for (a, [x, y]) in places.iter().enumerate() {
        let walls = [
            (*y <= RADIUS + 1e-9, [0.0, 1.0]),
            (*x <= 1e-9, [1.0, 0.0]),
            (*x >= columns as f64 - 1.0 - 1e-9, [-1.0, 0.0]),
        ];
        let walls = walls.into_iter().filter(|(touches, _)| *touches);
        contacts.extend(walls.map(|(_, normal)| (a, None, normal)));
    }
    let mut h = Vec::new();
    for (k, &(a, b, [c, s])) in contacts.iter().enumerate() {
        for (component, [x, y]) in [[c, s], [-s, c]].into_iter().enumerate() {
            let column = 2 * k + component;
            let arm = |sign: f64| sign * RADIUS * (c * y - s * x);
            h.extend([(3 * a, column, x), (3 * a + 1, column, y)]);
            h.push((3 * a + 2, column, arm(-1.0)));
            if let Some(b) = b {
                h.extend([(3 * b, column, -x), (3 * b + 1, column, -y)]);
                h.push((3 * b + 2, column, -arm(1.0)));
            }
        }
    }
    let mut numbers = Numbers(1);
    let masses: Vec<f64> = (0..discs).map(|_| 0.5 + 1.5 * numbers.next()).collect();
    let m = (0..3 * discs).map(|i| {
        let inertia = if i % 3 == 2 {
            0.5 * RADIUS * RADIUS
        } else {
            1.0
        };
        (i, i, masses[i / 3] * inertia)
    });
    // The free motion v enters as the load M v.
    let m: Vec<(usize, usize, f64)> = m.collect();
    let fall = [0.3, -1.0, 0.0];
    let f = m
        .iter()
        .map(|&(i, _, m)| m * (fall[i % 3] + 0.1 * (numbers.next() - 0.5)));
    Global {
        f: f.collect(),
        m: Matrix {
            rows: 3 * discs,
            columns: 3 * discs,
            entries: m,
        },
        b: vec![0.0; 2 * contacts.len()],
        mu: vec![mu; contacts.len()],
        h: Matrix {
            rows: 3 * discs,
            columns: 2 * contacts.len(),
            entries: h,
        },
    }
}

/// The packing condensed to its contacts.
pub fn local(columns: usize, rows: usize, mu: f64) -> Local {
    let global = global(columns, rows, mu);
    let mut of_row = vec![Vec::new(); global.m.rows];
    for &(i, j, value) in &global.h.entries {
        of_row[i].push((j, value));
    }
    let (mut entries, mut q) = (Vec::new(), vec![0.0; global.h.columns]);
    for (&(i, _, mass), row) in global.m.entries.iter().zip(&of_row) {
        for &(a, x) in row {
            q[a] += x * global.f[i] / mass;
            entries.extend(row.iter().map(|&(b, y)| (a, b, x * y / mass)));
        }
    }
    let size = global.h.columns;
    let w = Matrix {
        rows: size,
        columns: size,
        entries,
    };
    Local {
        w: w.merged(),
        q,
        mu: global.mu,
    }
}

/// How far forces (normal and tangential, of each contact in turn) are from obeying Coulomb's law, relative to their size: with
/// De Saxcé's ũ = (u_n + μ |u_t|, u_t) and K the friction cone, r − proj_K (r − ρ ũ).
pub fn natural_map(problem: &Local, forces: &[f64]) -> f64 {
    let mut u = problem.q.clone();
    let mut stiff = 0.0_f64;
    for &(i, j, w) in &problem.w.entries {
        u[i] += w * forces[j];
        stiff = if i == j { stiff.max(w) } else { stiff };
    }
    let (mut apart, mut size) = (0.0, 0.0);
    for (k, mu) in problem.mu.iter().enumerate() {
        let (r, u) = ([forces[2 * k], forces[2 * k + 1]], [u[2 * k], u[2 * k + 1]]);
        let trial = [r[0] - (u[0] + mu * u[1].abs()) / stiff, r[1] - u[1] / stiff];
        let near = projected(trial, *mu);
        apart += (r[0] - near[0]).powi(2) + (r[1] - near[1]).powi(2);
        size += r[0] * r[0] + r[1] * r[1];
    }
    (apart / size).sqrt()
}

/// The nearest force within the cone |t| ≤ μ n.
fn projected([n, t]: [f64; 2], mu: f64) -> [f64; 2] {
    if t.abs() <= mu * n {
        [n, t]
    } else if mu * t.abs() <= -n {
        [0.0, 0.0]
    } else {
        let along = (n + mu * t.abs()) / (1.0 + mu * mu);
        [along, mu * along * t.signum()]
    }
}
