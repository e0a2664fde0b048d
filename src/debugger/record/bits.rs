//! A digest of the bits of a value: 64 bits over all its numbers, texts, field names and lengths.
//!
//! Words go to four sums in turn, so that consecutive multiplications do not wait for one another. A word enters its sum by steps
//! that can be undone, so that any single changed word changes the digest. All NaN are equal. The digest detects accidental changes;
//! it is not a signature.

use serde::ser::{self, Serialize, Serializer};
use std::fmt;

/// An odd number with ones and zeros everywhere: the fraction of the golden ratio.
const FACTOR: u64 = 0x9e37_79b9_7f4a_7c15;

/// The digest of a value; `None` if the value refuses to be serialized.
pub fn digest(value: &impl Serialize) -> Option<u64> {
    let mut bits = Bits([1, 2, 3, 4]);
    value.serialize(&mut bits).ok()?;
    Some(bits.0.into_iter().fold(0, mixed))
}

fn mixed(sum: u64, word: u64) -> u64 {
    // Without the rotation, two changed signs would cancel.
    (sum ^ word).rotate_left(29).wrapping_mul(FACTOR)
}

struct Bits([u64; 4]);

impl Bits {
    #[inline]
    fn add(&mut self, word: u64) -> Result<(), fmt::Error> {
        let [first, second, third, fourth] = self.0;
        self.0 = [second, third, fourth, mixed(first, word)];
        Ok(())
    }

    fn add_bytes(&mut self, bytes: &[u8]) -> Result<(), fmt::Error> {
        self.add(bytes.len() as u64)?;
        let (fours, rest) = bytes.as_chunks::<4>();
        for four in fours {
            for (sum, byte) in self.0.iter_mut().zip(four) {
                *sum = mixed(*sum, (*byte).into());
            }
        }
        rest.iter().try_for_each(|byte| self.add((*byte).into()))
    }
}

/// Methods that add one word.
macro_rules! words {
    ($($name:ident: $of:ty, $word:expr;)*) => {
        $(#[inline] fn $name(self, value: $of) -> Result<(), fmt::Error> {
            let word: fn($of) -> u64 = $word;
            self.add(word(value))
        })*
    };
}

/// Methods that start a compound value: they add its length or variant.
macro_rules! compounds {
    ($($name:ident($($argument:ident: $of:ty),*), $word:expr;)*) => {
        $(fn $name(self, $($argument: $of),*) -> Result<Self, fmt::Error> {
            self.add($word as u64)?;
            Ok(self)
        })*
    };
}

impl Serializer for &mut Bits {
    type Ok = ();
    type Error = fmt::Error;
    type SerializeSeq = Self;
    type SerializeTuple = Self;
    type SerializeTupleStruct = Self;
    type SerializeTupleVariant = Self;
    type SerializeMap = Self;
    type SerializeStruct = Self;
    type SerializeStructVariant = Self;

    words! {
        serialize_bool: bool, u64::from;
        serialize_i8: i8, |value| value as u64;
        serialize_i16: i16, |value| value as u64;
        serialize_i32: i32, |value| value as u64;
        serialize_i64: i64, |value| value as u64;
        serialize_u8: u8, u64::from;
        serialize_u16: u16, u64::from;
        serialize_u32: u32, u64::from;
        serialize_u64: u64, |value| value;
        serialize_f32: f32, |value| f64::from(value).to_bits();
        serialize_f64: f64, |value| if value.is_nan() { f64::NAN } else { value }.to_bits();
        serialize_char: char, u64::from;
    }

    compounds! {
        serialize_seq(count: Option<usize>), count.unwrap_or(0);
        serialize_tuple(count: usize), count;
        serialize_tuple_struct(_name: &'static str, count: usize), count;
        serialize_tuple_variant(_name: &'static str, index: u32, _variant: &'static str, _count: usize), index;
        serialize_map(count: Option<usize>), count.unwrap_or(0);
        serialize_struct(_name: &'static str, count: usize), count;
        serialize_struct_variant(_name: &'static str, index: u32, _variant: &'static str, _count: usize), index;
    }

    fn serialize_str(self, text: &str) -> Result<(), fmt::Error> {
        self.add_bytes(text.as_bytes())
    }

    fn serialize_bytes(self, bytes: &[u8]) -> Result<(), fmt::Error> {
        self.add_bytes(bytes)
    }

    fn serialize_none(self) -> Result<(), fmt::Error> {
        self.add(0)
    }

    fn serialize_some<T: Serialize + ?Sized>(self, value: &T) -> Result<(), fmt::Error> {
        self.add(1)?;
        value.serialize(self)
    }

    fn serialize_unit(self) -> Result<(), fmt::Error> {
        Ok(())
    }

    fn serialize_unit_struct(self, _: &'static str) -> Result<(), fmt::Error> {
        Ok(())
    }

    fn serialize_unit_variant(
        self,
        _: &'static str,
        index: u32,
        _: &'static str,
    ) -> Result<(), fmt::Error> {
        self.add(index.into())
    }

    fn serialize_newtype_struct<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        value: &T,
    ) -> Result<(), fmt::Error> {
        value.serialize(self)
    }

    fn serialize_newtype_variant<T: Serialize + ?Sized>(
        self,
        _: &'static str,
        index: u32,
        _: &'static str,
        value: &T,
    ) -> Result<(), fmt::Error> {
        self.add(index.into())?;
        value.serialize(self)
    }

    fn is_human_readable(&self) -> bool {
        false
    }
}

/// Compound values: their parts one after the other, named ones after their names.
macro_rules! parts {
    ($($compound:ident::$method:ident($($key:ident)?);)*) => {
        $(impl ser::$compound for &mut Bits {
            type Ok = ();
            type Error = fmt::Error;

            #[inline]
            fn $method<T: Serialize + ?Sized>(
                &mut self,
                $($key: &'static str,)?
                value: &T,
            ) -> Result<(), fmt::Error> {
                $(self.add_bytes($key.as_bytes())?;)?
                value.serialize(&mut **self)
            }

            fn end(self) -> Result<(), fmt::Error> {
                Ok(())
            }
        })*
    };
}

parts! {
    SerializeSeq::serialize_element();
    SerializeTuple::serialize_element();
    SerializeTupleStruct::serialize_field();
    SerializeTupleVariant::serialize_field();
    SerializeStruct::serialize_field(key);
    SerializeStructVariant::serialize_field(key);
}

impl ser::SerializeMap for &mut Bits {
    type Ok = ();
    type Error = fmt::Error;

    fn serialize_key<T: Serialize + ?Sized>(&mut self, key: &T) -> Result<(), fmt::Error> {
        key.serialize(&mut **self)
    }

    fn serialize_value<T: Serialize + ?Sized>(&mut self, value: &T) -> Result<(), fmt::Error> {
        value.serialize(&mut **self)
    }

    fn end(self) -> Result<(), fmt::Error> {
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Serialize;
    use std::collections::BTreeMap;

    #[derive(Serialize)]
    struct Sample {
        numbers: Vec<f64>,
        #[serde(skip_serializing_if = "Option::is_none")]
        one: Option<u32>,
        #[serde(skip_serializing_if = "Option::is_none")]
        other: Option<u32>,
        named: BTreeMap<String, i8>,
    }

    #[test]
    fn any_changed_number_length_or_field_changes_the_digest() {
        let numbers: Vec<f64> = (1..40).map(|k| f64::from(k).sin()).collect();
        let mut all = Vec::new();
        let mut add = |numbers: &[f64], one, other, name: &str| {
            let digest = digest(&Sample {
                numbers: numbers.to_vec(),
                one,
                other,
                named: BTreeMap::from([(name.to_owned(), -1)]),
            });
            assert!(digest.is_some() && !all.contains(&digest), "{digest:?}");
            all.push(digest);
        };
        add(&numbers, None, None, "a");
        add(&numbers[1..], None, None, "a");
        add(&numbers, Some(1), None, "a");
        add(&numbers, None, Some(1), "a");
        add(&numbers, None, None, "b");
        for k in 0..numbers.len() - 4 {
            let mut changed = numbers.clone();
            changed[k] = changed[k].next_up();
            add(&changed, None, None, "a");
            // The signs of one number, and of two of the same sum.
            changed.clone_from(&numbers);
            for k in [k, k + 4] {
                changed[k] = -changed[k];
                add(&changed, None, None, "a");
            }
        }
    }
}
