//! The origin of results: the program's revision, and the machine.

/// The revision that the program was built from, set by `build.rs`; development builds have none.
pub const REVISION: &str = env!("STICKSLIP_REVISION");

/// The program's version, with its revision.
pub const VERSION: &str = concat!(
    env!("CARGO_PKG_VERSION"),
    " (",
    env!("STICKSLIP_REVISION"),
    ")"
);

/// The program and its revision.
pub fn program() -> String {
    format!("stickslip {VERSION}")
}

/// The program and the machine, as shown in tables and pictures.
pub fn made_by() -> String {
    format!("{} on {}", program(), machine())
}

/// The processor's name or, if unknown, its architecture; and the number of cores.
pub fn machine() -> String {
    let cores = std::thread::available_parallelism().map_or(1, std::num::NonZero::get);
    let (system, kind) = (std::env::consts::OS, std::env::consts::ARCH);
    format!("{}, {cores} cores, {system}/{kind}", processor())
}

/// The processor's name or, if unknown, its architecture.
pub fn processor() -> String {
    let text = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
    let name = text.lines().find_map(|line| {
        let (field, value) = line.split_once(':')?;
        (field.trim() == "model name").then(|| value.trim().to_owned())
    });
    name.filter(|name| !name.is_empty())
        .unwrap_or_else(|| std::env::consts::ARCH.to_owned())
}
