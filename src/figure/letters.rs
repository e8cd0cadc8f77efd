//! Finds the letters missing in the font and their replacements.

use ab_glyph::{Font, FontRef};
use unicode_normalization::UnicodeNormalization;

/// The letters of DejaVu Sans: Latin, Greek, Cyrillic, Arabic and symbols, but no Chinese or Japanese, and few emoji.
pub(super) struct Letters(FontRef<'static>);

impl Letters {
    /// Reads the font.
    pub fn new() -> std::result::Result<Self, String> {
        FontRef::try_from_slice(dejavu::sans::regular()).map(Self).map_err(|_| "the font cannot be read".to_owned())
    }

    fn has(&self, letter: char) -> bool {
        self.0.glyph_id(letter).0 != 0
    }

    /// Replaces letters that the font lacks by their compatibility decomposition (NFKD), or by `missing`.
    pub fn plain(&self, text: &str, missing: char) -> String {
        let mut plain = String::new();
        for letter in one_line(text).nfc() {
            let decomposed = || std::iter::once(letter).nfkd();
            match letter {
                // Joiners and variation selectors change other letters and are not visible themselves.
                '\u{200d}' | '\u{fe00}'..='\u{fe0f}' => {}
                letter if self.has(letter) => plain.push(letter),
                _ if decomposed().all(|part| self.has(part)) => plain.extend(decomposed()),
                _ => plain.push(missing),
            }
        }
        plain
    }
}

/// Replaces each control character by a space.
pub(super) fn one_line(text: &str) -> String {
    text.chars().map(|letter| if letter.is_control() { ' ' } else { letter }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_that_the_font_lacks_are_replaced() {
        let letters = Letters::new().unwrap();
        for (text, plain) in [
            ("Plate, 0.5 m²: Δt → 0", "Plate, 0.5 m²: Δt → 0"),
            ("Платформа, πλάκα, żółw", "Платформа, πλάκα, żółw"),
            // Composed if possible, because the font does not place combining accents over letters.
            ("e\u{301}", "é"),
            ("平板 🎉 ok", "?? ? ok"),
            // Full-width letters, a unit in one character, and an emoji of three code points.
            ("ＡＢ ㎏ \u{1f469}\u{200d}\u{1f52c}", "AB kg ??"),
            ("two\nlines", "two lines"),
        ] {
            assert_eq!(letters.plain(text, '?'), plain);
        }
    }
}
