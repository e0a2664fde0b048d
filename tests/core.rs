//! The core of a cycle, and whole frozen problems, written out as scenes of their own: these take the same way.

mod common;

use common::{go_on, run, scene};
use std::sync::Arc;
use stickslip::debug::core::{Core, core};
use stickslip::debug::export::{self, Origin, compared};
use stickslip::scene::{Mode, Scene, builtin};
use stickslip::solve::event::Cycle;
use stickslip::solve::frozen::{Frozen, Trials};
use stickslip::solve::{Failure, Outcome, Stepper};

/// A run that ended in a cycle of minors: its stepper there, the cycle, and where.
struct Stuck {
    scene: Scene,
    stepper: Stepper,
    cycle: Cycle,
    origin: Origin,
}

fn stuck(scene: Scene) -> Option<Stuck> {
    let run = run(&scene);
    let (event, failure) = run.failure?;
    let Failure::Cycle(cycle) = failure else {
        return None;
    };
    let origin = Origin::of(&scene, event.position, event.load_factor);
    Some(Stuck {
        scene,
        stepper: run.stepper,
        cycle,
        origin,
    })
}

impl Stuck {
    fn core(&mut self) -> (Frozen, Core, String) {
        let problem = self.stepper.frozen().unwrap();
        let core = core(&problem).unwrap();
        let model = &self.scene.model;
        let text = export::core(model, &self.origin, &self.cycle, &core)
            .unwrap_or_else(|why| panic!("{}: {why}", self.scene.name));
        (problem, core, text)
    }
}

fn read(text: &str) -> Scene {
    Scene::from_text("core", text, &[]).unwrap_or_else(|e| panic!("{e}\n{text}"))
}

/// Modes and forces of some slave nodes over one round, from a stepper that stands on a cycle.
fn round(stepper: &mut Stepper, slaves: &[usize], period: u32) -> Vec<Vec<(Mode, f64, f64)>> {
    let of = |stepper: &mut Stepper| {
        let event = stepper.step().unwrap();
        let one = |&s: &usize| {
            let node = &event.nodes[s];
            (node.decision.before, node.f_n, node.f_t)
        };
        slaves.iter().map(one).collect()
    };
    (0..period).map(|_| of(stepper)).collect()
}

/// Whether two rounds are the same, wherever each begins.
fn same(a: &[Vec<(Mode, f64, f64)>], b: &[Vec<(Mode, f64, f64)>], size: f64) -> bool {
    let close = |x: f64, y: f64| (x - y).abs() <= 1e-8 * size;
    let equal = |a: &Vec<(Mode, f64, f64)>, b: &Vec<(Mode, f64, f64)>| {
        let mut pairs = a.iter().zip(b);
        pairs.all(|(a, b)| a.0 == b.0 && close(a.1, b.1) && close(a.2, b.2))
    };
    (0..a.len()).any(|by| (0..a.len()).all(|k| equal(&a[(k + by) % a.len()], &b[k])))
}

#[test]
fn every_oscillator_has_a_core_whose_file_cycles_as_it_does() {
    let mut found = Vec::new();
    for builtin in builtin::list()
        .iter()
        .filter(|b| b.name.starts_with("osc-"))
    {
        let Some(mut stuck) = stuck(scene(builtin.name, &[])) else {
            continue;
        };
        let name = builtin.name;
        let (problem, core, text) = stuck.core();
        let off = compared(&core.on_cycle(), &text).unwrap();
        assert!(off < 1e-9, "{name}: {off}");
        let mut alone = run(&read(&text));
        let Some((_, Failure::Cycle(cycle))) = &alone.failure else {
            panic!("{name}: {:?}\n{text}", alone.failure);
        };
        assert_eq!(cycle.period, core.cycle.period, "{name}");
        assert_eq!(cycle.members.len(), core.cycle.members.len(), "{name}");
        let names: Vec<&str> = core
            .places
            .iter()
            .map(|&p| problem.nodes[p].slave)
            .map(|s| {
                let model = &stuck.scene.model;
                model.nodes[model.slaves[s].node].name.as_str()
            })
            .collect();
        // What the core does where the others go on with what they do: in the whole scene, if it is the whole cycle.
        let slaves: Vec<usize> = core
            .places
            .iter()
            .map(|&p| problem.nodes[p].slave)
            .collect();
        let all: Vec<usize> = (0..slaves.len()).collect();
        let ours = round(&mut alone.stepper, &all, core.cycle.period);
        let theirs = if slaves.len() == stuck.cycle.members.len() {
            assert_eq!(stuck.cycle.period, core.cycle.period, "{name}");
            round(&mut stuck.stepper, &slaves, core.cycle.period)
        } else {
            let frozen = core.on_cycle();
            let (mut trials, mut nodes) = (Trials::new(&frozen).unwrap(), frozen.states());
            (0..core.cycle.period)
                .map(|_| {
                    let (records, _) = trials.minor(&mut nodes).unwrap();
                    records
                        .iter()
                        .map(|r| (r.decision.before, r.f_n, r.f_t))
                        .collect()
                })
                .collect()
        };
        assert!(
            same(&ours, &theirs, problem.force),
            "{name}: {ours:?} {theirs:?}"
        );
        println!(
            "{name}: {names:?} period {} off {off:.1e}\n{text}",
            core.cycle.period
        );
        found.push(name);
    }
    assert!(found.len() >= 13, "{found:?}");
}
