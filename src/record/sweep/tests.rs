//! Tests that the file of a sweep is valid at any moment.

use std::fs;
use std::os::unix::fs::MetadataExt;
use std::path::Path;

use super::*;
use crate::record::columns::SERIES;
use crate::record::episodes::Episode;

fn header(members: usize, has_series: bool) -> Header {
    let key = Key {
        path: "impactor.speed".to_owned(),
        units: "m/s".to_owned(),
        is_log: false,
        values: Values::Numbers((0..members).map(|member| member as f64).collect()),
    };
    Header { origin: Origin::default(), keys: vec![key], has_series, probes: Vec::new(), shard: None }
}

/// A member with some contacts and, if wanted, series of ten rows.
fn member(index: usize, has_series: bool, contacts: usize) -> Member {
    let mut member = Member::new(index, false);
    member.status = Status::Done;
    member.set(Quantity::PeakForce, index as f64);
    member.contacts = vec![Episode { start: index as f64, ..Episode::default() }; contacts];
    member.series = has_series.then(|| vec![vec![index as f64; 10]; SERIES.len()]);
    member
}

/// The numbers of the members that are done in a file, each with all its data; the file must be whole.
fn done(file: &Path) -> Vec<usize> {
    // The writer has the file itself open.
    let copy = file.with_extension("copy");
    fs::copy(file, &copy).expect("a copy");
    let sweep = Sweep::read(&copy).expect("a whole sweep");
    let is_done = |index: &usize| sweep.status[*index] == Status::Done;
    let all: Vec<usize> = (0..sweep.status.len()).filter(is_done).collect();
    for &index in &all {
        let contacts = sweep.contacts.iter().filter(|(of, _)| *of == index).count();
        // (As text, because unknown quantities are NaN.)
        let [found, exact] = [sweep.member(index).expect("a member"), member(index, sweep.header.has_series, contacts)]
            .map(|member| format!("{member:?}"));
        assert_eq!(found, exact);
        assert!(contacts > 0);
    }
    all
}

/// Whether a file still begins with the earlier bytes. The first 48 bytes are ignored: they contain the flag of an open file
/// and its checksum.
fn has_same_bytes(now: &[u8], before: &[u8]) -> bool {
    const FLAGS: usize = 48;
    now[FLAGS..].starts_with(&before[FLAGS..])
}

/// A flush that moves something replaces the file: a hard link to the old file keeps the old bytes. Otherwise the file is
/// written in place.
#[test]
fn a_flush_that_moves_something_replaces_the_file() {
    for has_series in [false, true] {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("s.h5");
        let mut writer = SweepWriter::open(&path, &header(20, has_series)).expect("a new sweep");
        // The last member has more contacts than a chunk of the table.
        for (index, contacts, moves) in [(3, 1, true), (5, 2, has_series), (2, 5000, true)] {
            let (before, earlier) = (folder.path().join(format!("before-{index}.h5")), done(&path));
            fs::hard_link(&path, &before).unwrap();
            let bytes = fs::read(&path).unwrap();
            writer.push(member(index, has_series, contacts)).expect("a member");
            writer.flush().expect("a flush");
            let is_replaced = path.metadata().unwrap().ino() != before.metadata().unwrap().ino();
            assert_eq!(is_replaced, moves, "{index} {has_series}");
            if moves {
                assert!(has_same_bytes(&fs::read(&before).unwrap(), &bytes), "{index} {has_series}");
                assert_eq!(done(&before), earlier);
            }
            assert_eq!(done(&path).len(), earlier.len() + 1);
        }
        // The contacts are put in the order of the members.
        let (before, bytes) = (folder.path().join("before.h5"), fs::read(&path).unwrap());
        fs::hard_link(&path, &before).unwrap();
        writer.finish().expect("an end");
        assert!(has_same_bytes(&fs::read(&before).unwrap(), &bytes));
        drop(writer);
        let sweep = Sweep::read(&path).expect("a whole sweep");
        assert!(sweep.matches_file_contacts && sweep.contacts.len() == 5003);
        let hidden = fs::read_dir(folder.path()).unwrap().flatten();
        assert_eq!(hidden.filter(|entry| entry.file_name().to_string_lossy().starts_with('.')).count(), 0);
    }
}

/// Contacts of members whose status did not reach the disk are removed when the sweep is continued, and so is the copy that
/// a killed process has left.
#[test]
fn what_a_kill_has_left_is_removed() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("s.h5");
    let header = header(4, false);
    let mut writer = SweepWriter::open(&path, &header).expect("a new sweep");
    (0..3).for_each(|index| writer.push(member(index, false, 2)).expect("a member"));
    writer.finish().expect("an end");
    drop(writer);
    let file = hdf5_metno::File::open_rw(&path).expect("the file");
    file.dataset("members/status").unwrap().write_slice(&[0_u8], 1..2).unwrap();
    drop(file);
    let part = folder.path().join(".s.h5.123.part");
    fs::write(&part, "").unwrap();
    let mut writer = SweepWriter::open(&path, &header).expect("the sweep");
    assert!(!part.exists());
    writer.push(member(3, false, 1)).expect("a member");
    writer.finish().expect("an end");
    drop(writer);
    let sweep = Sweep::read(&path).expect("a whole sweep");
    assert_eq!(sweep.contacts.iter().map(|(member, _)| *member).collect::<Vec<_>>(), [0, 0, 2, 2, 3]);
    assert!(sweep.matches_file_contacts);
}

/// Two processes cannot write the same sweep.
#[test]
fn a_second_writer_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let (path, header) = (folder.path().join("s.h5"), header(2, false));
    let another = SweepWriter::open(&path, &header).expect("the sweep");
    let refused = SweepWriter::open(&path, &header).err().map(|error| error.to_string());
    assert!(refused.is_some_and(|text| text.contains("is being written by another run")));
    drop(another);
}
