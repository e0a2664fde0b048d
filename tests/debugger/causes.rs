//! The rules for decks and records, each on a deck that CalculiX gives up for that cause and solves with the cure.

#[path = "../common/causes.rs"]
mod stored;

use std::path::{Path, PathBuf};
use stickslip::explain::page::DiagnosisPage;
use stickslip::recorded::calculix::rules::{examine, shape::DeckShape};
use stickslip::recorded::calculix::run::CalculixRun;
use stickslip_exchange::inp::{self, Deck};
use stickslip_exchange::mesh::CellKind;
use stored::{opened, rows, run};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/calculix")
}

fn deck(text: &str) -> Deck {
    let mut none = |_: &str| Err("no other file".to_owned());
    inp::outline("job.inp", text, &mut none).unwrap()
}

fn causes(text: &str) -> Vec<&'static str> {
    let deck = deck(text);
    let found = examine(Some(&DeckShape::new(&deck)), None);
    found.iter().map(|found| found.rule).collect()
}

fn text(name: &str) -> String {
    std::fs::read_to_string(root().join(format!("causes/{name}.inp"))).unwrap()
}

#[test]
fn each_deck_is_explained_by_its_cause_and_the_advised_lines_help_in_calculix() {
    let rows = rows();
    assert!(rows.len() >= 28);
    for row in rows {
        let run = run(&root(), &row.deck);
        let first = &run.findings[0];
        assert_eq!(first.rule, row.rule, "{}: {first:?}", row.deck);
        assert_eq!(first.lines, row.cure, "{}", row.deck);
        let without_contact = |outcome: &str| outcome.ends_with("without contact");
        let failed = row.outcome.starts_with("failed");
        assert!(failed || without_contact(&row.outcome), "{}", row.deck);
        assert!(row.cured.starts_with("converged"), "{}", row.deck);
        let apart = row.deck == "aside";
        assert_eq!(without_contact(&row.cured), apart, "{}", row.deck);
    }
}

/// A beam that is held along x and y at one node can turn about it.
#[test]
fn a_beam_is_held_by_the_rotation_of_its_node() {
    let beam = "*NODE\n1, 0., 0.\n2, 1., 0.\n3, 2., 0.\n*ELEMENT, TYPE=B32, ELSET=B\n1, 1, 2, 3\n\
                *MATERIAL, NAME=M\n*ELASTIC\n1.E6, 0.\n*BEAM SECTION, ELSET=B, MATERIAL=M, SECTION=RECT\n1., .1\n0., 0., -1.\n\
                *BOUNDARY\n1, 1, 6\n*STEP\n*STATIC\n1., 1.\n*CLOAD\n3, 2, -.01\n*END STEP\n";
    assert_eq!(causes(beam), [""; 0]);
    let turning = beam.replace("1, 1, 6\n", "1, 1, 2\n");
    assert_eq!(causes(&turning), ["unconnected body"]);
}

#[test]
fn rules_are_silent_on_the_cured_decks() {
    for row in rows()
        .iter()
        .filter(|row| root().join(format!("causes/{}.inp", row.deck)).is_file())
    {
        let failing = causes(&text(&row.deck));
        let record_only = [
            "increments",
            "clearance",
            "direct",
            "between",
            "roll",
            "row",
        ];
        let record_only = record_only.contains(&row.deck.as_str());
        assert_eq!(
            failing.contains(&row.rule.as_str()),
            !record_only,
            "{}",
            row.deck
        );
    }
    let stick = text("stick");
    assert_eq!(causes(&stick.replace("0.3, 1e12", "0.3, 1e5")), [""; 0]);
    assert_eq!(
        causes(&text("stiff").replace("\n1e11\n", "\n4e6\n")),
        [""; 0]
    );
    let overlap = text("overlap").replace("NODE TO SURFACE", "NODE TO SURFACE, ADJUST=0.");
    assert_eq!(causes(&overlap), [""; 0]);
    let tied = text("tie").replace("TOLERANCE=0.1", "TOLERANCE=0.21");
    assert_eq!(causes(&tied), ["constrained slave nodes"]);
}

#[test]
fn a_run_that_converged_has_no_cause_from_attempts_that_were_cut() {
    let run = run(&root(), "slider-soft");
    assert!(!run.switching.is_empty());
    assert!(run.findings.is_empty(), "{:?}", run.findings);
    let finished = opened(&root(), "slider-soft").scene.model.finished;
    let page = DiagnosisPage::finished(&finished.unwrap());
    assert_eq!(
        page.what,
        "Run: the last attempt converged, and no rule applies"
    );
    // Nor one from its deck, which `check` would warn about.
    let path = root().join("slider-soft.inp");
    let soft = std::fs::read_to_string(path).unwrap();
    let stiff = deck(&soft.replace("\n1e7", "\n1e11"));
    let shape = DeckShape::new(&stiff);
    assert!(!examine(Some(&shape), None).is_empty());
    assert!(examine(Some(&shape), Some(&run)).is_empty());
    // What is wrong with the mesh is wrong in a run that converged, too.
    let tie =
        deck(&text("tie").replace("*END STEP", "*END STEP\n*STEP\n*STATIC\n1., 1.\n*END STEP"));
    let found = examine(Some(&DeckShape::new(&tie)), Some(&run));
    let rules: Vec<_> = found.iter().map(|found| found.rule).collect();
    assert_eq!(rules, ["tie out of reach"]);
}

#[test]
fn contacts_chatter_in_the_last_attempt_or_else_in_an_earlier_one() {
    let mut run = CalculixRun::clone(&run(&root(), "two-blocks"));
    let chatter = |run: &CalculixRun| {
        let found = examine(None, Some(run));
        let found = found.into_iter().find(|found| found.rule == "chattering");
        found.map(|found| found.cause).unwrap()
    };
    let last = chatter(&run);
    assert!(
        last.contains("in the last attempt, up to 6 times in 2.1.3:"),
        "{last}"
    );
    let attempts = run.files.attempts.len();
    for found in &mut run.switching {
        found.attempts.retain(|(attempt, _)| attempt + 1 < attempts);
    }
    let earlier = chatter(&run);
    assert!(
        earlier.contains(&format!(
            "in one of {attempts} attempts, up to 6 times in 2.1.2:"
        )),
        "{earlier}"
    );
}

#[test]
fn cards_that_couple_nodes_silence_the_rules_on_supports() {
    let open = text("open");
    assert_eq!(causes(&open), ["held by open contact"]);
    let coupled = open.replace("*MATERIAL", "*EQUATION\n1\n1, 1, 1.\n*MATERIAL");
    assert_eq!(causes(&coupled), [""; 0]);
}

#[test]
fn faces_that_look_past_the_master_are_replaced_by_those_that_look_at_it() {
    let aside = text("side-faces");
    let right = aside.replace("19, S6\n21, S6", "19, S1\n20, S1\n21, S1\n22, S1");
    assert_eq!(causes(&aside), ["reversed faces"]);
    assert!(!causes(&right).contains(&"reversed faces"));
}

#[test]
fn nodes_at_a_common_place_are_found_only_there_however_far_the_origin_is() {
    let moved = |text: &str, by: f64| -> String {
        let at = text.find("*ELEMENT").unwrap();
        let nodes = text[..at]
            .lines()
            .map(|line| match line.split(", ").collect::<Vec<_>>()[..] {
                [node, x, y, z] => format!("{node}, {}, {y}, {z}", x.parse::<f64>().unwrap() + by),
                _ => line.to_owned(),
            });
        nodes.collect::<Vec<_>>().join("\n") + "\n" + &text[at..]
    };
    for by in [0.0, 1e7] {
        let rules = causes(&moved(&text("unmerged"), by));
        assert!(rules.contains(&"unmerged nodes"), "{by}: {rules:?}");
        let rules = causes(&moved(&text("loose"), by));
        assert!(!rules.contains(&"unmerged nodes"), "{by}: {rules:?}");
    }
}

#[test]
fn supports_that_a_later_step_removes_hold_nothing_in_it() {
    let steps = "*STEP\n*STATIC\n1., 1.\n*BOUNDARY\nSIDE, 1, 2, 0.\n*END STEP\n*STEP\n*STATIC\n1., 1.\n*BOUNDARY{}\nTOP, 1, 3, 0.\n*CLOAD\nSIDE, 1, 10.\n*END STEP\n";
    let middle = text("middle");
    let model = middle.split("*STEP").next().unwrap();
    let kept = format!("{model}{}", steps.replace("{}", ""));
    let removed = format!("{model}{}", steps.replace("{}", ", OP=NEW\nFIX, 1, 3"));
    assert_eq!(causes(&kept), [""; 0]);
    assert_eq!(causes(&removed), ["free to slide"]);
}

/// The body cannot follow its load down to the contact.
#[test]
fn a_body_that_supports_keep_open_is_held_where_it_is_free() {
    let held = text("open").replacen("*STEP", "*BOUNDARY\nTOP, 3, 3\n*STEP", 1);
    let deck = deck(&held.replace("TOP, 3, -50.", "TOP, 3, -50.\nTOP, 1, 5."));
    let found = examine(Some(&DeckShape::new(&deck)), None);
    assert_eq!(found[0].rule, "held by open contact");
    assert_eq!(found[0].lines, "*BOUNDARY\nTOP, 1, 1, 0.\nTOP, 2, 2, 0.");
}

/// Loads along the surface, or away from it, do not close the gap.
#[test]
fn a_gap_is_closed_along_the_normal() {
    for (load, away) in [("TOP, 1, 50.", false), ("TOP, 3, 50.", true)] {
        let deck = deck(&text("open").replace("TOP, 3, -50.", load));
        let found = examine(Some(&DeckShape::new(&deck)), None);
        assert_eq!(found[0].rule, "held by open contact");
        let lines = "*BOUNDARY\nTOP, 1, 1, 0.\nTOP, 2, 2, 0.\nTOP, 3, 3, -0.063";
        assert_eq!(found[0].lines, lines);
        assert_eq!(found[0].cause.ends_with(", away from it"), away);
    }
}

/// Without the .cvg, iterations without contact elements are not known.
#[test]
fn a_run_whose_contact_never_closed_has_one_finding() {
    let run = run(&root(), "clearance");
    let rules: Vec<_> = run.findings.iter().map(|found| found.rule).collect();
    assert_eq!(rules, ["contact never closed"]);
    let alone = examine(None, Some(&run));
    assert_eq!(alone.len(), 1);
    assert!(alone[0].lines.is_empty());
    let mut unknown = CalculixRun::clone(&run);
    unknown
        .files
        .iterations
        .iter_mut()
        .for_each(|at| at.norms = None);
    assert_eq!(examine(None, Some(&unknown)), []);
}

#[test]
fn the_faces_of_an_inner_layer_are_replaced_by_the_outer_ones() {
    let mut inner = text("reversed");
    for element in 10..19 {
        inner = inner.replace(
            &format!("\n{element}, S1\n"),
            &format!("\n{}, S2\n", element - 9),
        );
    }
    let deck = deck(&inner);
    let found = examine(Some(&DeckShape::new(&deck)), None);
    assert_eq!(found[0].rule, "reversed faces");
    let outer: Vec<String> = (10..19).map(|element| format!("{element}, S2")).collect();
    assert_eq!(found[0].lines, outer.join("\n"), "{}", found[0].cure);
}

#[test]
fn a_pair_with_small_sliding_is_given_without() {
    let small = text("first").replace("NODE TO SURFACE", "NODE TO SURFACE, SMALL SLIDING");
    let small = small.replace("TOP, 1, 1, 0.9", "TOP, 1, 1, 1.0");
    let deck = deck(&small);
    let found = examine(Some(&DeckShape::new(&deck)), None);
    let found = found
        .iter()
        .find(|found| found.rule == "small displacements");
    let lines = "*CONTACT PAIR, INTERACTION=RUB, TYPE=NODE TO SURFACE";
    assert_eq!(found.unwrap().lines, lines);
}

/// Loads whose resultant stays on the contact, that press, and that local axes may turn.
#[test]
fn bodies_that_stay_on_their_contact_have_no_finding() {
    let found = |name: &str, from: &str, to: &str| {
        assert!(text(name).contains(from));
        causes(&text(name).replace(from, to))
    };
    // The resultant meets the contact at 0.9 of its half width with 30.5, and at its edge with 33.9 per node.
    assert_eq!(found("tip", "TOP, 1, 40.", "TOP, 1, 30.5"), [""; 0]);
    assert_eq!(found("tip", "TOP, 1, 40.", "TOP, 1, 38."), ["tipping over"]);
    assert_eq!(found("pull", "TOP, 3, 20.", "TOP, 3, -20."), [""; 0]);
    // Without loads, or with loads that are not read.
    let both = "TOP, 3, -50.\nTOP, 1, 5.";
    assert_eq!(found("slide", both, "TOP, 3, 0."), [""; 0]);
    let spin = "*DLOAD\nSLIDER, CENTRIF, 1., 0., 0., 0., 0., 0., 1.\n*CLOAD";
    assert_eq!(found("pull", "*CLOAD", spin), [""; 0]);
    assert_eq!(found("pull", "=LINEAR", "=TIED"), [""; 0]);
    // New point loads leave pressures.
    let pressed = text("friction").replace("*CLOAD\nTOP, 3, -50.", "*DLOAD\nSLIDER, P2, 125.");
    let pushed = pressed.replace("*CLOAD", "*CLOAD, OP=NEW");
    assert_eq!(causes(&pushed), ["load above friction"]);
    let turned = "*TRANSFORM, NSET=FOOT, TYPE=C\n0., 0., 0., 0., 0., 1.\n*MATERIAL";
    assert_eq!(found("supported", "*MATERIAL", turned), [""; 0]);
}

/// A wedge whose tip is 0.1 below the line where the two faces of a valley meet.
#[test]
fn a_node_behind_the_edge_between_two_faces_is_in_front_of_both() {
    let deck = deck(
        "*NODE\n1, -1., 0.\n2, 0., -1.\n3, 1., 0.\n4, -1., -2.\n5, 1., -2.\n6, 0., -2.\n7, 0., -1.1\n8, 0.5, 1.\n9, -0.5, 1.\n\
         *ELEMENT, TYPE=CPE4, ELSET=VALLEY\n1, 4, 6, 2, 1\n2, 6, 5, 3, 2\n*ELEMENT, TYPE=CPE3, ELSET=WEDGE\n3, 7, 8, 9\n\
         *SURFACE, NAME=M\n1, S3\n2, S3\n*SURFACE, NAME=S, TYPE=NODE\n7\n*SURFACE INTERACTION, NAME=I\n\
         *CONTACT PAIR, INTERACTION=I\nS, M\n*STEP\n*STATIC\n1., 1.\n*END STEP\n",
    );
    let shape = DeckShape::new(&deck);
    let node = shape.pairs[0].nodes[0];
    assert!((node.gap + 0.1).abs() < 1e-12, "{node:?}");
    assert!(node.beyond < 1e-12, "{node:?}");
}

#[test]
fn a_run_without_contact_elements_shows_the_slave_nodes_of_its_deck() {
    let opened = opened(&root(), "open");
    assert_eq!(opened.run.files.slaves.len(), 9);
    assert_eq!(opened.run.slave(0), "node 49");
    assert!(opened.run.cycles.iter().all(Option::is_none));
}

/// Two elements of a kind, one on the other; the faces of the pair are the right ones.
#[test]
fn faces_of_all_kinds_of_solids_are_read() {
    let brick = [
        [0., 0., 0.],
        [1., 0., 0.],
        [1., 1., 0.],
        [0., 1., 0.],
        [0., 0., 1.],
        [1., 0., 1.],
        [1., 1., 1.],
        [0., 1., 1.],
    ];
    let wedge = [0, 1, 3, 4, 5, 7].map(|k| brick[k]);
    let tetra = [0, 1, 3, 4].map(|k| brick[k]);
    let kinds: [(&str, &[[f64; 3]], &str, &str); 10] = [
        ("C3D8", &brick, "S2", "S1"),
        ("C3D8R", &brick, "S2", "S1"),
        ("C3D8I", &brick, "S2", "S1"),
        ("C3D20", &brick, "S2", "S1"),
        ("C3D20R", &brick, "S2", "S1"),
        ("C3D6", &wedge, "S2", "S1"),
        ("C3D15", &wedge, "S2", "S1"),
        ("C3D4", &tetra, "S1", "S1"),
        ("C3D10", &tetra, "S1", "S1"),
        ("C3D10T", &tetra, "S1", "S1"),
    ];
    for (kind, corners, low, high) in kinds {
        let deck = deck(&stacked(kind, corners, low, high));
        assert_eq!(
            (deck.remarks.len(), deck.elements.len()),
            (0, 2),
            "{kind}: {:?}",
            deck.remarks
        );
        let shape = DeckShape::new(&deck);
        let pair = &shape.pairs[0];
        let quadratic = deck.elements[0].nodes.len() > corners.len();
        let of_face = pair.slaves[0].corners.len() * if quadratic { 2 } else { 1 };
        assert_eq!(pair.nodes.len(), of_face, "{kind}");
        assert!(
            pair.nodes.iter().all(|node| (node.gap - 0.5).abs() < 1e-12),
            "{kind}"
        );
        assert!((pair.normal().z - 1.0).abs() < 1e-12, "{kind}");
        assert!(
            examine(Some(&shape), None)
                .iter()
                .all(|f| f.rule != "reversed faces"),
            "{kind}"
        );
        if low == "S2" {
            let below = stacked(kind, corners, low, high).replace("\n1, S2\n", "\n1, S1\n");
            assert!(causes(&below).contains(&"reversed faces"), "{kind}");
        }
    }
}

/// The deck of two such elements, the second half a unit above the first, which is mirrored if its face S1 is the master. Midside
/// nodes bend both upwards.
fn stacked(kind: &str, corners: &[[f64; 3]], low: &str, high: &str) -> String {
    let of_kind = match corners.len() {
        8 => CellKind::Hexa8,
        6 => CellKind::Wedge6,
        _ => CellKind::Tetra4,
    };
    let wanted = match kind {
        "C3D20" | "C3D20R" | "C3D15" | "C3D10" | "C3D10T" => of_kind.edges(),
        _ => &[],
    };
    let place = |k: usize, at: [f64; 3]| match (k, low) {
        (0, "S1") => [at[0], at[1], -at[2]],
        (0, _) => [at[0], at[1], at[2] - 1.0],
        _ => [at[0], at[1], at[2] + 0.5],
    };
    let (mut nodes, mut elements) = (String::from("*NODE\n"), String::new());
    let count = corners.len() + wanted.len();
    for body in 0..2 {
        let at: Vec<[f64; 3]> = corners.iter().map(|at| place(body, *at)).collect();
        let middles = wanted
            .iter()
            .map(|[a, b]| [0, 1, 2].map(|k| (at[*a][k] + at[*b][k]) / 2.0))
            .map(|[x, y, z]| [x, y, z + 0.2 * x * (1.0 - x)]);
        for (k, [x, y, z]) in at.iter().copied().chain(middles).enumerate() {
            nodes += &format!("{}, {x}, {y}, {z}\n", body * count + k + 1);
        }
        let labels: Vec<String> = (1..=count)
            .map(|k| (body * count + k).to_string())
            .collect();
        let lines: Vec<String> = labels.chunks(10).map(|part| part.join(", ")).collect();
        elements += &format!(
            "*ELEMENT, TYPE={kind}, ELSET=B{body}\n{}, {}\n",
            body + 1,
            lines.join(",\n")
        );
    }
    format!(
        "{nodes}{elements}*SURFACE, NAME=LOW\n1, {low}\n*SURFACE, NAME=HIGH\n2, {high}\n*SURFACE INTERACTION, NAME=I\n*CONTACT PAIR, INTERACTION=I\nHIGH, LOW\n*STEP\n*STATIC\n1., 1.\n*END STEP\n"
    )
}

/// A value of zero ends a load. Accelerations in different directions are added, so that those of the second step leave a tenth of
/// the weight.
#[test]
fn a_rule_sees_the_loads_that_a_step_leaves() {
    let friction = text("friction");
    let steps = |first: &str, second: &str| {
        let mut parts = friction.split("*CLOAD\n");
        let mut part = || parts.next().unwrap();
        let (head, between, end) = (part(), part(), part());
        let between = between.split_once('\n').unwrap().1;
        let end = end.split_once('\n').unwrap().1;
        let text = format!("{head}{first}\n{between}{second}\n{end}");
        causes(&text.replace("210000., 0.3", "210000., 0.3\n*DENSITY\n1."))
    };
    let slides = "load above friction";
    let pressed = "*CLOAD\nTOP, 3, -50.\nTOP, 1, 3.";
    assert_eq!(steps(pressed, "*CLOAD\nTOP, 3, -10."), [slides]);
    assert_eq!(steps(pressed, "*CLOAD\nTOP, 3, -10.\nTOP, 1, 0."), [""; 0]);
    let weight = |size: f64, z: f64| format!("*DLOAD\nSLIDER, GRAV, {size}, 0., 0., {z}");
    let heavy = weight(100.0, -1.0) + "\n*CLOAD\nTOP, 1, 1.";
    assert_eq!(steps(&heavy, &weight(50.0, -1.0)), [""; 0]);
    assert_eq!(steps(&heavy, &weight(90.0, 1.0)), [slides]);
}
