//! Writes and reads work-precision charts as tables.

use super::csv::Table;
use super::figure::assigned;
use super::precision::{Cost, Point, Precision, mark_front};
use std::fmt::Write;
use std::path::Path;
use stickslip_platform::input::{self, TABLE_BYTES};
use stickslip_scene::format::error::quoted;
use stickslip_scene::format::read::not_read;
use stickslip_scene::{SceneError, joined, shown};

/// Maximum length of a name in a table, in characters.
const MOST_NAME: usize = 200;
/// Maximum number of comments kept, and their maximum length in characters.
const MOST_COMMENTS: usize = 40;
const MOST_COMMENT: usize = 2000;
/// Maximum number of runs in a table.
const MOST_RUNS: usize = 20_000;
/// Reads the text of a table, for [`read`].
///
/// # Errors
/// If the file cannot be read.
pub fn open(file: &Path) -> Result<String, SceneError> {
    input::text(file, TABLE_BYTES, "too large for the table of a chart")
        .map_err(|why| not_read(&file.display().to_string(), &why))
}

/// Parses charts from a table as written by [`csv`](fn@csv). Only the columns `scene`, `series`, `run`,
/// `status`, `error` and `seconds` are required, and the runs may come from other programs.
///
/// # Errors
/// If it cannot be read; the message has file, line and column.
pub fn read(
    name: &str,
    text: &str,
    cost: Cost,
    target: Option<f64>,
) -> Result<Vec<Precision>, SceneError> {
    let table = Table::read(name, text)?;
    let about: Vec<String> = table
        .comments()
        .map(|line| shown::cut(line, MOST_COMMENT))
        .take(MOST_COMMENTS)
        .collect();
    let heads = table.heads();
    for wanted in ["scene", "series", "run", "status", "error", "seconds"] {
        if !heads.contains(&wanted) {
            let message = format!("not the table of a chart: column {wanted} is missing");
            return Err(table.wrong_header(message));
        }
    }
    let mut charts: Vec<Precision> = Vec::new();
    let mut runs = 0;
    for row in &table.rows {
        table.check(row)?;
        let place = |head: &str| heads.iter().position(|own| *own == head);
        let word = |head: &str| place(head).map_or("", |k| &row.fields[k]);
        let wrong = |head: &str, message| table.wrong(row, place(head).unwrap_or(0), message);
        for head in ["scene", "series", "run", "status"] {
            let letters = word(head).chars().count();
            if letters > MOST_NAME {
                let message = format!(
                    "the text under {head} has {letters} characters; the limit is {MOST_NAME}"
                );
                return Err(wrong(head, message));
            }
        }
        let number = |head: &str| match word(head) {
            "" => Ok(None),
            word => {
                let value = word.parse::<f64>().ok().filter(|v| *v >= 0.0);
                value.map(Some).ok_or_else(|| {
                    let word = quoted(word);
                    let message = format!("{word} under {head} is not a number that can be drawn");
                    wrong(head, message)
                })
            }
        };
        let count = |head: &str| number(head).map(|value| value.unwrap_or(0.0) as u64);
        runs += 1;
        if runs > MOST_RUNS {
            let message = format!("the table has more than {MOST_RUNS} runs, the limit for charts");
            return Err(table.wrong(row, 0, message));
        }
        let (scene, own) = (word("scene"), word("series"));
        if charts.last().is_none_or(|chart| chart.scene != scene) {
            charts.push(Precision {
                scene: scene.to_owned(),
                title: scene.to_owned(),
                cost,
                target,
                ..Precision::default()
            });
        }
        let Some(chart) = charts.last_mut() else {
            continue;
        };
        let series = chart
            .series
            .iter()
            .position(|name| name == own)
            .unwrap_or_else(|| {
                chart.series.push(own.to_owned());
                chart.series.len() - 1
            });
        for (head, bar) in ["uncertainty", "force_uncertainty"]
            .iter()
            .zip(&mut chart.uncertainty)
        {
            *bar = number(head)?.or(*bar);
        }
        let status = word("status");
        chart.points.push(Point {
            series,
            name: word("run").to_owned(),
            settings: Vec::new(),
            seconds: number("seconds")?.unwrap_or(0.0),
            spread: number("fastest")?.zip(number("slowest")?),
            repeats: count("repeats")? as usize,
            factorizations: count("factorizations")?,
            majors: count("majors")?,
            minors: count("minors")?,
            increments: count("increments")?,
            unknowns: count("unknowns")? as usize,
            failed: (!["whole", "reference"].contains(&status)).then(|| status.to_owned()),
            unsettled: count("unsettled")? as usize,
            error: number("error")?,
            force_error: number("force_error")?,
            reference: status == "reference",
            front: false,
        });
    }
    for chart in &mut charts {
        mark_front(&mut chart.points, cost);
    }
    let last = charts
        .last_mut()
        .ok_or_else(|| table.wrong_header("the table has no rows".into()))?;
    last.about = about;
    Ok(charts)
}

/// A table with a row for each run of some charts, after comment lines with their origin.
pub fn csv(charts: &[Precision]) -> String {
    let mut text = super::csv::comments(charts.iter().flat_map(|chart| &chart.about));
    text += "scene,series,run,settings,status,error,seconds,repeats,factorizations,majors,minors,increments,unknowns,\
             unsettled,front,force_error,fastest,slowest,uncertainty,force_uncertainty\n";
    let cell = |value: Option<f64>| value.map(|value| format!("{value:?}")).unwrap_or_default();
    for (chart, point) in charts
        .iter()
        .flat_map(|c| c.points.iter().map(move |p| (c, p)))
    {
        let settings = joined(assigned(&point.settings), " ");
        let status = match (&point.failed, point.reference) {
            (Some(why), _) => why.as_str(),
            (None, true) => "reference",
            (None, false) => "whole",
        };
        let words = [
            &chart.scene,
            &chart.series[point.series],
            &point.name,
            &settings,
            status,
        ];
        let words = joined(words.into_iter().map(super::csv::field), ",");
        // Writing to a string does not fail.
        let _ = writeln!(
            text,
            "{},{},{:?},{},{},{},{},{},{},{},{},{},{},{},{},{}",
            words,
            cell(point.error),
            point.seconds,
            point.repeats,
            point.factorizations,
            point.majors,
            point.minors,
            point.increments,
            point.unknowns,
            point.unsettled,
            point.front,
            cell(point.force_error),
            cell(point.spread.map(|(fastest, _)| fastest)),
            cell(point.spread.map(|(_, slowest)| slowest)),
            cell(chart.uncertainty[0]),
            cell(chart.uncertainty[1])
        );
    }
    text
}
