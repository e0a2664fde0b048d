//! Keywords: supported ones with their parameters and readers, ignored ones, and unsupported ones with alternatives.

use super::cards::{ANY, Card};
use super::reader::Reader;
use super::source::Done;
use Pass::{Laws, Mesh, Model, Step};
use std::sync::LazyLock;

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

/// The known keywords, in alphabetical order.
pub static KEYWORDS: LazyLock<Vec<(&str, Treatment)>> = LazyLock::new(|| {
    let alike = ALIKE
        .iter()
        .flat_map(|(treatment, names)| names.iter().map(|name| (*name, *treatment)));
    let mut all: Vec<(&str, Treatment)> = alike.chain(ONE_BY_ONE.iter().copied()).collect();
    all.sort_unstable_by_key(|(name, _)| *name);
    all
});

/// Keywords with a common reason.
const ALIKE: &[(Treatment, &[&str])] = &[
    (
        Refused("only *STATIC steps are supported"),
        &[
            "BUCKLE",
            "COUPLED TEMPERATURE-DISPLACEMENT",
            "DYNAMIC",
            "FREQUENCY",
            "HEAT TRANSFER",
            "MODAL DYNAMIC",
            "STEADY STATE DYNAMICS",
            "SUBSTRUCTURE GENERATE",
            "UNCOUPLED TEMPERATURE-DISPLACEMENT",
            "VISCO",
        ],
    ),
    (
        Ignored("it concerns the flow of heat, which is not computed"),
        &[
            "CFLUX",
            "CONDUCTIVITY",
            "DFLUX",
            "FILM",
            "GAP CONDUCTANCE",
            "GAP HEAT GENERATION",
            "RADIATE",
            "SPECIFIC HEAT",
        ],
    ),
    (
        Refused("contact definitions must be the same in all steps"),
        &["CHANGE FRICTION", "CHANGE SURFACE BEHAVIOR", "MODEL CHANGE"],
    ),
    (
        Ignored("output is selected on the command line"),
        &[
            "CONTACT FILE",
            "CONTACT OUTPUT",
            "CONTACT PRINT",
            "EL FILE",
            "EL PRINT",
            "ELEMENT OUTPUT",
            "ENERGY FILE",
            "ENERGY OUTPUT",
            "MONITOR",
            "NODE FILE",
            "NODE OUTPUT",
            "OUTPUT",
            "PREPRINT",
            "PRINT",
            "SECTION PRINT",
            "TIME POINTS",
        ],
    ),
    (
        Refused(
            "equations between nodes are not supported; give both bodies common nodes, or use *TIE",
        ),
        &[
            "COUPLING",
            "CYCLIC SYMMETRY MODEL",
            "DISTRIBUTING COUPLING",
            "EQUATION",
            "KINEMATIC",
            "KINEMATIC COUPLING",
            "MPC",
        ],
    ),
    (
        Refused("only isotropic, linear *ELASTIC materials are supported"),
        &[
            "CREEP",
            "DEFORMATION PLASTICITY",
            "DEPVAR",
            "HYPERELASTIC",
            "HYPERFOAM",
            "PLASTIC",
            "USER MATERIAL",
        ],
    ),
    (
        Refused("other coordinate systems are not supported; write x and y"),
        &["DISTRIBUTION", "SYSTEM", "TRANSFORM"],
    ),
];

/// The other keywords.
const ONE_BY_ONE: &[(&str, Treatment)] = &[
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
    (
        "CLOAD",
        read(
            "on axisymmetric elements, the force on the whole ring",
            Step,
            &["OP", "AMPLITUDE"],
            Reader::force,
        ),
    ),
    (
        "CONTACT CONTROLS",
        Ignored("this program solves contact differently"),
    ),
    (
        "CONTACT DAMPING",
        Refused("contact damping is not supported; leave it out"),
    ),
    (
        "CONTACT PAIR",
        read(
            "NODE TO SURFACE; SURFACE TO SURFACE with LINEAR and TIED (HARD as node to surface, with a note); masters are the sides of the second surface",
            Model,
            &["INTERACTION", "TYPE", "SMALLSLIDING", "ADJUST"],
            Reader::pair,
        ),
    ),
    (
        "CONTROLS",
        Ignored("this program controls increments differently; see `stickslip help settings`"),
    ),
    ("DAMPING", Ignored("it only affects *DYNAMIC steps")),
    (
        "DASHPOT",
        Refused("dashpots are not supported; only *STATIC steps are"),
    ),
    (
        "DENSITY",
        read("for GRAV in *DLOAD", Laws, &[], Reader::density),
    ),
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
    (
        "EXPANSION",
        read(
            "isotropic, with one coefficient; used by *TEMPERATURE",
            Laws,
            &["TYPE", "ZERO"],
            Reader::expansion,
        ),
    ),
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
    ("HEADING", read("as the title", Mesh, ANY, Reader::heading)),
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
    ("MASS", Ignored("it only affects *DYNAMIC steps")),
    ("MATERIAL", read("", Laws, &["NAME"], Reader::material)),
    (
        "NO ANALYSIS",
        Refused("it would disable the solve; leave it out"),
    ),
    (
        "NODE",
        read("in the plane z = 0", Mesh, &["NSET"], Reader::nodes),
    ),
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
    ("PART", Read("", None)),
    ("PHYSICAL CONSTANTS", Ignored("it only concerns heat")),
    (
        "PRE-TENSION SECTION",
        Refused(
            "pre-tension sections couple nodes by an equation, which is not supported; displace an end by *BOUNDARY instead",
        ),
    ),
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
            &["PRESSURE-OVERCLOSURE"],
            Reader::behavior,
        ),
    ),
    (
        "SURFACE INTERACTION",
        read("", Laws, &["NAME"], Reader::interaction),
    ),
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
