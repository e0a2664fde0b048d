//! Many random mesh scenes, judged from outside.
//!
//! ```text
//! cargo bench --bench random_scenes -- 10000 --seed 1              scenes 0 to 9,999 of seed 1, and their tables
//! cargo bench --bench random_scenes -- 10000 --list FILE           writes a line for every scene as well
//! cargo bench --bench random_scenes -- --seed 1 --only 157         one scene, with all that is wrong in it
//! cargo bench --bench random_scenes -- 1000 --set surfaces.*.smooth=true   each scene changed in some way
//! cargo bench --bench random_scenes -- 200 --pages                 the diagnosis pages of those that fail, checked
//! cargo bench --bench random_scenes -- 200 --needs                 the recoveries and strategies that each scene uses and needs
//! cargo bench --bench random_scenes -- --write 157 FILE.ron        writes one scene to a file, to be run or debugged
//! cargo bench --bench random_scenes -- --file FILE.ron --set refine=2    the same for any scene, changed in some way
//! ```
//!
//! What is printed is the same whatever the number of cores, but for the time.

#[path = "../outside/mod.rs"]
mod outside;

use outside::tally;
use outside::trial::{attempt, forgives};
use rayon::prelude::*;
use std::collections::BTreeMap;
use std::process::ExitCode;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;
use stickslip::scene::Scene;

/// Scenes where nobody says how many.
const SCENES: u64 = 1000;

/// What the command line asks for.
#[derive(Default)]
struct Asked {
    count: Option<u64>,
    seed: u64,
    from: u64,
    list: Option<String>,
    only: Option<u64>,
    write: Option<(u64, String)>,
    files: Vec<String>,
    set: Vec<(String, String)>,
    pages: bool,
    needs: bool,
}

fn asked() -> Option<Asked> {
    let mut asked = Asked {
        seed: 1,
        ..Asked::default()
    };
    let mut args = std::env::args().skip(1);
    while let Some(arg) = args.next() {
        match arg.as_str() {
            // What cargo says to every bench.
            "--bench" => {}
            "--pages" => asked.pages = true,
            "--needs" => asked.needs = true,
            "--seed" => asked.seed = args.next()?.parse().ok()?,
            "--from" => asked.from = args.next()?.parse().ok()?,
            "--only" => asked.only = Some(args.next()?.parse().ok()?),
            "--list" => asked.list = Some(args.next()?),
            "--write" => asked.write = Some((args.next()?.parse().ok()?, args.next()?)),
            "--file" => asked.files.push(args.next()?),
            "--set" => {
                let set = args.next()?;
                let (path, value) = set.split_once('=')?;
                asked.set.push((path.to_owned(), value.to_owned()));
            }
            count => asked.count = Some(count.parse().ok()?),
        }
    }
    Some(asked)
}

fn main() -> ExitCode {
    let Some(asked) = asked() else {
        eprintln!(
            "usage: [COUNT] [--seed N] [--from NUMBER] [--list FILE] [--only NUMBER] [--write NUMBER FILE] [--file SCENE] [--set PATH=VALUE]"
        );
        return ExitCode::from(2);
    };
    if let Some((number, file)) = &asked.write {
        if let Err(error) = std::fs::write(file, outside::families::draw(asked.seed, *number).text)
        {
            eprintln!("{file}: {error}");
            return ExitCode::from(2);
        }
        return ExitCode::SUCCESS;
    }
    for file in &asked.files {
        match Scene::open(file, &asked.set) {
            Ok(scene) => show(file, &scene),
            Err(error) => {
                eprintln!("{error}");
                return ExitCode::from(2);
            }
        }
    }
    if let Some(number) = asked.only {
        let (drawn, scene) = match tally::scene(asked.seed, number, &asked.set) {
            Ok((drawn, scene)) => (drawn, scene),
            Err((drawn, refused)) => {
                println!("{}\n{refused}", drawn.text);
                return ExitCode::from(2);
            }
        };
        println!("{}", drawn.text);
        show(&format!("scene {number}"), &scene);
        return ExitCode::SUCCESS;
    }
    if asked.pages {
        return pages(&asked);
    }
    if asked.needs {
        needs(&asked);
        return ExitCode::SUCCESS;
    }
    if asked.files.is_empty() {
        return many(&asked);
    }
    ExitCode::SUCCESS
}

/// Prints everything that is wrong in a scene.
fn show(name: &str, scene: &Scene) {
    let trial = attempt(scene);
    println!(
        "{name}: {:?}, {} increments, {} on a vertex, {} unexplained{}",
        trial.end,
        trial.increments,
        trial.vertices,
        trial.unexplained,
        if forgives(scene) { ", forgiven" } else { "" }
    );
    for wrong in &trial.wrong {
        let node = wrong.breach.slave.map(|slave| {
            let node = scene.model.contacts[slave].node;
            scene.model.nodes[node].name.as_str()
        });
        println!(
            "  increment {} to {:?}: {} by {:.3e} at {}",
            wrong.increment,
            wrong.load_factor,
            wrong.breach.law.name(),
            wrong.breach.amount,
            node.unwrap_or("all")
        );
    }
}

/// Checks the diagnosis pages of the scenes that fail.
fn pages(asked: &Asked) -> ExitCode {
    let (mut failed, mut faulty, mut ended, mut solved) = (0, 0, 0, 0);
    for number in asked.from..asked.from + asked.count.unwrap_or(SCENES) {
        let Ok((_, scene)) = tally::scene(asked.seed, number, &asked.set) else {
            continue;
        };
        let Some(page) = outside::page::check(&scene) else {
            continue;
        };
        failed += 1;
        faulty += usize::from(!page.faults.is_empty());
        ended += usize::from(page.ends);
        solved += usize::from(!page.ends && page.works.is_some());
        println!("{number}: {}", page.cause);
        if let Some(works) = &page.works {
            println!("  try: {works}");
        }
        page.faults.iter().for_each(|fault| println!("  {fault}"));
    }
    println!(
        "{failed} scenes fail; the pages of {ended} show a limit load or that no modes are consistent, those of {solved} others what was tried and passes, and {faulty} pages have faults"
    );
    ExitCode::from(u8::from(faulty > 0))
}

/// Prints what each scene that finishes uses and needs, and how many scenes use and need each recovery and strategy.
fn needs(asked: &Asked) {
    let numbers = asked.from..asked.from + asked.count.unwrap_or(SCENES);
    let one = |number: u64| {
        let (_, scene) = tally::scene(asked.seed, number, &asked.set).ok()?;
        let (ends, used) = outside::needs::run(&scene, None);
        ends.then(|| (number, outside::needs::needs(&scene, &used), used))
    };
    let numbers: Vec<u64> = numbers.collect();
    let found: Vec<_> = numbers
        .into_par_iter()
        .with_max_len(1)
        .filter_map(one)
        .collect();
    let mut counts: BTreeMap<&str, [usize; 2]> = BTreeMap::new();
    for (number, needed, used) in &found {
        if !used.is_empty() {
            println!("{number}: uses {used:?}, needs {needed:?}");
        }
        used.iter()
            .for_each(|name| counts.entry(name).or_default()[0] += 1);
        needed
            .iter()
            .for_each(|name| counts.entry(name).or_default()[1] += 1);
    }
    println!(
        "{} scenes finish\n{:<14} {:>6} {:>6}",
        found.len(),
        "",
        "use it",
        "need it"
    );
    for (name, [used, needed]) in counts {
        println!("{name:<14} {used:>6} {needed:>7}");
    }
}

fn many(asked: &Asked) -> ExitCode {
    let count = asked.count.unwrap_or(SCENES);
    let done = AtomicUsize::new(0);
    let start = Instant::now();
    let rows = tally::run(
        asked.seed,
        asked.from..asked.from + count,
        &asked.set,
        |_| {
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            if done.is_multiple_of(500) {
                eprintln!("{done} scenes, {:.0} s", start.elapsed().as_secs_f64());
            }
        },
    );
    println!(
        "{count} scenes from {} on of seed {}\n",
        asked.from, asked.seed
    );
    print!("{}", tally::tables(&rows));
    let wrong = rows.iter().filter(|row| row.is_wrong());
    println!("\nscenes with wrong increments");
    for row in wrong.clone() {
        println!("{}", row.line());
    }
    eprintln!("{:.0} s", start.elapsed().as_secs_f64());
    if let Some(file) = &asked.list {
        let lines: String = rows.iter().map(|row| row.line() + "\n").collect();
        if let Err(error) = std::fs::write(file, lines) {
            eprintln!("{file}: {error}");
            return ExitCode::from(2);
        }
    }
    ExitCode::from(u8::from(wrong.count() > 0))
}
