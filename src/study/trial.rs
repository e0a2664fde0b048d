//! Tries one random interface problem with every strategy, and checks the results by its census and by
//! Coulomb's law.
//!
//! The number of solutions of a problem is counted by the census of its frozen interface problem, before the
//! first step. The end of a run is checked independently of the solver: with the problem as drawn, the
//! displacements u and the forces f at the end (at load factor 1, in one increment, which is not cut) must
//! satisfy
//!
//! ```text
//! K (u − free) = load + f   or   u = free + W (load + f)
//! g = gap + u_n >= 0,   f_n >= 0,   g f_n = 0
//! |f_t| <= μ f_n + c where g = 0, else f_t = 0;   slip s = −u_t: f_t = sgn(s) (μ f_n + c) where s ≠ 0
//! ```

use super::log::Outcome;
use super::random::{Population, RandomProblem};
use super::reason::Reason;
use super::verdict::RunVerdict;
use serde::{Deserialize, Serialize};
use std::convert::Infallible;
use std::ops::ControlFlow;
use std::sync::Arc;
use stickslip_core::interface::census::census;
use stickslip_core::plane::max_abs;
use stickslip_core::{Model, RunEnd, Stepper, Until};
use stickslip_scene::base::{Base, Method};
use stickslip_scene::format::condensed::{Matrix, Problem};
use stickslip_scene::format::paths;
use stickslip_scene::{Scene, SceneError, increments};

/// A run whose end violates a condition by more than this, relatively, is not a solution. This is far above the
/// solver's errors (its tolerance is 1e-11) and far below the violations of wrong states.
pub const TOLERANCE: f64 = 1e-6;
/// Limit for a small problem; more minor iterations are not worth the time.
const MOST_MINORS: u64 = 20_000;

/// A set of settings to try, with its name.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Variant {
    /// Its name.
    pub name: String,
    /// Path and value of each setting.
    pub settings: Vec<(String, String)>,
}

/// Results of one random problem.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JudgedProblem {
    /// Number of contacts.
    pub nodes: usize,
    /// Name of its form.
    pub form: String,
    /// Whether it has cohesion.
    pub cohesive: bool,
    /// Number of solutions in the census.
    pub answers: usize,
    /// One trial per variant.
    pub trials: Vec<Trial>,
}

/// Result of one variant on one problem.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// Verdict on the run.
    pub verdict: RunVerdict,
    /// Major iterations.
    pub majors: u64,
    /// Minor iterations.
    pub minors: u64,
    /// Largest relative violation of Coulomb's law and of equilibrium at the end; infinite if there is no end.
    pub violation: f64,
}

impl Outcome for JudgedProblem {
    const MAX_BYTES: usize = 1 << 20;

    /// A violation may be infinite without an end, but is within the tolerance if right.
    fn is_sound(&self) -> bool {
        let right = |trial: &Trial| trial.verdict == RunVerdict::Right;
        self.trials.iter().all(|trial| {
            if right(trial) {
                trial.violation <= TOLERANCE
            } else {
                !trial.violation.is_nan()
            }
        })
    }

    fn runs(&self) -> usize {
        self.trials.len()
    }
}

impl JudgedProblem {
    /// Whether the problem has a solution: in the census, or found by a run where the census has none (it does
    /// not examine assignments with a whole line of solutions).
    pub fn solvable(&self) -> bool {
        self.answers > 0 || self.trials.iter().any(|t| t.verdict == RunVerdict::Right)
    }
}

/// A variant, with the solution method that its settings give for all problems of a population.
#[derive(Debug, Clone)]
pub struct PreparedVariant<'a> {
    variant: &'a Variant,
    /// `None` if the settings are not only about the method, or are invalid.
    method: Option<Method>,
}

/// Prepares variants to be tried on many problems.
pub fn prepared(variants: &[Variant]) -> Vec<PreparedVariant<'_>> {
    // All problems share this history and these settings, and nothing else matters here.
    let common = Problem::new("", Vec::new(), Matrix::Stiffness(Vec::new()), Vec::new());
    let spec = common.spec();
    variants
        .iter()
        .map(|variant| {
            let settings = settings(variant);
            PreparedVariant {
                variant,
                method: Method::from_spec(&spec, &settings)
                    .filter(|method| method.increments() == 1.0),
            }
        })
        .collect()
}

/// The settings of a variant, without cuts of the increment.
fn settings(variant: &Variant) -> Vec<(String, String)> {
    let least = ("history.least".to_owned(), "1".to_owned());
    std::iter::once(least)
        .chain(variant.settings.iter().cloned())
        .collect()
}

/// Tries one problem of a population with all variants; `None` if `stop` returns true.
///
/// # Errors
/// If a variant's settings are invalid.
pub fn try_variants(
    population: &Population,
    k: usize,
    variants: &[PreparedVariant<'_>],
    stop: &(dyn Fn() -> bool + Sync),
) -> Result<Option<JudgedProblem>, SceneError> {
    let RandomProblem {
        problem,
        form,
        cohesive,
    } = population.draw(k);
    let base = Base::new(Scene::from_spec(&problem.title, problem.spec())?);
    let mut stepper = Stepper::new(Arc::new(base.scene().model.clone()));
    let mut judged = JudgedProblem {
        nodes: problem.contacts.len(),
        form: form.name().to_owned(),
        cohesive,
        answers: answers(&mut stepper),
        trials: Vec::with_capacity(variants.len()),
    };
    for PreparedVariant { variant, method } in variants {
        if stop() {
            return Ok(None);
        }
        let quick = method.as_ref().and_then(|method| base.solved_by(method));
        let model = quick.map_or_else(|| changed(base.scene(), variant), Ok)?;
        let model = Arc::new(model);
        if !stepper.renew(&model) {
            stepper = Stepper::new(model);
        }
        judged.trials.push(one(&problem, &mut stepper));
    }
    Ok(Some(judged))
}

/// The model of a scene after setting a variant's values in turn.
fn changed(scene: &Scene, variant: &Variant) -> Result<Model, SceneError> {
    let mut own = scene.clone();
    for (path, value) in settings(variant) {
        own = own.with(&paths::whole(&own.spec, &path), &value)?;
    }
    if increments(&own.model.path, |leg| own.model.on_leg(leg)) != 1.0 {
        let message = "random problems are solved in one increment, because their solutions are known only for that";
        return Err(SceneError::whole(&scene.name, message));
    }
    Ok(own.model)
}

/// Number of solutions in the census; 0 if the problem cannot be condensed.
fn answers(stepper: &mut Stepper) -> usize {
    let frozen = stepper.interface_problem();
    let found = frozen.and_then(|frozen| census(&frozen).ok());
    found.map_or(0, |census| census.answers.len())
}

/// Runs a stepper from the start.
fn one(problem: &Problem, stepper: &mut Stepper) -> Trial {
    let mut trial = Trial {
        verdict: RunVerdict::Failed(Reason::MinorLimit),
        majors: 0,
        minors: 0,
        violation: f64::INFINITY,
    };
    let until = Until::end().minors(MOST_MINORS);
    let end = stepper.drive(until, |stepper| {
        trial.minors += 1;
        let ends = stepper.event().outcome.ends_major();
        trial.majors += u64::from(ends);
        ControlFlow::<Infallible>::Continue(())
    });
    match end {
        RunEnd::Finished => {
            trial.violation = violation(problem, stepper);
            trial.verdict = if trial.violation <= TOLERANCE {
                RunVerdict::Right
            } else {
                RunVerdict::Wrong
            };
        }
        RunEnd::Failed(failure) => trial.verdict = RunVerdict::from_failure(&failure),
        RunEnd::Spent | RunEnd::Interrupted => {}
        RunEnd::Stopped(never) => match never {},
    }
    trial
}

/// Violation of the conditions in the current state, relative to its forces and lengths.
fn violation(problem: &Problem, stepper: &Stepper) -> f64 {
    let (model, state) = (stepper.model(), stepper.state());
    // The contacts are the slaves, in order; n is y and t is −x (`format::condensed`).
    let place = |s: usize| model.dofs.first[model.contacts[s].node];
    let slaves = 0..problem.contacts.len();
    let u: Vec<f64> = slaves
        .clone()
        .flat_map(|s| [state.u[place(s) + 1], -state.u[place(s)]])
        .collect();
    let f: Vec<f64> = slaves
        .flat_map(|s| [state.nodes[s].f_n, state.nodes[s].f_t])
        .collect();
    broken(problem, &u, &f)
}

/// Violation of the conditions by displacements and forces, given as n and t of each contact in turn.
fn broken(problem: &Problem, u: &[f64], f: &[f64]) -> f64 {
    let free = |i: usize| problem.free.get(i).copied().unwrap_or(0.0);
    let acts = |i: usize| problem.contacts[i / 2].load[i % 2] + f[i];
    let size = |values: &mut dyn Iterator<Item = f64>| max_abs(values);
    let all = || 0..u.len();
    let stiff = matches!(problem.matrix, Matrix::Stiffness(_));
    let of = |j: usize| if stiff { u[j] - free(j) } else { acts(j) };
    let mut products = vec![0.0; u.len()];
    match &problem.matrix {
        Matrix::Stiffness(rows) | Matrix::Compliance(rows) => {
            for (product, row) in products.iter_mut().zip(rows) {
                let terms = row.iter().enumerate();
                *product = terms.map(|(j, entry)| entry * of(j)).sum();
            }
        }
        Matrix::Entries(entries) => {
            for &(i, j, entry) in entries {
                products[i] += entry * of(j);
            }
        }
    }
    let product = |i: usize| products[i];
    let gaps = problem.contacts.iter().map(|contact| contact.gap);
    let mut length = size(&mut gaps.chain(u.iter().copied()).chain(all().map(free)));
    let mut force = size(&mut all().map(acts).chain(f.iter().copied()));
    // If everything is zero, there is no reference size.
    if stiff {
        force = force.max(size(&mut all().map(product)))
    } else {
        length = length.max(size(&mut all().map(product)))
    }
    let (length, force) = (length.max(f64::MIN_POSITIVE), force.max(f64::MIN_POSITIVE));
    let balance = all().map(|i| {
        if stiff {
            (product(i) - acts(i)).abs() / force
        } else {
            (u[i] - free(i) - product(i)).abs() / length
        }
    });
    let balance = balance.fold(0.0, f64::max);
    let contacts = problem.contacts.iter().enumerate().map(|(k, contact)| {
        let (g, p) = ((contact.gap + u[2 * k]) / length, f[2 * k] / force);
        let t = f[2 * k + 1] / force;
        let normal = (-g).max(-p).max(g.min(p));
        let limit = contact.friction.coefficient() * p.max(0.0) + contact.friction.cohesion / force;
        let slip = -u[2 * k + 1] / length;
        let tangential = if g > TOLERANCE {
            t.abs()
        } else {
            (t.abs() - limit).max(slip.abs().min((t - limit * slip.signum()).abs()))
        };
        normal.max(tangential)
    });
    let worst = contacts.fold(balance, f64::max);
    // NaN is not a solution, but a maximum ignores it.
    if u.iter().chain(f).all(|v| v.is_finite()) {
        worst
    } else {
        f64::INFINITY
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_core::model::Friction;
    use stickslip_scene::format::condensed::Contact;

    /// A node on two unit springs, with load (−1, 1) along n and t and friction μ = 0.5: it slides, u_t = 0.5.
    fn slider() -> Problem {
        let contact = Contact {
            id: "a".to_owned(),
            friction: Friction {
                angle: 0.5_f64.atan().to_degrees(),
                cohesion: 0.0,
            },
            load: [-1.0, 1.0],
            ..Contact::default()
        };
        let matrix = Matrix::Stiffness(vec![vec![1.0, 0.0], vec![0.0, 1.0]]);
        Problem::new("slider", vec![contact], matrix, Vec::new())
    }

    #[test]
    fn violations_of_coulombs_law_are_detected() {
        let problem = slider();
        assert!(broken(&problem, &[0.0, 0.5], &[1.0, -0.5]) < 1e-15);
        for (u, f) in [
            ([0.0, 1.0], [1.0, 0.0]),    // no friction
            ([0.0, 0.0], [1.0, -1.0]),   // more friction than the limit
            ([0.0, 1.5], [1.0, 0.5]),    // friction drives the slip
            ([-1.0, 1.0], [0.0, 0.0]),   // penetrates
            ([0.5, 0.25], [1.5, -0.75]), // force across an open gap
            ([0.0, 0.6], [1.0, -0.5]),   // not in balance
            ([0.0, f64::NAN], [1.0, -0.5]),
        ] {
            assert!(broken(&problem, &u, &f) > 1e-2, "{u:?} {f:?}");
        }
    }

    #[test]
    fn a_prepared_variant_equals_setting_values_in_turn() {
        let settings = [
            &[][..],
            &[
                "settings.strategy=lemke",
                "t_max=consistent",
                "solver=condensed",
            ],
            &["touch=ratio", "minors=7", "history.jumps=accept"],
            &["history.least=0.25", "increment=0.5", "history.path[1]=0.5"],
        ];
        let others = [&["friction=20"][..], &["nodes.n1.at.y=0.125"]];
        let variant = |settings: &&[&str]| Variant {
            name: settings.join(" "),
            settings: settings
                .iter()
                .map(|text| text.split_once('=').unwrap())
                .map(|(path, value)| (path.to_owned(), value.to_owned()))
                .collect(),
        };
        let ours: Vec<Variant> = settings.iter().map(variant).collect();
        let ours = prepared(&ours);
        let population = Population {
            seed: 7,
            count: 30,
            nodes: 1..=4,
        };
        for k in 0..population.count {
            let problem = population.draw(k).problem;
            let base = Base::new(Scene::from_spec("x", problem.spec()).unwrap());
            for PreparedVariant { variant, method } in &ours {
                let quick = base.solved_by(method.as_ref().unwrap()).unwrap();
                let slow = changed(base.scene(), variant);
                assert_eq!(format!("{quick:?}"), format!("{:?}", slow.unwrap()), "{k}");
            }
        }
        let others: Vec<Variant> = others.iter().map(variant).collect();
        assert!(prepared(&others).iter().all(|other| other.method.is_none()));
    }

    #[test]
    fn a_prepared_variant_refuses_what_setting_in_turn_refuses() {
        let refused = [
            "settings.minors=0",
            "increment=0.5",
            "tolerance=1",
            "t_max=none",
        ];
        let all = refused.map(|text| {
            let (path, value) = text.split_once('=').unwrap();
            let first = (path.to_owned(), value.to_owned());
            // A valid later value must not hide an invalid earlier one.
            let later = ("settings.minors".to_owned(), "9".to_owned());
            Variant {
                name: text.to_owned(),
                settings: vec![first, later],
            }
        });
        let problem = slider();
        let scene = Scene::from_spec("x", problem.spec()).unwrap();
        for PreparedVariant { variant, method } in prepared(&all) {
            assert!(method.is_none(), "{}", variant.name);
            assert!(changed(&scene, variant).is_err(), "{}", variant.name);
        }
    }
}
