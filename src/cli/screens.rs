//! `stickslip screens`: screens of the debugger as pictures.

use super::base::{Error, Exit, answer, notify, usage};
use super::front::{self, MAIN_SCREENS, MainScreen, SIZES};
use std::path::PathBuf;
use stickslip_core::counted;
use stickslip_debugger::Colours;
use stickslip_platform::files;
use stickslip_study::pen;

#[derive(Debug, clap::Args)]
#[command(after_help = "\
Without -o, lists the main screens with the scene and the keys that lead to each. With -o, draws them, each at all sizes and in \
all colours; or only those named; or the screen of SCENE after the keys of --keys. Keys are named as on page `keys` and separated \
by blanks; a command line ends with Enter: --keys 'c d', --keys ':goto 3 Enter e'. Files: DIR/NAME-80x24-dark.png.")]
pub struct Args {
    /// A main screen; with --keys, a scene
    #[arg(value_name = "SCREEN|SCENE")]
    names: Vec<String>,
    /// Keys to press after opening the scene
    #[arg(long, value_name = "KEYS")]
    keys: Option<String>,
    /// Columns and rows of the terminal [default: 80x24, 120x40 and 200x60]
    #[arg(long, value_name = "WxH", value_parser = size)]
    size: Vec<(u16, u16)>,
    /// Colours of the screen [default: dark, light and none]
    #[arg(long, value_name = "COLOURS", value_parser = clap::builder::PossibleValuesParser::new(Colours::NAMES))]
    colours: Vec<String>,
    /// Folder for the pictures
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Overwrites existing files
    #[arg(long, requires = "output")]
    force: bool,
}

pub fn main(args: &Args) -> Result<Exit, Error> {
    front::ready()?;
    let Some(folder) = &args.output else {
        return answer(&listed());
    };
    pen::ready().map_err(Error::usage)?;
    files::create_folder(folder)?;
    let chosen: Vec<Colours> = args
        .colours
        .iter()
        .filter_map(|word| Colours::from_word(word))
        .collect();
    let (sizes, colours) = (
        or_all(&args.size, &SIZES),
        or_all(&chosen, &[Colours::Dark, Colours::Light, Colours::None]),
    );
    let mut count = 0u32;
    let mut draw = |screen: &MainScreen<'_>| {
        for &(width, height) in sizes {
            let drawn = front::screenshots(screen, (width, height), colours)?;
            for (colours, bytes) in colours.iter().zip(drawn) {
                let word = colours.word().replace(' ', "-");
                let name = format!("{}-{width}x{height}-{word}.png", screen.name);
                files::write(&folder.join(name), bytes, args.force)?;
                count += 1;
            }
        }
        Ok::<_, Error>(())
    };
    match (&args.keys, &args.names[..]) {
        (Some(keys), [scene]) => draw(&MainScreen {
            name: &files::stem(scene),
            scene: Some(scene),
            keys,
        })?,
        (Some(_), _) => return Err(usage!("--keys needs one SCENE")),
        (None, names) => named(names)?.into_iter().try_for_each(draw)?,
    }
    notify(&format!(
        "wrote {} to {}",
        counted(count, "picture"),
        folder.display()
    ));
    Ok(Exit::Good)
}

fn or_all<'a, T>(given: &'a [T], all: &'a [T]) -> &'a [T] {
    match given {
        [] => all,
        given => given,
    }
}

/// The main screens with these names, or all.
fn named(names: &[String]) -> Result<Vec<&'static MainScreen<'static>>, Error> {
    if let Some(name) = names
        .iter()
        .find(|name| !MAIN_SCREENS.iter().any(|own| own.name == **name))
    {
        return Err(usage!(
            "no main screen named '{name}' (`stickslip screens` lists them; for a scene, add --keys)"
        ));
    }
    let is_wanted =
        |own: &&MainScreen<'_>| names.is_empty() || names.iter().any(|name| name == own.name);
    Ok(MAIN_SCREENS.iter().filter(is_wanted).collect())
}

fn listed() -> String {
    MAIN_SCREENS
        .iter()
        .map(|screen| {
            let scene = screen.scene.unwrap_or("(chooser)");
            let line = format!("{:<16}  {scene:<28}  {}", screen.name, screen.keys);
            line.trim_end().to_owned() + "\n"
        })
        .collect()
}

/// Reads `120x40`.
fn size(text: &str) -> Result<(u16, u16), String> {
    let (width, height) = super::export::size(text)?;
    if [width, height].iter().all(|side| (10..=400).contains(side)) {
        Ok((width, height))
    } else {
        Err("a screen has 10 to 400 columns and rows".into())
    }
}
