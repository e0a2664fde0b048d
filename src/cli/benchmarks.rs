//! `stickslip study benchmarks`: scenes with published reference values ([`stickslip_study::benchmarks`]).

use super::base::{Error, Exit, notify};
use super::interrupt::Interrupt;
use super::outputs::{OutputArgs, Outputs};
use stickslip_scene::{aligned, sig2, sig6};
use stickslip_study::Watch;
use stickslip_study::benchmarks::{Assessment, Benchmark, Benchmarks, ComparedBenchmark, table};

/// Runs a list of benchmarks, and reports the deviation of each value.
pub fn main(list: &Benchmarks, out: &OutputArgs) -> Result<Exit, Error> {
    if out.draws() {
        let name = &list.name;
        let text = format!("{name}: benchmarks have no figure; use --csv for the table");
        return Err(Error::Usage(text));
    }
    let interrupt = Interrupt::listen();
    let outputs = Outputs::open(out)?;
    let watch = Watch {
        stop: &|| interrupt.has_arrived(),
        done: &|_| {},
    };
    let compared = list.run(out.jobs(), &watch).map_err(Error::usage)?;
    outputs.write_table(&table(list, &compared))?;
    if !out.quiet {
        report_table(list, &compared);
    }
    let all = compared.len();
    let count = |is: fn(&Assessment) -> bool| compared.iter().filter(|c| is(&c.standing)).count();
    let good = count(|standing| *standing == Assessment::Good);
    notify(&format!("{}: {good} of {all} pass", list.name));
    Ok(match count(|standing| *standing == Assessment::NotRun) {
        0 if good == all => Exit::Good,
        0 => Exit::Differ,
        _ => Exit::Interrupted,
    })
}

fn report_table(list: &Benchmarks, compared: &[ComparedBenchmark]) {
    notify(&list.title);
    if !list.about.is_empty() {
        notify(&list.about);
    }
    let header = [
        "benchmark",
        "what",
        "source's",
        "ours",
        "error",
        "allowed",
        "drift",
        "standing",
    ];
    let mut rows = vec![header.map(str::to_owned).to_vec()];
    let pairs = list.list.iter().zip(compared);
    rows.extend(pairs.map(|(benchmark, compared)| row(benchmark, compared)));
    for line in aligned(&rows, 2) {
        notify(&line);
    }
}

fn row(benchmark: &Benchmark, compared: &ComparedBenchmark) -> Vec<String> {
    let some = |value: Option<f64>, show: fn(f64) -> String| value.map(show).unwrap_or_default();
    vec![
        benchmark.case(),
        benchmark.what.clone(),
        sig6(benchmark.value),
        some(compared.ours, sig6),
        some(compared.error, sig2),
        sig2(benchmark.within),
        some(compared.drift, sig2),
        compared.standing.to_string(),
    ]
}
