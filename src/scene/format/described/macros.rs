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
        if $field.is_some() {
            $crate::format::described::macros::walk_field!($field, $place, $visit)
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

/// Defines a type and describes it. Enum variants have fields in braces or none.
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

        $crate::format::described::macros::describe! {
            $name, stringify!($name), &[$(stickslip_core::doc_line!($($meta)*)),*],
            false $(|| $crate::format::described::macros::has_default!($($meta)*))*,
            [$name, None, &[], { $(
                $part $(=> $mark)?,
                &[$(stickslip_core::doc_line!($($part_meta)*)),*],
                false $(|| $crate::format::described::macros::has_default!($($part_meta)*))*,
                <$type as $crate::format::described::Described>::blank();
            )* }]
        }
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

        $crate::format::described::macros::describe! {
            $name, stringify!($name), &[$(stickslip_core::doc_line!($($meta)*)),*], false,
            $([$name::$form, Some(stringify!($form)), &[$(stickslip_core::doc_line!($($form_meta)*)),*], { $($(
                $part $(=> $mark)?,
                &[$(stickslip_core::doc_line!($($part_meta)*)),*],
                false $(|| $crate::format::described::macros::has_default!($($part_meta)*))*,
                <$type as $crate::format::described::Described>::blank();
            )*)? }])*
        }
    };
}

/// Describes a type: its name and docs, whether all fields may be omitted, and its forms, of which a struct has one without a
/// name. A field has its docs, whether it may be omitted, and its text in a blank form.
macro_rules! describe {
    ($name:ident, $title:expr, $docs:expr, $every:expr, $([
        $($path:ident)::+, $form:expr, $form_docs:expr, {
            $($part:ident $(=> $mark:ident)?, $part_docs:expr, $optional:expr, $blank:expr;)*
        }
    ])+) => {
        const _: () = {
            use $crate::format::described;

            fn blanks() -> Vec<String> {
                vec![$(described::blank_form(
                    $form,
                    &[$((stringify!($part), $every || $optional, $blank)),*],
                )),+]
            }

            #[allow(non_snake_case, irrefutable_let_patterns)]
            impl described::Described for $name {
                fn walk(
                    &mut self,
                    place: &described::ScalarPlace<'_>,
                    visit: &mut described::Visit<'_>,
                ) {
                    match self {
                        $($($path)::+ { $($part),* } => {
                            $(described::macros::walk_field!($part, place, visit $(, $mark)?);)*
                        })+
                    }
                }

                fn called(&self) -> Option<&str> {
                    match self {
                        $($($path)::+ { $($part),* } => {
                            let called: &[Option<&str>] =
                                &[$(described::macros::name_field!($part $(, $mark)?)),*];
                            called.iter().copied().flatten().next()
                        })+
                    }
                }

                fn kind() -> String {
                    described::link($title)
                }

                fn blank() -> String {
                    blanks().swap_remove(0)
                }

                fn shown(&self) -> String {
                    let form: Option<&str> = match self {
                        $($($path)::+ { .. } => $form),+
                    };
                    form.unwrap_or(described::OWN_DEFAULTS).to_owned()
                }

                fn types(into: &mut Vec<described::Type>) -> Result<(), String> {
                    if described::contains(into, $title) {
                        return Ok(());
                    }
                    let place = into.len();
                    into.push(described::Type {
                        name: $title,
                        docs: stickslip_core::model::documented::text($docs),
                        forms: Vec::new(),
                    });
                    let mut blanks = blanks().into_iter();
                    $(
                        let blank = blanks.next().unwrap_or_default();
                        let $($path)::+ { $($part),* } = &described::read_blank(&blank)? else {
                            return Err(format!("{blank}: read as another form"));
                        };
                        into[place].forms.push(described::Form {
                            name: $form,
                            docs: stickslip_core::model::documented::text($form_docs),
                            fields: vec![$(described::field_of(
                                stringify!($part),
                                $part_docs,
                                $part,
                                $every || $optional,
                            )),*],
                        });
                        $(described::types_of($part, into)?;)*
                    )+
                    Ok(())
                }
            }
        };
    };
}

pub(crate) use {describe, described, has_default, name_field, walk_field};
