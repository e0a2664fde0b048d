//! Components of vectors in messages: a number along t in the plane, a list of two or three numbers otherwise.

use serde::de::{self, Deserializer, SeqAccess, Visitor};
use serde::ser::{Serialize, Serializer};
use serde::{Deserialize, de::Error as _};
use std::fmt;

/// One, two or three components; one is a plain number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Components {
    count: usize,
    all: [f64; 3],
}

impl Components {
    /// The components.
    pub fn as_slice(&self) -> &[f64] {
        // The constructors keep the count from 1 to 3.
        &self.all[..self.count]
    }

    /// The length of the vector.
    pub fn size(&self) -> f64 {
        match *self.as_slice() {
            [x] => x.abs(),
            [x, y] => x.hypot(y),
            _ => self.all[0].hypot(self.all[1]).hypot(self.all[2]),
        }
    }

    /// The only component; `None` if there are several.
    pub fn scalar(&self) -> Option<f64> {
        match *self.as_slice() {
            [x] => Some(x),
            _ => None,
        }
    }

    /// Two components; `None` if there is another number of them.
    pub fn pair(&self) -> Option<[f64; 2]> {
        self.as_slice().try_into().ok()
    }

    /// Three components, of which a missing third one is 0.
    pub fn in_space(&self) -> [f64; 3] {
        self.all
    }

    fn from_slice(given: &[f64]) -> Option<Components> {
        let mut all = [0.0; 3];
        all.get_mut(..given.len())?.copy_from_slice(given);
        let count = given.len();
        (count > 0).then_some(Components { count, all })
    }
}

impl From<f64> for Components {
    fn from(x: f64) -> Self {
        Components {
            count: 1,
            all: [x, 0.0, 0.0],
        }
    }
}

impl From<[f64; 2]> for Components {
    fn from([x, y]: [f64; 2]) -> Self {
        Components {
            count: 2,
            all: [x, y, 0.0],
        }
    }
}

impl From<[f64; 3]> for Components {
    fn from(all: [f64; 3]) -> Self {
        Components { count: 3, all }
    }
}

impl Serialize for Components {
    fn serialize<S: Serializer>(&self, to: S) -> Result<S::Ok, S::Error> {
        match self.scalar() {
            Some(x) => to.serialize_f64(x),
            None => self.as_slice().serialize(to),
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
        Ok(x.into())
    }

    fn visit_i64<E: de::Error>(self, x: i64) -> Result<Components, E> {
        Ok((x as f64).into())
    }

    fn visit_u64<E: de::Error>(self, x: u64) -> Result<Components, E> {
        Ok((x as f64).into())
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut list: A) -> Result<Components, A::Error> {
        let (mut all, mut count) = ([0.0; 4], 0);
        while let Some(x) = list.next_element()? {
            // One place more than allowed, so that longer lists are refused below.
            all[count.min(3)] = x;
            count += 1;
        }
        let found = (count > 1).then(|| Components::from_slice(&all[..count.min(4)]));
        found
            .flatten()
            .ok_or_else(|| A::Error::invalid_length(count, &self))
    }
}
