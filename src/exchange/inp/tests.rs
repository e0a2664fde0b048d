//! Tests with valid, rejected and damaged decks.

use super::deck::{Adjust, Direction, Faces, Family, Form, Normal, Volume};
use super::*;
use crate::mesh::CellKind;
use proptest::prelude::*;

const PLATES: &str = include_str!("../../../tests/decks/pressed-plates.inp");
const RINGS: &str = include_str!("../../../tests/decks/shrunk-ring.inp");
const BLOCK: &str = include_str!("../../../tests/decks/press-and-push.inp");
const BEAM: &str = include_str!("../../../tests/decks/beam-on-a-post.inp");
const GLUED: &str = include_str!("../../../tests/decks/glued.inp");
const GLUED_MESH: &str = include_str!("../../../tests/decks/parts/glued-mesh.inp");

fn alone(_: &str) -> Result<String, String> {
    Err("no file can be had here".to_owned())
}

fn deck(text: &str) -> Deck {
    read("job.inp", text, &mut alone).unwrap_or_else(|wrong| panic!("{wrong}"))
}

fn refusal(text: &str) -> String {
    match read("job.inp", text, &mut alone) {
        Ok(_) => panic!("it was read: {text}"),
        Err(wrong) => wrong.to_string(),
    }
}

/// The block's deck with one piece of text replaced.
fn but(text: &str, from: &str, to: &str) -> String {
    assert!(text.contains(from), "{from:?} is not in the deck");
    text.replacen(from, to, 1)
}

#[test]
fn nodes_elements_sections_and_laws_match_the_deck() {
    let deck = deck(PLATES);
    assert_eq!(
        deck.heading,
        "Two plates of one CPS8R each, pressed together: linear penalty, point loads"
    );
    assert_eq!(deck.nodes.len(), 16);
    assert_eq!(
        (deck.nodes[8].label, deck.nodes[8].at),
        (11, [0.0, 2.0, 0.0])
    );
    let kind = deck.elements[1].kind;
    assert_eq!(
        (kind.family, kind.cell, kind.reduced),
        (Family::PlaneStress, CellKind::Quad8, true)
    );
    assert_eq!(deck.side(0, 2), [2, 6, 3]);
    assert_eq!(deck.sections[0].form, Form::Solid { thickness: 2.0 });
    assert_eq!(deck.materials[0].elastic, Some((70000.0, 0.33)));
    let law = &deck.interactions[0];
    assert_eq!(
        (law.normal, law.friction, law.stick),
        (Normal::Linear { stiffness: 1e6 }, 0.0, None)
    );
    let pair = &deck.pairs[0];
    assert_eq!(
        (
            deck.surfaces[pair.slave].name.as_str(),
            pair.small_sliding,
            pair.faces
        ),
        ("DOWN", true, false)
    );
    let step = &deck.steps[0];
    assert!(step.nlgeom && !step.at_once);
    let forces: Vec<_> = step
        .forces
        .iter()
        .map(|f| (deck.nodes[f.node].label, f.direction, f.value))
        .collect();
    let y = Direction::Y;
    assert_eq!(forces, [(13, y, -100.0), (14, y, -100.0), (17, y, -400.0)]);
    assert_eq!(deck.node_sets[deck.printed[0]].name, "TOP");
}

#[test]
fn sets_may_be_generated_and_nested_and_steps_are_in_order() {
    let deck = deck(BLOCK);
    let set = |name: &str| {
        deck.node_sets
            .iter()
            .find(|set| set.name == name)
            .expect("a set")
    };
    assert_eq!(set("TOP").members, [3, 4, 5]);
    assert_eq!(set("GROUND").members, [6, 7, 8, 9]);
    assert_eq!(deck.element_sets[2].members, [0, 1, 2]);
    assert_eq!(deck.surfaces[0].of, Faces::Elements(vec![(0, 0), (1, 0)]));
    assert_eq!(deck.interactions[0].friction, 0.4);
    assert_eq!(deck.steps.len(), 2);
    let second = &deck.steps[1];
    assert!(second.time.direct && second.time.initial == 0.125);
    assert_eq!(second.motions[0].amplitude, Some(0));
    assert_eq!(
        deck.amplitudes[0].points,
        [(0.0, 0.0), (0.5, 1.0), (1.0, -1.0)]
    );
}

#[test]
fn a_rectangular_beam_has_its_second_thickness_in_the_plane() {
    let deck = deck(BEAM);
    let form = Form::Rectangle {
        width: 0.1,
        height: 0.2,
    };
    assert_eq!(deck.sections[0].form, form);
    assert_eq!(deck.elements[0].kind.family, Family::Beam);
    let held: Vec<_> = deck
        .supports
        .iter()
        .filter(|v| v.node == 0)
        .map(|v| v.direction)
        .collect();
    assert_eq!(held, [Direction::X, Direction::Y, Direction::Rotation]);
}

#[test]
fn case_spaces_comments_continuation_lines_and_fortran_numbers_do_not_matter() {
    let text = but(
        BLOCK,
        "*SURFACE INTERACTION, NAME=ROUGH",
        "*surface Interaction ,\n** in between\n name = \" ro ugh\"",
    );
    let text = but(&text, "1, 1, 2, 5, 4\n", "1, 1, 2,\n5, 4,\n");
    let text = but(&text, "1000., 0.3", "1.D3, 3d-1");
    let text = but(&text, "*STATIC, DIRECT", "* Static , direct");
    let (ours, theirs) = (deck(&text), deck(BLOCK));
    assert_eq!(
        ours.interactions[0].friction,
        theirs.interactions[0].friction
    );
    assert_eq!(ours.materials[0].elastic, theirs.materials[0].elastic);
    assert_eq!(ours.elements[0].nodes, theirs.elements[0].nodes);
    assert_eq!(ours.steps[0].time, theirs.steps[0].time);
}

#[test]
fn an_include_file_is_read_in_place_and_its_errors_have_its_lines() {
    let mut give = |name: &str| match name {
        "parts/glued-mesh.inp" => Ok(GLUED_MESH.to_owned()),
        _ => Err("no such file".to_owned()),
    };
    let deck = read("glued.inp", GLUED, &mut give).expect("it is sound");
    assert_eq!(
        (deck.nodes.len(), deck.elements.len(), deck.ties.len()),
        (8, 2, 1)
    );
    assert_eq!((deck.nodes[0].place.file, deck.nodes[0].place.line), (1, 3));
    assert_eq!(deck.ties[0].place.line, 13);
    let mut damaged = |_: &str| Ok(GLUED_MESH.replace("11, 12, 13, 14", "11, 12, 13, 15"));
    let wrong = read("glued.inp", GLUED, &mut damaged).expect_err("node 15 is not there");
    assert_eq!(
        wrong.to_string(),
        "parts/glued-mesh.inp:13:16: there is no node 15; *NODE must come first"
    );
    let mut none = |_: &str| Err("there is no such file".to_owned());
    let wrong = read("glued.inp", GLUED, &mut none).expect_err("no file");
    assert_eq!(wrong.to_string(), "glued.inp:3:1: there is no such file");
}

#[test]
fn recursive_includes_are_rejected() {
    let mut itself = |_: &str| Ok("*INCLUDE, INPUT=a.inp\n".to_owned());
    let wrong = read("job.inp", "*INCLUDE, INPUT=a.inp\n", &mut itself).expect_err("endless");
    assert_eq!(
        wrong.to_string(),
        "a.inp:1:1: the file \"a.inp\" includes itself"
    );
    let mut number = 0;
    let mut deeper = |_: &str| {
        number += 1;
        Ok(format!("*INCLUDE, INPUT={number}.inp\n"))
    };
    let wrong = read("job.inp", "*INCLUDE, INPUT=a.inp\n", &mut deeper).expect_err("too deep");
    assert!(
        wrong
            .to_string()
            .contains("includes are nested more than 16 deep"),
        "{wrong}"
    );
    // Each file includes the next one twice: 2^k times the last.
    let mut twice = |name: &str| {
        let next = name.trim_end_matches(".inp").parse::<u32>().unwrap_or(0) + 1;
        Ok(format!("*INCLUDE, INPUT={next}.inp\n").repeat(if next < 14 { 2 } else { 0 }))
    };
    let wrong = read("job.inp", "*INCLUDE, INPUT=1.inp\n", &mut twice).expect_err("too many");
    assert!(wrong.to_string().contains("too large"), "{wrong}");
}

#[test]
fn errors_have_a_location_and_the_expected_input() {
    let cases = [
        (
            "TYPE=CPE4, ELSET=BLOCK",
            "TYPE=C3D8, ELSET=BLOCK",
            "job.inp:14:11: C3D8 is a three-dimensional element, which only CalculiX solves: `stickslip check` applies the rules for decks, and `stickslip JOB.cel` shows the run and why it failed; supported are CPE, CPS and CAX with 3, 4, 4R, 6, 8 and 8R, and B21, B22, B31, B31R, B32, B32R",
        ),
        (
            "PRESSURE-OVERCLOSURE=HARD",
            "PRESSURE-OVERCLOSURE=EXPONENTIAL\n1.E-4, .1",
            "job.inp:35:20: *SURFACE BEHAVIOR: PRESSURE-OVERCLOSURE=EXPONENTIAL is not supported: nonlinear pressure laws do not give a complementarity problem; it must be HARD, LINEAR or TIED",
        ),
        (
            "*ELASTIC\n",
            "*ELASTIC, TYPE=ORTHO\n",
            "job.inp:30:11: *ELASTIC: TYPE=ORTHO is not supported; it must be ISO or ISOTROPIC",
        ),
        (
            "*AMPLITUDE, NAME=FORTH",
            "*EQUATION",
            "job.inp:40:1: *EQUATION: equations between nodes are not supported; give both bodies common nodes, or use *TIE",
        ),
        (
            "*STATIC, DIRECT",
            "*DYNAMIC",
            "job.inp:45:1: *DYNAMIC: only *STATIC steps are supported",
        ),
        (
            "*STATIC, DIRECT",
            "*STATICS",
            "job.inp:45:1: *STATICS: it is not a supported keyword; did you mean *STATIC?",
        ),
        (
            "2, 1., 0.",
            "2, 1., 0., 0.5",
            "job.inp:5:13: node 2 is at z = 0.5; only z = 0 is supported",
        ),
        (
            "2, 1., 0.",
            "2, 1., abc",
            "job.inp:5:9: found \"abc\" where a coordinate, a number, was expected",
        ),
        (
            "2, 1., 0.",
            "2, 1., 1e999",
            "job.inp:5:9: found \"1e999\" where a coordinate, a number, was expected",
        ),
        (
            "2, 1., 0.",
            "1, 1., 0.",
            "job.inp:5:2: node 1 is defined twice",
        ),
        (
            "BLOCK, S1",
            "BLOCK, S5",
            "job.inp:26:8: element 1 has no side \"S5\"; it must be S1 to S4",
        ),
        (
            "BLOCK, S1",
            "BLOCKS, S1",
            "job.inp:26:1: there is no element set BLOCKS; it must be defined first",
        ),
        (
            "BELOW, ABOVE",
            "BELOW, UNDER",
            "job.inp:39:8: there is no surface UNDER; *SURFACE, NAME=... defines one",
        ),
        (
            "TOP, 2, 2, -0.02",
            "TOP, 3, 3, -0.02",
            "job.inp:49:12: a displacement of -0.02 along direction 3 leaves the plane",
        ),
        (
            "GROUND, 1, 2",
            "GROUND, 1, 2, 0.5",
            "job.inp:43:15: nonzero values are not allowed before the first step; write this one inside a step",
        ),
        (
            "*STEP\n",
            "*STEP, PERTURBATION\n",
            "job.inp:44:8: *STEP: the parameter PERTURBATION is not supported; supported are NLGEOM, INC, AMPLITUDE, NAME, UNSYMM, INCF, INCF1",
        ),
        (
            "0.5, 1.\n*BOUNDARY",
            "2., 1.\n*BOUNDARY",
            "job.inp:46:1: the first increment, 2.0, is longer than the step, 1.0",
        ),
        (
            "0., 0., 0.5, 1., 1., -1.",
            "0., 0., 0.5",
            "job.inp:41:9: a time without a factor; they must come in pairs",
        ),
        (
            "PRESSURE-OVERCLOSURE=HARD",
            "PRESSURE OVERCLOSURE=LINEAR\n1000., 1e-9",
            "job.inp:35:20: *SURFACE BEHAVIOR: the parameter PRESSUREOVERCLOSURE is not supported; supported are PRESSURE-OVERCLOSURE",
        ),
        (
            "*ELASTIC\n",
            "*EXPANSION, USER\n1e-3\n*ELASTIC\n",
            "job.inp:30:13: *EXPANSION: the parameter USER is not supported; supported are TYPE, ZERO",
        ),
        (
            "*ELASTIC\n",
            "*EXPANSION, ZERO=20.\n1e-3, 20., 2e-3\n*ELASTIC\n",
            "job.inp:31:12: unexpected value; isotropic expansion has a coefficient and a temperature",
        ),
        (
            "TOP, 2, 2, -0.02\n",
            "*CLOAD\n4, 2, -1.\n*CLOAD, OP=NEW\n5, 2, -1.\n",
            "job.inp:51:9: *CLOAD: OP must be the same on all *CLOAD cards of a step: CalculiX only reads that of the first one",
        ),
        (
            "*END STEP\n",
            "*END STEP\n*BOUNDARY\n4, 2\n",
            "job.inp:51:1: *BOUNDARY: it is outside the steps; it must be in a step, or before the first *STEP",
        ),
        (
            "*END STEP\n",
            "*END STEP\n*CONTACT PAIR, INTERACTION=ROUGH\nBELOW, ABOVE\n",
            "job.inp:51:1: *CONTACT PAIR: it belongs to the model and must come before the first *STEP",
        ),
        (
            "*SURFACE, NAME=BELOW",
            "*SURFACE, NAME=POINTS, TYPE=NODE\n1, 2\n*SURFACE, NAME=BELOW",
            "job.inp:26:4: unexpected value; a line of a surface of nodes has one node or set, and behind it only an area such as 1.",
        ),
    ];
    for (from, to, message) in cases {
        assert_eq!(refusal(&but(BLOCK, from, to)), message);
    }
    // Abaqus writes an area behind each node.
    let with_area = "*SURFACE, NAME=POINTS, TYPE=NODE\n1, 1.\n*SURFACE, NAME=BELOW";
    deck(&but(BLOCK, "*SURFACE, NAME=BELOW", with_area));
    assert!(
        refusal(BLOCK.rsplit_once("*END STEP").map_or("", |(most, _)| most))
            .contains("the step has no end")
    );
    assert!(refusal("*NODE\n1, 0., 0.\n").contains("the deck has no step"));
    assert!(refusal("1, 2\n").contains("before the first keyword"));
}

#[test]
fn ignored_and_reinterpreted_input_is_listed_with_its_line() {
    let lines = |deck: &Deck| -> Vec<String> {
        let remarks = deck.remarks.iter();
        remarks
            .map(|remark| format!("{}: {}", remark.place.line, remark.text))
            .collect()
    };
    let rings = but(RINGS, "*EXPANSION", "*CONDUCTIVITY");
    let found = lines(&deck(&rings)).join("\n");
    assert!(
        found.contains("30: *CONDUCTIVITY is ignored: it concerns the flow of heat"),
        "{found}"
    );
    let soft = but(BLOCK, "OVERCLOSURE=HARD", "OVERCLOSURE=LINEAR\n2e4");
    let heated = but(
        &soft,
        "TOP, 1, 1, 0.\n",
        "TOP, 1, 1, 0.\nTOP, 11, 11, 20.\n",
    );
    let found = lines(&deck(&but(
        &heated,
        "*END STEP",
        "*CFLUX\nTOP, 11, 1.\n*END STEP",
    )))
    .join("\n");
    for part in [
        "36: LINEAR has no second value",
        "direction 11, the temperature",
        "*CFLUX is ignored",
    ] {
        assert!(found.contains(part), "{found}");
    }
    let all: String = (900..921).map(|k| format!("{k}, 9., 9.\n")).collect();
    let wide = but(
        BLOCK,
        "*ELEMENT",
        &format!("*NODE, NSET=ALL\n{all}*ELEMENT"),
    );
    let wide = deck(&but(
        &wide,
        "*END STEP",
        "*NODE PRINT, NSET=ALL\nU\n*END STEP",
    ));
    assert!(lines(&wide).join("\n").contains("more than 20 nodes") && wide.printed.is_empty());
    let twice = but(
        BLOCK,
        "*BOUNDARY\nGROUND, 1, 2",
        "*BOUNDARY\nGROUND, 1, 3\nTOP, 3",
    );
    let deck = deck(&twice);
    let remark = deck
        .remarks
        .iter()
        .find(|remark| remark.text.contains("always fixed"))
        .expect("a remark");
    assert_eq!((remark.place.line, remark.times), (43, 2));
}

#[test]
fn an_orientation_of_an_isotropic_section_is_ignored_with_a_note() {
    let section = "*SOLID SECTION";
    let oriented = BLOCK.replace(
        section,
        "*ORIENTATION, NAME=AXES\n1., 0., 0., 0., 1., 0.\n*SOLID SECTION, ORIENTATION=AXES",
    );
    assert!(BLOCK.contains(section));
    let read = deck(&oriented);
    assert_eq!(read.elements.len(), deck(BLOCK).elements.len());
    let noted = read.remarks.iter().map(|remark| &remark.text);
    assert!(
        noted
            .into_iter()
            .any(|text| text.contains("*ORIENTATION is ignored"))
    );
}

#[test]
fn loads_on_sides_and_volumes_and_adjusted_gaps_are_read() {
    let text = but(
        BLOCK,
        "TYPE=NODE TO SURFACE",
        "TYPE=NODE TO SURFACE, ADJUST=TOP",
    );
    let text = but(
        &text,
        "*END STEP",
        "*DLOAD\nBLOCK, P2, 5.\n2, GRAV, 9.81, 0., -2., 0.\n1, BX, 3.\n*DSLOAD\nABOVE, P, 7.\n*END STEP",
    );
    let deck = deck(&text);
    assert_eq!(deck.pairs[0].adjust, Some(Adjust::Set(0)));
    let step = &deck.steps[0];
    let pressures: Vec<_> = step
        .pressures
        .iter()
        .map(|p| (p.element, p.side, p.value))
        .collect();
    assert_eq!(pressures, [(0, 1, 5.0), (1, 1, 5.0), (2, 2, 7.0)]);
    let weights: Vec<_> = step.weights.iter().map(|w| (w.element, w.load)).collect();
    assert_eq!(
        weights,
        [
            (
                1,
                Volume::Gravity {
                    acceleration: [0.0, -9.81, 0.0],
                    direction: [0.0, -1.0, 0.0]
                }
            ),
            (
                0,
                Volume::Force {
                    axis: 0,
                    value: 3.0
                }
            )
        ]
    );
}

#[test]
fn keywords_are_unique_and_sorted() {
    let names: Vec<&str> = keywords::KEYWORDS.iter().map(|(name, _)| *name).collect();
    assert!(names.windows(2).all(|pair| pair[0] < pair[1]), "{names:?}");
}

/// A deck with some bytes, lines or words changed, or taken from another deck.
fn damaged() -> impl Strategy<Value = String> {
    let decks = prop::sample::select(vec![PLATES, RINGS, BLOCK, BEAM, GLUED]);
    let change = (
        any::<prop::sample::Index>(),
        any::<prop::sample::Index>(),
        0..6usize,
        "\\PC{0,12}",
    );
    (decks, prop::collection::vec(change, 1..6)).prop_map(|(deck, changes)| {
        let mut lines: Vec<String> = deck.lines().map(str::to_owned).collect();
        for (at, other, kind, text) in changes {
            let (at, other) = (at.index(lines.len()), other.index(lines.len()));
            match kind {
                0 => lines.swap(at, other),
                1 => lines[at] = lines[other].clone(),
                2 => lines[at] = text,
                3 => lines[at].push_str(&text),
                4 => lines[at] = lines[at].replace(',', "="),
                _ => lines[at] = lines[at].replace(['0', '1'], "9999999999999999999"),
            }
        }
        lines.join("\n")
    })
}

proptest! {
    #[test]
    fn no_text_makes_the_reader_panic(text in "(?s).{0,300}") {
        let _ = read("job.inp", &text, &mut alone);
        let _ = is_one(&text);
    }

    #[test]
    fn no_sequence_of_cards_makes_the_reader_panic(
        cards in prop::collection::vec((prop::sample::select(keywords::KEYWORDS.clone()), "[A-Z, =0-9.*-]{0,40}", "[A-Z0-9,. \n-]{0,60}"), 0..12),
    ) {
        let lines = cards.iter().map(|((name, _), parameters, data)| format!("*{name},{parameters}\n{data}\n"));
        let _ = read("job.inp", &lines.collect::<String>(), &mut alone);
    }

    #[test]
    fn a_damaged_deck_is_read_or_rejected_with_a_valid_line(text in damaged()) {
        let mut give = |_: &str| Ok(GLUED_MESH.to_owned());
        if let Err(wrong) = read("job.inp", &text, &mut give) {
            let lines = if wrong.place.file == 0 { text.lines().count() } else { GLUED_MESH.lines().count() };
            prop_assert!((1..=lines).contains(&wrong.place.line), "{}", wrong);
            prop_assert!(!wrong.message.is_empty());
        }
    }
}

/// Two instances of one part, as Abaqus/CAE writes them: the second one is turned by 90 degrees and moved.
const ASSEMBLY: &str = "*Part, name=Part-1
*Node
 1, 0., 0.
 2, 2., 0.
 3, 2., 1.
 4, 0., 1.
*Element, type=CPE4R
1, 1, 2, 3, 4
*Nset, nset=Ends, generate
 2, 3, 1
*Elset, elset=All
 1,
*Solid Section, elset=All, controls=EC-1, material=Steel
,
*End Part
*Assembly, name=Assembly
*Instance, name=Part-1-1, part=Part-1
*End Instance
*Instance, name=Part-1-2, part=Part-1
 0., 5., 0.
 0., 5., 0., 0., 5., 1., 90.
*End Instance
*Nset, nset=Held, instance=Part-1-1
 1, 4
*Nset, nset=Held, instance=Part-1-2
 1,
*Elset, elset=_Top_S3, internal, instance=Part-1-1
 1,
*Surface, type=ELEMENT, name=Top
_Top_S3, S3
*End Assembly
*Material, name=Steel
*Elastic
1000., 0.3
*Step, name=Step-1, nlgeom=NO
*Static
1., 1.
*Boundary
Held, 1, 2
Part-1-2.Ends, 1, 1
*Cload
Part-1-1.2, 2, -1.
*End Step
";

#[test]
fn instances_repeat_their_part_with_their_own_numbers_names_and_position() {
    let deck = deck(ASSEMBLY);
    let label = |node: usize| deck.nodes[node].label;
    let labels: Vec<u64> = (0..deck.nodes.len()).map(label).collect();
    assert_eq!(labels, [11, 12, 13, 14, 21, 22, 23, 24]);
    for (node, at) in [(2, [2.0, 1.0]), (5, [0.0, 7.0]), (6, [-1.0, 7.0])] {
        let off = [0, 1].map(|k| deck.nodes[node].at[k] - at[k]);
        assert!(
            off[0].hypot(off[1]) < 1e-15,
            "{node}: {:?}",
            deck.nodes[node].at
        );
    }
    let members = |name: &str| -> Vec<u64> {
        let set = deck.node_sets.iter().find(|set| set.name == name).unwrap();
        set.members.iter().map(|&node| label(node)).collect()
    };
    assert_eq!(members("HELD"), [11, 14, 21]);
    assert_eq!(members("PART-1-1.ENDS"), [12, 13]);
    assert_eq!(members("PART-1-2.ENDS"), [22, 23]);
    assert_eq!((deck.sections.len(), deck.surfaces.len()), (2, 1));
    let step = &deck.steps[0];
    assert_eq!(label(step.forces[0].node), 12);
    assert_eq!(step.motions.len(), 2 * 3 + 2);
    let one = but(
        ASSEMBLY,
        "*Instance, name=Part-1-2",
        "*Instance, name=Part-1-1, part=Part-1\n*End Instance\n*Instance, name=Part-1-2",
    );
    assert!(refusal(&one).contains("defined twice"), "{}", refusal(&one));
    for (from, to, why) in [
        (
            "part=Part-1\n 0., 5.",
            "part=Part-2\n 0., 5.",
            "there is no *PART, NAME=PART-2 before it",
        ),
        (
            "0., 5., 1., 90.",
            "1., 5., 0., 90.",
            "the axis of rotation must be perpendicular to the plane",
        ),
        ("*End Part\n", "", "its end is missing"),
        ("Held, 1, 2", "1, 1, 2", "there is no node 1"),
    ] {
        let found = refusal(&but(ASSEMBLY, from, to));
        assert!(found.contains(why), "{found}");
    }
}

#[test]
fn a_single_instance_keeps_its_numbers_unless_the_assembly_has_one_of_them() {
    let begin = ASSEMBLY.find("*Instance, name=Part-1-2").unwrap();
    let end = ASSEMBLY
        .find("*Nset, nset=Held, instance=Part-1-1")
        .unwrap();
    let one = format!("{}{}", &ASSEMBLY[..begin], &ASSEMBLY[end..]);
    let one = but(&one, "*Nset, nset=Held, instance=Part-1-2\n 1,\n", "");
    let one = but(&one, "Part-1-2.Ends, 1, 1\n", "");
    let labels = |text: &str| -> Vec<u64> {
        let nodes = deck(text).nodes;
        nodes.iter().map(|node| node.label).collect()
    };
    assert_eq!(labels(&one), [1, 2, 3, 4]);
    let with = |node: &str| {
        but(
            &one,
            "*Nset, nset=Held",
            &format!("*Node\n{node}, 9., 9.\n*Nset, nset=Held"),
        )
    };
    assert_eq!(labels(&with("5")), [1, 2, 3, 4, 5]);
    assert_eq!(labels(&with("1")), [11, 12, 13, 14, 1]);
    let deck = deck(&with("1"));
    let force = &deck.steps[0].forces[0];
    assert_eq!(deck.nodes[force.node].label, 12);
}

#[test]
fn an_outline_takes_small_strain_moduli_and_the_largest_yield_stress_from_laws_that_the_solver_refuses()
 {
    let first = |law: &str| {
        let at = PLATES.find("*ELASTIC").unwrap();
        let text = format!("{}{law}\n{}", &PLATES[..at], &PLATES[at..]);
        assert!(refusal(&text).contains("*ELASTIC"), "{law}");
        // Without *ELASTIC, which would replace the moduli.
        let text = text.replacen("*ELASTIC", "*HEADING", 1);
        outline("job.inp", &text, &mut alone).unwrap().materials[0].clone()
    };
    // G = 2 C10 = 1, K = 2 / D1 = 4: E = 9 K G / (3 K + G), nu = E / (2 G) - 1.
    let (young, poisson) = first("*HYPERELASTIC, NEO HOOKE\n0.5, 0.5").elastic.unwrap();
    assert!((young - 36.0 / 13.0).abs() < 1e-12);
    assert!((poisson - 5.0 / 13.0).abs() < 1e-12);
    let (young, poisson) = first("*HYPERELASTIC, MOONEY-RIVLIN\n0.2, 0.3, 0")
        .elastic
        .unwrap();
    assert_eq!((young, poisson), (3.0, 0.5));
    assert_eq!(first("*PLASTIC\n235, 0\n240, 0.2").yields, Some(240.0));
}
