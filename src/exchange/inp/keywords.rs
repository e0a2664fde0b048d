//! Keywords: which are read, which make no difference here, and which cannot be read, with what would be right.

/// What becomes of a keyword.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Treatment {
    /// It is read; the words say how, where there is something to say.
    Read(&'static str),
    /// It is passed over, and `check` lists it; the words say why.
    Ignored(&'static str),
    /// It cannot be read; the words say why, and what would be right.
    Refused(&'static str),
}

use Treatment::{Ignored, Read, Refused};

const OUTPUT: &str = "what is written is chosen by the command";
const HEAT: &str = "it acts with temperatures only, and there are none";
const COUPLED: &str =
    "nodes cannot be bound to one another by equations; give both bodies common nodes, or use *TIE";
const OTHER: &str = "only *STATIC steps can be read";
const INELASTIC: &str = "only *ELASTIC materials, isotropic and linear, can be read";
const ASSEMBLED: &str = "parts and assemblies cannot be read; write the deck flat (in Abaqus/CAE: Model, Edit Attributes, \"Do not use \
                         parts and assemblies in input files\")";
const FRAMES: &str = "components in other frames cannot be read; write x and y";
const CHANGES: &str = "contact must stay what it is over all steps";

/// The keywords that are known, in the order of the alphabet.
pub const KEYWORDS: &[(&str, Treatment)] = &[
    (
        "AMPLITUDE",
        Read("tabular, in the step's or the total time"),
    ),
    ("ASSEMBLY", Refused(ASSEMBLED)),
    (
        "BEAM SECTION",
        Read(
            "SECTION=RECT with its first axis across the plane: EA, EI, and GA with the shear factor 5/6",
        ),
    ),
    (
        "BOUNDARY",
        Read(
            "directions 1 and 2, and 6 on beams; others that are held at 0 hold themselves in the plane",
        ),
    ),
    ("BUCKLE", Refused(OTHER)),
    ("CHANGE FRICTION", Refused(CHANGES)),
    ("CHANGE SURFACE BEHAVIOR", Refused(CHANGES)),
    (
        "CLOAD",
        Read("on axisymmetric elements the force on the whole ring"),
    ),
    ("CONDUCTIVITY", Ignored(HEAT)),
    (
        "CONTACT CONTROLS",
        Ignored("contact is solved in another way"),
    ),
    (
        "CONTACT DAMPING",
        Refused("contact has no damping; leave it out"),
    ),
    ("CONTACT FILE", Ignored(OUTPUT)),
    ("CONTACT OUTPUT", Ignored(OUTPUT)),
    (
        "CONTACT PAIR",
        Read("both types node to surface; masters are the sides of the second surface"),
    ),
    ("CONTACT PRINT", Ignored(OUTPUT)),
    (
        "CONTROLS",
        Ignored("increments are solved and cut in another way; see `stickslip help settings`"),
    ),
    ("COUPLED TEMPERATURE-DISPLACEMENT", Refused(OTHER)),
    ("COUPLING", Refused(COUPLED)),
    ("CREEP", Refused(INELASTIC)),
    ("CYCLIC SYMMETRY MODEL", Refused(COUPLED)),
    ("DAMPING", Ignored("it acts in *DYNAMIC steps only")),
    (
        "DASHPOT",
        Refused("dashpots cannot be read; only *STATIC steps can"),
    ),
    ("DEFORMATION PLASTICITY", Refused(INELASTIC)),
    ("DENSITY", Read("for GRAV in *DLOAD")),
    ("DEPVAR", Refused(INELASTIC)),
    ("DISTRIBUTING COUPLING", Refused(COUPLED)),
    ("DISTRIBUTION", Refused(FRAMES)),
    (
        "DLOAD",
        Read("P1 to P4, GRAV, BX and BY; pressure follows the side in steps with NLGEOM"),
    ),
    ("DSLOAD", Read("P")),
    ("DYNAMIC", Refused(OTHER)),
    ("EL FILE", Ignored(OUTPUT)),
    ("EL PRINT", Ignored(OUTPUT)),
    ("ELASTIC", Read("isotropic")),
    (
        "ELEMENT",
        Read(
            "CPE, CPS, CAX with 3, 4, 6, 8 nodes and 8R; B21, B22, B31, B31R, B32, B32R in the plane",
        ),
    ),
    ("ELEMENT OUTPUT", Ignored(OUTPUT)),
    ("ELSET", Read("")),
    ("END ASSEMBLY", Refused(ASSEMBLED)),
    ("END INSTANCE", Refused(ASSEMBLED)),
    ("END PART", Refused(ASSEMBLED)),
    ("END STEP", Read("")),
    ("ENERGY FILE", Ignored(OUTPUT)),
    ("ENERGY OUTPUT", Ignored(OUTPUT)),
    ("EQUATION", Refused(COUPLED)),
    ("EXPANSION", Ignored(HEAT)),
    ("FILM", Refused("only mechanical loads can be read")),
    ("FREQUENCY", Refused(OTHER)),
    (
        "FRICTION",
        Read("the stick slope as the stiffness of elastic slip"),
    ),
    (
        "GAP",
        Refused("gap elements cannot be read; use *CONTACT PAIR"),
    ),
    ("GAP CONDUCTANCE", Ignored(HEAT)),
    ("HEADING", Read("as the title")),
    ("HEAT TRANSFER", Refused(OTHER)),
    ("HYPERELASTIC", Refused(INELASTIC)),
    ("HYPERFOAM", Refused(INELASTIC)),
    (
        "INCLUDE",
        Read("files beside the deck or in folders below it"),
    ),
    (
        "INITIAL CONDITIONS",
        Ignored("TYPE=TEMPERATURE only, since there are no other temperatures"),
    ),
    ("INSTANCE", Refused(ASSEMBLED)),
    ("KINEMATIC", Refused(COUPLED)),
    ("KINEMATIC COUPLING", Refused(COUPLED)),
    ("MASS", Ignored("it acts in *DYNAMIC steps only")),
    ("MATERIAL", Read("")),
    ("MODAL DYNAMIC", Refused(OTHER)),
    ("MODEL CHANGE", Refused(CHANGES)),
    ("MONITOR", Ignored(OUTPUT)),
    ("MPC", Refused(COUPLED)),
    (
        "NO ANALYSIS",
        Refused("nothing would be solved; leave it out"),
    ),
    ("NODE", Read("in the plane z = 0")),
    ("NODE FILE", Ignored(OUTPUT)),
    ("NODE OUTPUT", Ignored(OUTPUT)),
    (
        "NODE PRINT",
        Read("U of a set of at most 20 nodes, as monitors"),
    ),
    ("NSET", Read("")),
    ("ORIENTATION", Refused(FRAMES)),
    ("OUTPUT", Ignored(OUTPUT)),
    ("PART", Refused(ASSEMBLED)),
    ("PHYSICAL CONSTANTS", Ignored("it acts with heat only")),
    ("PLASTIC", Refused(INELASTIC)),
    (
        "PRE-TENSION SECTION",
        Refused(
            "a pre-tension section binds nodes by an equation; press or move an end instead, by *BOUNDARY",
        ),
    ),
    ("PREPRINT", Ignored(OUTPUT)),
    ("PRINT", Ignored(OUTPUT)),
    ("RADIATE", Refused("only mechanical loads can be read")),
    (
        "RESTART",
        Ignored("states are kept in snapshots, by --snapshot of run"),
    ),
    (
        "RIGID BODY",
        Refused(
            "rigid bodies with a reference node cannot be read; hold or move all nodes of it by *BOUNDARY",
        ),
    ),
    ("SECTION PRINT", Ignored(OUTPUT)),
    (
        "SHELL SECTION",
        Refused("shells are elements of space; only those of the plane can be read"),
    ),
    ("SOLID SECTION", Read("the thickness too")),
    ("SPECIFIC HEAT", Ignored(HEAT)),
    ("SPRING", Refused("springs cannot be read")),
    (
        "STATIC",
        Read("the first, least and largest increment and the step's period"),
    ),
    ("STEADY STATE DYNAMICS", Refused(OTHER)),
    ("STEP", Read("NLGEOM, INC, AMPLITUDE")),
    (
        "SUBMODEL",
        Refused("submodels cannot be read; write the motion by *BOUNDARY"),
    ),
    ("SUBSTRUCTURE GENERATE", Refused(OTHER)),
    (
        "SURFACE",
        Read("of sides of elements, or of nodes (slaves only)"),
    ),
    (
        "SURFACE BEHAVIOR",
        Read("HARD; LINEAR as a penalty; TIED as LINEAR in tension too"),
    ),
    ("SURFACE INTERACTION", Read("")),
    (
        "TEMPERATURE",
        Refused(
            "thermal expansion cannot be read; leave the temperatures out, or press by *BOUNDARY",
        ),
    ),
    ("TIE", Read("as a contact that neither opens nor slides")),
    ("TIME POINTS", Ignored(OUTPUT)),
    ("TRANSFORM", Refused(FRAMES)),
    ("UNCOUPLED TEMPERATURE-DISPLACEMENT", Refused(OTHER)),
    ("USER MATERIAL", Refused(INELASTIC)),
    ("VISCO", Refused(OTHER)),
];

/// What becomes of a keyword, by its name in capitals and without blanks.
pub(super) fn treatment(key: &str) -> Option<Treatment> {
    let plain = |name: &str| name.chars().filter(|c| !c.is_whitespace()).eq(key.chars());
    KEYWORDS
        .iter()
        .find(|(name, _)| plain(name))
        .map(|(_, treatment)| *treatment)
}

/// The keyword that is most like one that is not known, if one begins alike.
pub(super) fn nearest(key: &str) -> Option<&'static str> {
    let alike = |name: &str| {
        let letters = name.chars().filter(|c| !c.is_whitespace());
        letters.zip(key.chars()).take_while(|(a, b)| a == b).count()
    };
    let best = KEYWORDS.iter().max_by_key(|(name, _)| alike(name))?;
    (alike(best.0) >= 3).then_some(best.0)
}
