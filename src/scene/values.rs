//! Types of values, with error messages that say which value was expected.

use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::{self, Deserialize, Deserializer, SeqAccess, Visitor};

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

impl<'de> Deserialize<'de> for Number {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NumberVisitor)
    }
}

struct NumberVisitor;

impl Visitor<'_> for NumberVisitor {
    type Value = Number;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a number, as 0.05 or 70e9")
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Number, E> {
        Ok(Number(value))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Number, E> {
        Ok(Number(value as f64))
    }
}

impl<'de> Deserialize<'de> for Whole {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(WholeVisitor)
    }
}

struct WholeVisitor;

impl Visitor<'_> for WholeVisitor {
    type Value = Whole;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a whole number, as 20")
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Whole, E> {
        Ok(Whole(value))
    }
}

impl<'de> Deserialize<'de> for WordOrWhole {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(WordOrWholeVisitor)
    }
}

struct WordOrWholeVisitor;

impl Visitor<'_> for WordOrWholeVisitor {
    type Value = WordOrWhole;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("a word or a whole number")
    }

    fn visit_str<E: de::Error>(self, value: &str) -> Result<WordOrWhole, E> {
        Ok(WordOrWhole::Word(value.to_owned()))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<WordOrWhole, E> {
        Ok(WordOrWhole::Whole(value))
    }
}

impl<'de> Deserialize<'de> for FileOrPoints {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(FileOrPointsVisitor)
    }
}

struct FileOrPointsVisitor;

impl<'de> Visitor<'de> for FileOrPointsVisitor {
    type Value = FileOrPoints;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("the name of a file, or points [[0, 0], [0.001, 50.0]] of indentation and force")
    }

    fn visit_str<E: de::Error>(self, value: &str) -> Result<FileOrPoints, E> {
        Ok(FileOrPoints::File(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, entries: A) -> Result<FileOrPoints, A::Error> {
        let points: Vec<[Number; 2]> = all(entries)?;
        Ok(FileOrPoints::Points(points.into_iter().map(|[x, y]| [x.0, y.0]).collect()))
    }
}

impl<'de> Deserialize<'de> for FileOrTerms {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(FileOrTermsVisitor)
    }
}

struct FileOrTermsVisitor;

impl<'de> Visitor<'de> for FileOrTermsVisitor {
    type Value = FileOrTerms;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("the name of a file, or terms [{ modulus = 1e6, time = 1e-3 }]")
    }

    fn visit_str<E: de::Error>(self, value: &str) -> Result<FileOrTerms, E> {
        Ok(FileOrTerms::File(value.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, entries: A) -> Result<FileOrTerms, A::Error> {
        all(entries).map(FileOrTerms::Terms)
    }
}

impl<'de> Deserialize<'de> for Edges {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "three numbers [x, y, z], or two of a box with layers";
        deserializer.deserialize_any(TwoOrThree { expecting, two: Edges::AlongLayers, three: Edges::All })
    }
}

impl<'de> Deserialize<'de> for SurfacePoint {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let expecting = "three numbers [x, y, z], or two along the face of a box that is hit";
        deserializer.deserialize_any(TwoOrThree { expecting, two: SurfacePoint::AlongFace, three: SurfacePoint::All })
    }
}

/// Reads a value from two or three numbers.
struct TwoOrThree<T> {
    expecting: &'static str,
    two: fn([f64; 2]) -> T,
    three: fn([f64; 3]) -> T,
}

impl<'de, T> Visitor<'de> for TwoOrThree<T> {
    type Value = T;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.expecting)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, entries: A) -> Result<T, A::Error> {
        let numbers: Vec<f64> = all::<_, Number>(entries)?.into_iter().map(|number| number.0).collect();
        match numbers[..] {
            [x, y, z] => Ok((self.three)([x, y, z])),
            [x, y] => Ok((self.two)([x, y])),
            _ => Err(de::Error::invalid_length(numbers.len(), &self)),
        }
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Three<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ThreeVisitor(PhantomData))
    }
}

struct ThreeVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for ThreeVisitor<T> {
    type Value = Three<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("three numbers [x, y, z]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, entries: A) -> Result<Three<T>, A::Error> {
        three(entries, &self).map(Three)
    }
}

/// Reads exactly three entries. For another number the error names the `expected` value.
fn three<'de, A: SeqAccess<'de>, T: Deserialize<'de>>(
    entries: A,
    expected: &dyn de::Expected,
) -> Result<[T; 3], A::Error> {
    all(entries)?.try_into().map_err(|all: Vec<T>| de::Error::invalid_length(all.len(), expected))
}

fn all<'de, A: SeqAccess<'de>, T: Deserialize<'de>>(mut entries: A) -> Result<Vec<T>, A::Error> {
    let mut all = Vec::new();
    while let Some(entry) = entries.next_element()? {
        all.push(entry);
    }
    Ok(all)
}

impl<'de> Deserialize<'de> for ByComponent {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ByComponentVisitor)
    }
}

struct ByComponentVisitor;

impl<'de> Visitor<'de> for ByComponentVisitor {
    type Value = ByComponent;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("one number, or three [x, y, z]")
    }

    fn visit_f64<E: de::Error>(self, value: f64) -> Result<ByComponent, E> {
        Ok(ByComponent([value; 3]))
    }

    fn visit_i64<E: de::Error>(self, value: i64) -> Result<ByComponent, E> {
        self.visit_f64(value as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, entries: A) -> Result<ByComponent, A::Error> {
        let numbers: [Number; 3] = three(entries, &self)?;
        Ok(ByComponent(Three(numbers).numbers()))
    }
}

impl<'de, T: Deserialize<'de>> Deserialize<'de> for List<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(ListVisitor(PhantomData))
    }
}

struct ListVisitor<T>(PhantomData<T>);

impl<'de, T: Deserialize<'de>> Visitor<'de> for ListVisitor<T> {
    type Value = List<T>;

    fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str("an array; tables in one have headers in double brackets, as [[support]]")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, entries: A) -> Result<List<T>, A::Error> {
        all(entries).map(List)
    }
}

/// Schema of two or three numbers.
fn two_or_three() -> Schema {
    json_schema!({ "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 3 })
}

/// Implements inline schemas for the types of values.
macro_rules! inline_schema {
    ($(@$t:ident)? $type:ty, $generator:ident => $schema:expr) => {
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

inline_schema!(Number, _generator => json_schema!({ "type": "number" }));
inline_schema!(Whole, _generator => json_schema!({ "type": "integer" }));
inline_schema!(WordOrWhole, _generator => json_schema!({ "type": ["string", "integer"] }));
inline_schema!(FileOrPoints, _generator => json_schema!({
    "anyOf": [
        { "type": "string" },
        { "type": "array", "items": { "type": "array", "items": { "type": "number" }, "minItems": 2, "maxItems": 2 } },
    ]
}));
inline_schema!(FileOrTerms, generator => {
    let term = generator.subschema_for::<Term>();
    json_schema!({ "anyOf": [{ "type": "string" }, { "type": "array", "items": term }] })
});
inline_schema!(Edges, _generator => two_or_three());
inline_schema!(SurfacePoint, _generator => two_or_three());
inline_schema!(@T Three<T>, generator => {
    json_schema!({ "type": "array", "items": generator.subschema_for::<T>(), "minItems": 3, "maxItems": 3 })
});
inline_schema!(ByComponent, _generator => json_schema!({
    "anyOf": [
        { "type": "number" },
        { "type": "array", "items": { "type": "number" }, "minItems": 3, "maxItems": 3 },
    ]
}));
inline_schema!(@T List<T>, generator => json_schema!({ "type": "array", "items": generator.subschema_for::<T>() }));
