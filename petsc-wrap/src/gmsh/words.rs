//! Reads the words and numbers of a Gmsh file, piece by piece. The numbers are text, or binary between words.

use std::hash::{DefaultHasher, Hasher};
use std::io::{Read, Seek, SeekFrom};
use std::ops::Range;

/// Longest word or line accepted, in bytes. Gmsh's text files have none nearly as long.
const LONGEST: usize = 1000;

/// Number of bytes of the file that are in memory at a time.
const PIECE: usize = 1 << 18;

const CUT_OFF: &str = "the file ends too early: it is cut off";

/// A position in a file. Error messages begin with the line number, or with the byte position in a binary file.
pub(super) struct Tokenizer<R> {
    source: R,
    piece: Vec<u8>,
    /// Number of bytes of the piece that are filled.
    end: usize,
    at: usize,
    /// Start of the last item.
    start: usize,
    /// Bytes and lines before the piece.
    before: Place,
    hasher: DefaultHasher,
    /// Whether numbers are binary, in this machine's (little-endian) byte order.
    pub binary: bool,
}

/// A place in a file.
#[derive(Clone, Copy, Default)]
pub(super) struct Place {
    bytes: usize,
    lines: usize,
}

impl<R: Read + Seek> Tokenizer<R> {
    /// Starts at the beginning of a readable file.
    pub fn new(source: R) -> Result<Self, String> {
        let (piece, hasher) = (vec![0; PIECE], DefaultHasher::new());
        let mut words =
            Self { source, piece, end: 0, at: 0, start: 0, before: Place::default(), hasher, binary: false };
        words.read_on()?;
        Ok(words)
    }

    /// Returns an error that says `what` is wrong with the last item.
    pub fn error<T>(&self, what: impl std::fmt::Display) -> Result<T, String> {
        let Place { bytes, lines } = self.place(self.start);
        let place = if self.binary { format!("byte {bytes}") } else { format!("line {}", 1 + lines) };
        Err(format!("{place}: {what}"))
    }

    /// Position of the next item, or of the blanks before it.
    pub fn here(&self) -> Place {
        self.place(self.at)
    }

    fn place(&self, at: usize) -> Place {
        let lines = self.piece[..at].iter().filter(|byte| **byte == b'\n').count();
        Place { bytes: self.before.bytes + at, lines: self.before.lines + lines }
    }

    /// Goes back to an earlier position.
    pub fn go_to(&mut self, place: Place) -> Result<(), String> {
        self.source.seek(SeekFrom::Start(place.bytes as u64)).map_err(unreadable)?;
        (self.before, self.end, self.at, self.start) = (place, 0, 0, 0);
        Ok(())
    }

    /// A hash of everything read so far: different files almost certainly have different values.
    pub fn digest(&self) -> u64 {
        self.hasher.finish()
    }

    /// Reads more of the file and drops everything before the last item. Returns whether there was more.
    fn read_on(&mut self) -> Result<bool, String> {
        let Place { bytes, lines } = self.place(self.start);
        self.before = Place { bytes, lines };
        self.piece.copy_within(self.start..self.end, 0);
        (self.at, self.end, self.start) = (self.at - self.start, self.end - self.start, 0);
        let begin = self.end;
        // Fills the whole piece, so that the digest does not depend on the pieces that the source delivers.
        while self.end < self.piece.len() {
            match self.source.read(&mut self.piece[self.end..]) {
                Ok(0) => break,
                Ok(count) => self.end += count,
                Err(error) if error.kind() == std::io::ErrorKind::Interrupted => (),
                Err(error) => return Err(unreadable(error)),
            }
        }
        self.hasher.write(&self.piece[begin..self.end]);
        Ok(self.end > begin)
    }

    /// The next word in the piece. Reading continues after the one blank that ends it, where binary numbers may begin.
    fn find_word(&mut self) -> Result<Range<usize>, String> {
        loop {
            let blanks = self.piece[self.at..self.end].iter().take_while(|byte| byte.is_ascii_whitespace()).count();
            self.at += blanks;
            self.start = self.at;
            if self.at < self.end {
                break;
            }
            if !self.read_on()? {
                return self.error(CUT_OFF);
            }
        }
        self.find_end(|byte| byte.is_ascii_whitespace())
    }

    /// The range from the start of the last item to the next byte that ends it, to the end of the file, or to where the
    /// item is too long.
    fn find_end(&mut self, ends: impl Fn(&u8) -> bool) -> Result<Range<usize>, String> {
        let mut length = 0;
        loop {
            length += self.piece[self.start + length..self.end].iter().take_while(|byte| !ends(byte)).count();
            if self.start + length < self.end || length > LONGEST || !self.read_on()? {
                break;
            }
        }
        self.at = self.end.min(self.start + length + 1);
        Ok(self.start..self.start + length)
    }

    fn text(&self, place: Range<usize>) -> Option<&str> {
        std::str::from_utf8(&self.piece[place.clone()]).ok().filter(|_| place.len() <= LONGEST)
    }

    /// Reads the next word, which is text in a binary file too.
    pub fn word(&mut self) -> Result<String, String> {
        let place = self.find_word()?;
        self.text(place).map(str::to_owned).map_or_else(|| self.error("this is no text of a Gmsh file"), Ok)
    }

    /// Reads the rest of the line.
    pub fn line(&mut self) -> Result<String, String> {
        self.start = self.at;
        let place = self.find_end(|byte| *byte == b'\n')?;
        self.text(place).map(str::to_owned).map_or_else(|| self.error("this is no text in UTF-8"), Ok)
    }

    /// Reads the next word, which must be this one.
    pub fn expect(&mut self, word: &str) -> Result<(), String> {
        match self.word()? {
            found if found == word => Ok(()),
            found => self.error(format!("expected {word}, found {found:?}")),
        }
    }

    fn parsed<T: std::str::FromStr>(&mut self, kind: &str) -> Result<T, String> {
        let place = self.find_word()?;
        match self.text(place) {
            Some(word) => word.parse().or_else(|_| self.error(format!("expected {kind}, found {word:?}"))),
            None => self.error("this is no text of a Gmsh file"),
        }
    }

    fn raw<const N: usize>(&mut self) -> Result<[u8; N], String> {
        self.start = self.at;
        while self.end - self.at < N {
            if !self.read_on()? {
                return self.error(CUT_OFF);
            }
        }
        self.at += N;
        Ok(std::array::from_fn(|i| self.piece[self.start + i]))
    }

    /// Reads an integer of 32 bits.
    pub fn int(&mut self) -> Result<i32, String> {
        if self.binary { self.raw().map(i32::from_le_bytes) } else { self.parsed("a whole number") }
    }

    /// Reads a count, which is text even in a binary file.
    pub fn written_count(&mut self) -> Result<usize, String> {
        let count: i32 = self.parsed("a count")?;
        usize::try_from(count).or_else(|_| self.error(format!("{count} is not a count")))
    }

    /// Reads a count or a node number: 64 bits in a binary file, with a value that fits in 32 bits.
    pub fn size(&mut self) -> Result<usize, String> {
        if !self.binary {
            return self.written_count();
        }
        let size = self.raw().map(u64::from_le_bytes)?;
        i32::try_from(size).map(|size| size as usize).or_else(|_| self.error(format!("{size} is too large")))
    }

    /// Reads a real number, which may be infinite or NaN.
    pub fn real(&mut self) -> Result<f64, String> {
        if self.binary { self.raw().map(f64::from_le_bytes) } else { self.parsed("a number") }
    }
}

fn unreadable(error: std::io::Error) -> String {
    format!("cannot be read: {error}")
}

#[cfg(test)]
mod tests {
    use std::io::{Cursor, Read, Seek, SeekFrom};

    use super::{PIECE, Tokenizer};

    /// A source that delivers one byte at a time.
    struct Slow(Cursor<Vec<u8>>);

    impl Read for Slow {
        fn read(&mut self, buffer: &mut [u8]) -> std::io::Result<usize> {
            let one = buffer.len().min(1);
            self.0.read(&mut buffer[..one])
        }
    }

    impl Seek for Slow {
        fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
            self.0.seek(to)
        }
    }

    /// Words that cross the boundary of two pieces are read whole, and lines are counted across pieces.
    #[test]
    fn words_are_whole_across_pieces() {
        let lines: Vec<String> = (0..PIECE / 5).map(|i| format!("{i}  {}.5\n", i * i)).collect();
        let mut words = Tokenizer::new(Slow(Cursor::new(lines.concat().into_bytes()))).unwrap();
        let mut middle = words.here();
        for i in 0..lines.len() {
            if i == lines.len() / 2 {
                middle = words.here();
            }
            assert_eq!(words.int(), Ok(i as i32));
            assert_eq!(words.real(), Ok((i * i) as f64 + 0.5));
        }
        assert!(words.word().unwrap_err().contains(&format!("line {}: the file ends", lines.len() + 1)));
        words.go_to(middle).unwrap();
        assert_eq!(words.int(), Ok(lines.len() as i32 / 2));
        let place = format!("line {}: ", lines.len() / 2 + 1);
        assert_eq!(
            words.int(),
            Err(format!("{place}expected a whole number, found \"{}.5\"", (lines.len() / 2).pow(2)))
        );
    }

    #[test]
    fn what_is_longer_than_any_word_is_refused() {
        let long = vec![b'a'; 3 * PIECE];
        let mut words = Tokenizer::new(Cursor::new(long.clone())).unwrap();
        assert!(words.word().unwrap_err().contains("no text of a Gmsh file"));
        assert!(Tokenizer::new(Cursor::new(long)).unwrap().line().is_err());
        let mut blank = Tokenizer::new(Cursor::new([vec![b' '; 2 * PIECE], b"end".to_vec()].concat())).unwrap();
        assert_eq!(blank.word().as_deref(), Ok("end"));
    }
}
