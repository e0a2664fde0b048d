//! The chooser: groups, what a typed text leaves, a look at the selected offer, and the ways back; and files completed at the
//! colon.

use stickslip::record::state_digest::StateDigests;
use stickslip::scene::Scene;
use stickslip::step::State;
use stickslip::teach::progress::Progress;
use stickslip::tui::Debugger;
use stickslip::tui::chooser_state;
use stickslip::tui::debugger::TerminalRequest;
use stickslip::tui::keys;
use stickslip::tui::theme::Theme;

/// The debugger without a scene, with what the program itself offers.
fn choosing() -> Debugger {
    let mut offers = chooser_state::offers(&Progress::default());
    offers.retain(|offer| offer.group != chooser_state::Group::Files);
    let mut debugger = Debugger::new(Theme::mono(), offers, None);
    debugger.settle();
    debugger
}

fn digest_of(state: &State) -> String {
    StateDigests::default().digest(state)
}

fn scene_of(debugger: &Debugger) -> Option<&str> {
    debugger
        .session
        .as_ref()
        .map(|session| session.scene().name.as_str())
}

#[test]
fn without_a_scene_there_is_the_chooser() {
    for (width, height) in [(80, 24), (120, 40), (200, 60)] {
        insta::assert_snapshot!(
            format!("chooser-{width}x{height}"),
            choosing().text(width, height)
        );
    }
    let mut debugger = choosing();
    debugger.type_keys("Down Down");
    debugger.settle();
    let at = debugger.text(80, 24);
    assert!(at.contains("▸ majors"), "{at}");
    assert!(at.contains("New here? Start with the first lesson"), "{at}");
    debugger.type_text("cantilevers-rough");
    debugger.settle();
    debugger.type_keys("Enter");
    assert_eq!(scene_of(&debugger), Some("02-two-cantilevers-rough"));
}

#[test]
fn what_is_typed_finds_scenes_and_lessons() {
    let mut debugger = choosing();
    debugger.type_text("lag");
    debugger.settle();
    for (width, height) in [(80, 24), (120, 40), (200, 60)] {
        insta::assert_snapshot!(
            format!("chooser-found-{width}x{height}"),
            debugger.text(width, height)
        );
    }
    // Letters that are keys elsewhere are letters here.
    debugger.type_keys("Backspace Backspace Backspace");
    debugger.type_text("TABLE 2 q");
    assert!(debugger.text(80, 24).contains("Choose: TABLE 2 q"));
    debugger.type_keys("Backspace Backspace");
    debugger.settle();
    let left = debugger.text(80, 24);
    assert!(left.contains("table-2"), "{left}");
    debugger.type_keys("Esc");
    debugger.type_text("reading table");
    debugger.settle();
    debugger.type_keys("Enter");
    let lesson = debugger.app.learning.lesson.as_ref().unwrap();
    assert_eq!(lesson.lesson().name, "table-2");
}

#[test]
fn escape_forgets_what_was_typed_then_goes_back_and_never_quits() {
    let press = |debugger: &mut Debugger, name: &str| debugger.key(&keys::press(name).unwrap());
    let mut debugger = choosing();
    debugger.type_text("hertz");
    assert_eq!(press(&mut debugger, "Esc"), None);
    assert!(debugger.text(80, 24).contains("type to find one"));
    assert_eq!(press(&mut debugger, "Esc"), None);
    let told = debugger.text(80, 24);
    assert!(
        told.contains("press q to quit") && told.contains("Choose"),
        "{told}"
    );
    debugger.type_keys("Enter s s o");
    let state = digest_of(&debugger.session.as_ref().unwrap().frame().state);
    debugger.type_text("osc");
    assert_eq!(press(&mut debugger, "Esc"), None);
    assert_eq!(press(&mut debugger, "Esc"), None);
    let back = debugger.text(80, 24);
    assert!(back.contains(" Slave nodes "), "{back}");
    assert_eq!(
        digest_of(&debugger.session.as_ref().unwrap().frame().state),
        state
    );
    // Only q quits, and only where nothing is typed and nothing is open.
    let mut debugger = choosing();
    assert_eq!(press(&mut debugger, "q"), Some(TerminalRequest::Quit));
}

#[test]
fn files_of_a_folder_are_offered_and_those_that_cannot_be_opened_say_why() {
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let scene = Scene::open("osc-touch2", &[]).unwrap();
    let text = stickslip::scene::builtin::find("osc-touch2")
        .unwrap()
        .text
        .to_owned();
    std::fs::write(at("接触の例.ron"), text).unwrap();
    std::fs::write(at("broken.ron"), "(title: \"x\"").unwrap();
    std::fs::write(at("notes.txt"), "").unwrap();
    let mut offers = chooser_state::files(folder.path());
    let names: Vec<String> = offers.iter().map(|offer| offer.name.clone()).collect();
    assert_eq!(names, ["broken.ron", "接触の例.ron"]);
    // Opened from where the program runs, which the test does not.
    for offer in &mut offers {
        offer.name = at(&offer.name).display().to_string();
    }
    let mut debugger = Debugger::new(Theme::mono(), offers, None);
    debugger.settle();
    let broken = debugger.text(120, 40);
    assert!(broken.contains("Your files in this folder"), "{broken}");
    assert!(
        broken.contains("expected") || broken.contains("end"),
        "{broken}"
    );
    debugger.type_keys("Down");
    debugger.settle();
    assert!(debugger.text(120, 40).contains(&scene.model.title[..30]));
    debugger.type_keys("Enter");
    assert!(scene_of(&debugger).unwrap().ends_with("接触の例.ron"));
}

#[test]
fn tab_completes_files_and_goes_on_into_folders() {
    let folder = tempfile::tempdir().unwrap();
    let deep = folder.path().join("my scenes");
    std::fs::create_dir(&deep).unwrap();
    let text = stickslip::scene::builtin::find("osc-touch2")
        .unwrap()
        .text
        .to_owned();
    std::fs::write(deep.join("one node.ron"), text).unwrap();
    std::fs::write(deep.join("one node.txt"), "").unwrap();
    let mut debugger = choosing();
    debugger.type_keys(":");
    debugger.type_text(&format!("{}/m", folder.path().display()));
    debugger.type_keys("Tab Tab");
    debugger.type_keys("Enter");
    let name = deep.join("one node.ron").display().to_string();
    assert_eq!(scene_of(&debugger), Some(name.as_str()));
}

#[test]
fn prompts_and_completions_wrap_instead_of_being_cut() {
    let mut debugger = choosing();
    debugger.type_keys(": Backspace Backspace Backspace Backspace Backspace");
    debugger.type_text("open osc");
    debugger.type_keys("Tab");
    let screen = debugger.text(80, 24);
    for scene in [
        "osc-touch2",
        "osc-coh-none",
        "osc-p5-slow",
        ":open osc-inclined-cantilever",
    ] {
        assert!(screen.contains(scene), "{scene}:\n{screen}");
    }
    insta::assert_snapshot!("completions-80x24", screen);
    debugger.type_keys("Esc");
    debugger.type_keys(": Backspace Backspace Backspace Backspace Backspace");
    let long = format!("break at {}", "1".repeat(100));
    debugger.type_text(&long);
    let rows: String = debugger.text(80, 24).lines().collect();
    assert!(rows.contains(&format!(":{}", &long[..79])), "{rows}");
    assert!(rows.contains(&"1".repeat(29)), "{rows}");
}

#[test]
fn a_journal_is_opened_where_it_was_left() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("to go on with.journal");
    let mut debugger = choosing();
    debugger.type_keys("Enter :");
    debugger.type_text(&format!("journal {}", file.display()));
    debugger.type_keys("Enter s s s s");
    let state = digest_of(&debugger.session.as_ref().unwrap().frame().state);
    // Who has it open keeps it.
    let open = format!("{}/to", folder.path().display());
    let mut other = choosing();
    other.type_keys(":");
    other.type_text(&open);
    other.type_keys("Tab Enter");
    assert!(other.session.is_none());
    assert!(
        other.text(120, 40).contains("another session"),
        "{}",
        other.text(120, 40)
    );
    drop(debugger);
    other.type_keys(":");
    other.type_text(&open);
    other.type_keys("Tab Enter");
    let session = other.session.as_ref().unwrap();
    assert_eq!(digest_of(&session.frame().state), state);
    assert!(other.text(120, 40).contains("resumed from its journal"));
    assert_eq!(session.journal().path(), Some(file.as_path()));
}
