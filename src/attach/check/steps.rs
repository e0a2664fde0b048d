//! Checks the states of a solver: that they match its scene, follow from each other, obey the protocol's signs, and are the same
//! after a restart.

use super::report::{Outcome, Report, fails, good, not_tried};
use super::trial::{Trial, millis};
use stickslip_core::plane::max_abs;
use stickslip_core::step::judged::ALLOWED;
use stickslip_core::step::state::State as OurState;
use stickslip_core::{Mode, Model, Position, counted};
use stickslip_debugger::Fault;
use stickslip_debugger::recorded::decode::WireFrame;
use stickslip_scene::shown;

use std::time::Instant;
use stickslip_exchange::attach::message::{ContactResult, EndedLevel, Scene, State};
use stickslip_exchange::attach::{Answer, Request};

/// Iterations per check, and the maximum if no increment has been accepted by then.
const STEPS: usize = 24;
const MOST_STEPS: usize = 200;
/// Refused requests for measuring the round-trip time.
const ROUNDS: u32 = 10;
/// Maximum round-trip time of a request without work (ms).
const PROMPT: f64 = 20.0;
/// Violations of a law below this fraction of the largest force are round-off.
const ROUNDED: f64 = 1e-6;

/// Steps the solver, and checks its states.
pub fn stepping(report: &mut Report, mut trial: Trial) -> Vec<State> {
    let mut states = Vec::new();
    let mut times = Vec::new();
    let mut end = Ok(());
    let enough = |states: &[State]| {
        let most = if states.iter().any(is_settled) {
            STEPS
        } else {
            MOST_STEPS
        };
        states.len() >= most
    };
    while !enough(&states) && (states.is_empty() || !trial.is_late()) {
        let began = Instant::now();
        match trial.step() {
            Ok(Some(state)) => {
                if states.last().is_some_and(|before| is_retry(before, &state)) {
                    break;
                }
                times.push(millis(began.elapsed()));
                let done = state.ended == EndedLevel::Done;
                states.push(state);
                if done {
                    break;
                }
            }
            Ok(None) => break,
            Err(why) => {
                end = Err(why);
                break;
            }
        }
    }
    times.sort_by(f64::total_cmp);
    let goes_on = end.is_ok();
    let step = end.map(|()| match times.get(times.len() / 2) {
        None => fails(
            "the first step was refused",
            "answer the first step with a state",
        ),
        Some(median) => good(format!(
            "{}, {median:.1} ms each (median; the slowest {:.1} ms); {}",
            counted(states.len(), "iteration"),
            times[times.len() - 1],
            increments(&states),
        )),
    });
    report.add("step", step);
    if states.is_empty() {
        return states;
    }
    if goes_on {
        report.add("answers", prompt(&mut trial));
    }
    report.add("output", Ok(output(&trial)));
    look(report, &trial.scene, &trial.hello.name, &states);
    states
}

/// Whether a solver repeats an increment that it gave up.
fn is_retry(before: &State, state: &State) -> bool {
    before.ended == EndedLevel::Failure && state.at.increment <= before.at.increment
}

/// How many increments were accepted, and how many were given up.
fn increments(states: &[State]) -> String {
    let ended = |levels: &[EndedLevel]| {
        states
            .iter()
            .filter(|state| levels.contains(&state.ended))
            .count()
    };
    let accepted = ended(&[EndedLevel::Increment, EndedLevel::Done]);
    let given_up = ended(&[EndedLevel::Failure]);
    format!(
        "{} accepted, {given_up} given up",
        counted(accepted, "increment")
    )
}

/// Checks that standard output has only messages.
fn output(trial: &Trial) -> Outcome {
    match trial.link.stray() {
        None => good("only messages on standard output"),
        Some(stray) => fails(stray.to_string(), super::report::mend(stray)),
    }
}

/// Checks the round-trip time of a request without work.
fn prompt(trial: &mut Trial) -> Result<Outcome, Fault> {
    let request = Request::Set {
        name: "no such parameter".into(),
        value: serde_json::Value::Null,
    };
    let began = Instant::now();
    for _ in 0..ROUNDS {
        trial.ask(&request)?;
    }
    let each = millis(began.elapsed()) / f64::from(ROUNDS);
    let found = format!("{each:.2} ms per request without work");
    Ok(if each <= PROMPT {
        good(found)
    } else {
        fails(
            found,
            "read and write whole lines without delays: no polling with sleeps, and a flush after each line",
        )
    })
}

/// Checks states as the debugger reads them.
fn look(report: &mut Report, scene: &Scene, name: &str, states: &[State]) {
    let sound = match stickslip_scene::Scene::from_message(name, scene, None) {
        Ok(sound) => sound,
        Err(why) => {
            let mend = "`stickslip help protocol` describes the scene message";
            return report.add("scene", Ok(fails(why.message, mend)));
        }
    };
    let model = &sound.model;
    let bytes: usize = states.iter().map(|state| line(state).len()).sum();
    let began = Instant::now();
    match taken_in(model, scene, states) {
        Ok(()) => {
            let own = millis(began.elapsed()) / states.len() as f64;
            let kilobytes = bytes as f64 / 1e3 / states.len() as f64;
            let found = format!(
                "{}; {kilobytes:.1} kB each, read in {own:.2} ms",
                reported_values(states)
            );
            report.add("states", Ok(good(found)));
        }
        Err(why) => {
            let mend = "a state must have all contacts of the scene, in its order, and one displacement per node";
            return report.add("states", Ok(fails(why, mend)));
        }
    }
    let follows = states
        .windows(2)
        .zip(2..)
        .find_map(|(pair, number)| Some((number, unfollowed(&pair[0], &pair[1])?)));
    let order = match follows {
        None => good("each iteration follows from the previous one"),
        Some((number, (why, mend))) => fails(format!("iteration {number}: {why}"), mend),
    };
    report.add("order", Ok(order));
    report.add("laws", Ok(laws(scene, states)));
}

fn line(state: &State) -> String {
    Answer::State(Box::new(state.clone())).line()
}

/// Decodes all states from their lines, as the debugger does.
fn taken_in(model: &Model, scene: &Scene, states: &[State]) -> Result<(), String> {
    let ids: Vec<_> = scene
        .contacts
        .iter()
        .map(|contact| contact.id.clone())
        .collect();
    let frame = WireFrame {
        model,
        ids: &ids,
        decides: None,
    };
    let mut from = OurState::outside_start(model);
    for (state, number) in states.iter().zip(1..) {
        let message = match Answer::read(&line(state)) {
            Ok(Answer::State(message)) => *message,
            _ => {
                return Err(format!(
                    "state {number} changes when it is written and read again"
                ));
            }
        };
        let led = frame.recorded_step(&from, &message);
        from = led
            .map_err(|fault| format!("state {number}: {fault}"))?
            .state;
    }
    Ok(())
}

/// Which values the states report.
fn reported_values(states: &[State]) -> String {
    let all = || states.iter().flat_map(|state| &state.contacts);
    type Number = fn(&ContactResult) -> Option<f64>;
    let names: [(&str, Number); 5] = [
        ("gap", |found| found.gap),
        ("f_n", |found| found.f_n),
        ("f_t", |found| found.f_t.map(|f| f.size())),
        ("limit", |found| found.limit),
        ("slip", |found| found.slip.map(|slip| slip.size())),
    ];
    let lacks: Vec<&str> = names
        .iter()
        .filter(|(_, of)| all().all(|found| of(found).is_none()))
        .map(|(name, _)| *name)
        .collect();
    match lacks.as_slice() {
        [] => "all values are reported".into(),
        lacks => format!("never reported: {}", lacks.join(", ")),
    }
}

/// Why a state does not follow from the previous one, and how to fix that.
fn unfollowed(before: &State, state: &State) -> Option<(String, &'static str)> {
    let (then, now) = (before.at, state.at);
    let goes_on = match before.ended {
        EndedLevel::Iteration => {
            same_attempt(then, now) && (now.major, now.minor) > (then.major, then.minor)
        }
        EndedLevel::Equilibrium => same_attempt(then, now) && now.major > then.major,
        EndedLevel::Cut => now.increment == then.increment && now.attempt > then.attempt,
        EndedLevel::Increment => now.increment > then.increment,
        // After a failure the solver may continue anywhere.
        EndedLevel::Failure | EndedLevel::Done => true,
    };
    if !goes_on {
        let place =
            |at: Position| format!("{}.{}.{}.{}", at.increment, at.attempt, at.major, at.minor);
        let ended = format!("{:?}", before.ended).to_lowercase();
        return Some((
            format!(
                "position {} (increment, attempt, major, minor) after {}, which ended {ended}",
                place(now),
                place(then)
            ),
            "advance `at`: minors within a major, majors after equilibrium, attempts after cut, increments after increment",
        ));
    }
    if let [Some(then), Some(now)] = [before.load, state.load]
        && same_attempt(before.at, state.at)
        && before.arc.is_none()
        && then != now
    {
        return Some((
            format!("load {now:?} after {then:?} in the same attempt"),
            "`load` is the load factor at the end of the increment",
        ));
    }
    // In a new major iteration the geometry may change modes: a node reaches a corner, or the end of a surface.
    if before.ended != EndedLevel::Iteration {
        return None;
    }
    let other = before
        .contacts
        .iter()
        .zip(&state.contacts)
        .find(|(then, now)| then.next != now.mode);
    other.map(|(then, now)| {
        (
            format!(
                "contact {} is solved {}, but its previous `next` was {}",
                shown::line(&now.label()),
                now.mode.word(),
                then.next.word()
            ),
            "`mode` is the mode of this solve, `next` the mode of the next one",
        )
    })
}

fn same_attempt(then: Position, now: Position) -> bool {
    (then.increment, then.attempt) == (now.increment, now.attempt)
}

/// Checks that accepted states with settled modes obey the protocol's signs and the contact laws, except at tied contacts.
fn laws(scene: &Scene, states: &[State]) -> Outcome {
    let accepted = states.iter().filter(|state| is_settled(state));
    // The force scale comes from all states, since a single state may have only round-off forces.
    let forces = states
        .iter()
        .flat_map(|state| &state.contacts)
        .flat_map(|found| [found.f_n, found.f_t.map(|f| f.size())])
        .flatten();
    let largest = max_abs(forces);
    let slips = states
        .iter()
        .flat_map(|state| &state.contacts)
        .filter_map(|found| Some(found.slip?.size()));
    let crawl = ALLOWED * slips.fold(0.0, f64::max);
    let (mut count, mut nearly) = (0, String::new());
    for state in accepted {
        count += 1;
        let contacts = scene.contacts.iter().zip(&state.contacts);
        for (_, found) in contacts.filter(|(contact, _)| !contact.tied) {
            let located = |why: String| {
                let id = found.label();
                let at = state.at.increment;
                format!("increment {at}, contact {}: {why}", shown::line(&id))
            };
            if let Some((why, mend)) = unlawful(found, ALLOWED * largest, crawl) {
                return fails(located(why), mend);
            }
            if let Some((why, _)) = unlawful(found, ROUNDED * largest, crawl)
                && nearly.is_empty()
            {
                nearly = format!(
                    "; only to {ALLOWED:e} of the largest force: {}",
                    located(why)
                );
            }
        }
    }
    match count {
        0 => not_tried(
            "",
            format!(
                "no increment was accepted in {}",
                counted(states.len(), "iteration")
            ),
        ),
        _ => good(format!(
            "in {}: signs are right, forces within their limits{nearly}",
            counted(count, "accepted increment")
        )),
    }
}

/// Whether a state was accepted with unchanged modes.
pub fn is_settled(state: &State) -> bool {
    matches!(state.ended, EndedLevel::Increment | EndedLevel::Done)
        && state.contacts.iter().all(|found| found.mode == found.next)
}

/// How a settled contact violates the laws; forces below `small` count as zero, and slips below `crawl` have no direction.
fn unlawful(found: &ContactResult, small: f64, crawl: f64) -> Option<(String, &'static str)> {
    let size = found.f_t.map_or(0.0, |f| f.size());
    let f_n = found.f_n.unwrap_or(0.0);
    // The sign, in the plane.
    let f_t = found.f_t.and_then(|f| f.scalar()).unwrap_or(size);
    let slip = found.f_t.zip(found.slip);
    let slip = slip.and_then(|(f, slip)| Some((f.pair()?, slip.pair()?)));
    let limit = found.limit;
    // In space: the distance of the force from the point of the circle that the slip demands.
    let (off, degrees) = match slip {
        Some(([a, b], [u, v])) if u.hypot(v) > crawl => {
            let demanded = limit.unwrap_or(size) / u.hypot(v);
            let angle = (a * v - b * u).atan2(a * u + b * v).abs();
            (
                (a - demanded * u).hypot(b - demanded * v),
                angle.to_degrees(),
            )
        }
        _ => (0.0, 0.0),
    };
    match found.mode {
        Mode::Free if f_n.abs() > small || size > small => Some((
            format!("free, but with forces ({f_n:?}, {f_t:?})"),
            "report zero forces for a free contact",
        )),
        Mode::Free => None,
        _ if f_n < -small => Some((
            format!("closed with f_n = {f_n:?}"),
            "compression is positive: f_n is the force on the slave node along the outward normal of the master",
        )),
        Mode::Sliding if limit.is_some_and(|limit| limit * f_t < 0.0 && f_t.abs() > small) => {
            Some((
                format!(
                    "sliding with f_t = {f_t:?}, but its limit is {:?}",
                    limit.unwrap_or(0.0)
                ),
                "give limit the sign of the friction force: copysign(mu * f_n + cohesion, f_t)",
            ))
        }
        Mode::Sliding if off > small => Some((
            format!(
                "sliding with f_t = {f_t:?} of {:?}, {degrees:.1} degrees off its slip",
                limit.unwrap_or(size)
            ),
            "|f_t| = limit in the direction of slip, the motion of the master relative to the node",
        )),
        _ if limit.is_some_and(|limit| size > limit.abs() + small) => Some((
            format!("f_t = {f_t:?} exceeds the limit {:?}", limit.unwrap_or(0.0)),
            "in an accepted state |f_t| <= |limit| = mu f_n + cohesion",
        )),
        _ => None,
    }
}

/// Checks that the states after a restart are the same.
pub fn determinism(mut trial: Trial, states: &[State]) -> Result<Outcome, Fault> {
    const MEND: &str = "fix seeds and thread counts; a solver that differs after a restart cannot go back by replaying";
    let (mut bits, mut texts) = (None, false);
    for (then, number) in states.iter().zip(1..) {
        let now = trial.step()?;
        if now.as_ref() == Some(then) {
            continue;
        }
        let Some(now) = now else {
            return Ok(fails(
                format!("after a restart, step {number} was refused"),
                MEND,
            ));
        };
        if let Some(how) = otherwise(then, &now) {
            return Ok(fails(
                format!("after a restart, iteration {number} differs: {how}"),
                MEND,
            ));
        }
        if numbers(then) == numbers(&now) {
            texts = true
        } else {
            bits = bits.or(Some(number))
        }
    }
    Ok(good(match bits {
        None if texts => "same numbers after a restart; texts differ".into(),
        None => "bit-identical after a restart".into(),
        Some(number) => format!(
            "same modes after a restart; numbers differ in the last digits from iteration {number} on"
        ),
    }))
}

/// A state without its texts.
fn numbers(state: &State) -> State {
    let mut state = state.clone();
    state.reason.clear();
    state
        .contacts
        .iter_mut()
        .for_each(|found| found.rule.clear());
    state
}

/// How two states differ.
pub fn difference(then: &State, now: &State) -> String {
    let rest = if numbers(then) == numbers(now) {
        "only texts differ"
    } else {
        "numbers differ in the last digits"
    };
    otherwise(then, now).unwrap_or_else(|| rest.into())
}

/// The first difference between two states in position, outcome or modes.
fn otherwise(then: &State, now: &State) -> Option<String> {
    if then.at != now.at {
        return Some("another position (`at`)".into());
    }
    if then.ended != now.ended {
        return Some("another outcome (`ended`)".into());
    }
    let modes = |found: &ContactResult| (found.mode, found.next);
    let other = then
        .contacts
        .iter()
        .zip(&now.contacts)
        .find(|(then, now)| modes(then) != modes(now))?
        .1;
    let id = other.label();
    Some(format!(
        "contact {} is {}, next {}",
        shown::line(&id),
        other.mode.word(),
        other.next.word()
    ))
}
