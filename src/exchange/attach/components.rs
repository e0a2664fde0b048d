//! Components of vectors in messages: a number along t in the plane, a list of two or three numbers otherwise.

use serde::de::{self, Deserializer, Error as _, SeqAccess, Visitor};
use serde::{Deserialize, Serialize};
use std::fmt;

/// One, two or three components; one is a plain number.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(untagged)]
pub enum Components {
    /// A number along t.
    One(f64),
    /// Two components.
    Two([f64; 2]),
    /// Three components.
    Three([f64; 3]),
}

impl Components {
    /// The components.
    pub fn as_slice(&self) -> &[f64] {
        match self {
            Components::One(x) => std::slice::from_ref(x),
            Components::Two(all) => all,
            Components::Three(all) => all,
        }
    }

    /// The length of the vector.
    pub fn size(&self) -> f64 {
        match *self {
            Components::One(x) => x.abs(),
            Components::Two([x, y]) => x.hypot(y),
            Components::Three([x, y, z]) => x.hypot(y).hypot(z),
        }
    }

    /// The only component; `None` if there are several.
    pub fn scalar(&self) -> Option<f64> {
        match *self {
            Components::One(x) => Some(x),
            _ => None,
        }
    }

    /// Two components; `None` if there is another number of them.
    pub fn pair(&self) -> Option<[f64; 2]> {
        match *self {
            Components::Two(pair) => Some(pair),
            _ => None,
        }
    }

    /// Three components, of which a missing third one is 0.
    pub fn in_space(&self) -> [f64; 3] {
        match *self {
            Components::One(x) => [x, 0.0, 0.0],
            Components::Two([x, y]) => [x, y, 0.0],
            Components::Three(all) => all,
        }
    }
}

impl<'de> Deserialize<'de> for Components {
    fn deserialize<D: Deserializer<'de>>(from: D) -> Result<Components, D::Error> {
        from.deserialize_any(ComponentsReader)
    }
}

struct ComponentsReader;

impl<'de> Visitor<'de> for ComponentsReader {
    type Value = Components;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or a list of 2 or 3 numbers")
    }

    fn visit_f64<E: de::Error>(self, x: f64) -> Result<Components, E> {
        Ok(Components::One(x))
    }

    fn visit_i64<E: de::Error>(self, x: i64) -> Result<Components, E> {
        Ok(Components::One(x as f64))
    }

    fn visit_u64<E: de::Error>(self, x: u64) -> Result<Components, E> {
        Ok(Components::One(x as f64))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Components, A::Error> {
        let (mut all, mut count) = ([0.0; 4], 0);
        while let Some(x) = list.next_element()? {
            // One place more than allowed, so that longer lists are refused below.
            all[count.min(3)] = x;
            count += 1;
        }
        let [x, y, z, _] = all;
        match count {
            2 => Ok(Components::Two([x, y])),
            3 => Ok(Components::Three([x, y, z])),
            _ => Err(A::Error::invalid_length(count, &self)),
        }
    }
}
