//! Diagnosis, timeline, branches and remedies on the screen, on scenes that do not converge.

use ratatui::buffer::Buffer;
use ratatui::layout::Rect;
use ratatui::style::Modifier;
use stickslip::explain::remedies::TrialEnd;
use stickslip::history::tree::Budget;
use stickslip::history::verdicts::BranchEnd;
use stickslip::history::verdicts::summaries;
use stickslip::model::Mode;
use stickslip::record::command::{Command, Unit};
use stickslip::record::journal::{JournalTarget, Record};
use stickslip::record::story::story;
use stickslip::scene::Scene;
use stickslip::session::Session;
use stickslip::step::event::Outcome;
use stickslip::step::intervene::Intervention;
use stickslip::step::state::Status;
use stickslip::tui::theme::Theme;
use stickslip::tui::{Debugger, keys, screen};

fn session(scene: &str) -> Session {
    Session::new(Scene::open(scene, &[]).unwrap())
}

fn debugger(scene: &str, keys: &str) -> Debugger {
    let mut debugger = Debugger::new(Theme::colour(), vec![], Some(session(scene)));
    debugger.type_keys(keys);
    debugger
}

/// The screen, with wall times made alike.
fn text(debugger: &Debugger, width: u16, height: u16) -> String {
    let text = debugger.text(width, height);
    let mut lines: Vec<String> = text.lines().map(String::from).collect();
    for line in &mut lines {
        while let Some(at) = line.find(" ms") {
            let digit = |c: char| c.is_ascii_digit() || c == '.';
            let start = line[..at].trim_end_matches(digit).len();
            line.replace_range(start..at + 3, "(time)");
        }
    }
    lines.join("\n")
}

fn solve(session: &mut Session, command: Command) {
    session.submit(command).unwrap();
    session.wait();
}

const RUN: Command = Command::Forward {
    unit: Unit::Run,
    count: 1,
};

fn finished(session: &Session) -> bool {
    session.frame().state.status == Status::Finished
}

#[test]
fn what_pushed_a_node_adds_up_to_what_changed() {
    let mut session = session("osc-two6");
    solve(&mut session, RUN);
    let last = session.cursor();
    let mut compared = 0;
    for step in 2..=last {
        solve(&mut session, Command::Goto { step });
        for slave in 0..2 {
            session.look(slave);
            session.background_mut().wait();
            session.look(slave);
            session.background_mut().wait();
            let pushes = session
                .background()
                .pushes(session.timeline().place(), slave)
                .unwrap();
            let sum: f64 = pushes.unwrap().iter().map(|p| p.influence.f_n).sum();
            let of = |step: usize| session.frames()[step].event.as_ref().unwrap().nodes[slave].f_n;
            let change = of(step) - of(step - 1);
            assert!(
                (sum - change).abs() < 1e-12,
                "{step} {slave}: {sum} {change}"
            );
            compared += 1;
        }
    }
    assert_eq!(compared, 10);
}

#[test]
fn the_first_minor_iteration_of_a_major_has_nothing_before_it() {
    let mut session = session("osc-two6");
    solve(&mut session, RUN);
    solve(&mut session, Command::Goto { step: 1 });
    assert_eq!(session.timeline().minor_before(), None);
    session.look(0);
    session.background_mut().wait();
    assert!(
        session
            .background()
            .pushes(session.timeline().place(), 0)
            .is_none()
    );
}

#[test]
fn from_a_consistent_state_of_the_census_the_cycle_is_left() {
    for scene in [
        "osc-two6",
        "osc-inclined-cantilever",
        "osc-lag4",
        "osc-three10",
    ] {
        // After the failure, and before it.
        for keys in ["c d Enter n", "d Enter n"] {
            let debugger = debugger(scene, keys);
            let session = debugger.session.as_ref().unwrap();
            let event = session.frame().event.as_ref().unwrap();
            let left = matches!(
                event.outcome,
                Outcome::Major { .. } | Outcome::Increment { .. }
            );
            assert!(left, "{scene} {keys}: {:?}", event.outcome);
        }
    }
}

#[test]
fn an_answer_by_its_number_starts_all_of_its_nodes_in_one_step() {
    let mut debugger = debugger("osc-two6", "c :");
    debugger.type_text("start-from 1");
    debugger.type_keys("Enter");
    let session = debugger.session.as_ref().unwrap();
    let Some(Intervention::Assume(starts)) = &session.frame().intervention else {
        panic!("{:?}", session.frame().intervention);
    };
    let modes: Vec<_> = starts
        .iter()
        .map(|start| (start.slave, start.mode))
        .collect();
    assert_eq!(modes, [(0, Mode::Sliding), (1, Mode::Sliding)]);
    assert!(starts.iter().all(|start| start.t_max < 0.0));
    debugger.type_keys(":");
    debugger.type_text("start-from 7");
    debugger.type_keys("Enter");
    assert!(debugger.app.message.text.contains("not known here yet"));
}

#[test]
fn where_no_state_is_consistent_the_screen_says_which_condition_fails_by_least() {
    let debugger = debugger("osc-coh-none", "c d");
    let text = text(&debugger, 80, 40);
    assert!(text.contains("no modes of a are consistent"), "{text}");
    assert!(
        text.contains("none of 4 assignments is consistent"),
        "{text}"
    );
    assert!(text.contains("\"no tension\" at a by 0.3226"), "{text}");
    assert!(!text.contains("Enter starts"), "{text}");
}

#[test]
fn a_census_is_held_at_the_start_too_and_says_that_there_is_no_cycle() {
    let debugger = debugger("01-pinned-beam-rough-floor", "d");
    let text = text(&debugger, 80, 24);
    assert!(text.contains("do not cycle from here"), "{text}");
    assert!(text.contains("1 of 4 assignments is consistent"), "{text}");
}

#[test]
fn enter_takes_the_selected_line_of_try_in_a_new_branch() {
    let mut debugger = debugger("osc-two6", "c d");
    let seen = text(&debugger, 80, 24);
    assert!(seen.contains("▸1 ✓ the ladder of strategies"), "{seen}");
    debugger.type_keys("Down Enter");
    let session = debugger.session.as_ref().unwrap();
    assert_eq!(session.timeline().tree().branches().len(), 2);
    assert_eq!(session.frame().state.status, Status::Finished);
    assert!(matches!(
        session.frames()[7].intervention,
        Some(Intervention::Assume(_))
    ));
}

#[test]
fn the_page_of_a_finished_run_is_its_report() {
    let debugger = debugger("02-two-cantilevers-smooth", "c d");
    let seen = text(&debugger, 120, 40);
    for part in [
        "The history is complete: ",
        "Report",
        "most iterations: increment ",
    ] {
        assert!(seen.contains(part), "{part}: {seen}");
    }
}

#[test]
fn the_timeline_moves_the_whole_screen() {
    let mut debugger = debugger("osc-two6", "c t t");
    let seen = text(&debugger, 80, 24);
    assert!(seen.contains("│▸a") || seen.contains("┃▸a"), "{seen}");
    let close = seen.replace(' ', "");
    assert!(
        close.contains("FFXFXSS") && close.contains("FFXSSFX"),
        "{seen}"
    );
    assert!(seen.contains("╯ 6-cycle"), "{seen}");
    debugger.type_keys("Left Left");
    assert_eq!(debugger.session.as_ref().unwrap().cursor(), 4);
    let seen = text(&debugger, 80, 24);
    assert!(seen.contains("minor 4   load 1   4 of 6 steps"), "{seen}");
    debugger.type_keys("Home");
    assert_eq!(debugger.session.as_ref().unwrap().cursor(), 0);
    debugger.type_keys("3 Right Down");
    assert_eq!(debugger.session.as_ref().unwrap().cursor(), 3);
    assert_eq!(debugger.app.selected, 1);
}

#[test]
fn the_timeline_marks_the_cursor_and_forced_modes_without_colour_too() {
    for theme in [Theme::colour(), Theme::mono()] {
        let mut debugger = Debugger::new(theme, vec![], Some(session("osc-two6")));
        debugger.type_keys("c :");
        debugger.type_text("start-from 1");
        debugger.type_keys("Enter s t");
        let area = Rect::new(0, 0, 80, 24);
        let mut buffer = Buffer::empty(area);
        screen::draw(&mut buffer, area, &debugger.app, debugger.view().as_ref());
        let row = |y: u16| -> String {
            let cells = (0..80).map(|x| buffer[(x, y)].symbol());
            cells.filter(|symbol| *symbol != " ").collect()
        };
        let y = (0..24).find(|&y| row(y).contains("FFXFXSSss")).unwrap();
        let x = (0..80)
            .find(|&x| buffer[(x, y - 1)].symbol() == "▼")
            .unwrap();
        assert!(buffer[(x, y)].modifier.contains(Modifier::REVERSED));
        assert_eq!(buffer[(x, y)].symbol(), "s", "small: forced");
        assert!(buffer[(x, y)].modifier.contains(Modifier::UNDERLINED));
        assert!(!buffer[(x - 8, y)].modifier.contains(Modifier::UNDERLINED));
        if theme == Theme::colour() {
            assert_eq!(buffer[(x, y)].fg, theme.mode(Mode::Sliding).fg.unwrap());
        }
    }
}

#[test]
fn majors_and_increments_are_ruled_off() {
    let debugger = debugger("01-pinned-beam-rough-floor", "2 f t");
    let seen = text(&debugger, 120, 40);
    assert!(seen.contains("║") && seen.contains("✓"), "{seen}");
    let row = seen.lines().find(|line| line.contains("▸beam.5")).unwrap();
    assert!(row.contains("S│S") && row.contains("║S"), "{row}");
}

#[test]
fn remedies_are_measured_and_the_chosen_one_is_done_again_in_a_branch_of_its_own() {
    let mut debugger = debugger("osc-inclined-cantilever", "c r");
    let session = debugger.session.as_ref().unwrap();
    let tried = session.background().tried().unwrap().clone();
    let ends = |label: &str| {
        let mut trials = tried.trials.iter();
        let found = trials.find(|trial| trial.label.starts_with(label));
        found.unwrap_or_else(|| panic!("{label}")).end.clone()
    };
    assert_eq!(ends("state 1: beam.5 sliding"), TrialEnd::Converged);
    for label in [
        "enter contact as sliding",
        "enter as sliding, one chan",
        "block",
        "semismooth Newton",
        "Lemke",
        "the ladder",
    ] {
        assert_eq!(ends(label), TrialEnd::Converged, "{label}");
    }
    for label in ["one change", "hysteresis", "t_max", "residual", "half"] {
        assert!(matches!(ends(label), TrialEnd::Failed(_)), "{label}");
    }
    let best = &tried.trials[0];
    let left = best.left.unwrap();
    assert!(left.worst < 1e-8 && left.residual < 1e-10, "{left:?}");
    // Whole or condensed: one factorization a minor iteration, or one a major.
    assert!(best.minors > 0, "{best:?}");
    let each = [best.minors, best.majors];
    assert!(each.contains(&best.factorizations), "{best:?}");
    debugger.type_keys("Down Enter");
    let session = debugger.session.as_ref().unwrap();
    let second = &tried.trials[1];
    let branches = summaries(session.timeline().tree());
    assert_eq!(branches.len(), 2);
    assert!(branches[1].name.ends_with(&second.label) && branches[1].is_current);
    assert_eq!(branches[1].own.minors, u64::from(second.minors));
    assert!(matches!(
        session.frame().event.as_ref().unwrap().outcome,
        Outcome::Increment { .. }
    ));
    assert_eq!(branches[0].verdict, BranchEnd::Cycle, "nothing is lost");
}

#[test]
fn every_converging_remedy_ends_in_the_state_that_its_trial_measured() {
    let mut session = session("osc-two6");
    solve(&mut session, RUN);
    solve(&mut session, Command::Remedies);
    session.background_mut().wait();
    let (_, step) = session.timeline().place();
    let trials = session.background().tried().unwrap().trials.clone();
    let mut good = 0;
    for trial in trials.into_iter().filter(|t| t.end == TrialEnd::Converged) {
        solve(&mut session, Command::Goto { step });
        let (label, steps) = (trial.label.clone(), trial.steps);
        solve(&mut session, Command::Follow { label, steps });
        assert!(finished(&session), "{}", trial.label);
        good += 1;
    }
    assert_eq!(good, 8);
    let ends: Vec<BranchEnd> = summaries(session.timeline().tree())
        .into_iter()
        .map(|b| b.verdict)
        .collect();
    assert_eq!(ends[0], BranchEnd::Cycle);
    assert!(
        matches!(ends[2], BranchEnd::Same { branch: 1, .. }),
        "{ends:?}"
    );
}

#[test]
fn keys_are_answered_while_remedies_are_tried() {
    let mut debugger = debugger("osc-inclined-cantilever", "c");
    let press = |debugger: &mut Debugger, name: &str| {
        debugger.key(&keys::press(name).unwrap());
    };
    press(&mut debugger, "r");
    assert!(debugger.session.as_ref().unwrap().background().is_trying());
    assert!(!debugger.is_busy());
    press(&mut debugger, "S");
    assert_eq!(debugger.session.as_ref().unwrap().cursor(), 1);
    press(&mut debugger, "Ctrl-c");
    debugger.settle();
    assert!(!debugger.session.as_ref().unwrap().background().is_trying());
    press(&mut debugger, "Enter");
    assert!(
        debugger.app.message.text.contains("tried"),
        "{}",
        debugger.app.message.text
    );
}

#[test]
fn a_remedy_from_elsewhere_is_not_taken_here() {
    let mut debugger = debugger("osc-two6", "c r r S r Enter");
    let branches = summaries(debugger.session.as_ref().unwrap().timeline().tree()).len();
    assert_eq!(branches, 2, "{}", debugger.app.message.text);
    debugger.type_keys("s Enter");
    let message = &debugger.app.message.text;
    assert!(
        message.contains("these remedies were tried from step 5 of b1"),
        "{message}"
    );
}

#[test]
fn branches_are_walked_and_stand_beside_each_other() {
    let mut debugger = debugger("osc-inclined-cantilever", "c r Enter v Up");
    let seen = text(&debugger, 120, 40);
    assert!(
        seen.contains("b1: start") && seen.contains("└ b2: "),
        "{seen}"
    );
    assert!(
        seen.contains("↺ cycle") && seen.contains("Compared: "),
        "{seen}"
    );
    debugger.type_keys("Enter");
    let session = debugger.session.as_ref().unwrap();
    assert_eq!(
        (session.timeline().tree().current(), session.cursor()),
        (0, 2)
    );
}

#[test]
fn a_branch_that_was_left_at_its_tip_keeps_it_when_memory_is_short() {
    let scene = Scene::open("osc-inclined-cantilever", &[]).unwrap();
    let budget = Budget {
        frames: 20_000,
        ..Budget::default()
    };
    let mut session = Session::with_budget(scene, budget);
    solve(&mut session, RUN);
    solve(&mut session, Command::Remedies);
    session.background_mut().wait();
    let trial = session.background().tried().unwrap().trials[0].clone();
    let (label, steps) = (trial.label, trial.steps);
    solve(&mut session, Command::Follow { label, steps });
    solve(&mut session, RUN);
    assert!(finished(&session));
    session
        .submit(Command::Branch(
            stickslip::record::command::BranchTarget::Previous,
        ))
        .unwrap();
    assert!(session.frame().is_whole());
    assert_eq!(session.cursor(), 2);
}

#[test]
fn answers_and_remedies_are_in_the_journal_and_replay_to_the_same_bits() {
    let directory = tempfile::tempdir().unwrap();
    let path = directory.path().join("a.journal");
    let mut session = session("osc-two6");
    JournalTarget::File(path.clone())
        .begin(&mut session)
        .unwrap();
    solve(&mut session, RUN);
    solve(&mut session, Command::Remedies);
    session.background_mut().wait();
    for trial in session.background().tried().unwrap().trials.clone() {
        solve(&mut session, Command::Goto { step: 6 });
        let (label, steps) = (trial.label, trial.steps);
        solve(&mut session, Command::Follow { label, steps });
    }
    solve(&mut session, Command::Goto { step: 6 });
    solve(&mut session, Command::Census(vec![]));
    session.background_mut().wait();
    let finding = session
        .background()
        .examination(session.timeline().place())
        .flatten()
        .unwrap();
    let starts = finding.found.starts(0).unwrap();
    solve(&mut session, Command::Assume(starts));
    solve(&mut session, RUN);
    let record = Record::read(&path).unwrap();
    let again = record.replay().unwrap();
    assert_eq!(again.timeline().place(), session.timeline().place());
    assert_eq!(again.frame().state, session.frame().state);
    assert_eq!(summaries(again.timeline().tree()).len(), 22);
    for branch in 0..22 {
        let tip = |session: &Session| {
            session
                .timeline()
                .tree()
                .tip(branch)
                .unwrap()
                .0
                .state
                .clone()
        };
        assert_eq!(tip(&again), tip(&session), "b{}", branch + 1);
    }
    let told = story(&record).unwrap();
    assert!(
        told.contains("Applied a remedy") && told.contains("Started from a consistent state"),
        "{told}"
    );
}

#[test]
#[ignore = "a measurement"]
fn drawing_thousands_of_iterations() {
    let mut debugger = debugger("osc-inclined-cantilever", "c r Enter c t");
    let steps = debugger.session.as_ref().unwrap().frames().len();
    for place in ["End", "Home", "End"] {
        debugger.type_keys(place);
        let began = std::time::Instant::now();
        for _ in 0..100 {
            std::hint::black_box(debugger.text(120, 40));
        }
        println!(
            "{steps} steps, {place}: {:?} a screen",
            began.elapsed() / 100
        );
    }
}

/// The debugger on problem 04 in a few large increments, with a line typed.
fn measuring(line: &str) -> Debugger {
    let set = [("history.increment".to_string(), "0.5".to_string())];
    let scene = Scene::open("04-cantilever-rigid-circle", &set).unwrap();
    let mut debugger = Debugger::new(Theme::mono(), vec![], Some(Session::new(scene)));
    debugger.type_keys(":");
    debugger.type_text(line);
    debugger.key(&keys::press("Enter").unwrap());
    debugger
}

#[test]
fn a_chart_of_the_scene_is_measured_beside_the_run_and_shown_when_it_is_done() {
    let mut debugger = measuring("chart refine=1,2 nodes.beam.per_element=3,5");
    // Steps go on meanwhile.
    debugger.key(&keys::press("s").unwrap());
    debugger.settle();
    let shown = debugger.text(120, 40);
    assert!(shown.contains("Work and precision"), "{shown}");
    assert!(
        shown.contains("a nodes.beam.per_element=3  ") && shown.contains("=3, refine=1"),
        "{shown}"
    );
    debugger.type_keys("Esc");
    let shown = debugger.text(120, 40);
    assert!(shown.contains("increment 1") && !shown.contains("chart:"));
    assert_eq!(debugger.session.as_ref().unwrap().frames().len(), 2);
}

#[test]
fn a_chart_that_is_being_measured_says_how_far_it_is_and_can_be_stopped() {
    let mut debugger = measuring("chart history.increment=5e-6,4e-6");
    debugger.advance();
    let shown = debugger.text(80, 24);
    assert!(
        shown.contains("chart: 0 %") && shown.contains("Ctrl-C"),
        "{shown}"
    );
    debugger.type_keys("Ctrl-c");
    let shown = debugger.text(80, 24);
    assert!(!shown.contains("chart: "), "{shown}");
    assert!(
        shown.contains("stopped before any run was finished"),
        "{shown}"
    );
}

#[test]
fn what_no_chart_can_be_made_of_is_told() {
    for (line, told) in [
        ("chart refin=1,2", "refin"),
        ("chart refine=", "refine"),
        ("chart no-such-file.csv", "no-such-file.csv"),
    ] {
        let mut debugger = measuring(line);
        debugger.settle();
        let shown = debugger.text(120, 40);
        assert!(
            shown.contains(told) && !shown.contains("Work and precision"),
            "{shown}"
        );
    }
}

#[test]
fn enter_on_the_heading_of_a_part_of_the_diagnosis_folds_it_and_unfolds_it() {
    let mut debugger = debugger("osc-two6", "c d");
    let page = |debugger: &Debugger| text(debugger, 120, 80);
    let unfolded = page(&debugger);
    assert!(
        unfolded.contains("minor") && !unfolded.contains("Loop …"),
        "{unfolded}"
    );
    // Behind the last line of Try.
    let tries = unfolded.matches(" ✓ ").count() + unfolded.matches(" ✗ ").count();
    debugger.type_keys(&"Down ".repeat(tries));
    debugger.type_keys("Enter");
    let folded = page(&debugger);
    assert!(folded.contains("Loop … (Enter)"), "{folded}");
    debugger.type_keys("Enter");
    assert!(!page(&debugger).contains("Loop …"));
}

#[test]
fn the_footer_offers_enter_only_where_there_is_something_to_take() {
    for (scene, keys, offered) in [
        ("osc-two6", "c d", "Enter take"),
        ("osc-two6", "d", "Enter take"),
        // The history is complete: its report can only be folded.
        ("osc-off-end", "c d", "Enter fold"),
        ("osc-off-end", "c r", ""),
        ("osc-two6", "c r", "Enter apply"),
    ] {
        let shown = text(&debugger(scene, keys), 120, 40);
        let footer = shown.lines().last().unwrap();
        match offered {
            "" => assert!(!footer.contains("Enter"), "{scene} {keys}: {footer}"),
            offered => assert!(footer.contains(offered), "{scene} {keys}: {footer}"),
        }
    }
}

#[test]
fn enter_folds_the_report_of_a_complete_history() {
    let mut debugger = debugger("osc-off-end", "c d Enter");
    let folded = text(&debugger, 120, 40);
    assert!(folded.contains("Report … (Enter)"), "{folded}");
    debugger.type_keys("Enter");
    assert!(text(&debugger, 120, 40).contains("no increment was cut"));
}

#[test]
fn a_node_off_all_surfaces_has_no_gap() {
    let debugger = debugger("osc-off-end", "c");
    let shown = text(&debugger, 120, 40);
    let row = shown.lines().find(|line| line.contains("▸  beam.5"));
    let row = row.unwrap_or_else(|| panic!("{shown}"));
    assert!(row.contains("free → free        -   "), "{row}");
}

#[test]
fn a_caption_of_the_shape_that_is_cut_says_so() {
    // Enlarged, with forces and a diagnosed node.
    let debugger = debugger("osc-inclined-cantilever", "c d Esc -");
    let whole = "longest force 0.005781   ! diagnosed   ×0.80  0: fit";
    assert!(text(&debugger, 200, 60).contains(whole));
    let shown = text(&debugger, 120, 40);
    assert!(shown.contains("! diagnosed   ×0.80  0: f…│"), "{shown}");
}
