//! `stickslip map` with so many cells that only sums are kept: [`crate::study::sums`].

use super::base::{Error, Exit, tell};
use super::interrupt::Interrupt;
use super::outputs::{OutputArgs, Outputs};
use super::parts::{PartArgs, failed};
use super::sink::Sink;
use crate::outside::shown::aligned;
use crate::study::large_map::{LargeMap, way};
use crate::study::merge::Keeping;
use crate::study::random::Population;
use crate::study::run::Spare;
use crate::study::sums::{BLOCK, Large, Sums, total};
use crate::study::survey::{self, HEADS, Tally};
use crate::study::trial::{Variant, prepared};
use crate::study::{Study, Watch, verdict_figure};
use std::num::NonZeroU64;

/// What is wanted of sums.
pub struct Wanted<'a> {
    /// Cells of a block.
    pub block: Option<NonZeroU64>,
    /// Where what failed is written to.
    pub failing: Option<&'a str>,
    /// Where sums are kept.
    pub keeping: Keeping,
    /// Which part is done.
    pub part: &'a PartArgs,
    /// Where tables and pictures go.
    pub out: &'a OutputArgs,
}

/// What a picture has of sums: names of its bars, and what they are made of.
type Rows<'a> = dyn Fn(&Sums) -> (Vec<Variant>, Vec<Tally>) + 'a;

/// Sums, and what is said of them.
struct Told<'a> {
    heads: Vec<&'a str>,
    about: Vec<String>,
    title: &'a str,
    rows: &'a Rows<'a>,
}

/// Random problems.
pub fn random_problems(
    wanted: &Wanted<'_>,
    population: &Population,
    variants: &[Variant],
) -> Result<Exit, Error> {
    let interrupt = Interrupt::listen();
    let ways = prepared(variants);
    let stop = || interrupt.came();
    let large = Large {
        what: "map --random, as sums",
        input: survey::input(population, variants),
        cells: population.count as u64,
        together: NonZeroU64::MIN,
        block: wanted.block.unwrap_or(BLOCK),
        run: &|cell, sums| survey::count(population, &ways, cell, sums, &stop),
    };
    let told = Told {
        heads: HEADS.to_vec(),
        about: survey::about(population),
        title: "Random interface problems by strategy",
        rows: &|sums| (variants.to_vec(), survey::tallies(variants, sums)),
    };
    run(wanted, &large, &interrupt, &told)
}

/// Scenes over settings.
pub fn scenes(wanted: &Wanted<'_>, study: Study, tolerance: f64) -> Result<Exit, Error> {
    let interrupt = Interrupt::listen();
    let map = LargeMap::new(study, tolerance)?;
    let spare = Spare::default();
    let watch = Watch {
        stop: &|| interrupt.came(),
        done: &|_| {},
    };
    let large = Large {
        what: "map, as sums",
        input: map.input(),
        cells: map.cells(),
        together: map.together(),
        block: wanted.block.unwrap_or(BLOCK),
        run: &|first, sums| map.count(first, sums, &spare, &watch),
    };
    let told = Told {
        heads: map.heads(),
        about: map.about(),
        title: "Runs by their settings",
        rows: &|sums| {
            let variants = LargeMap::variants(sums);
            let mut tallies = vec![Tally::default(); variants.len()];
            for (labels, count) in sums.counts() {
                let (name, verdict) = (way(labels), labels.last());
                let own = variants.iter().position(|variant| variant.name == name);
                if let (Some(own), Some(verdict)) = (own, verdict) {
                    tallies[own].add(true, verdict, count.runs as usize);
                }
            }
            (variants, tallies)
        },
    };
    run(wanted, &large, &interrupt, &told)
}

/// Runs or puts together, and writes.
fn run(
    wanted: &Wanted<'_>,
    large: &Large<'_>,
    interrupt: &Interrupt,
    told: &Told<'_>,
) -> Result<Exit, Error> {
    let outputs = Outputs::open(wanted.out)?;
    let failing = wanted.failing;
    let failing = failing
        .map(|to| Sink::open(to, wanted.out.force))
        .transpose()?;
    let kept = large.open(&wanted.keeping).map_err(|e| failed(e.into()))?;
    if let Some(incomplete) = wanted.part.whole(&kept) {
        return Ok(incomplete);
    }
    let progress = wanted.out.progress(large.cells, "cells");
    let watch = Watch {
        stop: &|| interrupt.came(),
        done: &|cells| progress.inc(cells),
    };
    let blocks = large.run_kept(&kept, wanted.out.jobs(), &watch);
    progress.finish_and_clear();
    let blocks = blocks.map_err(failed)?;
    let left = blocks.iter().filter(|block| block.is_none()).count();
    if wanted.part.is_part() || (wanted.part.any() && left > 0) {
        let done = |b: usize| blocks[b].is_some();
        return Ok(wanted.part.end(&kept, done, wanted.out.quiet));
    }
    let sums = total(&blocks);
    let (variants, tallies) = (told.rows)(&sums);
    let bars = || verdict_figure::bars_of(told.title, &variants, &tallies, &told.about);
    let table = sums.table(&told.heads, &told.about);
    outputs.write(&table, || bars()?.svg(), || bars()?.png())?;
    if let Some(mut sink) = failing {
        sink.send(&sums.failing_table(&told.heads, &told.about))?;
        sink.finish()?;
    }
    if !wanted.out.quiet {
        tell_sums(told, &sums);
    }
    if left > 0 {
        let all = blocks.len();
        tell(&format!(
            "interrupted; {} of {all} blocks were done",
            all - left
        ));
        return Ok(Exit::Interrupted);
    }
    Ok(Exit::Good)
}

fn tell_sums(told: &Told<'_>, sums: &Sums) {
    told.about.iter().for_each(|line| tell(line));
    let heads = told.heads.iter().copied().chain(["runs"]);
    let mut table = vec![heads.map(str::to_owned).collect::<Vec<_>>()];
    for (labels, count) in sums.counts() {
        let mut row = labels.to_vec();
        row.push(count.runs.to_string());
        table.push(row);
    }
    for line in aligned(&table, told.heads.len()) {
        tell(&line);
    }
    tell(&format!(
        "{} runs failed (--failing writes them with their cells)",
        sums.failing()
    ));
}
