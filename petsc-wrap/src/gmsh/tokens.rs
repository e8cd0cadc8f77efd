//! Reads the words and numbers of a Gmsh file. Numbers are text, or binary between words.

use std::io::{BufRead, ErrorKind};

/// Longest word or line accepted, in bytes. Gmsh's text files have none nearly as long.
const LONGEST: usize = 1000;

const CUT_OFF: &str = "the file ends too early: it is cut off";

/// A position in a file. Error messages begin with the line number, or with the byte position in a binary file.
pub(super) struct Tokens<R> {
    source: R,
    /// The last word or line.
    item: Vec<u8>,
    /// Place of the last item.
    start: Place,
    /// Place of what is read next.
    at: Place,
    /// Whether numbers are binary, in this machine's (little-endian) byte order.
    pub binary: bool,
}

/// Numbers of bytes and of lines before a position.
#[derive(Clone, Copy, Default)]
struct Place {
    bytes: usize,
    lines: usize,
}

impl<R: BufRead> Tokens<R> {
    /// Starts at the beginning of a file, after a byte-order mark.
    pub fn new(mut source: R) -> Result<Self, String> {
        if source.fill_buf().map_err(unreadable)?.starts_with("\u{feff}".as_bytes()) {
            source.consume(3);
        }
        Ok(Self { source, item: Vec::new(), start: Place::default(), at: Place::default(), binary: false })
    }

    /// Returns an error that says `what` is wrong with the last item.
    pub fn error<T>(&self, what: impl std::fmt::Display) -> Result<T, String> {
        let Place { bytes, lines } = self.start;
        let place = if self.binary { format!("byte {bytes}") } else { format!("line {}", 1 + lines) };
        Err(format!("{place}: {what}"))
    }

    /// Passes over the bytes before the first one that `ends` them, and appends them to `item`. Returns whether there is
    /// such a byte before the end of the file.
    fn pass(&mut self, ends: impl Fn(&u8) -> bool) -> Result<bool, String> {
        loop {
            let buffer = self.source.fill_buf().map_err(unreadable)?;
            let length = buffer.iter().position(&ends).unwrap_or(buffer.len());
            let (is_ended, is_last) = (length < buffer.len(), buffer.is_empty());
            self.item.extend_from_slice(&buffer[..length]);
            self.at.lines += buffer[..length].iter().filter(|byte| **byte == b'\n').count();
            self.at.bytes += length;
            self.source.consume(length);
            // What is too long is no word, and is not kept.
            if is_ended || is_last || self.item.len() > LONGEST {
                return Ok(is_ended);
            }
        }
    }

    /// Passes over one byte.
    fn pass_one(&mut self) -> Result<(), String> {
        let next = self.source.fill_buf().map_err(unreadable)?.first().copied();
        self.at.bytes += usize::from(next.is_some());
        self.at.lines += usize::from(next == Some(b'\n'));
        self.source.consume(usize::from(next.is_some()));
        Ok(())
    }

    /// Reads the next word into `item`. Reading continues after the one blank that ends it, where binary numbers may
    /// begin.
    fn read_word(&mut self) -> Result<(), String> {
        let mut is_found = false;
        while !is_found {
            let before = self.at.bytes;
            self.item.clear();
            is_found = self.pass(|byte| !byte.is_ascii_whitespace())?;
            self.start = self.at;
            if !is_found && self.at.bytes == before {
                return self.error(CUT_OFF);
            }
        }
        self.item.clear();
        self.pass(u8::is_ascii_whitespace)?;
        self.pass_one()
    }

    /// The last item as text.
    fn text(&self) -> Result<&str, String> {
        let text = std::str::from_utf8(&self.item).ok().filter(|text| text.len() <= LONGEST);
        text.map_or_else(|| self.error("this is no text of a Gmsh file, which is in UTF-8"), Ok)
    }

    /// Reads the next word, which is text in a binary file too.
    pub fn word(&mut self) -> Result<String, String> {
        self.read_word()?;
        self.text().map(str::to_owned)
    }

    /// Reads the rest of the line.
    pub fn line(&mut self) -> Result<String, String> {
        (self.start, self.item) = (self.at, Vec::new());
        self.pass(|byte| *byte == b'\n')?;
        self.pass_one()?;
        self.text().map(str::to_owned)
    }

    /// Reads the next word, which must be this one.
    pub fn expect(&mut self, word: &str) -> Result<(), String> {
        match self.word()? {
            found if found == word => Ok(()),
            found => self.error(format!("expected {word}, found {found:?}")),
        }
    }

    fn parsed<T: std::str::FromStr>(&mut self, kind: &str) -> Result<T, String> {
        self.read_word()?;
        let word = self.text()?;
        word.parse().or_else(|_| self.error(format!("expected {kind}, found {word:?}")))
    }

    fn raw<const N: usize>(&mut self) -> Result<[u8; N], String> {
        self.start = self.at;
        let mut bytes = [0; N];
        self.at.bytes += N;
        match self.source.read_exact(&mut bytes) {
            Ok(()) => Ok(bytes),
            Err(error) if error.kind() == ErrorKind::UnexpectedEof => self.error(CUT_OFF),
            Err(error) => Err(unreadable(error)),
        }
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
    use std::io::{BufReader, Cursor};

    use super::{LONGEST, Tokens};

    /// Words that cross the boundary of two pieces of the file are read whole, and lines are counted across pieces.
    #[test]
    fn words_are_whole_across_pieces() {
        let lines: Vec<String> = (0..2000).map(|i| format!("{i}  {}.5\n", i * i)).collect();
        for capacity in [1, 2, 7, 1 << 13] {
            let source = BufReader::with_capacity(capacity, Cursor::new(lines.concat().into_bytes()));
            let mut tokens = Tokens::new(source).unwrap();
            for i in 0..lines.len() {
                assert_eq!(tokens.int(), Ok(i as i32));
                assert_eq!(tokens.real(), Ok((i * i) as f64 + 0.5));
            }
            assert!(tokens.word().unwrap_err().contains(&format!("line {}: the file ends", lines.len() + 1)));
        }
        let mut tokens = Tokens::new("\u{feff}1 2\n 3.5".as_bytes()).unwrap();
        assert_eq!((tokens.int(), tokens.int()), (Ok(1), Ok(2)));
        assert_eq!(tokens.int(), Err("line 2: expected a whole number, found \"3.5\"".to_owned()));
    }

    #[test]
    fn what_is_longer_than_any_word_is_refused() {
        let long = vec![b'a'; 3 * LONGEST];
        assert!(Tokens::new(&long[..]).unwrap().word().unwrap_err().contains("no text of a Gmsh file"));
        assert!(Tokens::new(&long[..]).unwrap().line().is_err());
        let blank = [vec![b' '; 3 * LONGEST], b"end".to_vec()].concat();
        assert_eq!(Tokens::new(&blank[..]).unwrap().word().as_deref(), Ok("end"));
    }
}
