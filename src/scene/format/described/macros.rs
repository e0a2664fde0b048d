//! `described!`: defines a type of the scene file together with its walk and its entry in the reference.

/// Whether an attribute allows a field, or every field, to be omitted.
macro_rules! has_default {
    (serde($($inside:tt)*)) => { $crate::format::described::macros::has_default!(@in $($inside)*) };
    (@in default $($rest:tt)*) => { true };
    (@in $other:tt $($rest:tt)*) => { $crate::format::described::macros::has_default!(@in $($rest)*) };
    (@in) => { false };
    ($($other:tt)*) => { false };
}

/// Visits a field according to its mark.
macro_rules! walk_field {
    ($field:ident, $place:ident, $visit:ident) => {
        $crate::format::described::Described::walk(
            $field,
            &$place.field(stringify!($field)),
            $visit,
        )
    };
    ($field:ident, $place:ident, $visit:ident, given) => {
        if let Some(given) = $field {
            $crate::format::described::Described::walk(
                given,
                &$place.field(stringify!($field)),
                $visit,
            )
        }
    };
    ($field:ident, $place:ident, $visit:ident, name) => {
        let _ = $field;
    };
    ($field:ident, $place:ident, $visit:ident, skip) => {
        let _ = $field;
    };
}

/// The field's text, if it is marked as the name.
macro_rules! name_field {
    ($field:ident, name) => {
        Some($field.as_str())
    };
    ($field:ident $(, $other:ident)?) => {{
        let _ = $field;
        None
    }};
}

/// Enum variants have fields in braces or none.
macro_rules! described {
    ($(#[$($meta:tt)*])* $vis:vis struct $name:ident {
        $($(#[$($part_meta:tt)*])* $part_vis:vis $part:ident : $type:ty $(=> $mark:ident)?),* $(,)?
    }) => {
        #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        $(#[$($meta)*])*
        $vis struct $name {
            $($(#[$($part_meta)*])* $part_vis $part: $type),*
        }

        const _: () = {
            use $crate::format::described;

            #[allow(non_snake_case)]
            impl described::Described for $name {
                fn walk(
                    &mut self,
                    place: &described::ScalarPlace<'_>,
                    visit: &mut described::Visit<'_>,
                ) {
                    let $name { $($part),* } = self;
                    $(described::macros::walk_field!($part, place, visit $(, $mark)?);)*
                }
                fn called(&self) -> Option<&str> {
                    let $name { $($part),* } = self;
                    [$(described::macros::name_field!($part $(, $mark)?)),*].into_iter().flatten().next()
                }
                fn kind() -> String {
                    described::link(stringify!($name))
                }
                fn blank() -> String {
                    let every = false $(|| described::macros::has_default!($($meta)*))*;
                    described::blank_form("", &[$((
                        stringify!($part),
                        every $(|| described::macros::has_default!($($part_meta)*))*,
                        <$type as described::Described>::blank(),
                    )),*])
                }
                fn shown(&self) -> String {
                    described::OWN_DEFAULTS.to_owned()
                }
                fn types(into: &mut Vec<described::Type>) -> Result<(), String> {
                    if described::contains(into, stringify!($name)) {
                        return Ok(());
                    }
                    let every = false $(|| described::macros::has_default!($($meta)*))*;
                    let $name { $($part),* } = &described::read_blank(&Self::blank())?;
                    into.push(described::Type {
                        name: stringify!($name),
                        docs: stickslip_core::model::documented::text(&[$(stickslip_core::doc_line!($($meta)*)),*]),
                        forms: vec![described::Form {
                            name: None,
                            docs: String::new(),
                            fields: vec![$(described::field_of(
                                stringify!($part),
                                &[$(stickslip_core::doc_line!($($part_meta)*)),*],
                                $part,
                                every $(|| described::macros::has_default!($($part_meta)*))*,
                            )),*],
                        }],
                    });
                    $(<$type as described::Described>::types(into)?;)*
                    Ok(())
                }
            }
        };
    };
    ($(#[$($meta:tt)*])* $vis:vis enum $name:ident {
        $($(#[$($form_meta:tt)*])* $form:ident $({
            $($(#[$($part_meta:tt)*])* $part:ident : $type:ty $(=> $mark:ident)?),* $(,)?
        })?),* $(,)?
    }) => {
        #[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        $(#[$($meta)*])*
        $vis enum $name {
            $($(#[$($form_meta)*])* $form $({
                $($(#[$($part_meta)*])* $part: $type),*
            })?),*
        }

        const _: () = {
            use $crate::format::described;

            #[allow(non_snake_case)]
            impl described::Described for $name {
                fn walk(
                    &mut self,
                    place: &described::ScalarPlace<'_>,
                    visit: &mut described::Visit<'_>,
                ) {
                    match self {
                        $($name::$form $({ $($part),* })? => {
                            $($(described::macros::walk_field!($part, place, visit $(, $mark)?);)*)?
                        })*
                    }
                }
                fn called(&self) -> Option<&str> {
                    match self {
                        $($name::$form $({ $($part),* })? => {
                            let called: &[Option<&str>] =
                                &[$($(described::macros::name_field!($part $(, $mark)?)),*)?];
                            called.iter().copied().flatten().next()
                        })*
                    }
                }
                fn kind() -> String {
                    described::link(stringify!($name))
                }
                fn blank() -> String {
                    let all = [$(described::macros::blank_variant!($form $({
                        $((
                            stringify!($part),
                            false $(|| described::macros::has_default!($($part_meta)*))*,
                            <$type as described::Described>::blank(),
                        )),*
                    })?)),*];
                    all[0].clone()
                }
                fn shown(&self) -> String {
                    let name = match self {
                        $($name::$form { .. } => stringify!($form)),*
                    };
                    name.to_owned()
                }
                fn types(into: &mut Vec<described::Type>) -> Result<(), String> {
                    if described::contains(into, stringify!($name)) {
                        return Ok(());
                    }
                    let mut forms = Vec::new();
                    $(
                        let blank = described::macros::blank_variant!($form $({
                            $((
                                stringify!($part),
                                false $(|| described::macros::has_default!($($part_meta)*))*,
                                <$type as described::Described>::blank(),
                            )),*
                        })?);
                        let $name::$form $({ $($part),* })? = &described::read_blank(&blank)? else {
                            return Err(format!("{blank}: read as another form"));
                        };
                        forms.push(described::Form {
                            name: Some(stringify!($form)),
                            docs: stickslip_core::model::documented::text(
                                &[$(stickslip_core::doc_line!($($form_meta)*)),*],
                            ),
                            fields: vec![$($(described::field_of(
                                stringify!($part),
                                &[$(stickslip_core::doc_line!($($part_meta)*)),*],
                                $part,
                                false $(|| described::macros::has_default!($($part_meta)*))*,
                            )),*)?],
                        });
                    )*
                    into.push(described::Type {
                        name: stringify!($name),
                        docs: stickslip_core::model::documented::text(&[$(stickslip_core::doc_line!($($meta)*)),*]),
                        forms,
                    });
                    $($($(<$type as described::Described>::types(into)?;)*)?)*
                    Ok(())
                }
            }
        };
    };
}

/// The shortest text of a variant: only its name if it has no fields.
macro_rules! blank_variant {
    ($form:ident) => {
        stringify!($form).to_owned()
    };
    ($form:ident { $($fields:tt)* }) => {
        $crate::format::described::blank_form(stringify!($form), &[$($fields)*])
    };
}

pub(crate) use {blank_variant, described, has_default, name_field, walk_field};
