//! Tests of typed lines and their meaning.

use super::meaning::{Action, Question, Ui};
use super::{ACTIONS, Context, complete, markdown, parse};
use crate::history::breakpoints::Condition;
use crate::history::tree::Budget;
use crate::{Command, ExportScope, Tree, Unit, Watch, WatchQuantity};
use std::path::PathBuf;
use stickslip_core::{Contact, Friction, Mode, Model, Node};
use stickslip_scene::Scene;

fn model() -> Model {
    let names = ["beam.1", "beam.4", "beam.5"];
    let nodes = names
        .map(|name| Node {
            name: name.into(),
            at: [0.0; 2],
        })
        .into();
    let slave = |node| Contact::new(node, vec![], Friction::default());
    Model {
        increment: 0.1,
        budget: 1e9,
        dofs: Default::default(),
        length: 1.0,
        ..Model::from_contacts("", nodes, vec![], vec![slave(1), slave(2)])
    }
}

fn read(line: &str) -> Result<Action, String> {
    let model = model();
    parse(
        line,
        &Context {
            model: Some(&model),
            selected: 1,
            ..Context::default()
        },
    )
    .map_err(|e| e.to_string())
}

fn forward(unit: Unit, count: u32) -> Result<Action, String> {
    Ok(Action::Session(Command::Forward { unit, count }))
}

#[test]
fn keys_and_names_are_unique() {
    let mut keys: Vec<_> = ACTIONS.iter().flat_map(|entry| entry.keys).collect();
    let mut names: Vec<_> = ACTIONS.iter().map(|entry| entry.name).collect();
    let (all_keys, all_names) = (keys.len(), names.len());
    keys.sort();
    keys.dedup();
    names.sort();
    names.dedup();
    assert_eq!((keys.len(), names.len()), (all_keys, all_names));
}

#[test]
fn motions_take_counts_prefixes_and_key_letters() {
    assert_eq!(read("step 3"), forward(Unit::Minor, 3));
    assert_eq!(read("s 3"), forward(Unit::Minor, 3));
    assert_eq!(read("ne"), forward(Unit::Major, 1));
    assert_eq!(read("  fin  "), forward(Unit::Increment, 1));
    assert_eq!(
        read("F 2"),
        Ok(Action::Session(Command::Back {
            unit: Unit::Increment,
            count: 2
        }))
    );
    assert_eq!(
        read("step 0"),
        Err("invalid count '0'; usage: step [COUNT]".into())
    );
    assert_eq!(read("step 1 2"), Err("usage: step [COUNT]".into()));
}

#[test]
fn unknown_and_ambiguous_names_are_reported() {
    assert_eq!(
        read("jump"),
        Err("unknown action 'jump'; ? lists all actions".into())
    );
    assert_eq!(read("mi"), Err("usage: minors LIMIT".into()));
    assert_eq!(read("re"), Err(
        "'re' is ambiguous: reverse-step, reverse-next, reverse-finish, reverse-continue, repeat, release, rename, remedies, reread, redraw".into()
    ));
}

#[test]
fn modes_are_forced_on_the_named_or_the_selected_node() {
    let force = |slave, mode, hold| Ok(Action::Session(Command::Force { slave, mode, hold }));
    assert_eq!(read("force beam.4 sliding"), force(0, Mode::Sliding, false));
    assert_eq!(read("force x"), force(1, Mode::Fixed, false));
    assert_eq!(read("hold fr"), force(1, Mode::Free, true));
    assert_eq!(read("force"), Ok(Action::Ui(Ui::Ask(Question::Mode))));
    assert_eq!(
        read("force beam.1 s"),
        Err("beam.1 is not a slave node; slave nodes: beam.4, beam.5".into())
    );
    assert_eq!(
        read("force tip s"),
        Err("unknown node 'tip'; slave nodes: beam.4, beam.5".into())
    );
    assert_eq!(
        read("force glued"),
        Err("invalid mode 'glued'; expected free, sliding or fixed".into())
    );
    assert_eq!(
        read("release"),
        Ok(Action::Session(Command::Release { slave: 1 }))
    );
}

#[test]
fn numbers_and_paths() {
    assert_eq!(
        read("increment 0.005"),
        Ok(Action::Session(Command::Increment(0.005)))
    );
    assert!(read("increment -1").is_err_and(|e| e.contains("invalid increment '-1'")));
    assert!(read("increment NaN").is_err());
    let set = |path: &str, value: &str| {
        Ok(Action::Session(Command::Set {
            path: path.into(),
            value: value.into(),
        }))
    };
    assert_eq!(read("set friction.angle 20"), set("friction.angle", "20"));
    assert_eq!(read("friction 20"), set("friction.angle", "20"));
    assert_eq!(read("minors 50"), set("settings.minors", "50"));
    let snapshot = |file: Option<&str>, overwrite| {
        Ok(Action::Session(Command::Snapshot {
            file: file.map(PathBuf::from),
            overwrite,
        }))
    };
    assert_eq!(read("w"), snapshot(None, false));
    assert_eq!(read("snap a b.ron"), snapshot(Some("a b.ron"), false));
    assert_eq!(read("snap! x.ron"), snapshot(Some("x.ron"), true));
    assert_eq!(read("snapshot!"), Err("usage: snapshot! FILE".into()));
}

#[test]
fn breakpoints_take_a_condition_a_node_and_a_value() {
    let set = |condition| Ok(Action::Session(Command::Break(condition)));
    let mode = |node, from, to| set(Condition::Mode { node, from, to });
    assert_eq!(read("break mode"), mode(None, None, None));
    assert_eq!(
        read("break mode sliding"),
        mode(None, None, Some(Mode::Sliding))
    );
    assert_eq!(read("break mode beam.5"), mode(Some(1), None, None));
    assert_eq!(
        read("b leaves beam.4 s"),
        mode(Some(0), Some(Mode::Sliding), None)
    );
    assert_eq!(
        read("break leaves any free"),
        mode(None, Some(Mode::Free), None)
    );
    let margin = |node, below| set(Condition::Margin { node, below });
    assert_eq!(read("break margin 1e-3"), margin(None, 1e-3));
    assert_eq!(read("break margin beam.4 -2"), margin(Some(0), -2.0));
    assert_eq!(
        read("break element"),
        set(Condition::Element { node: None })
    );
    assert_eq!(read("break cycle"), set(Condition::Cycle));
    let place = "3.2".parse().unwrap();
    assert_eq!(read("break at 3.2"), set(Condition::At(place)));
    assert_eq!(read("b"), Ok(Action::Ui(Ui::Ask(Question::Break))));
    for (line, text) in [
        ("break leaves beam.4", "usage: break leaves [NODE] MODE"),
        (
            "break mode beam.4 glued",
            "invalid mode 'glued'; expected free, sliding or fixed",
        ),
        (
            "break mode tip",
            "unknown node 'tip'; slave nodes: beam.4, beam.5",
        ),
        ("break margin", "usage: break margin [NODE] VALUE"),
        (
            "break margin beam.4 NaN",
            "invalid margin 'NaN'; expected a number",
        ),
        ("break cycle 2", "usage: break cycle "),
        (
            "break at 0",
            "invalid position '0'; expected INC[.MAJOR[.MINOR]]",
        ),
        (
            "break dance",
            "unknown condition 'dance'; conditions: mode, leaves, margin, element, cycle, residual, failure, at",
        ),
        (
            "delete x",
            "invalid breakpoint number 'x'; usage: delete NUMBER|all",
        ),
    ] {
        assert_eq!(read(line), Err(text.into()), "{line}");
    }
    assert_eq!(
        read("disable all"),
        Ok(Action::Session(Command::Enable {
            id: None,
            on: false
        }))
    );
    assert_eq!(
        read("delete 2"),
        Ok(Action::Session(Command::Delete(Some(2))))
    );
}

#[test]
fn watches_have_a_given_or_a_default_name() {
    let watch = |name: &str, quantity, slave| {
        let name = name.into();
        Ok(Action::Session(Command::Watch(Watch {
            name,
            quantity,
            slave,
        })))
    };
    assert_eq!(
        read("watch gap"),
        watch("gap beam.5", WatchQuantity::Gap, 1)
    );
    assert_eq!(
        read("watch f_n beam.4 as heel force"),
        watch("heel force", WatchQuantity::NormalForce, 0)
    );
    assert_eq!(
        read("watch residual"),
        watch("residual", WatchQuantity::Residual, 0)
    );
    assert_eq!(
        read("watch temperature"),
        Err("cannot watch 'temperature'; quantities: gap, f_n, f_t, t_max, slip, margin, residual, interface".into())
    );
    assert!(read("watch gap as").is_err() && read("watch residual beam.4").is_err());
}

#[test]
fn finding_wraps_around_from_the_selected_node() {
    assert_eq!(read("node beam.5"), Ok(Action::Ui(Ui::Select(1))));
    assert_eq!(read("/ beam"), Ok(Action::Ui(Ui::Select(0))));
    assert!(read("node wall").is_err());
}

#[test]
fn a_census_takes_nodes_by_name_or_by_index() {
    let census = |slaves: &[usize]| Ok(Action::Session(Command::Census(slaves.to_vec())));
    assert_eq!(read("census"), census(&[]));
    assert_eq!(read("census beam.5"), census(&[1]));
    assert_eq!(read("census beam.5,beam.4"), census(&[0, 1]));
    assert_eq!(read("census 2, 1 2"), census(&[0, 1]));
    assert!(read("census 3").is_err_and(|e| e.contains("unknown node '3'")));
    assert!(read("census 0").is_err() && read("census beam.1").is_err());
}

#[test]
fn export_requires_a_file_name() {
    let export = |what, file: &str, overwrite| {
        Ok(Action::Session(Command::Export {
            what,
            file: file.into(),
            overwrite,
        }))
    };
    assert_eq!(
        read("core a b.ron"),
        export(ExportScope::Core, "a b.ron", false)
    );
    assert_eq!(read("export! x"), export(ExportScope::Shown, "x", true));
    assert_eq!(
        read("export --frozen a b.ron"),
        export(ExportScope::Whole, "a b.ron", false)
    );
    assert_eq!(
        read("export --frozen.svg"),
        export(ExportScope::Shown, "--frozen.svg", false)
    );
    assert!(read("export --frozen").is_err());
    assert_eq!(read("core"), Err("usage: core FILE".into()));
    assert_eq!(
        read("export!"),
        Err("usage: export! [--frozen] FILE".into())
    );
}

#[test]
fn branches_complete_by_number_and_by_label() {
    let model = std::sync::Arc::new(Scene::open("osc-two6", &[]).unwrap().model);
    let start = stickslip_core::step::stepper::Stepper::new(model.clone())
        .state()
        .clone();
    let tree = Tree::new(model, start, Budget::default());
    let context = Context {
        tree: Some(&tree),
        ..Context::default()
    };
    let label = &tree.branches()[0].label;
    let all = complete("branch ", &context);
    assert_eq!(all, ["branch b1".to_owned(), format!("branch {label}")]);
    assert_eq!(complete("compare b", &context), ["compare b1"]);
    assert!(complete("branch x", &context).is_empty());
}

#[test]
fn completion_offers_names_nodes_paths_and_values() {
    let model = model();
    let scenes = ["01-pinned".to_string()];
    let context = Context {
        model: Some(&model),
        scenes: &scenes,
        ..Context::default()
    };
    let ask = |line: &str| complete(line, &context);
    assert_eq!(ask("ste"), ["step"]);
    assert_eq!(
        ask("force beam.5 f"),
        ["force beam.5 free", "force beam.5 fixed"]
    );
    assert_eq!(ask("release b"), ["release beam.4", "release beam.5"]);
    let strategies = ["ladder", "least", "lemke"].map(|s| format!("set settings.strategy {s}"));
    assert_eq!(ask("set settings.strategy l"), strategies);
    assert_eq!(
        ask("set settings.to"),
        ["set settings.touch", "set settings.tolerance"]
    );
    let both = ["census beam.4,beam.4", "census beam.4,beam.5"];
    assert_eq!(ask("census beam.4,b"), both);
    assert_eq!(
        ask("set friction."),
        ["set friction.angle", "set friction.cohesion"]
    );
    assert_eq!(ask("set settings.ties p"), ["set settings.ties printed"]);
    assert_eq!(ask("break m"), ["break mode", "break margin"]);
    assert_eq!(ask("break margin beam.4"), ["break margin beam.4"]);
    assert_eq!(
        ask("break leaves beam.4 s"),
        ["break leaves beam.4 sliding"]
    );
    assert_eq!(ask("watch f_"), ["watch f_n", "watch f_t"]);
    assert_eq!(ask("open 01"), ["open 01-pinned"]);
    assert!(ask("nonsense ").is_empty());
}

#[test]
fn markdown_names_every_action_once() {
    let text = markdown();
    for entry in ACTIONS {
        let name = format!("{} {}", entry.name, entry.arguments);
        let [name, help] = [name.trim_end(), entry.help].map(|t| t.replace('|', "\\|"));
        let end = format!("| `{name}` | {help} |");
        let rows = text.lines().filter(|row| row.ends_with(&end));
        // An unescaped bar would start another column.
        let columns = |row: &str| row.replace("\\|", "").matches('|').count() - 1;
        assert_eq!(rows.map(columns).collect::<Vec<_>>(), [3], "{}", entry.name);
    }
}
