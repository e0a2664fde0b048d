//! The results of a study as curves, like the paper's figures.

use super::curves::{Axis, Curve, CurveChart, CurveEnd};
use super::monitor_kind::{MonitorKind, kind};
use super::origin;
use super::plan::Plan;
use super::read::{AxisQuantity, Study};
use super::result::{CaseEnd, Run};
use stickslip_core::counted;
use stickslip_scene::{joined, sig6};

/// The chart of a study: a curve per run, over the plan's axes.
pub fn chart(plan: &Plan, runs: &[Run]) -> CurveChart {
    let names = short_names(&plan.columns);
    let curves = plan
        .cases
        .iter()
        .zip(runs)
        .filter(|(_, run)| run.end != CaseEnd::NotRun)
        .map(|(case, run)| Curve {
            label: label(&names, &case.values),
            points: points(plan, run),
            end: match &run.end {
                CaseEnd::Finished | CaseEnd::NotRun => CurveEnd::Whole,
                CaseEnd::Failed(failed) => CurveEnd::Failed(format!(
                    "{} in increment {}, load {}",
                    failed.reason,
                    failed.increment,
                    sig6(failed.load)
                )),
                CaseEnd::Interrupted => CurveEnd::Stopped("interrupted".to_owned()),
            },
        })
        .collect();
    CurveChart {
        title: plan.title.clone(),
        x: axis(plan, &plan.x),
        y: axis(plan, &plan.y),
        curves,
        footer: footer(plan, runs),
    }
}

/// The settings that distinguish a run: `increment=0.02, geometry=frozen`. Empty if there is only one run.
pub fn label(names: &[String], values: &[String]) -> String {
    joined(
        names
            .iter()
            .zip(values)
            .map(|(name, value)| match name.as_str() {
                "scene" => value.clone(),
                _ => format!("{name}={value}"),
            }),
        ", ",
    )
}

/// Settings as typed: `path=value`.
pub fn assigned(settings: &[(String, String)]) -> impl Iterator<Item = String> {
    settings
        .iter()
        .map(|(path, value)| format!("{path}={value}"))
}

/// The changed and varied settings of a study, after the scenes.
pub(super) fn changes(study: &Study) -> String {
    let varied = study
        .vary
        .iter()
        .map(|vary| format!("{} over {}", vary.path, vary.values.join(", ")));
    assigned(&study.set)
        .chain(varied)
        .map(|change| format!("; {change}"))
        .collect()
}

/// The settings that distinguish a case of a plan.
pub fn name(plan: &Plan, case: usize) -> String {
    label(&short_names(&plan.columns), &plan.cases[case].values)
}

/// The last step of each path if those are unique, otherwise the whole paths.
pub fn short_names(paths: &[String]) -> Vec<String> {
    let short: Vec<String> = paths
        .iter()
        .map(|path| path.rsplit('.').next().unwrap_or(path).to_owned())
        .collect();
    if short
        .iter()
        .all(|name| short.iter().filter(|other| *other == name).count() == 1)
    {
        short
    } else {
        paths.to_vec()
    }
}

fn axis(plan: &Plan, quantity: &AxisQuantity) -> Axis {
    let name = match quantity {
        AxisQuantity::Load => "load factor".to_owned(),
        AxisQuantity::Majors => "major iterations of the increment".to_owned(),
        AxisQuantity::Minors => "minor iterations of the increment".to_owned(),
        AxisQuantity::Increment => "increment".to_owned(),
        AxisQuantity::Monitor(name) => format!("{name}{}", unit(plan, name)),
    };
    Axis {
        name,
        counts: matches!(
            quantity,
            AxisQuantity::Increment | AxisQuantity::Majors | AxisQuantity::Minors
        ),
    }
}

/// Unit of a monitor; lengths and forces are in the scene's units.
fn unit(plan: &Plan, monitor: &str) -> &'static str {
    let kind = plan.cases.iter().find_map(|case| {
        let model = case.model().ok()?;
        let found = model.monitors.iter().find(|own| own.name == monitor)?;
        Some(kind(&model, &found.of))
    });
    match kind {
        Some(MonitorKind::Length | MonitorKind::Drift) => " (length)",
        Some(MonitorKind::Rotation) => " (rad)",
        Some(MonitorKind::Force) => " (force)",
        Some(MonitorKind::Pressure) => " (force by area)",
        Some(MonitorKind::Count) | None => "",
    }
}

/// The points of a run, including the start if the quantities are defined there.
fn points(plan: &Plan, run: &Run) -> Vec<(f64, f64)> {
    let counts = |q: &AxisQuantity| matches!(q, AxisQuantity::Majors | AxisQuantity::Minors);
    let start = (!counts(&plan.x) && !counts(&plan.y)).then_some(&run.start);
    start
        .into_iter()
        .chain(&run.rows)
        .filter_map(|row| Some((run.value(row, &plan.x)?, run.value(row, &plan.y)?)))
        .filter(|(x, y)| x.is_finite() && y.is_finite())
        .collect()
}

/// The origin of the chart: scenes, settings and program.
fn footer(plan: &Plan, runs: &[Run]) -> Vec<String> {
    let study = &plan.study;
    let mut made = format!("Scene: {}", study.scenes.join(", "));
    if study.scenes.first() != Some(&study.name) {
        made = format!("Study: {}. {made}", study.name);
    }
    made += &changes(study);
    let failed = runs.iter().filter(|run| run.failed().is_some()).count();
    let by = format!(
        "{}, of which {failed} failed. {}",
        counted(runs.len(), "run"),
        origin::made_by()
    );
    vec![made, by]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_short_if_unique() {
        let own = |names: &[&str]| names.iter().map(|n| n.to_string()).collect::<Vec<_>>();
        let short = short_names(&own(&["history.increment", "settings.majors"]));
        assert_eq!(short, ["increment", "majors"]);
        let long = own(&["slaves[0].friction.angle", "friction.angle"]);
        assert_eq!(short_names(&long), long);
    }

    #[test]
    fn numbers_have_six_digits() {
        assert_eq!(sig6(0.1 + 0.2), "0.3");
        assert_eq!(sig6(-0.0), "0");
        assert_eq!(sig6(1.0 / 3.0), "0.333333");
        assert_eq!(sig6(1.2e-9), "1.2e-9");
    }
}
