//! Lists the members of a sweep: every combination of the values of its keys.

use super::vary::{MAX_VALUES, Variation};
use crate::record::sweep::{Key, Values};
use crate::scene::unit;

/// Every combination of the values of some keys; the last key changes fastest.
#[derive(Debug, Clone, PartialEq)]
pub struct Grid {
    variations: Vec<Variation>,
    members: usize,
}

impl Grid {
    /// The grid over at least one key.
    ///
    /// # Errors
    /// If a key is given twice, or if there are more members than a sweep may have.
    pub fn new(variations: Vec<Variation>) -> Result<Self, String> {
        for (n, variation) in variations.iter().enumerate() {
            if variations[..n].iter().any(|other| other.key == variation.key) {
                return Err(format!("--vary: the key {} is varied twice", variation.key));
            }
        }
        let members = variations.iter().try_fold(1_usize, |all, variation| all.checked_mul(variation.texts.len()));
        match members.filter(|members| *members <= MAX_VALUES) {
            Some(members) => Ok(Self { variations, members }),
            None => Err(format!("a sweep has at most {MAX_VALUES} members")),
        }
    }

    /// Number of members.
    pub fn len(&self) -> usize {
        self.members
    }

    /// The one varied key whose values are on a line: stiffness or damping of a support, the temperature, or the shear
    /// modulus of a material, given as numbers. `None` if no such key or several are varied.
    pub fn line(&self) -> Option<&str> {
        let on_line = |variation: &&Variation| {
            let mut words = variation.key.split('.');
            let words = [words.next(), words.next(), words.next(), words.next()];
            let is_on_line = matches!(
                words,
                [Some("support"), Some(_), Some("stiffness" | "damping"), None]
                    | [Some("body"), Some("temperature"), None, None]
                    | [Some("material"), Some(_), Some("shear"), None]
            );
            is_on_line && variation.numbers.is_some()
        };
        let mut on = self.variations.iter().filter(on_line);
        let first = on.next()?;
        on.next().is_none().then_some(first.key.as_str())
    }

    /// A member's value of a key, if the key is varied over numbers.
    pub fn number(&self, member: usize, key: &str) -> Option<f64> {
        let places = self.places(member);
        let at = self.variations.iter().position(|variation| variation.key == key)?;
        self.variations[at].numbers.as_ref().map(|numbers| numbers[places[at]])
    }

    /// Whether a key is varied.
    pub fn varies(&self, key: &str) -> bool {
        self.variations.iter().any(|variation| variation.key == key)
    }

    /// Whether a key with this prefix is varied.
    pub fn varies_prefix(&self, prefix: &str) -> bool {
        self.variations.iter().any(|variation| variation.key.starts_with(prefix))
    }

    /// Whether the grid has no members; it always has at least one.
    pub fn is_empty(&self) -> bool {
        self.members == 0
    }

    /// The member with the first value of the key at index `place`, and all other values as in `member`.
    pub fn with_first(&self, member: usize, place: usize) -> usize {
        let stride: usize = self.variations[place + 1..].iter().map(|variation| variation.texts.len()).product();
        member - stride * self.places(member)[place]
    }

    /// The values of a member as `KEY=VALUE`, one per key.
    pub fn values(&self, member: usize) -> Vec<String> {
        self.pairs(member, |variation| &variation.contents)
    }

    /// Name of a member in messages.
    pub fn name(&self, member: usize) -> String {
        format!("member {member}: {}", self.pairs(member, |variation| &variation.texts).join(", "))
    }

    fn pairs(&self, member: usize, of: impl Fn(&Variation) -> &[String]) -> Vec<String> {
        let each = self.variations.iter().zip(self.places(member));
        each.map(|(variation, place)| format!("{}={}", variation.key, of(variation)[place])).collect()
    }

    /// The values of a key as given by the user; empty if the key is not varied.
    pub fn texts(&self, key: &str) -> &[String] {
        self.variations.iter().find(|variation| variation.key == key).map_or(&[], |variation| &variation.texts)
    }

    /// Replaces the values of a key in the scenes by `contents`.
    pub fn set_contents(&mut self, key: &str, contents: Vec<String>) {
        let found = self.variations.iter_mut().find(|variation| variation.key == key);
        if let Some(variation) = found.filter(|variation| variation.texts.len() == contents.len()) {
            variation.contents = contents;
        }
    }

    /// The keys as stored in a result, with the value of every member.
    pub fn keys(&self) -> Vec<Key> {
        let places: Vec<Vec<usize>> = (0..self.members).map(|member| self.places(member)).collect();
        let key = |(n, variation): (usize, &Variation)| Key {
            path: variation.key.clone(),
            units: unit(&variation.key).to_owned(),
            is_log: variation.is_log,
            values: match &variation.numbers {
                Some(numbers) => Values::Numbers(places.iter().map(|place| numbers[place[n]]).collect()),
                None => Values::Words(places.iter().map(|place| variation.texts[place[n]].clone()).collect()),
            },
        };
        self.variations.iter().enumerate().map(key).collect()
    }

    /// Index of a member's value for each key.
    fn places(&self, member: usize) -> Vec<usize> {
        let mut rest = member;
        let mut places: Vec<usize> = self
            .variations
            .iter()
            .rev()
            .map(|variation| {
                let place = rest % variation.texts.len();
                rest /= variation.texts.len();
                place
            })
            .collect();
        places.reverse();
        places
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(given: &[&str]) -> Result<Grid, String> {
        Grid::new(given.iter().map(|given| Variation::parse(given, false).unwrap()).collect())
    }

    #[test]
    fn the_first_key_is_the_slowest() {
        let grid =
            grid(&["support.0.stiffness=1e8,1e9", "time.scheme=newmark,energy", "impactor.speed=1..3:3"]).unwrap();
        assert_eq!(grid.len(), 12);
        assert_eq!(grid.values(0), ["support.0.stiffness=1e8", "time.scheme=newmark", "impactor.speed=1"]);
        assert_eq!(grid.values(1)[2], "impactor.speed=2");
        assert_eq!(grid.values(3), ["support.0.stiffness=1e8", "time.scheme=energy", "impactor.speed=1"]);
        assert_eq!(grid.values(11), ["support.0.stiffness=1e9", "time.scheme=energy", "impactor.speed=3"]);
        assert_eq!(grid.name(6), "member 6: support.0.stiffness=1e9, time.scheme=newmark, impactor.speed=1");
        assert_eq!([0, 1, 2].map(|place| grid.with_first(11, place)), [5, 8, 9]);
        let keys = grid.keys();
        assert_eq!(keys[0].values, Values::Numbers([[1e8; 6], [1e9; 6]].concat()));
        assert_eq!((keys[0].units.as_str(), keys[2].units.as_str()), ("N/m3", "m/s"));
        assert!(matches!(&keys[1].values, Values::Words(words) if words[2] == "newmark" && words[3] == "energy"));
    }

    #[test]
    fn too_many_members_and_keys_given_twice_are_refused() {
        assert!(grid(&["a=1,2", "b=1,2", "a=3"]).unwrap_err().contains("the key a is varied twice"));
        assert!(grid(&["a=1..2:1000", "b=1..2:1000"]).is_ok());
        assert!(grid(&["a=1..2:1000", "b=1..2:1001"]).unwrap_err().contains("at most 1000000 members"));
        let many = ["a", "b", "c", "d"].map(|key| format!("{key}=1..2:1000000"));
        assert!(grid(&many.each_ref().map(String::as_str)).is_err());
    }
}
