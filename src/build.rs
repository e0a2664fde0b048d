//! Tells the program the revision that it is built from: `STICKSLIP_REVISION` where that is set, else what git says of the
//! work tree, but only in an optimised build, so that a commit does not build all tests anew. And it compresses the font, and the texts that the program carries.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// How hard to compress.
const LEVEL: u8 = 10;
/// Files that the program carries, and folders of such.
const CARRIED: [&str; 3] = [
    "problems",
    "src/manual/pages",
    "src/attach/stickslip_attach.py",
];

fn main() {
    println!("cargo::rerun-if-env-changed=STICKSLIP_REVISION");
    let optimised = env::var("PROFILE").is_ok_and(|profile| profile == "release");
    for path in [".git/logs/HEAD", "src", "problems", "Cargo.lock"] {
        if optimised {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    for path in CARRIED {
        println!("cargo::rerun-if-changed={path}");
        carry(Path::new(path));
    }
    #[cfg(feature = "plot")]
    compress(dejavu::sans::regular(), "font.deflate");
    let given = env::var("STICKSLIP_REVISION").ok();
    let revision = given.or_else(|| optimised.then(described).flatten());
    let revision = revision.unwrap_or_else(|| "a build without a revision".into());
    println!("cargo::rustc-env=STICKSLIP_REVISION={revision}");
}

/// The last commit, and whether the work tree is another; none without git.
fn described() -> Option<String> {
    let arguments = ["describe", "--always", "--dirty"];
    let output = Command::new("git").args(arguments).output().ok()?;
    let text = String::from_utf8(output.stdout).ok()?;
    let text = text.trim();
    (output.status.success() && !text.is_empty()).then(|| text.to_owned())
}

/// Compresses a file, or all files of a folder, and of those in it.
fn carry(path: &Path) {
    if path.is_dir() {
        let entries = fs::read_dir(path).expect("a folder of the package can be listed");
        for entry in entries {
            carry(&entry.expect("a folder can be listed").path());
        }
        return;
    }
    let bytes = fs::read(path).expect("a file of the package can be read");
    compress(&bytes, Path::new("carried").join(path));
}

/// Writes what the program carries where it is taken from.
fn compress(bytes: &[u8], to: impl AsRef<Path>) {
    let folder = env::var("OUT_DIR").expect("cargo names a folder for what is made");
    let file = PathBuf::from(folder).join(to);
    let around = file.parent().expect("it is in a folder");
    fs::create_dir_all(around).expect("a folder can be made where things are made");
    let packed = miniz_oxide::deflate::compress_to_vec(bytes, LEVEL);
    fs::write(&file, packed).expect("the folder for what is made can be written");
}
