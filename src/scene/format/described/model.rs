//! Types that the scene file shares with the solver: defined with [`documented!`](stickslip_core::model::documented) and listed
//! here.

use super::macros::describe;
use super::types::{Type, contains, lines_of, of_words};
use super::words::{of_word, word, words};
use super::{Choice, Described, Scalar, ScalarPlace, Visit, one_of};
use stickslip_core::model::{
    AtCycle, AtLimit, Axis, Geometry, LinearSolver, PointForce, Refactor, ResidualMethod,
    SlavePoints, SlipCount, Sticking, TieRule,
};
use stickslip_core::{
    BoundUpdate, Component, Control, ElementKind, Friction, InitialGaps, InitialState, Jumps, Law,
    Mode, Plane, SearchBudget, SearchMode, Settings, Strategy, Touch, Update,
};

macro_rules! fields {
    ($name:ident { $($part:ident),* $(,)? }) => {
        describe! {
            $name, $name::DOCS.name, $name::DOCS.lines, true,
            [$name, None, &[], { $(
                $part, lines_of(&$name::DOCS, stringify!($part)), true, String::new();
            )* }]
        }
    };
}

macro_rules! words {
    ($($type:ident),* $(,)?) => {
        $(
            impl Choice for $type {
                fn names(&self) -> &'static [&'static str] {
                    words::<$type>()
                }
                fn name(&self) -> String {
                    word(self)
                }
                fn choose(&mut self, name: &str) -> bool {
                    of_word(name).map(|value| *self = value).is_some()
                }
            }

            impl Described for $type {
                fn walk(&mut self, place: &ScalarPlace<'_>, visit: &mut Visit<'_>) {
                    visit(place, Scalar::Choice(self));
                }
                fn kind() -> String {
                    one_of(words::<$type>())
                }
                fn blank() -> String {
                    words::<$type>().first().copied().unwrap_or_default().to_owned()
                }
                fn shown(&self) -> String {
                    word(self)
                }
                fn types(into: &mut Vec<Type>) -> Result<(), String> {
                    if !contains(into, $type::DOCS.name) {
                        into.push(of_words(&$type::DOCS, words::<$type>()));
                    }
                    Ok(())
                }
            }
        )*
    };
}

fields!(Friction { angle, cohesion });
fields!(InitialState {
    f_n,
    f_t,
    t_max,
    slip,
    ratio
});
fields!(Settings {
    strategy,
    residual,
    solver,
    factor,
    geometry,
    point_force,
    t_max,
    slip,
    sticking,
    touch,
    ties,
    minors,
    majors,
    at_minor_limit,
    at_cycle,
    at_major_limit,
    tolerance,
    limit_load,
    matrix_accuracy,
    search,
    initial_gaps,
    adjust_gap,
    memory,
});
words!(
    AtCycle,
    AtLimit,
    Axis,
    Component,
    BoundUpdate,
    Geometry,
    InitialGaps,
    Control,
    ElementKind,
    Jumps,
    Law,
    Mode,
    Plane,
    PointForce,
    Refactor,
    ResidualMethod,
    SlavePoints,
    SlipCount,
    LinearSolver,
    Sticking,
    Strategy,
    TieRule,
    Touch,
    Update,
);

impl Choice for SearchBudget {
    fn names(&self) -> &'static [&'static str] {
        words::<SearchMode>()
    }
    fn name(&self) -> String {
        match self {
            SearchBudget::Mode(mode) => word(mode),
            SearchBudget::Limit(most) => most.to_string(),
        }
    }
    fn accepts(&self) -> String {
        Self::kind()
    }
    fn choose(&mut self, name: &str) -> bool {
        let mode = of_word(name).map(SearchBudget::Mode);
        let limit = || name.parse().ok().map(SearchBudget::Limit);
        mode.or_else(limit).map(|value| *self = value).is_some()
    }
}

impl Described for SearchBudget {
    fn walk(&mut self, place: &ScalarPlace<'_>, visit: &mut Visit<'_>) {
        visit(place, Scalar::Choice(self));
    }
    fn kind() -> String {
        format!("{}, or a whole number", one_of(words::<SearchMode>()))
    }
    fn blank() -> String {
        "auto".to_owned()
    }
    fn shown(&self) -> String {
        self.name()
    }
    fn types(into: &mut Vec<Type>) -> Result<(), String> {
        if !contains(into, SearchMode::DOCS.name) {
            into.push(of_words(&SearchMode::DOCS, words::<SearchMode>()));
        }
        Ok(())
    }
}
