//! Types of values, with error messages that say which value was expected.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserialize, Deserializer, SeqAccess, Unexpected, Visitor};

use super::Vec3;
use super::raw::Term;

/// A real number; a whole number is accepted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Number(pub f64);

/// A whole number.
#[derive(Debug, Clone, Copy)]
pub(super) struct Whole(pub i64);

/// A word, or a whole number.
#[derive(Debug, Clone)]
pub(super) enum WordOrWhole {
    Word(String),
    Whole(i64),
}

/// The name of a file with pairs of numbers, or the pairs themselves.
#[derive(Debug, Clone)]
pub(super) enum FileOrPoints {
    File(String),
    Points(Vec<[f64; 2]>),
}

/// The name of a file with relaxation terms, or the terms themselves.
#[derive(Debug)]
pub(super) enum FileOrTerms {
    File(String),
    Terms(Vec<Term>),
}

/// Edge lengths of a box: three, or the two along its layers.
#[derive(Debug, Clone, Copy)]
pub(super) enum Edges {
    All(Vec3),
    AlongLayers([f64; 2]),
}

/// A point of the surface: three coordinates, or the two along the impacted face of a box.
#[derive(Debug, Clone, Copy)]
pub(super) enum SurfacePoint {
    All(Vec3),
    AlongFace([f64; 2]),
}

/// Three entries, one for each direction.
#[derive(Debug, Clone, Copy)]
pub(super) struct Three<T>(pub [T; 3]);

/// One value for each Cartesian component, or one for all.
#[derive(Debug, Clone, Copy)]
pub(super) struct ByComponent(pub Vec3);

/// A list of any length.
#[derive(Debug)]
pub(super) struct List<T>(pub Vec<T>);

impl<T> Default for List<T> {
    fn default() -> Self {
        Self(Vec::new())
    }
}

impl Three<Number> {
    /// The three numbers.
    pub fn numbers(self) -> Vec3 {
        self.0.map(|number| number.0)
    }
}

/// A type of values, with the forms in which a scene may have it; a form without a function is refused.
trait Value<'de>: Sized {
    /// Description in messages about other forms.
    const EXPECTED: &'static str;

    fn of_word(_: &str) -> Option<Self> {
        None
    }

    fn of_whole(whole: i64) -> Option<Self> {
        Self::of_number(whole as f64)
    }

    fn of_number(_: f64) -> Option<Self> {
        None
    }

    fn of_list<A: SeqAccess<'de>>(_: A) -> Result<Self, A::Error> {
        Err(de::Error::invalid_type(Unexpected::Seq, &Self::EXPECTED))
    }
}

/// Reads a value in any of its forms.
struct ValueVisitor<T>(PhantomData<T>);

impl<'de, T: Value<'de>> Visitor<'de> for ValueVisitor<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(T::EXPECTED)
    }

    fn visit_str<E: de::Error>(self, word: &str) -> Result<T, E> {
        T::of_word(word).ok_or_else(|| E::invalid_type(Unexpected::Str(word), &self))
    }

    fn visit_i64<E: de::Error>(self, whole: i64) -> Result<T, E> {
        T::of_whole(whole).ok_or_else(|| E::invalid_type(Unexpected::Signed(whole), &self))
    }

    fn visit_f64<E: de::Error>(self, number: f64) -> Result<T, E> {
        T::of_number(number).ok_or_else(|| E::invalid_type(Unexpected::Float(number), &self))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, entries: A) -> Result<T, A::Error> {
        T::of_list(entries)
    }
}

impl Value<'_> for Number {
    const EXPECTED: &'static str = "a number, as 0.05 or 70e9";

    fn of_number(number: f64) -> Option<Self> {
        Some(Self(number))
    }
}

impl Value<'_> for Whole {
    const EXPECTED: &'static str = "a whole number, as 20";

    fn of_whole(whole: i64) -> Option<Self> {
        Some(Self(whole))
    }
}

impl Value<'_> for WordOrWhole {
    const EXPECTED: &'static str = "a word or a whole number";

    fn of_word(word: &str) -> Option<Self> {
        Some(Self::Word(word.to_owned()))
    }

    fn of_whole(whole: i64) -> Option<Self> {
        Some(Self::Whole(whole))
    }
}

impl<'de> Value<'de> for FileOrPoints {
    const EXPECTED: &'static str = "the name of a file, or points [[0, 0], [0.001, 50.0]] of indentation and force";

    fn of_word(file: &str) -> Option<Self> {
        Some(Self::File(file.to_owned()))
    }

    fn of_list<A: SeqAccess<'de>>(entries: A) -> Result<Self, A::Error> {
        let points: Vec<[Number; 2]> = all(entries)?;
        Ok(Self::Points(points.into_iter().map(|[x, y]| [x.0, y.0]).collect()))
    }
}

impl<'de> Value<'de> for FileOrTerms {
    const EXPECTED: &'static str = "the name of a file, or terms [{ modulus = 1e6, time = 1e-3 }]";

    fn of_word(file: &str) -> Option<Self> {
        Some(Self::File(file.to_owned()))
    }

    fn of_list<A: SeqAccess<'de>>(entries: A) -> Result<Self, A::Error> {
        all(entries).map(Self::Terms)
    }
}

impl<'de> Value<'de> for Edges {
    const EXPECTED: &'static str = "three numbers [x, y, z], or two of a box with layers";

    fn of_list<A: SeqAccess<'de>>(entries: A) -> Result<Self, A::Error> {
        two_or_three(entries, Self::AlongLayers, Self::All, Self::EXPECTED)
    }
}

impl<'de> Value<'de> for SurfacePoint {
    const EXPECTED: &'static str = "three numbers [x, y, z], or two along the face of a box that is hit";

    fn of_list<A: SeqAccess<'de>>(entries: A) -> Result<Self, A::Error> {
        two_or_three(entries, Self::AlongFace, Self::All, Self::EXPECTED)
    }
}

impl<'de, T: Deserialize<'de>> Value<'de> for Three<T> {
    const EXPECTED: &'static str = "three numbers [x, y, z]";

    fn of_list<A: SeqAccess<'de>>(entries: A) -> Result<Self, A::Error> {
        three(entries, Self::EXPECTED).map(Self)
    }
}

impl<'de> Value<'de> for ByComponent {
    const EXPECTED: &'static str = "one number, or three [x, y, z]";

    fn of_number(number: f64) -> Option<Self> {
        Some(Self([number; 3]))
    }

    fn of_list<A: SeqAccess<'de>>(entries: A) -> Result<Self, A::Error> {
        three(entries, Self::EXPECTED).map(|numbers: [Number; 3]| Self(Three(numbers).numbers()))
    }
}

impl<'de, T: Deserialize<'de>> Value<'de> for List<T> {
    const EXPECTED: &'static str = "an array; tables in one have headers in double brackets, as [[support]]";

    fn of_list<A: SeqAccess<'de>>(entries: A) -> Result<Self, A::Error> {
        all(entries).map(Self)
    }
}

fn all<'de, A: SeqAccess<'de>, T: Deserialize<'de>>(mut entries: A) -> Result<Vec<T>, A::Error> {
    let mut all = Vec::new();
    while let Some(entry) = entries.next_element()? {
        all.push(entry);
    }
    Ok(all)
}

/// Reads exactly three entries. For another number the error names the `expected` value.
fn three<'de, A: SeqAccess<'de>, T: Deserialize<'de>>(entries: A, expected: &'static str) -> Result<[T; 3], A::Error> {
    all(entries)?.try_into().map_err(|all: Vec<T>| de::Error::invalid_length(all.len(), &expected))
}

/// Reads a value from two or three numbers.
fn two_or_three<'de, A: SeqAccess<'de>, T>(
    entries: A,
    two: fn([f64; 2]) -> T,
    three: fn([f64; 3]) -> T,
    expected: &'static str,
) -> Result<T, A::Error> {
    let numbers: Vec<f64> = all::<_, Number>(entries)?.into_iter().map(|number| number.0).collect();
    match numbers[..] {
        [x, y, z] => Ok(three([x, y, z])),
        [x, y] => Ok(two([x, y])),
        _ => Err(de::Error::invalid_length(numbers.len(), &expected)),
    }
}

/// Schema of two or three numbers.
fn schema_of_two_or_three() -> Schema {
    json_schema!({ "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 3 })
}

/// Makes a type of values readable, with an inline schema.
macro_rules! value {
    ($(@$t:ident)? $type:ty, $generator:ident => $schema:expr) => {
        impl<'de $(, $t: Deserialize<'de>)?> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
                deserializer.deserialize_any(ValueVisitor(PhantomData))
            }
        }

        impl$(<$t: JsonSchema>)? JsonSchema for $type {
            fn inline_schema() -> bool {
                true
            }

            fn schema_name() -> Cow<'static, str> {
                stringify!($type).into()
            }

            fn json_schema($generator: &mut SchemaGenerator) -> Schema {
                $schema
            }
        }
    };
}

value!(Number, _generator => json_schema!({ "type": "number" }));
value!(Whole, _generator => json_schema!({ "type": "integer" }));
value!(WordOrWhole, _generator => json_schema!({ "type": ["string", "integer"] }));
value!(FileOrPoints, _generator => json_schema!({
    "anyOf": [
        { "type": "string" },
        { "type": "array", "items": { "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 } },
    ]
}));
value!(FileOrTerms, generator => {
    let term = generator.subschema_for::<Term>();
    json_schema!({ "anyOf": [{ "type": "string" }, { "type": "array", "items": term }] })
});
value!(Edges, _generator => schema_of_two_or_three());
value!(SurfacePoint, _generator => schema_of_two_or_three());
value!(@T Three<T>, generator => {
    json_schema!({ "type": "array", "items": generator.subschema_for::<T>(), "minItems": 3, "maxItems": 3 })
});
value!(ByComponent, _generator => json_schema!({
    "anyOf": [
        { "type": "number" },
        { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 },
    ]
}));
value!(@T List<T>, generator => json_schema!({ "type": "array", "items": generator.subschema_for::<T>() }));
