//! The words of an enum of unit variants, as serde reads and writes them.

use crate::format::notation::line;
use serde::de::value::Error as Unread;
use serde::de::{DeserializeOwned, Deserializer, Error, IntoDeserializer, Visitor};
use serde::{Serialize, forward_to_deserialize_any};

/// The words that serde reads for an enum of unit variants.
pub(super) fn words<T: DeserializeOwned>() -> &'static [&'static str] {
    struct Ask<'a>(&'a mut &'static [&'static str]);
    impl<'de> Deserializer<'de> for Ask<'_> {
        type Error = Unread;
        fn deserialize_any<V: Visitor<'de>>(self, _: V) -> Result<V::Value, Unread> {
            Err(Unread::custom("expected an enum"))
        }
        fn deserialize_enum<V: Visitor<'de>>(
            self,
            _: &'static str,
            variants: &'static [&'static str],
            _: V,
        ) -> Result<V::Value, Unread> {
            *self.0 = variants;
            Err(Unread::custom("no value"))
        }
        forward_to_deserialize_any! {
            bool i8 i16 i32 i64 i128 u8 u16 u32 u64 u128 f32 f64 char str string bytes byte_buf option unit unit_struct
            newtype_struct seq tuple tuple_struct map struct identifier ignored_any
        }
    }
    let mut found: &'static [&'static str] = &[];
    // Deserialization always fails here: it only captures the list of variants.
    let _ = T::deserialize(Ask(&mut found));
    found
}

/// The word that serde writes for a value of an enum of unit variants.
pub(super) fn word(value: &impl Serialize) -> String {
    line(value).unwrap_or_default()
}

/// The enum value for a word, if there is one.
pub(super) fn of_word<T: DeserializeOwned>(word: &str) -> Option<T> {
    let word: serde::de::value::StrDeserializer<'_, Unread> = word.into_deserializer();
    T::deserialize(word).ok()
}

#[cfg(test)]
mod tests {
    use super::*;
    use stickslip_core::model::{Law, Strategy};

    #[test]
    fn words_are_written_as_they_are_read() {
        for name in words::<Strategy>() {
            let value: Strategy = of_word(name).unwrap();
            assert_eq!(word(&value), **name);
        }
        assert_eq!(words::<Strategy>(), Strategy::NAMES);
        assert_eq!(words::<Law>(), ["svk", "neohookean"]);
        assert_eq!(of_word::<Law>("steel"), None);
        assert_eq!(Strategy::DOCS.parts.len(), Strategy::NAMES.len());
    }
}
