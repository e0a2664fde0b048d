//! The start of a solver: reads its greeting and its scene.

use super::link::{Link, Start, name};
use std::sync::Arc;
use std::sync::atomic::AtomicUsize;
use stickslip_core::step::intervene::Value;
use stickslip_core::step::solver::Range;
use stickslip_core::{Capabilities, Parameter, RewindSupport};
use stickslip_debugger::recorded::orders::{COHESION, FRICTION, INCREMENT};
use stickslip_debugger::{Fault, Log};
use stickslip_exchange::attach::message::{self, Hello, ParameterKind, Restore, Scene};
use stickslip_exchange::attach::{Answer, PROTOCOLS, Request};
use stickslip_scene::shown;

/// Optional parts of the protocol that the debugger reads.
const READS: [&str; 3] = ["progress", "space", "partial"];

/// A started solver.
pub struct StartedSolver {
    /// The child process.
    pub link: Link,
    /// Its greeting.
    pub hello: Hello,
    /// Its scene.
    pub scene: Scene,
    /// Its capabilities.
    pub offers: Capabilities,
}

/// Starts a solver, and reads its greeting and its scene.
///
/// # Errors
/// The fault that ended it.
pub fn meet(start: &Start, log: &Log, asks: &Arc<AtomicUsize>) -> Result<StartedSolver, Fault> {
    let mut link = Link::start(start, log, asks.clone())?;
    let request = Request::Hello {
        protocol: PROTOCOLS[0],
        protocols: PROTOCOLS.to_vec(),
        reads: READS.map(String::from).to_vec(),
        name: "stickslip".into(),
        version: env!("CARGO_PKG_VERSION").into(),
    };
    let hello = match link.ask(&request, start.start)? {
        Answer::Hello(hello) => *hello,
        answer => return Err(other(&request, answer, "hello")),
    };
    if !PROTOCOLS.contains(&hello.protocol) {
        return Err(Fault::Version(hello.protocol));
    }
    let offers = capabilities(&hello)?;
    link.set_interrupts(hello.abilities.interrupt);
    let scene = match link.ask(&Request::Scene, start.start)? {
        Answer::Scene(scene) => *scene,
        answer => return Err(other(&Request::Scene, answer, "scene")),
    };
    if scene.dimension != 2 && hello.protocol < 2 {
        return Err(Fault::Unfit {
            message: "scene",
            why: "dimension: 3 needs version 2 of the protocol in hello".into(),
        });
    }
    Ok(StartedSolver {
        link,
        hello,
        scene,
        offers,
    })
}

/// The fault for an answer of the wrong type.
pub fn other(request: &Request, answer: Answer, expected: &'static str) -> Fault {
    match answer {
        Answer::Refused { reason } => Fault::Refused {
            asked: name(request),
            why: reason,
        },
        answer => Fault::OtherAnswer {
            asked: name(request),
            answer: answer.kind().to_owned(),
            expected,
        },
    }
}

/// The capabilities of a solver, in the debugger's terms.
fn capabilities(hello: &Hello) -> Result<Capabilities, Fault> {
    let mut parameters: Vec<Parameter> = Vec::with_capacity(hello.parameters.len());
    for sent in &hello.parameters {
        let parameter = parameter(sent)?;
        if parameters.iter().any(|known| known.name == parameter.name) {
            return unfit(sent, "duplicate name");
        }
        parameters.push(parameter);
    }
    let has = |name: &str| parameters.iter().any(|known| known.name == name);
    let abilities = hello.abilities;
    Ok(Capabilities {
        name: shown::line(&hello.name).into_owned(),
        version: shown::line(&hello.version).into_owned(),
        past: None,
        force: abilities.force,
        hold: abilities.hold,
        increment: has(INCREMENT),
        friction: has(FRICTION),
        cohesion: has(COHESION),
        settings: false,
        goes_back: match abilities.restore {
            Restore::None => RewindSupport::Again,
            Restore::Increment => RewindSupport::ToIncrements,
            Restore::Any => RewindSupport::ToAny,
        },
        problem: abilities.problem,
        cures: false,
        parameters,
    })
}

fn unfit<T>(sent: &message::ParameterMessage, why: &str) -> Result<T, Fault> {
    Err(Fault::Unfit {
        message: "hello",
        why: format!("parameter {:?}: {why}", sent.name),
    })
}

fn parameter(sent: &message::ParameterMessage) -> Result<Parameter, Fault> {
    if sent.name.is_empty()
        || sent
            .name
            .contains(|c: char| c.is_whitespace() || shown::is_order(c))
    {
        return unfit(sent, "the name must be one word");
    }
    let numbers = |whole: bool| Range::Numbers {
        least: sent.least.unwrap_or(f64::NEG_INFINITY),
        most: sent.most.unwrap_or(f64::INFINITY),
        whole,
    };
    let parameter = Parameter {
        name: sent.name.clone(),
        value: match &sent.value {
            serde_json::Value::Bool(flag) => Value::Flag(*flag),
            serde_json::Value::String(text) => Value::Text(text.clone()),
            serde_json::Value::Number(number) => Value::Number(number.as_f64().unwrap_or(f64::NAN)),
            _ => return unfit(sent, "the value must be a number, a flag or a text"),
        },
        range: match sent.kind {
            ParameterKind::Number => numbers(false),
            ParameterKind::Integer => numbers(true),
            ParameterKind::Flag => Range::Flag,
            ParameterKind::Choice => Range::Choice(sent.choices.clone()),
            ParameterKind::Text => Range::Text,
        },
        about: shown::line(&sent.about).into_owned(),
        tunes: sent.tunes,
    };
    match parameter.check(&parameter.value) {
        Ok(()) => Ok(parameter),
        Err(why) => unfit(sent, &format!("its current value is invalid: {why}")),
    }
}
