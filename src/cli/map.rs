//! `stickslip map`: where the iterations converge.

use super::base::{Error, Exit, SetArgs, put, tolerance, usage, whole};
use super::interrupt::Interrupt;
use super::sweep::{Report, SweepArgs};
use std::ops::RangeInclusive;
use std::path::PathBuf;
use std::sync::Arc;
use stickslip_core::strategy::method;
use stickslip_core::{BoundUpdate, Strategy};
use stickslip_scene::{aligned, builtin, joined};
use stickslip_study::map::{self, Map, MapCell};
use stickslip_study::plan::{MOST_CASES, product};
use stickslip_study::random::{NODES, Population};
use stickslip_study::survey::{self, Survey};
use stickslip_study::trial::{JudgedProblem, TOLERANCE, Variant};
use stickslip_study::{Plan, Study, Vary, verdict_figure};

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Values of --over may be a range, 0.01..0.1/4 (evenly spaced) or 0.01..0.1/4log (even ratios), or a multiple \
of the scene's value, 2x. Without --over and --strategies, scenes are run with all strategies.

Cells that fail are results. The exit code is 0 if the map is complete, 2 for bad input or usage, 4 if cells are \
missing to --merge, 75 if a log is busy or cannot be written, and 130 if interrupted; files then contain \
the finished cells.")]
pub struct Args {
    /// Scene files, or names of built-in scenes; all: every built-in scene
    #[arg(value_name = "SCENE", required_unless_present_any = ["random", "write"], conflicts_with_all = ["random", "write"])]
    scenes: Vec<String>,
    /// Runs this many random interface problems, whose numbers of solutions are known
    #[arg(long, value_name = "N", value_parser = count)]
    random: Option<usize>,
    /// With --random: one row per kind of problem, strategy and verdict, instead of one per problem
    #[arg(long, requires = "random")]
    totals: bool,
    /// Seed of the random problems
    #[arg(long, value_name = "SEED", default_value_t = 1, value_parser = whole::<u64>)]
    seed: u64,
    /// Node counts of the random problems: K, or A..B [default: 1..4]
    #[arg(long, value_name = "A..B", value_parser = range)]
    nodes: Option<RangeInclusive<usize>>,
    /// Writes random problem number K as a scene file, and runs nothing
    #[arg(long, value_name = "K", value_parser = whole::<usize>)]
    write: Option<usize>,
    /// Output file of --write; - is standard output [default: -]
    #[arg(long, short, value_name = "FILE", requires = "write")]
    output: Option<PathBuf>,
    /// Runs with each of the values; may be repeated for the product of all
    #[arg(long, value_name = "PATH=A,B,C", value_parser = Vary::parse)]
    over: Vec<Vary>,
    /// Runs with each of the strategies; all: every strategy
    #[arg(long, value_name = "A,B,C", value_delimiter = ',')]
    strategies: Vec<String>,
    #[command(flatten)]
    set: SetArgs,
    /// A final state that differs from the reference by more than this fraction of the largest value is on a wrong branch
    #[arg(long, value_name = "PART", default_value_t = map::TOLERANCE, value_parser = tolerance)]
    tolerance: f64,
    #[command(flatten)]
    sweep: SweepArgs,
}

fn range(text: &str) -> Result<RangeInclusive<usize>, String> {
    let number = |text: &str| text.trim().parse::<usize>().ok();
    let ends = match text.split_once("..") {
        Some((low, high)) => number(low).zip(number(high.trim_start_matches('='))),
        None => number(text).map(|k| (k, k)),
    };
    // A census of more nodes takes long: 4 states per node.
    const MOST: usize = 6;
    match ends {
        Some((low, high)) if (1..=high).contains(&low) && high <= MOST => Ok(low..=high),
        _ => Err(format!("expected K or A..B, within 1 to {MOST}")),
    }
}

fn count(text: &str) -> Result<usize, String> {
    let count = text
        .parse::<u64>()
        .ok()
        .filter(|n| (1..=MOST_CASES).contains(n));
    count.map(|n| n as usize).ok_or_else(|| {
        format!("expected a whole number from 1 to {MOST_CASES}; for more, run several seeds")
    })
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    if !args.scenes.is_empty() {
        return scenes(args);
    }
    let population = Population {
        seed: args.seed,
        count: args.random.unwrap_or(0),
        nodes: args.nodes.clone().unwrap_or(NODES),
    };
    if let Some(k) = args.write {
        return write(args, &population, k);
    }
    let variants = variants(args)?;
    let interrupt = Interrupt::listen();
    let sweep = survey::sweep(&population, &variants);
    args.sweep.run(&sweep, &interrupt, |judged| {
        let survey = Survey {
            population: population.clone(),
            variants: variants.clone(),
            judged,
        };
        Ok(Report {
            table: if args.totals {
                survey.totals()
            } else {
                survey.csv()
            },
            lines: survey_lines(&survey),
            warnings: Vec::new(),
            picture: Box::new(move || verdict_figure::bars(&survey)),
        })
    })
}

/// Writes one random problem.
fn write(args: &Args, population: &Population, k: usize) -> Result<Exit, Error> {
    let (low, high) = population.nodes.clone().into_inner();
    let head = [format!(
        "stickslip map --random {} --seed {} --nodes {low}..{high} --write {k}",
        population.count.max(k + 1),
        population.seed
    )];
    let text = population.draw(k).problem.text(&head);
    put(args.output.as_deref(), &text, args.sweep.out.force)
}

/// Runs scenes with many settings.
fn scenes(args: &Args) -> Result<Exit, Error> {
    let study = study(args)?;
    let interrupt = Interrupt::listen();
    let plan = Arc::new(Plan::new(study)?);
    args.sweep.run(&map::sweep(&plan), &interrupt, |ended| {
        let map = Map::judged(plan.clone(), args.tolerance, ended);
        Ok(Report {
            table: map.csv(),
            lines: map_lines(&map),
            warnings: Vec::new(),
            picture: Box::new(move || verdict_figure::grid(&map)),
        })
    })
}

/// The study to run.
fn study(args: &Args) -> Result<Study, Error> {
    let every = || builtin::list().iter().map(|scene| scene.name.to_owned());
    let mut scenes: Vec<String> = Vec::new();
    for name in &args.scenes {
        match name.as_str() {
            "all" => scenes.extend(every()),
            name => scenes.push(name.to_owned()),
        }
    }
    let mut vary = strategies(args)?;
    for over in &args.over {
        if vary.iter().any(|other| other.path == over.path) {
            let path = &over.path;
            return Err(usage!("--over {path}: given twice"));
        }
        vary.push(over.clone());
    }
    Ok(Study {
        name: scenes.join(", "),
        scenes,
        vary,
        set: args.set.set.clone(),
        ..Study::default()
    })
}

/// The requested strategies; all of them if nothing is varied.
fn strategies(args: &Args) -> Result<Vec<Vary>, Error> {
    let values = match args.strategies.as_slice() {
        [] if !args.over.is_empty() => return Ok(Vec::new()),
        [] => Strategy::NAMES.map(str::to_owned).to_vec(),
        [all] if all == "all" => Strategy::NAMES.map(str::to_owned).to_vec(),
        some => some.to_vec(),
    };
    Ok(vec![Vary {
        path: "settings.strategy".to_owned(),
        values,
    }])
}

/// The map as grids of glyphs.
fn map_lines(map: &Map) -> Vec<String> {
    let mut lines = vec![map.title.clone()];
    for panel in map.panels() {
        if !panel.name.is_empty() {
            lines.push(format!("\n{}", panel.name));
        }
        let mut table = vec![vec![format!("{} \\ {}", panel.y, panel.x)]];
        table[0].extend(panel.columns.iter().cloned());
        for (name, cells) in panel.rows.iter().zip(&panel.cells) {
            let mut row = vec![name.clone()];
            row.extend(cells.iter().map(|k| {
                map.cells[*k]
                    .as_ref()
                    .map_or("?".to_owned(), MapCell::label)
            }));
            // Scenes with individual settings may have fewer columns.
            row.resize(panel.columns.len() + 1, String::new());
            table.push(row);
        }
        lines.extend(aligned(&table, panel.columns.len() + 1));
    }
    lines.push(
        "\n✓C converged   ≠W wrong branch   ↺ cycle and its period   ↗D diverged   ∅N reported unsolvable"
            .to_owned(),
    );
    lines.extend(map.signs());
    if map.cells.iter().any(Option::is_none) {
        lines.push("? not run".to_owned());
    }
    lines.extend(map.origin());
    lines
}

/// The settings for random problems: each combination of the varied values, named by them; if nothing is varied, all strategies,
/// with lagged and consistent T_max if they support both.
fn variants(args: &Args) -> Result<Vec<Variant>, Error> {
    let mut vary = match (args.strategies.is_empty(), args.over.is_empty()) {
        (true, true) => return Ok(every_variant(&args.set.set)),
        _ => strategies(args)?,
    };
    vary.extend(args.over.iter().cloned());
    Ok(product(&vary)
        .into_iter()
        .map(|varied| {
            let values = joined(varied.iter().map(|(_, value)| value), " ");
            Variant {
                name: values,
                settings: [args.set.set.clone(), varied].concat(),
            }
        })
        .collect())
}

/// All strategies on random problems.
fn every_variant(set: &[(String, String)]) -> Vec<Variant> {
    let variant = |strategy: Strategy, t_max: &str, touch: &str| {
        let own = [
            ("settings.strategy", strategy.name()),
            ("settings.t_max", t_max),
            ("settings.touch", touch),
        ];
        let own = own.map(|(path, value)| (path.to_owned(), value.to_owned()));
        let mut name = strategy.name().to_owned();
        if lags(strategy) {
            name += &format!(" {t_max}");
        }
        if touch == "ratio" {
            name += " as printed";
        }
        Variant {
            name,
            settings: [own.to_vec(), set.to_vec()].concat(),
        }
    };
    let mut all = vec![variant(Strategy::Table2, "lagged", "ratio")];
    for strategy in Strategy::ALL.into_iter().filter(|&s| lags(s)) {
        all.extend(["lagged", "consistent"].map(|t_max| variant(strategy, t_max, "start")));
    }
    let others = Strategy::ALL
        .into_iter()
        .filter(|&s| !lags(s) && s != Strategy::Ladder)
        .chain([Strategy::Ladder]);
    all.extend(others.map(|strategy| variant(strategy, "lagged", "start")));
    all
}

/// Whether a strategy supports both lagged and consistent T_max.
fn lags(strategy: Strategy) -> bool {
    strategy != Strategy::Ladder
        && method(strategy).bound(BoundUpdate::Lagged) == BoundUpdate::Lagged
}

fn survey_lines(survey: &Survey) -> Vec<String> {
    let all: Vec<&JudgedProblem> = survey.done().map(|(_, judged)| judged).collect();
    let count =
        |is: &dyn Fn(&JudgedProblem) -> bool| all.iter().filter(|judged| is(judged)).count();
    let mut lines = survey.origin();
    let unseen = count(&|j| j.answers == 0 && j.solvable());
    let besides = match unseen {
        0 => String::new(),
        n => format!(
            " (for {n} of these a strategy found one of a continuum, which a census cannot find)"
        ),
    };
    lines.push(format!(
        "solutions by census: one in {}, several in {}, none in {}{besides}",
        count(&|j| j.answers == 1),
        count(&|j| j.answers > 1),
        count(&|j| j.answers == 0),
    ));
    let heads = [
        "solved", "wrong", "cycle", "failed", "none?", "| none!", "wrong", "other",
    ];
    let mut table = vec![
        ["strategy"]
            .iter()
            .chain(&heads)
            .map(|word| word.to_string())
            .collect(),
    ];
    for (v, variant) in survey.variants.iter().enumerate() {
        let tally = survey.tally(v, |_| true);
        let mut row = vec![variant.name.clone()];
        for count in [
            tally.solved,
            tally.wrong,
            tally.cycled,
            tally.failed,
            tally.denied,
        ] {
            row.push(format!("{:.1}", tally.per_thousand(count)));
        }
        row.push(format!("| {}", tally.admitted));
        row.push(tally.invented.to_string());
        row.push((tally.unsolvable - tally.admitted - tally.invented).to_string());
        table.push(row);
    }
    lines.extend(aligned(&table, 1));
    let tally = survey.tally(0, |_| true);
    lines.push(format!(
        "left: per 1,000 of the {} problems with a solution (none?: reported unsolvable; wrong: final state violates Coulomb's \
         law by more than {TOLERANCE:e}); right of the bar: counts of the {} problems without one",
        tally.solvable, tally.unsolvable
    ));
    lines
}
