//! What a solver tells as it steps: whether it fits its scene and follows from what it told before, whether it keeps to the signs
//! of the protocol, and whether it is the same when started again.

use super::report::{Outcome, Report, fails, good, not_tried};
use super::trial::{Trial, is_last, millis};
use stickslip_core::model::{Mode, Model};
use stickslip_debugger::explain::names;
use stickslip_debugger::recorded::fault::Fault;
use stickslip_debugger::recorded::judged::ALLOWED;
use stickslip_debugger::recorded::told::Frame;
use stickslip_scene::shown;

use std::time::Instant;
use stickslip_core::step::event::Position;
use stickslip_core::step::state::State as OurState;
use stickslip_exchange::attach::message::{Ended, Found, Scene, State};
use stickslip_exchange::attach::{Answer, Request};

/// Iterations that a solver is stepped by, and most of them as long as no increment was accepted.
const STEPS: usize = 24;
const MOST_STEPS: usize = 200;
/// Requests that are refused, by which the way there and back is measured.
const ROUNDS: u32 = 10;
/// Longest that a line may take to be answered that takes no work (ms).
const PROMPT: f64 = 20.0;
/// Forces against a law below this part of the largest are rounding.
const ROUNDED: f64 = 1e-6;

/// Steps on, and looks at what is told.
pub fn stepping(report: &mut Report, mut trial: Trial) -> Vec<State> {
    let mut states = Vec::new();
    let mut times = Vec::new();
    let mut end = Ok(());
    let enough = |states: &[State]| {
        let most = match states.iter().any(is_settled) {
            true => STEPS,
            false => MOST_STEPS,
        };
        states.len() >= most
    };
    while !enough(&states) && (states.is_empty() || !trial.is_late()) {
        let began = Instant::now();
        match trial.step() {
            Ok(Some(state)) => {
                times.push(millis(began.elapsed()));
                let last = is_last(&state);
                states.push(state);
                if last {
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
            "the first step is refused",
            "a step from the start is answered by a state",
        ),
        Some(median) => good(format!(
            "{} iterations, {median:.1} ms each (median; the slowest {:.1} ms)",
            states.len(),
            times[times.len() - 1]
        )),
    });
    report.add("step", step);
    if states.is_empty() {
        return states;
    }
    if goes_on {
        report.add("answers", prompt(&mut trial));
    }
    look(report, &trial.scene, &trial.hello.name, &states);
    states
}

/// How long a line is under way that takes no work.
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
    let found = format!("{each:.2} ms for a request and its answer without work");
    Ok(match each <= PROMPT {
        true => good(found),
        false => fails(
            found,
            "read and write whole lines without waiting in between: no polling with sleeps, and a flush after each line",
        ),
    })
}

/// Looks at states, as the debugger does.
fn look(report: &mut Report, scene: &Scene, name: &str, states: &[State]) {
    let sound = match stickslip_scene::Scene::told(name, scene, None) {
        Ok(sound) => sound,
        Err(why) => {
            let mend = "`stickslip help attach` says what a scene is";
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
                "{}; {kilobytes:.1} kB each, which this program reads in {own:.2} ms",
                told(states)
            );
            report.add("states", Ok(good(found)));
        }
        Err(why) => {
            let mend =
                "a state has all contacts of the scene, in its order, and one displacement a node";
            return report.add("states", Ok(fails(why, mend)));
        }
    }
    let follows = states
        .windows(2)
        .zip(2..)
        .find_map(|(pair, number)| Some((number, unfollowed(&pair[0], &pair[1])?)));
    let order = match follows {
        None => good("each iteration follows from the one before"),
        Some((number, (why, mend))) => fails(format!("iteration {number}: {why}"), mend),
    };
    report.add("order", Ok(order));
    report.add("laws", Ok(laws(states)));
}

fn line(state: &State) -> String {
    Answer::State(Box::new(state.clone())).line()
}

/// Reads all states from their lines, and makes of them what the debugger shows.
fn taken_in(model: &Model, scene: &Scene, states: &[State]) -> Result<(), String> {
    let ids: Vec<_> = scene
        .contacts
        .iter()
        .map(|contact| contact.id.clone())
        .collect();
    let frame = Frame {
        model,
        ids: &ids,
        decides: None,
    };
    let mut from = OurState::outside_start(model);
    for (state, number) in states.iter().zip(1..) {
        let told = match Answer::read(&line(state)) {
            Ok(Answer::State(told)) => *told,
            _ => {
                return Err(format!(
                    "state {number} does not read back as it was written"
                ));
            }
        };
        let led = frame.led(&from, &told);
        from = led
            .map_err(|fault| format!("state {number}: {fault}"))?
            .state;
    }
    Ok(())
}

/// Which numbers the states tell.
fn told(states: &[State]) -> String {
    let all = || states.iter().flat_map(|state| &state.contacts);
    type Number = fn(&Found) -> Option<f64>;
    let names: [(&str, Number); 5] = [
        ("gap", |found| found.gap),
        ("f_n", |found| found.f_n),
        ("f_t", |found| found.f_t),
        ("limit", |found| found.limit),
        ("slip", |found| found.slip),
    ];
    let lacks: Vec<&str> = names
        .iter()
        .filter(|(_, of)| all().all(|found| of(found).is_none()))
        .map(|(name, _)| *name)
        .collect();
    match lacks.as_slice() {
        [] => "all numbers are told".into(),
        lacks => format!("never told: {}", lacks.join(", ")),
    }
}

/// How a state does not follow from the one before, and how to mend that.
fn unfollowed(before: &State, state: &State) -> Option<(String, &'static str)> {
    let (then, now) = (before.at, state.at);
    let goes_on = match before.ended {
        Ended::Iteration => {
            same_attempt(then, now) && (now.major, now.minor) > (then.major, then.minor)
        }
        Ended::Equilibrium => same_attempt(then, now) && now.major > then.major,
        Ended::Cut => now.increment == then.increment && now.attempt > then.attempt,
        Ended::Increment => now.increment > then.increment,
        // What follows a failure is the solver's own matter.
        Ended::Failure | Ended::Done => true,
    };
    if !goes_on {
        let place =
            |at: Position| format!("{}.{}.{}.{}", at.increment, at.attempt, at.major, at.minor);
        let ended = format!("{:?}", before.ended).to_lowercase();
        return Some((
            format!(
                "it is {} (increment, attempt, major, minor) after {}, which ended {ended}",
                place(now),
                place(then)
            ),
            "at counts on: minors within a major, majors after equilibrium, attempts after cut, increments after increment",
        ));
    }
    // Where equilibrium is sought anew, the geometry may change modes: a node has come to a corner, or past the end of a surface.
    if before.ended != Ended::Iteration {
        return None;
    }
    let mut pairs = before.contacts.iter().zip(&state.contacts);
    let other = pairs.find(|(then, now)| then.next != now.mode);
    other.map(|(then, now)| {
        (
            format!(
                "contact {} is solved {}, and was to go on {}",
                shown::line(&now.id.to_string()),
                names::mode(now.mode),
                names::mode(then.next)
            ),
            "`mode` is that of the solve that was made, `next` that of the one to come",
        )
    })
}

fn same_attempt(then: Position, now: Position) -> bool {
    (then.increment, then.attempt) == (now.increment, now.attempt)
}

/// Whether accepted states whose modes have settled keep to the signs of the protocol, and to the laws of contact.
fn laws(states: &[State]) -> Outcome {
    let accepted = states.iter().filter(|state| is_settled(state));
    // A state may have no forces but those of rounding: what is small, all states tell.
    let all = states.iter().flat_map(|state| &state.contacts);
    let forces = all.flat_map(|found| [found.f_n, found.f_t]).flatten();
    let largest = forces.fold(0.0, |most: f64, force| most.max(force.abs()));
    let (mut count, mut nearly) = (0, String::new());
    for state in accepted {
        count += 1;
        for found in &state.contacts {
            let told = |why: String| {
                let id = found.id.to_string();
                let at = state.at.increment;
                format!("increment {at}, contact {}: {why}", shown::line(&id))
            };
            if let Some((why, mend)) = unlawful(found, ALLOWED * largest) {
                return fails(told(why), mend);
            }
            if let Some((why, _)) = unlawful(found, ROUNDED * largest)
                && nearly.is_empty()
            {
                nearly = format!("; only to {ALLOWED:e} of the largest force: {}", told(why));
            }
        }
    }
    match count {
        0 => not_tried(
            "",
            format!("no increment was accepted in {} iterations", states.len()),
        ),
        _ => good(format!(
            "in {count} accepted increments: signs, and forces within their limits{nearly}"
        )),
    }
}

/// Whether a state was accepted with modes that stay.
pub fn is_settled(state: &State) -> bool {
    matches!(state.ended, Ended::Increment | Ended::Done)
        && state.contacts.iter().all(|found| found.mode == found.next)
}

/// How a settled contact breaks the laws, where forces below `small` are none.
fn unlawful(found: &Found, small: f64) -> Option<(String, &'static str)> {
    let (f_n, f_t) = (found.f_n.unwrap_or(0.0), found.f_t.unwrap_or(0.0));
    let limit = found.limit;
    match found.mode {
        Mode::Free if f_n.abs() > small || f_t.abs() > small => Some((
            format!("it is free, and has forces ({f_n:?}, {f_t:?})"),
            "a free contact has no forces",
        )),
        Mode::Free => None,
        _ if f_n < -small => Some((
            format!("it touches with f_n = {f_n:?}"),
            "compression is positive: f_n is the force on the slave node along the outward normal of the master",
        )),
        Mode::Sliding if limit.is_some_and(|limit| limit * f_t < 0.0 && f_t.abs() > small) => {
            Some((
                format!(
                    "it slides with f_t = {f_t:?}, and its limit is {:?}",
                    limit.unwrap_or(0.0)
                ),
                "limit has the sign of the friction force: copysign(mu * f_n + cohesion, f_t)",
            ))
        }
        _ if limit.is_some_and(|limit| f_t.abs() > limit.abs() + small) => Some((
            format!(
                "f_t = {f_t:?} is more than the limit {:?}",
                limit.unwrap_or(0.0)
            ),
            "in an accepted state |f_t| <= |limit| = mu f_n + cohesion",
        )),
        _ => None,
    }
}

/// The same twice.
pub fn determinism(mut trial: Trial, states: &[State]) -> Result<Outcome, Fault> {
    const MEND: &str = "fix seeds and thread counts; a solver that is started again and goes elsewhere cannot go back by replaying";
    let mut bits = None;
    for (then, number) in states.iter().zip(1..) {
        let now = trial.step()?;
        if now.as_ref() == Some(then) {
            continue;
        }
        let Some(now) = now else {
            return Ok(fails(
                format!("started again, step {number} is refused"),
                MEND,
            ));
        };
        if let Some(how) = otherwise(then, &now) {
            return Ok(fails(
                format!("started again, iteration {number} is another: {how}"),
                MEND,
            ));
        }
        bits = bits.or(Some(number));
    }
    Ok(good(match bits {
        None => "started again, the same to the last bit".into(),
        Some(number) => format!(
            "started again, the same modes; from iteration {number} on the numbers have other bits"
        ),
    }))
}

/// How one state goes another way than a second.
pub fn otherwise(then: &State, now: &State) -> Option<String> {
    if then.at != now.at {
        return Some("it is another iteration (at)".into());
    }
    if then.ended != now.ended {
        return Some("it ended otherwise".into());
    }
    let modes = |found: &Found| (found.mode, found.next);
    let mut pairs = then.contacts.iter().zip(&now.contacts);
    let other = pairs.find(|(then, now)| modes(then) != modes(now))?.1;
    let id = other.id.to_string();
    Some(format!(
        "contact {} is {} and goes on {}",
        shown::line(&id),
        names::mode(other.mode),
        names::mode(other.next)
    ))
}
