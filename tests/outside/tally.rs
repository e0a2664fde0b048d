//! What came out of many random scenes, as tables.

use super::families::{Drawn, FAMILIES, draw};
use super::judge::Law;
use super::trial::{End, Trial, attempt, forgives};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::fmt::Write;
use std::ops::Range;
use stickslip::scene::Scene;

/// A scene's number, and what came of it.
#[derive(Debug, Clone, PartialEq)]
pub struct Row {
    pub number: u64,
    pub family: &'static str,
    /// Its settings allow states that are not Coulomb's.
    pub forgiven: bool,
    /// It has default settings.
    pub plain: bool,
    pub trial: Trial,
}

impl Row {
    /// Whether it accepted what it must not.
    pub fn is_wrong(&self) -> bool {
        !self.forgiven && !self.trial.wrong.is_empty()
    }

    /// Whether it came to its end, and not only through what it must not accept.
    pub fn is_finished(&self) -> bool {
        self.trial.end == End::Finished && !self.is_wrong()
    }

    /// What became of it, in a word.
    fn end(&self) -> String {
        match &self.trial.end {
            End::Finished if self.is_wrong() => "wrong".into(),
            End::Finished => "finished".into(),
            End::Failed { kind, at_vertex } => {
                let vertex = if *at_vertex { ",vertex" } else { "" };
                format!("failed[{}{vertex}]", kind.replace(", ", "+"))
            }
            End::Endless => "endless".into(),
            End::Panicked => "panicked".into(),
            End::Refused => "refused".into(),
        }
    }

    /// A line: number, family, end, accepted increments, wrong ones, and by which law, at which slave node, when and how much
    /// the first was and the worst is.
    pub fn line(&self) -> String {
        let trial = &self.trial;
        let mut line = format!(
            "{} {} {} increments={} wrong={} vertices={} unexplained={}",
            self.number,
            self.family,
            self.end(),
            trial.increments,
            trial.wrong_increments(),
            trial.vertices,
            trial.unexplained,
        );
        for fallback in &trial.fallbacks {
            let _ = write!(line, " by-{fallback:?}");
        }
        if self.forgiven {
            line += " forgiven";
        }
        let worst = trial
            .wrong
            .iter()
            .max_by(|a, b| a.breach.amount.total_cmp(&b.breach.amount));
        for (what, wrong) in [("first", trial.wrong.first()), ("worst", worst)] {
            if let Some(wrong) = wrong {
                let slave = wrong
                    .breach
                    .slave
                    .map_or("all".to_owned(), |s| s.to_string());
                let _ = write!(
                    line,
                    " {what}={}@{} slave {slave} at {:?} by {:.1e}",
                    wrong.breach.law.name(),
                    wrong.increment,
                    wrong.load_factor,
                    wrong.breach.amount
                );
            }
        }
        line
    }
}

/// A path of a scene and its value there. `surfaces.*.` stands for every surface.
pub type Set = (String, String);

/// A drawn scene, changed and checked; or why it is refused.
pub fn scene(seed: u64, number: u64, set: &[Set]) -> Result<(Drawn, Scene), (Drawn, String)> {
    let drawn = draw(seed, number);
    let made = Scene::from_text("random.ron", &drawn.text, &[]);
    let changed = made.and_then(|scene| {
        let ids: Vec<_> = scene.spec.surfaces.iter().map(|s| s.id.clone()).collect();
        let each = set.iter().flat_map(|(path, value)| {
            let of = |id: &String| {
                (
                    path.replace("surfaces.*.", &format!("surfaces.{id}.")),
                    value,
                )
            };
            let count = if path.contains(".*.") { ids.len() } else { 1 };
            ids[..count].iter().map(of).collect::<Vec<_>>()
        });
        each.into_iter()
            .try_fold(scene, |scene, (path, value)| scene.with(&path, value))
    });
    match changed {
        Ok(scene) => Ok((drawn, scene)),
        Err(refused) => Err((drawn, refused.to_string())),
    }
}

/// Runs scenes on all cores; the rows are in order.
pub fn run(seed: u64, numbers: Range<u64>, set: &[Set], done: impl Fn(&Row) + Sync) -> Vec<Row> {
    let one = |number: u64| {
        let (drawn, forgiven, trial) = match scene(seed, number, set) {
            Ok((drawn, scene)) => (drawn, forgives(&scene), attempt(&scene)),
            Err((drawn, _)) => (drawn, false, Trial::before(End::Refused)),
        };
        let row = Row {
            number,
            family: drawn.family,
            forgiven,
            plain: drawn.text.contains("settings: ()"),
            trial,
        };
        done(&row);
        row
    };
    let numbers: Vec<u64> = numbers.collect();
    // Scenes take very different times: each is shared out alone.
    numbers.into_par_iter().with_max_len(1).map(one).collect()
}

/// The tables: by family, by law, and what runs failed of.
pub fn tables(rows: &[Row]) -> String {
    let mut text = String::new();
    let _ = writeln!(
        text,
        "{:<12} {:>6} {:>9} {:>6} {:>9} {:>7} {:>6} {:>8} {:>9} {:>7} {:>7} {:>9} {:>11}",
        "family",
        "scenes",
        "finished",
        "%",
        "increm.",
        "wrong",
        "%",
        "in scn.",
        "in done %",
        "failed",
        "vertex",
        "on vertex",
        "unexplained"
    );
    let names = FAMILIES.iter().map(|f| f.0);
    for family in names {
        let of: Vec<&Row> = rows.iter().filter(|r| r.family == family).collect();
        let _ = writeln!(text, "{}", family_line(family, &of));
    }
    let plain: Vec<&Row> = rows.iter().filter(|r| r.plain).collect();
    let _ = writeln!(text, "{}", family_line("(defaults)", &plain));
    let all: Vec<&Row> = rows.iter().collect();
    let _ = writeln!(text, "{}", family_line("all", &all));
    let _ = writeln!(
        text,
        "\nbroken laws (increments / scenes), and the largest amounts"
    );
    for forgiven in [false, true] {
        if forgiven {
            let _ = writeln!(text, "where settings allow it:");
        }
        for law in Law::ALL {
            text += &law_line(law, rows.iter().filter(|r| r.forgiven == forgiven));
        }
    }
    let _ = writeln!(text, "\nruns that did not finish");
    let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
    for row in rows.iter().filter(|r| !r.is_finished()) {
        *kinds.entry(row.end()).or_default() += 1;
    }
    let mut kinds: Vec<_> = kinds.into_iter().collect();
    kinds.sort_by_key(|k| std::cmp::Reverse(k.1));
    for (kind, count) in kinds {
        let _ = writeln!(text, "{count:>6}  {kind}");
    }
    text
}

fn family_line(name: &str, rows: &[&Row]) -> String {
    let count = |is: &dyn Fn(&Row) -> bool| rows.iter().filter(|r| is(r)).count();
    let sum = |of: &dyn Fn(&Row) -> usize| rows.iter().map(|r| of(r)).sum::<usize>();
    let share = |part: usize, of: usize| 100.0 * part as f64 / of.max(1) as f64;
    let ended = count(&|r| r.trial.end == End::Finished);
    let finished = count(&Row::is_finished);
    let vertex = count(&|r| matches!(&r.trial.end, End::Failed { at_vertex, .. } if *at_vertex));
    let increments = sum(&|r| r.trial.increments);
    let wrong = sum(&|r| {
        if r.is_wrong() {
            r.trial.wrong_increments()
        } else {
            0
        }
    });
    format!(
        "{name:<12} {:>6} {finished:>9} {:>6.1} {increments:>9} {wrong:>7} {:>6.2} {:>8} {:>9.2} {:>7} {vertex:>7} {:>9} {:>11}",
        rows.len(),
        share(finished, rows.len()),
        share(wrong, increments),
        count(&|r| r.is_wrong()),
        share(ended - finished, ended),
        rows.len() - ended - vertex,
        sum(&|r| r.trial.vertices),
        sum(&|r| r.trial.unexplained),
    )
}

fn law_line<'a>(law: Law, rows: impl Iterator<Item = &'a Row>) -> String {
    let (mut increments, mut scenes, mut amounts) = (0, 0, Vec::new());
    for row in rows {
        let of = row.trial.wrong.iter().filter(|w| w.breach.law == law);
        let mut numbers: Vec<usize> = of.clone().map(|w| w.increment).collect();
        numbers.dedup();
        increments += numbers.len();
        scenes += usize::from(!numbers.is_empty());
        amounts.extend(of.map(|w| w.breach.amount));
    }
    amounts.sort_by(f64::total_cmp);
    let at = |part: f64| amounts[((amounts.len() - 1) as f64 * part) as usize];
    let sizes = if amounts.is_empty() {
        String::new()
    } else {
        format!(
            "  least {:.0e}, median {:.0e}, most {:.0e}",
            at(0.0),
            at(0.5),
            at(1.0)
        )
    };
    format!("  {:<8} {increments:>6} / {scenes:<6}{sizes}\n", law.name())
}
