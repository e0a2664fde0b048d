//! The arguments of `set`: paths of our own scenes, or parameters of an attached solver, whose names may
//! contain spaces, with their current values.

use super::context::Context;
use stickslip_core::Parameter;
use stickslip_core::step::intervene::Value;
use stickslip_core::step::solver::Range;
use stickslip_scene::format::paths;
use stickslip_scene::number;
use stickslip_scene::shown;

/// The parameter with the longest name that a text begins with, and the rest of the text.
pub fn parameter<'a, 'b>(text: &'b str, context: &Context<'a>) -> Option<(&'a Parameter, &'b str)> {
    context
        .offers?
        .parameters
        .iter()
        .filter_map(|known| {
            let rest = text.trim_start().strip_prefix(known.name.as_str())?;
            let apart = rest.is_empty() || rest.starts_with(char::is_whitespace);
            apart.then_some((known, rest.trim()))
        })
        .max_by_key(|(known, _)| known.name.len())
}

/// The current value of a parameter, as typed.
pub fn present(known: &Parameter, context: &Context) -> String {
    let now = match (context.model, context.state) {
        (Some(model), Some(state)) => known.now(model, state),
        _ => known.value.clone(),
    };
    match now {
        Value::Number(value) => number::shortest(value),
        other => other.to_string(),
    }
}

/// Completions of `set` for an attached solver: the names of its parameters and, after a name, its choices or
/// its current value.
pub(super) fn parameter_lines(rest: &str, context: &Context) -> Vec<String> {
    let Some((known, _)) =
        parameter(rest, context).filter(|(known, _)| rest.trim_start().len() > known.name.len())
    else {
        return set_paths(context);
    };
    let values = match &known.range {
        Range::Choice(choices) => choices.clone(),
        Range::Flag => ["true", "false"].map(String::from).into(),
        Range::Numbers { .. } | Range::Text => vec![present(known, context)],
    };
    values
        .iter()
        .map(|value| format!("{} {value}", known.name))
        .collect()
}

/// The paths that `set` can change during a run.
pub(super) fn set_paths(context: &Context) -> Vec<String> {
    if let Some(offers) = context.offers {
        return offers
            .parameters
            .iter()
            .map(|known| shown::line(&known.name).into_owned())
            .collect();
    }
    let others = ["history.increment", "friction.angle", "friction.cohesion"];
    let settings = paths::of_settings().map(|own| own.path);
    others
        .map(String::from)
        .into_iter()
        .chain(settings)
        .collect()
}
