//! Runs the fuzzer's targets on its corpus and on similar inputs, for some seconds each; `scripts/fuzz` runs longer.

#[path = "../fuzz/src/lib.rs"]
mod targets;

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::time::{Duration, Instant};

/// Time for each target, in addition to the corpus.
const TIME: Duration = Duration::from_secs(2);

/// Pseudo-random numbers, the same in every run of the test.
struct Random(u64);

impl Random {
    fn next(&mut self, end: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % end.max(1)
    }
}

/// An input in which some bytes or ranges of bytes are changed, doubled, removed or taken from another input.
fn changed(input: &[u8], other: &[u8], random: &mut Random) -> Vec<u8> {
    let mut bytes = input.to_vec();
    for _ in 0..=random.next(4) {
        let at = random.next(bytes.len() + 1);
        let end = (at + 1 + random.next(20)).min(bytes.len());
        match random.next(6) {
            0 if at < bytes.len() => bytes[at] = random.next(256) as u8,
            1 if at < bytes.len() => bytes[at] ^= 1 << random.next(8),
            2 if at < end => drop(bytes.drain(at..end)),
            3 if at < end => {
                let copy = bytes[at..end].to_vec();
                bytes.splice(at..at, copy);
            }
            4 if !other.is_empty() => {
                let from = random.next(other.len());
                let to = (from + 1 + random.next(40)).min(other.len());
                bytes.splice(at..at, other[from..to].iter().copied());
            }
            _ => bytes.truncate(at),
        }
    }
    bytes
}

fn run(name: &str, target: fn(&[u8])) {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(name);
    let mut paths: Vec<_> = fs::read_dir(&folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    let corpus: Vec<Vec<u8>> = paths.iter().map(|path| fs::read(path).unwrap()).collect();
    assert!(corpus.len() >= 3, "{name}: a corpus of {}", corpus.len());
    let check = |input: &[u8]| {
        let begin = Instant::now();
        if catch_unwind(AssertUnwindSafe(|| target(input))).is_err() {
            panic!("{name}: a panic over {:?}", String::from_utf8_lossy(input));
        }
        assert!(
            begin.elapsed() < Duration::from_secs(5),
            "{name}: {:?} took {:?}",
            String::from_utf8_lossy(input),
            begin.elapsed()
        );
    };
    corpus.iter().for_each(|input| check(input));
    let (mut random, mut count, begin) = (Random(4711), 0, Instant::now());
    while begin.elapsed() < TIME {
        let [one, other] = [0, 1].map(|_| &corpus[random.next(corpus.len())]);
        check(&changed(one, other, &mut random));
        count += 1;
    }
    println!("{name}: {} inputs of the corpus and {count} near them", corpus.len());
    assert!(count > 10);
}

/// The targets run one after the other, because MPI and PETSc start once in a process and in one thread.
#[test]
fn targets_answer_whatever_comes() {
    run("scene", targets::scene);
    run("set", targets::set);
    run("checkpoint", targets::checkpoint);
    run("mesh", targets::mesh);
    run("result", targets::result);
}
