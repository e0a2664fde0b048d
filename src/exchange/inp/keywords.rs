//! Keywords: supported ones with their parameters and readers, ignored ones, and unsupported ones with alternatives.

use super::cards::{ANY, Card};
use super::reader::Reader;
use super::source::Done;
use Pass::{Laws, Mesh, Model, Step};

/// Treatment of a keyword.
#[derive(Debug, Clone, Copy)]
pub enum Treatment {
    /// Supported; with a note on its interpretation, if needed.
    Read(&'static str, Option<Reading>),
    /// Ignored and listed by `check`; with the reason.
    Ignored(&'static str),
    /// Unsupported; with the reason and an alternative.
    Refused(&'static str),
}

use Treatment::{Ignored, Read, Refused};

/// When and how the cards of a keyword are read.
#[derive(Debug, Clone, Copy)]
pub struct Reading {
    pub(super) pass: Pass,
    /// The supported parameters.
    pub(super) parameters: &'static [&'static str],
    pub(super) read: fn(&mut Reader, &Card<'_>) -> Done,
}

/// The passes over the cards. The last two are one pass, but cards of the model must come before the first step.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pass {
    Mesh,
    Laws,
    Model,
    Step,
}

const fn read(
    note: &'static str,
    pass: Pass,
    parameters: &'static [&'static str],
    read: fn(&mut Reader, &Card<'_>) -> Done,
) -> Treatment {
    let reading = Reading {
        pass,
        parameters,
        read,
    };
    Read(note, Some(reading))
}

const OUTPUT: &str = "output is selected on the command line";
const HEAT: &str = "it concerns the flow of heat, which is not computed";
const COUPLED: &str =
    "equations between nodes are not supported; give both bodies common nodes, or use *TIE";
const OTHER: &str = "only *STATIC steps are supported";
const INELASTIC: &str = "only isotropic, linear *ELASTIC materials are supported";
const FRAMES: &str = "other coordinate systems are not supported; write x and y";
const CHANGES: &str = "contact definitions must be the same in all steps";

/// The known keywords, in alphabetical order.
pub const KEYWORDS: &[(&str, Treatment)] = &[
    (
        "AMPLITUDE",
        read(
            "tabular, in step or total time",
            Laws,
            &["NAME", "TIME", "DEFINITION", "VALUE"],
            Reader::amplitude,
        ),
    ),
    ("ASSEMBLY", Read("as Abaqus/CAE writes it", None)),
    (
        "BEAM SECTION",
        read(
            "SECTION=RECT with its first axis across the plane: EA, EI, and GA with the shear factor 5/6",
            Model,
            &["ELSET", "MATERIAL", "SECTION"],
            Reader::beam_section,
        ),
    ),
    (
        "BOUNDARY",
        read(
            "directions 1 and 2, and 6 on beams; other zero values are fulfilled by plane problems",
            Step,
            &["OP", "AMPLITUDE", "TYPE"],
            Reader::boundary,
        ),
    ),
    ("BUCKLE", Refused(OTHER)),
    ("CFLUX", Ignored(HEAT)),
    ("CHANGE FRICTION", Refused(CHANGES)),
    ("CHANGE SURFACE BEHAVIOR", Refused(CHANGES)),
    (
        "CLOAD",
        read(
            "on axisymmetric elements, the force on the whole ring",
            Step,
            &["OP", "AMPLITUDE"],
            Reader::force,
        ),
    ),
    ("CONDUCTIVITY", Ignored(HEAT)),
    (
        "CONTACT CONTROLS",
        Ignored("this program solves contact differently"),
    ),
    (
        "CONTACT DAMPING",
        Refused("contact damping is not supported; leave it out"),
    ),
    ("CONTACT FILE", Ignored(OUTPUT)),
    ("CONTACT OUTPUT", Ignored(OUTPUT)),
    (
        "CONTACT PAIR",
        read(
            "NODE TO SURFACE; SURFACE TO SURFACE with LINEAR and TIED (HARD as node to surface, with a warning); masters are the sides of the second surface",
            Model,
            &["INTERACTION", "TYPE", "SMALLSLIDING", "ADJUST"],
            Reader::pair,
        ),
    ),
    ("CONTACT PRINT", Ignored(OUTPUT)),
    (
        "CONTROLS",
        Ignored("this program controls increments differently; see `stickslip help settings`"),
    ),
    ("COUPLED TEMPERATURE-DISPLACEMENT", Refused(OTHER)),
    ("COUPLING", Refused(COUPLED)),
    ("CREEP", Refused(INELASTIC)),
    ("CYCLIC SYMMETRY MODEL", Refused(COUPLED)),
    ("DAMPING", Ignored("it only affects *DYNAMIC steps")),
    (
        "DASHPOT",
        Refused("dashpots are not supported; only *STATIC steps are"),
    ),
    ("DEFORMATION PLASTICITY", Refused(INELASTIC)),
    (
        "DENSITY",
        read("for GRAV in *DLOAD", Laws, &[], Reader::density),
    ),
    ("DEPVAR", Refused(INELASTIC)),
    ("DFLUX", Ignored(HEAT)),
    ("DISTRIBUTING COUPLING", Refused(COUPLED)),
    ("DISTRIBUTION", Refused(FRAMES)),
    (
        "DLOAD",
        read(
            "P1 to P4, GRAV, BX and BY; pressure follows the side in steps with NLGEOM",
            Step,
            &["OP", "AMPLITUDE"],
            Reader::load,
        ),
    ),
    (
        "DSLOAD",
        read("P", Step, &["OP", "AMPLITUDE"], Reader::surface_load),
    ),
    ("DYNAMIC", Refused(OTHER)),
    ("EL FILE", Ignored(OUTPUT)),
    ("EL PRINT", Ignored(OUTPUT)),
    (
        "ELASTIC",
        read("isotropic", Laws, &["TYPE"], Reader::elastic),
    ),
    (
        "ELEMENT",
        read(
            "CPE, CPS, CAX with 3, 4, 6, 8 nodes, 4R and 8R; B21, B22, B31, B31R, B32, B32R as plane elements",
            Mesh,
            &["TYPE", "ELSET"],
            Reader::elements,
        ),
    ),
    ("ELEMENT OUTPUT", Ignored(OUTPUT)),
    (
        "ELSET",
        read(
            "",
            Mesh,
            &["ELSET", "GENERATE", "UNSORTED", "INTERNAL", "INSTANCE"],
            Reader::element_set,
        ),
    ),
    ("END ASSEMBLY", Read("", None)),
    ("END INSTANCE", Read("", None)),
    ("END PART", Read("", None)),
    ("END STEP", read("", Step, &[], Reader::end)),
    ("ENERGY FILE", Ignored(OUTPUT)),
    ("ENERGY OUTPUT", Ignored(OUTPUT)),
    ("EQUATION", Refused(COUPLED)),
    (
        "EXPANSION",
        read(
            "isotropic, with one coefficient; used by *TEMPERATURE",
            Laws,
            ANY,
            Reader::expansion,
        ),
    ),
    ("FILM", Ignored(HEAT)),
    ("FREQUENCY", Refused(OTHER)),
    (
        "FRICTION",
        read(
            "with the stick slope as the stiffness of elastic slip",
            Laws,
            &["SLIPTOLERANCE"],
            Reader::friction,
        ),
    ),
    (
        "GAP",
        Refused("gap elements are not supported; use *CONTACT PAIR"),
    ),
    ("GAP CONDUCTANCE", Ignored(HEAT)),
    ("GAP HEAT GENERATION", Ignored(HEAT)),
    ("HEADING", read("as the title", Mesh, ANY, Reader::heading)),
    ("HEAT TRANSFER", Refused(OTHER)),
    ("HYPERELASTIC", Refused(INELASTIC)),
    ("HYPERFOAM", Refused(INELASTIC)),
    (
        "INCLUDE",
        Read("files in the folder of the deck or below", None),
    ),
    (
        "INITIAL CONDITIONS",
        read(
            "TYPE=TEMPERATURE, from which *TEMPERATURE expands",
            Model,
            &["TYPE"],
            Reader::initial,
        ),
    ),
    (
        "INSTANCE",
        Read(
            "of a part of the deck, with its translation and rotation; node 12 of the k-th of several is node k 000 + 12",
            None,
        ),
    ),
    ("KINEMATIC", Refused(COUPLED)),
    ("KINEMATIC COUPLING", Refused(COUPLED)),
    ("MASS", Ignored("it only affects *DYNAMIC steps")),
    ("MATERIAL", read("", Laws, &["NAME"], Reader::material)),
    ("MODAL DYNAMIC", Refused(OTHER)),
    ("MODEL CHANGE", Refused(CHANGES)),
    ("MONITOR", Ignored(OUTPUT)),
    ("MPC", Refused(COUPLED)),
    (
        "NO ANALYSIS",
        Refused("it would disable the solve; leave it out"),
    ),
    (
        "NODE",
        read("in the plane z = 0", Mesh, &["NSET"], Reader::nodes),
    ),
    ("NODE FILE", Ignored(OUTPUT)),
    ("NODE OUTPUT", Ignored(OUTPUT)),
    (
        "NODE PRINT",
        read(
            "U of a set of at most 20 nodes, as monitors",
            Step,
            ANY,
            Reader::print,
        ),
    ),
    (
        "NSET",
        read(
            "",
            Mesh,
            &["NSET", "GENERATE", "UNSORTED", "INTERNAL", "INSTANCE"],
            Reader::node_set,
        ),
    ),
    ("ORIENTATION", Ignored("materials are isotropic")),
    ("OUTPUT", Ignored(OUTPUT)),
    ("PART", Read("", None)),
    ("PHYSICAL CONSTANTS", Ignored("it only concerns heat")),
    ("PLASTIC", Refused(INELASTIC)),
    (
        "PRE-TENSION SECTION",
        Refused(
            "pre-tension sections couple nodes by an equation, which is not supported; displace an end by *BOUNDARY instead",
        ),
    ),
    ("PREPRINT", Ignored(OUTPUT)),
    ("PRINT", Ignored(OUTPUT)),
    ("RADIATE", Ignored(HEAT)),
    ("RESTART", Ignored("use run's --snapshot to save states")),
    (
        "RIGID BODY",
        Refused(
            "rigid bodies with a reference node are not supported; fix or move all of their nodes by *BOUNDARY",
        ),
    ),
    (
        "SECTION CONTROLS",
        Ignored("hourglass control is that of this program"),
    ),
    ("SECTION PRINT", Ignored(OUTPUT)),
    (
        "SHELL SECTION",
        Refused("shells are three-dimensional; only plane elements are supported"),
    ),
    (
        "SOLID SECTION",
        read(
            "including the thickness",
            Model,
            &["ELSET", "MATERIAL", "CONTROLS", "ORIENTATION"],
            Reader::solid_section,
        ),
    ),
    ("SPECIFIC HEAT", Ignored(HEAT)),
    ("SPRING", Refused("springs are not supported")),
    (
        "STATIC",
        read(
            "the first, minimum and maximum increment and the duration of the step",
            Step,
            &["DIRECT", "SOLVER", "TIMERESET", "STABILIZE"],
            Reader::time,
        ),
    ),
    ("STEADY STATE DYNAMICS", Refused(OTHER)),
    (
        "STEP",
        read(
            "NLGEOM, INC, AMPLITUDE",
            Step,
            &[
                "NLGEOM",
                "INC",
                "AMPLITUDE",
                "NAME",
                "UNSYMM",
                "INCF",
                "INCF1",
            ],
            Reader::begin,
        ),
    ),
    (
        "SUBMODEL",
        Refused("submodels are not supported; prescribe displacements by *BOUNDARY"),
    ),
    ("SUBSTRUCTURE GENERATE", Refused(OTHER)),
    (
        "SURFACE",
        read(
            "of sides of elements, or of nodes (slaves only)",
            Mesh,
            &["NAME", "TYPE", "INTERNAL"],
            Reader::surface,
        ),
    ),
    (
        "SURFACE BEHAVIOR",
        read(
            "HARD; LINEAR as a penalty; TIED as springs in tension too, or rigidly with NODE TO SURFACE",
            Laws,
            &["PRESSUREOVERCLOSURE", "PRESSURE-OVERCLOSURE"],
            Reader::behavior,
        ),
    ),
    (
        "SURFACE INTERACTION",
        read("", Laws, &["NAME"], Reader::interaction),
    ),
    ("SYSTEM", Refused(FRAMES)),
    (
        "TEMPERATURE",
        read(
            "as a thermal expansion, uniform in each body",
            Step,
            &["OP", "AMPLITUDE"],
            Reader::temperature,
        ),
    ),
    (
        "TIE",
        read(
            "as contacts that neither open nor slide",
            Model,
            &["NAME", "POSITIONTOLERANCE", "ADJUST", "TYPE"],
            Reader::tie,
        ),
    ),
    ("TIME POINTS", Ignored(OUTPUT)),
    ("TRANSFORM", Refused(FRAMES)),
    ("UNCOUPLED TEMPERATURE-DISPLACEMENT", Refused(OTHER)),
    ("USER MATERIAL", Refused(INELASTIC)),
    ("VISCO", Refused(OTHER)),
];

/// Keywords, without spaces, that support, load or couple nodes: an outline without them is incomplete.
pub(super) const COUPLING: &[&str] = &[
    "BOUNDARY",
    "CLOAD",
    "COUPLING",
    "CYCLICSYMMETRYMODEL",
    "DISTRIBUTINGCOUPLING",
    "DLOAD",
    "DSLOAD",
    "ELEMENT",
    "EQUATION",
    "GAP",
    "KINEMATIC",
    "KINEMATICCOUPLING",
    "MPC",
    "PRE-TENSIONSECTION",
    "RIGIDBODY",
    "SPRING",
    "SUBMODEL",
    "SYSTEM",
    "TIE",
    "TRANSFORM",
];

/// How the rules on a finished run read a keyword, by its name without spaces, that the solver refuses.
pub(super) fn outlined(key: &str) -> Option<Reading> {
    let read: fn(&mut Reader, &Card<'_>) -> Done = match key {
        "PLASTIC" => Reader::plastic,
        "HYPERELASTIC" => Reader::hyperelastic,
        _ => return None,
    };
    Some(Reading {
        pass: Laws,
        parameters: ANY,
        read,
    })
}

/// Treatment of a keyword, by its name in uppercase without spaces.
pub(super) fn treatment(key: &str) -> Option<Treatment> {
    let plain = |name: &str| name.chars().filter(|c| !c.is_whitespace()).eq(key.chars());
    KEYWORDS
        .iter()
        .find(|(name, _)| plain(name))
        .map(|(_, treatment)| *treatment)
}

/// The known keyword closest to an unknown one, if any has the same beginning.
pub(super) fn nearest(key: &str) -> Option<&'static str> {
    let alike = |name: &str| {
        name.chars()
            .filter(|c| !c.is_whitespace())
            .zip(key.chars())
            .take_while(|(a, b)| a == b)
            .count()
    };
    let best = KEYWORDS.iter().max_by_key(|(name, _)| alike(name))?;
    (alike(best.0) >= 3).then_some(best.0)
}
