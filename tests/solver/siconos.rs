//! Friction problems of Siconos: read whatever their storage, refused with a line where broken, solved as they say.

use crate::common::{Run, force, go_on, run};
use proptest::prelude::*;
use std::fmt::{Debug, Write};
use stickslip::model::Mode;
use stickslip::scene::Scene;
use stickslip::scene::siconos::read;
use stickslip::step::event::Failure;
use stickslip_exchange::problem::{Local, Matrix};
use stickslip_exchange::siconos::write;

fn path(name: &str) -> String {
    format!("{}/tests/siconos/{name}", env!("CARGO_MANIFEST_DIR"))
}

fn text(name: &str) -> String {
    std::fs::read_to_string(path(name)).unwrap()
}

fn problem(name: &str) -> Local {
    read(&text(name), None).unwrap_or_else(|broken| panic!("{name}: {broken:?}"))
}

#[test]
fn the_three_storages_say_the_same() {
    let dense = problem("two-dense.dat");
    let rows = dense.w.dense();
    assert_eq!(
        rows[0],
        [2.0, 0.5, 0.1, 0.25],
        "columns are stored, not rows"
    );
    assert_eq!(rows[3], [0.2, 0.4, 0.5, 2.0]);
    assert_eq!(dense.q, [-1.0, 0.1, -2.0, 0.5]);
    assert_eq!(dense.mu, [0.5, 0.6]);
    assert_eq!(problem("two-blocks.dat"), dense);
    assert_eq!(problem("two-columns.dat"), dense);
}

/// u and r of each contact in turn, normal first, at the end of a run.
pub fn answer(run: &Run) -> (Vec<f64>, Vec<f64>) {
    let (model, state) = (run.stepper.model(), run.stepper.state());
    let of = |s: &stickslip::model::Contact| {
        let first = model.dofs.first[s.node];
        [state.u[first + 1], -state.u[first]]
    };
    let u = model.contacts.iter().flat_map(of).collect();
    let last = &run.accepted.last().expect("an answer").event;
    (u, last.nodes.iter().flat_map(|n| [n.f_n, n.f_t]).collect())
}

/// u = W r + q, 0 <= u_n ⊥ r_n >= 0, |r_t| <= mu r_n, and at the bound against u_t where it slips.
pub fn assert_solved(problem: &Local, run: &Run) {
    let (u, r) = answer(run);
    for (i, row) in problem.w.dense().iter().enumerate() {
        let sum: f64 = row.iter().zip(&r).map(|(w, r)| w * r).sum();
        assert!((u[i] - sum - problem.q[i]).abs() < 1e-9, "{u:?} {r:?}");
    }
    for (k, mu) in problem.mu.iter().enumerate() {
        let (u, r) = (&u[2 * k..2 * k + 2], &r[2 * k..2 * k + 2]);
        assert!(u[0] > -1e-9 && r[0] > -1e-9 && (u[0] * r[0]).abs() < 1e-9);
        assert!(r[1].abs() <= mu * r[0] + 1e-9, "{r:?}");
        assert!(
            (u[1] * (r[1] + mu * r[0] * u[1].signum())).abs() < 1e-9,
            "{u:?} {r:?}"
        );
    }
}

#[test]
fn two_contacts_are_solved_by_both_solvers() {
    let wanted = problem("two-dense.dat");
    for solver in ["augmented", "condensed"] {
        let set = [("settings.solver".to_owned(), solver.to_owned())];
        let run = run(&Scene::open(&path("two-blocks.dat"), &set).unwrap());
        assert!(run.failure.is_none(), "{solver}: {:?}", run.failure);
        assert_solved(&wanted, &run);
    }
}

/// The reference's smallest case with friction: the only answer slides with r_n = 4/5, and Table 2 cycles.
#[test]
fn the_single_contact_cycles_and_slides_once_it_is_forced_to() {
    let table_2 = [("settings.strategy".to_owned(), "table2".to_owned())];
    let scene = Scene::open(&path("dense.dat"), &table_2).unwrap();
    let mut run = run(&scene);
    let Some((_, Failure::Cycle(cycle))) = &run.failure else {
        panic!("{:?}", run.failure)
    };
    assert_eq!(cycle.members, [(0, vec![Mode::Free, Mode::Fixed])]);
    force(&mut run, 0, Mode::Sliding, false);
    let run = go_on(run);
    assert!(run.failure.is_none(), "{:?}", run.failure);
    let (_, r) = answer(&run);
    assert!(
        (r[0] - 0.8).abs() < 1e-10 && (r[1] + 0.2).abs() < 1e-10,
        "{r:?}"
    );
    assert_solved(&problem("dense.dat"), &run);
}

#[test]
fn a_singular_matrix_is_no_hindrance_where_the_problem_has_one_answer() {
    // Nothing that acts on the contact moves it along: u_t = q_t whatever r is.
    let problem = Local {
        w: Matrix::from_rows(&[vec![1.0, 0.0], vec![0.0, 0.0]]),
        q: vec![-1.0, 0.2],
        mu: vec![0.3],
    };
    let text = write(&problem);
    for solver in ["augmented", "condensed"] {
        let set = [("slaves[0].start", "sliding"), ("settings.solver", solver)];
        let set = set.map(|(path, value)| (path.to_owned(), value.to_owned()));
        let run = run(&Scene::from_text("singular.dat", &text, &set).unwrap());
        assert!(run.failure.is_none(), "{solver}: {:?}", run.failure);
        let (_, r) = answer(&run);
        assert!(
            (r[0] - 1.0).abs() < 1e-10 && (r[1] + 0.3).abs() < 1e-10,
            "{r:?}"
        );
        assert_solved(&problem, &run);
    }
}

/// Each with the line and a part of the message.
#[test]
fn a_broken_file_is_refused_with_its_line() {
    let dense = text("two-dense.dat");
    let blocks = text("two-blocks.dat");
    let cases = [
        (
            dense.replacen("2\n2\n", "7\n2\n", 1),
            1,
            "begins with its dimension",
        ),
        (
            dense.replacen("2\n2\n", "2\n0\n", 1),
            2,
            "it must have at least 1",
        ),
        (dense.replacen("2\n2\n", "2\nx\n", 1), 2, "whole number"),
        (dense.replacen("2\n2\n0\n", "2\n2\n5\n", 1), 3, "storage 5"),
        (dense.replacen("4\n4\n4", "6\n4\n4", 1), 4, "it must be 4"),
        (dense.replacen("3.0e-01", "3,0e-01", 1), 8, "an entry of W"),
        (dense.replacen("3.0e-01", "nan", 1), 8, "an entry of W"),
        (
            dense.replacen(" 6.0e-01", " -6.0e-01", 1),
            12,
            "must not be negative",
        ),
        (dense.replacen(" 6.0e-01", "", 1), 12, "the file ends"),
        (
            blocks.replacen("2 4\n", "4 2\n", 1),
            9,
            "the ends must be ascending",
        ),
        (blocks.replacen("0 2 4\n", "0 5 4\n", 1), 13, "at most 4"),
        (
            blocks.replacen("0 1 0 1\n", "0 2 0 1\n", 1),
            14,
            "a block column is 2",
        ),
        (
            blocks.replacen("\n2\n0.1", "\n7\n0.1", 1),
            19,
            "the number of a block is 7",
        ),
    ];
    for (text, line, part) in cases {
        let broken = read(&text, None).expect_err(part);
        let (at_line, column) = broken.at.unwrap();
        assert_eq!(at_line, line, "{broken:?} in\n{text}");
        assert!(broken.message.contains(part), "{broken:?}");
        let error = Scene::from_text("x.dat", &text, &[])
            .unwrap_err()
            .to_string();
        let place = format!("x.dat:{line}:{column}: ");
        assert!(error.starts_with(&place), "{error}");
    }
    // The column is that of the word.
    for (wrong, column) in [("3,0e-01", 20), ("nan", 20)] {
        let broken = read(&dense.replacen("3.0e-01", wrong, 1), None).unwrap_err();
        assert_eq!(broken.at.unwrap().1, column);
    }
}

fn problems() -> impl Strategy<Value = Local> {
    (1usize..5).prop_flat_map(|contacts| {
        let size = 2 * contacts;
        let entry = prop_oneof![3 => Just(0.0), 2 => -1e3..1e3f64, 1 => -1e-9..1e-9f64];
        (
            prop::collection::vec(prop::collection::vec(entry, size), size),
            prop::collection::vec(-1e2..1e2f64, size),
            prop::collection::vec(0.0..3.0f64, contacts),
        )
            .prop_map(|(w, q, mu)| Local {
                w: Matrix::from_rows(&w),
                q,
                mu,
            })
    })
}

#[derive(Debug, Clone, Copy)]
enum Storage {
    Dense,
    Blocks,
}

fn written(problem: &Local, storage: Storage) -> String {
    match storage {
        Storage::Dense => write(problem),
        Storage::Blocks => in_blocks(problem),
    }
}

fn storages() -> impl Strategy<Value = Storage> {
    prop_oneof![Just(Storage::Dense), Just(Storage::Blocks)]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn what_is_written_reads_back_the_same(problem in problems(), storage in storages()) {
        let read = read(&written(&problem, storage), None).unwrap();
        prop_assert_eq!(read.w.dense(), problem.w.dense());
        prop_assert_eq!((read.q, read.mu), (problem.q, problem.mu));
    }

    /// A file that lacks a number at its end is refused; none makes the reader panic.
    #[test]
    fn a_cut_file_is_refused(problem in problems(), storage in storages(), part in 0.0..1.0f64) {
        let text = written(&problem, storage);
        let whole = text.trim_end().rfind(' ').or(text.trim_end().rfind('\n')).unwrap();
        let cut = (whole as f64 * part) as usize;
        prop_assert!(read(&text[..cut], None).is_err());
    }

    #[test]
    fn a_damaged_file_never_panics(
        problem in problems(),
        storage in storages(),
        place in 0usize..60,
        word in prop_oneof!["-?[0-9]{1,20}", "[a-z:]{1,5}", "[0-9.e+-]{1,6}", "\\PC{0,4}"],
    ) {
        let text = written(&problem, storage);
        let mut words: Vec<&str> = text.split_whitespace().collect();
        let place = place % words.len();
        words[place] = &word;
        let damaged = words.join("\n");
        if let Ok(read) = read(&damaged, None) {
            prop_assert_eq!(read.w.rows, read.q.len());
        }
        let _ = Scene::from_text("x.dat", &damaged, &[]);
    }

    #[test]
    fn any_text_is_answered(text in "[0-9 \n.:a-z-]{0,200}") {
        let _ = read(&text, None);
    }
}

/// A chain of contacts, each coupled to its neighbours, pressed on by different amounts and dragged along.
fn chain(contacts: usize) -> Local {
    let size = 2 * contacts;
    let mut w = vec![vec![0.0; size]; size];
    for k in 0..contacts {
        (w[2 * k][2 * k], w[2 * k + 1][2 * k + 1]) = (1.0, 0.8);
        (w[2 * k][2 * k + 1], w[2 * k + 1][2 * k]) = (0.15, 0.15);
        if k + 1 < contacts {
            for (a, b, value) in [(0, 0, 0.3), (1, 1, 0.25), (0, 1, 0.05), (1, 0, 0.1)] {
                w[2 * k + a][2 * k + 2 + b] = value;
                w[2 * k + 2 + b][2 * k + a] = value;
            }
        }
    }
    let q = (0..contacts).flat_map(|k| {
        let x = k as f64;
        [(0.37 * x).sin() - 0.4, 0.8 * (0.23 * x).cos()]
    });
    Local {
        w: Matrix::from_rows(&w),
        q: q.collect(),
        mu: (0..contacts).map(|k| 0.2 + 0.4 * (k % 3) as f64).collect(),
    }
}

/// Hundreds of contacts run to an end, with an answer or with a reason, in a bounded number of iterations.
#[test]
fn hundreds_of_contacts_come_to_an_end() {
    let directory = tempfile::tempdir().unwrap();
    let mut solved = 0;
    for contacts in [100, 400] {
        let problem = chain(contacts);
        let file = directory.path().join(format!("chain-{contacts}.dat"));
        std::fs::write(&file, in_blocks(&problem)).unwrap();
        for limit in ["lagged", "consistent"] {
            let begin = std::time::Instant::now();
            let set = [("settings.t_max".to_owned(), limit.to_owned())];
            let scene = Scene::open(file.to_str().unwrap(), &set).unwrap();
            let run = run(&scene);
            let most = run.stepper.state().controls.settings;
            assert!(run.steps <= (most.minors * most.majors) as usize);
            let (steps, failure) = (run.steps, run.failure.as_ref().map(|f| &f.1));
            println!("{contacts}, {limit}: {steps} minors, {:?}", begin.elapsed());
            match failure {
                None => {
                    assert_solved(&problem, &run);
                    solved += 1;
                }
                Some(Failure::Cycle(cycle)) => {
                    println!("period {}, {} members", cycle.period, cycle.members.len());
                    assert!(cycle.period >= 2 && !cycle.members.is_empty());
                }
                Some(failure) => panic!("{failure:?}"),
            }
        }
    }
    assert!(solved > 0, "all of them cycle");
}

/// The file of a problem whose matrix is stored as the blocks of its pairs of contacts.
pub fn in_blocks(problem: &Local) -> String {
    let (size, dimension) = (problem.q.len(), problem.dimension());
    let mut text = format!("{dimension}\n{}\n1\n{size}\n{size}\n", problem.mu.len());
    write_blocks(&mut text, &problem.w.dense(), dimension);
    line(&mut text, problem.q.iter());
    line(&mut text, problem.mu.iter());
    text
}

fn write_blocks(text: &mut String, rows: &[Vec<f64>], dimension: usize) {
    let contacts = rows.len() / dimension;
    let entries = |i: usize, j: usize| -> Vec<f64> {
        (0..dimension)
            .flat_map(|b| (0..dimension).map(move |a| (a, b)))
            .map(|(a, b)| rows[dimension * i + a][dimension * j + b])
            .collect()
    };
    let (mut begins, mut columns, mut blocks) = (vec![0], Vec::new(), String::new());
    for i in 0..contacts {
        for j in 0..contacts {
            let block = entries(i, j);
            if block.iter().any(|v| *v != 0.0) {
                let _ = writeln!(blocks, "{}", columns.len());
                line(&mut blocks, block.into_iter());
                columns.push(j);
            }
        }
        begins.push(columns.len());
    }
    if columns.is_empty() {
        text.push_str("0\n");
        return;
    }
    let _ = writeln!(text, "{}\n{contacts}\n{contacts}", columns.len());
    for _ in 0..2 {
        line(text, (1..=contacts).map(|k| dimension * k));
    }
    let _ = writeln!(text, "{}\n{}", begins.len(), columns.len());
    line(text, begins.iter());
    line(text, columns.iter());
    text.push_str(&blocks);
}

/// Words on one line, separated by spaces.
fn line(text: &mut String, words: impl Iterator<Item = impl Debug>) {
    for word in words {
        let _ = write!(text, "{word:?} ");
    }
    text.push('\n');
}
