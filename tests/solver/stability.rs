//! Stability of accepted states, against closed forms and against a tangent by differences of forces that shares no code with
//! the one of the solver: dense, with all multipliers, by its eigenvalues.

use crate::common::{read, run, scene};
use nalgebra::{DMatrix, DVector};
use std::f64::consts::PI;
use std::sync::Arc;
use stickslip::fem::assembly::{Assembly, AssemblyMotion};
use stickslip::fem::element::ElementOutput;
use stickslip::fem::lagrange::shape;
use stickslip::linalg::Pattern;
use stickslip::linear::stability::Stability::{self, Divergence, NotKnown, Stable, Unstable};
use stickslip::model::{Mode, Model};
use stickslip::scene::Scene;
use stickslip::step::state::State;
use stickslip::step::stepper::Stepper;

/// Stability at the end of a scene without a failure.
fn at_end(scene: &Scene) -> Stability {
    let mut run = run(scene);
    assert!(run.failure.is_none(), "{:?}", run.failure);
    run.stepper.stability()
}

/// A cantilever of length 1 and EI = 1 pressed along its axis. With EA = GA the axial and the shear strain, of first order in
/// P / EA, cancel in the buckling load of Reissner's beam; without GA they vanish with 1 / EA.
fn column(material: &str, load: f64) -> Scene {
    read(&format!(
        "(title: \"t\", nodes: [Line(id: \"b\", from: (0, 0), to: (1, 0), elements: 10, per_element: 5)],
          materials: [Section(id: \"m\", {material})], bodies: [Beam(id: \"b\", along: \"b\", material: \"m\")],
          supports: [(node: \"b.start\", fix: [x, y, rotation])], loads: [Force(node: \"b.end\", x: {})],
          history: (path: [0, 1], increment: 1))",
        -load
    ))
}

#[test]
fn a_column_turns_unstable_at_each_of_its_buckling_loads() {
    for (material, exact) in [("EA: 1e6, EI: 1, GA: 1e6", 1e-5), ("EA: 1e7, EI: 1", 1e-5)] {
        for mode in 0..3_usize {
            let critical = ((2 * mode + 1) as f64 * PI / 2.0).powi(2);
            let below = at_end(&column(material, critical * (1.0 - exact)));
            let above = at_end(&column(material, critical * (1.0 + exact)));
            let expected = match mode {
                0 => Stable,
                modes => Unstable { modes },
            };
            assert_eq!(below, expected, "{material}, mode {mode}");
            assert_eq!(
                above,
                Unstable { modes: mode + 1 },
                "{material}, mode {mode}"
            );
        }
    }
}

/// Two bars of half span 1 and height h, pressed down at their joint. With strains (l − L) / L the stiffness of the joint is
/// 2 EA / L (1 − L / l³), l² = 1 + y²: it vanishes at l³ = L.
#[test]
fn a_truss_of_two_bars_is_unstable_between_its_limit_points() {
    let h = 0.3_f64;
    let truss = |down: f64| {
        read(&format!(
            "(title: \"t\", nodes: [Through(id: \"l\", points: [(-1, 0), (0, {h}), (1, 0)], per_element: 2)],
              materials: [Section(id: \"m\", EA: 1, EI: 1e-6, GA: 100)],
              bodies: [Beam(id: \"l\", along: \"l\", material: \"m\")],
              supports: [(node: \"l.start\", fix: [x, y]), (node: \"l.end\", fix: [x, y])],
              loads: [{down}], history: (path: [0, 1], increment: 0.02))",
            down = down_load(down)
        ))
    };
    let length = (1.0 + h * h).sqrt();
    let limit = (length.powf(2.0 / 3.0) - 1.0).sqrt();
    for (y, expected) in [
        (limit * 1.01, Stable),
        (limit * 0.99, Unstable { modes: 1 }),
        (-limit * 0.99, Unstable { modes: 1 }),
        (-limit * 1.01, Stable),
    ] {
        // Led there by the hand, and let go: what is free then decides.
        let led = run(&truss(h - y));
        assert!(led.failure.is_none(), "{:?}", led.failure);
        let free = truss(0.0);
        let dof = free.model.dofs.first[free.node("l.2").unwrap()];
        let mut u = vec![0.0; free.model.dofs.len()];
        u.copy_from_slice(&led.stepper.state().u[..]);
        assert!((h + u[dof + 1] - y).abs() < 1e-12);
        assert_eq!(stability_at(&free, u, |_| {}), expected, "y = {y}");
    }
}

/// A prescribed motion down, or none.
fn down_load(down: f64) -> String {
    match down {
        0.0 => "Force(node: \"l.2\", y: 0.0)".to_owned(),
        _ => format!(
            "Displacement(node: \"l.2\", component: y, value: {})",
            -down
        ),
    }
}

/// Stability of a scene with these displacements, after its contacts were changed.
fn stability_at(scene: &Scene, u: Vec<f64>, change: impl Fn(&mut State)) -> Stability {
    let mut stepper = Stepper::new(Arc::new(scene.model.clone()));
    let mut state = stepper.state().clone();
    state.u = Arc::new(u.clone());
    Arc::make_mut(&mut state.start).u = Arc::new(u);
    change(&mut state);
    stepper.restore(&state);
    stepper.stability()
}

/// A node on springs K, pressed onto a rigid floor: sliding it is stable or diverges by the sign of K_tt − (±tan φ) K_nt.
#[test]
fn a_node_that_slides_on_its_springs_diverges_where_friction_grows_faster_than_they_do() {
    for (k_xy, angle, side) in [
        (0.0, 30.0, 1.0),
        (-80.0, 30.0, 1.0),
        (-80.0, 30.0, -1.0),
        (-80.0, 60.0, 1.0),
        (-80.0, 60.0, -1.0),
        (80.0, 60.0, 1.0),
        (80.0, 60.0, -1.0),
    ] {
        let scene = read(&format!(
            "(title: \"t\", nodes: [Node(id: \"s\", at: (0, 0)), Line(id: \"f\", from: (9, 0), to: (-9, 0), elements: 1, per_element: 2)],
              materials: [], bodies: [Matrix(id: \"k\", nodes: [\"s\"], stiffness: [[100, {k_xy}], [{k_xy}, 100]])],
              surfaces: [(id: \"f\", along: \"f\", endless: true)], slaves: [(nodes: [\"s\"], on: [\"f\"])],
              friction: (angle: {angle}), loads: [Force(node: \"s\", y: -1)], history: (path: [0, 1], increment: 1))"
        ));
        let found = stability_at(&scene, vec![0.0; scene.model.dofs.len()], |state| {
            let node = &mut state.nodes[0];
            (node.mode, node.sign, node.f_n) = (Mode::Sliding, side, 1.0);
            node.f_t = side * f64::to_radians(angle).tan();
        });
        // n = (0, 1), t = (−1, 0): F_x = −F_t = −side tan φ F_n, and F_n = K_xy u: balance along x gives
        // K_xx u + side tan φ K_xy u.
        let stiffness = 100.0 + side * f64::to_radians(angle).tan() * k_xy;
        let expected = if stiffness > 0.0 { Stable } else { Divergence };
        assert_eq!(found, expected, "{k_xy} {angle} {side}: {stiffness}");
    }
}

/// Out-of-balance forces and conditions of a scene as functions of displacements and multipliers, with the surfaces' geometry
/// made anew: bodies, and for every node that touches its forces and how far it is off.
struct Balance<'a> {
    model: &'a Model,
    assembly: Assembly,
    pattern: Pattern,
    state: &'a State,
    equations: Vec<usize>,
}

impl<'a> Balance<'a> {
    fn new(model: &'a Model, state: &'a State) -> Self {
        let mut assembly = Assembly::new(model);
        let pattern = Pattern::new(model.dofs.equations, assembly.entries(&model.dofs)).unwrap();
        assembly.bind(&model.dofs, &pattern, false);
        let all = 0..model.dofs.len();
        let equations = all.filter(|&d| model.dofs.equation[d].is_some()).collect();
        Balance {
            model,
            assembly,
            pattern,
            state,
            equations,
        }
    }

    fn conditions(&self) -> usize {
        let of = |mode| match mode {
            Mode::Free => 0,
            Mode::Sliding => 1,
            Mode::Fixed => 2,
        };
        self.state.nodes.iter().map(|node| of(node.mode)).sum()
    }

    /// Forces at the equations, then how far the conditions are off, at these changes of displacements and multipliers.
    fn at(&mut self, change: &DVector<f64>) -> DVector<f64> {
        let model = self.model;
        let mut u = self.state.u.to_vec();
        for (k, &dof) in self.equations.iter().enumerate() {
            u[dof] += change[k];
        }
        let dofs = model.dofs.len();
        let (mut force, mut size, step) = (vec![0.0; dofs], vec![0.0; dofs], vec![0.0; dofs]);
        let mut values = vec![0.0; self.pattern.entries()];
        let mut coupling = vec![0.0; model.dofs.equations];
        let out = ElementOutput {
            force: &mut force,
            size: &mut size,
            values: &mut values,
            coupling: &mut coupling,
        };
        let moved = AssemblyMotion {
            u: &u,
            step: &step,
            before: &self.state.start.u,
            history: &self.state.start.history,
        };
        self.assembly.assemble(&model.dofs, moved, out);
        let mut off = Vec::new();
        for (node, contact) in self.state.nodes.iter().zip(&model.contacts) {
            if node.mode == Mode::Free {
                continue;
            }
            let spot = node.spot.unwrap();
            let master = &model.surfaces[spot.surface].elements[spot.element];
            let slave = model.place(&u, contact.node);
            let places: Vec<[f64; 2]> = master.iter().map(|&n| model.place(&u, n)).collect();
            let sum = |weights: &[f64]| {
                let mut sum = [0.0; 2];
                for (place, w) in places.iter().zip(weights) {
                    (sum[0], sum[1]) = (sum[0] + w * place[0], sum[1] + w * place[1]);
                }
                sum
            };
            let mut xi = spot.xi;
            if node.mode == Mode::Sliding {
                for _ in 0..30 {
                    let s = shape(master.len(), xi);
                    let (x, d, dd) = (sum(&s.n), sum(&s.d), sum(&s.dd));
                    let r = [slave[0] - x[0], slave[1] - x[1]];
                    let value = r[0] * d[0] + r[1] * d[1];
                    xi += value / (d[0] * d[0] + d[1] * d[1] - r[0] * dd[0] - r[1] * dd[1]);
                }
            }
            let s = shape(master.len(), xi);
            let (x, d) = (sum(&s.n), sum(&s.d));
            let r = [slave[0] - x[0], slave[1] - x[1]];
            let length = d[0].hypot(d[1]);
            let (t, n) = (
                [d[0] / length, d[1] / length],
                [d[1] / length, -d[0] / length],
            );
            let first = self.equations.len() + off.len();
            let pressed = if node.mode == Mode::Fixed {
                off.extend(r);
                let f = node.force();
                [f[0] + change[first], f[1] + change[first + 1]]
            } else {
                off.push(r[0] * n[0] + r[1] * n[1]);
                let f_n = node.f_n + change[first];
                let friction = model.contacts[0].friction.coefficient() * node.sign;
                [
                    f_n * n[0] + friction * f_n * t[0],
                    f_n * n[1] + friction * f_n * t[1],
                ]
            };
            let mut push = |node: usize, weight: f64| {
                let at = model.dofs.first[node];
                force[at] -= weight * pressed[0];
                force[at + 1] -= weight * pressed[1];
            };
            push(contact.node, 1.0);
            master.iter().zip(s.n).for_each(|(&n, w)| push(n, -w));
        }
        let forces = self.equations.iter().map(|&dof| force[dof]);
        DVector::from_iterator(change.len(), forces.chain(off.iter().map(|off| -off)))
    }

    /// The derivative of [`Balance::at`], by central differences.
    fn derivative(&mut self) -> DMatrix<f64> {
        let size = self.equations.len() + self.conditions();
        let mut matrix = DMatrix::zeros(size, size);
        for k in 0..size {
            let h = 1e-5;
            let mut change = DVector::zeros(size);
            change[k] = h;
            let plus = self.at(&change);
            change[k] = -h;
            let minus = self.at(&change);
            matrix.set_column(k, &((plus - minus) / (2.0 * h)));
        }
        matrix
    }
}

/// The derivative below has no element that gives under a point force.
const PLAIN: (&str, &str) = ("settings.point_force", "plain");

/// What the derivative says: by its inertia, less one negative eigenvalue a condition, or by the sign of its determinant.
fn independently(model: &Model, state: &State) -> (Option<Stability>, f64) {
    let mut balance = Balance::new(model, state);
    let conditions = balance.conditions();
    let matrix = balance.derivative();
    let multipliers = conditions + model.dofs.inner;
    let sign = matrix.determinant().signum()
        * if multipliers.is_multiple_of(2) {
            1.0
        } else {
            -1.0
        };
    let rough = !model.contacts[0].friction.is_smooth();
    let slides = state.nodes.iter().any(|node| node.mode == Mode::Sliding);
    if rough && slides {
        return (None, sign);
    }
    let asymmetry = (&matrix - matrix.transpose()).amax();
    assert!(asymmetry < 1e-5 * matrix.amax(), "{asymmetry}");
    let values = ((&matrix + matrix.transpose()) / 2.0).symmetric_eigenvalues();
    let negative = values.iter().filter(|value| **value < 0.0).count();
    let modes = negative.checked_sub(multipliers).unwrap();
    let stability = if modes == 0 {
        Stable
    } else {
        Unstable { modes }
    };
    (Some(stability), sign)
}

#[test]
fn what_is_said_of_accepted_states_agrees_with_differences_of_forces() {
    let mut seen = Vec::new();
    for (name, set) in [
        (
            "02-two-cantilevers-smooth",
            vec![("history.increment", "0.25"), PLAIN],
        ),
        (
            "02-two-cantilevers-rough",
            vec![("history.increment", "0.25"), PLAIN],
        ),
        (
            "02-two-cantilevers-rough",
            vec![
                ("history.increment", "0.05"),
                ("friction.angle", "10"),
                PLAIN,
            ],
        ),
        (
            "02-two-cantilevers-rough",
            vec![
                ("history.increment", "0.05"),
                ("friction.angle", "5"),
                PLAIN,
            ],
        ),
        ("03-distant-cantilevers", vec![("history.increment", "0.5")]),
        ("osc-snap", vec![("settings.strategy", "ladder")]),
        (
            "01-pinned-beam-rough-floor",
            vec![("history.increment", "0.05")],
        ),
    ] {
        let scene = scene(name, &set);
        let mut found = run(&scene);
        for accepted in &found.accepted {
            found.stepper.restore(&accepted.state);
            let said = found.stepper.stability();
            let (exact, sign) = independently(&scene.model, &accepted.state);
            let place = format!(
                "{name} {set:?} load {}: {said}, {exact:?}, {sign}",
                accepted.load
            );
            match (said, exact) {
                (said, Some(exact)) => assert_eq!(said, exact, "{place}"),
                (Stable, None) => assert!(sign > 0.0, "{place}"),
                (Divergence, None) => assert!(sign < 0.0, "{place}"),
                (NotKnown, None) => assert!(sign > 0.0, "{place}"),
                (Unstable { .. }, None) => panic!("{place}"),
            }
            if !seen.contains(&(said, exact.is_some())) {
                seen.push((said, exact.is_some()));
            }
        }
    }
    assert!(
        seen.contains(&(Stable, true)) && seen.contains(&(Stable, false)),
        "{seen:?}"
    );
    assert!(seen.contains(&(NotKnown, false)), "{seen:?}");
}

/// The same states with their loads taken as they are but other modes and signs than they have: many of them unstable.
#[test]
fn states_that_nobody_would_accept_are_called_what_they_are() {
    let mut seen = Vec::new();
    for angle in ["0", "10", "60", "80"] {
        // On an element that gives, another F_n at the same displacements is no state of contact.
        let set = [
            ("history.increment", "0.25"),
            ("friction.angle", angle),
            PLAIN,
        ];
        let scene = scene("02-two-cantilevers-rough", &set);
        let found = run(&scene);
        for accepted in &found.accepted {
            for (sign, factor) in [
                (1.0, 1.0),
                (-1.0, 1.0),
                (1.0, 40.0),
                (-1.0, 40.0),
                (1.0, -40.0),
            ] {
                let change = |state: &mut State| {
                    let node = &mut state.nodes[0];
                    (node.mode, node.sign) = (Mode::Sliding, sign);
                    node.f_n *= factor;
                    node.f_t = sign * scene.model.contacts[0].friction.coefficient() * node.f_n;
                };
                let mut stepper = Stepper::new(Arc::new(scene.model.clone()));
                let mut state = accepted.state.clone();
                if state.nodes[0].spot.is_none() {
                    continue;
                }
                change(&mut state);
                stepper.restore(&state);
                let said = stepper.stability();
                let (exact, side) = independently(&scene.model, &state);
                let place = format!(
                    "{angle} {} {sign} {factor}: {said} {exact:?} {side}",
                    accepted.load
                );
                match (said, exact) {
                    (said, Some(exact)) => assert_eq!(said, exact, "{place}"),
                    (Stable | NotKnown, None) => assert!(side > 0.0, "{place}"),
                    (Divergence, None) => assert!(side < 0.0, "{place}"),
                    (Unstable { .. }, None) => panic!("{place}"),
                }
                if !seen.contains(&said) {
                    seen.push(said);
                }
            }
        }
    }
    for kind in [Stable, Unstable { modes: 1 }, Divergence, NotKnown] {
        assert!(seen.contains(&kind), "{seen:?}");
    }
}
