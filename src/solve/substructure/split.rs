//! Division of the unknowns of a distributed matrix into the interior of each rank's part and the interface between the
//! parts.

use petsc_wrap::{Int, MatrixView, Result, Row};

/// A rank's rows of a symmetric matrix, divided into interior and interface.
pub(super) struct Split {
    /// Unknowns of the interface, ascending; the same on every rank.
    pub interface: Vec<Int>,
    /// Interface unknowns that belong to this rank.
    pub own: Vec<OwnUnknown>,
    /// This rank's other (interior) unknowns, as positions among its rows.
    pub inside: Vec<usize>,
    /// Rows of the interior unknowns, each with its entries from the diagonal on, ascending. Columns are numbered in
    /// the order of `inside`, then of `coupled`.
    pub rows: Vec<Vec<Entry>>,
    /// Positions in the interface of the unknowns that are coupled to interior ones, ascending.
    pub coupled: Vec<usize>,
    /// For each of `coupled`: sum of the magnitudes of its row's entries on the interface. This is at least the amount
    /// that the elimination subtracts from the diagonal.
    pub bounds: Vec<f64>,
}

/// An interface unknown of this rank.
pub(super) struct OwnUnknown {
    /// Position among this rank's rows.
    pub row: usize,
    /// Position in the interface.
    pub place: usize,
    /// Entries of its row on the interface, with positions in the interface as columns.
    entries: Vec<Entry>,
}

/// Entry of a row.
#[derive(Debug, Clone, Copy)]
pub(super) struct Entry {
    pub column: usize,
    pub value: f64,
}

impl Split {
    /// Divides an assembled symmetric matrix. An unknown is on the interface if it is coupled to an unknown of a later
    /// rank. Collective.
    ///
    /// # Errors
    /// If a PETSc call fails, e.g. for a matrix that is not AIJ.
    pub fn new(matrix: &MatrixView) -> Result<Self> {
        let comm = matrix.comm();
        let range = matrix.row_range();
        let (mut row, mut outer, mut inside) = (Row::default(), Vec::new(), Vec::new());
        for number in range.clone() {
            matrix.row_into(number, &mut row)?;
            let local = (number - range.start) as usize;
            // Columns are ascending.
            let is_coupled = row.columns.last().is_some_and(|last| *last >= range.end);
            if is_coupled {
                outer.push(number)
            } else {
                inside.push(local)
            };
        }
        // Ascending, since later ranks have later rows.
        let interface = comm.all_gather(&outer);
        let place_of = |number: Int| interface.binary_search(&number).ok();
        let own = outer.iter().map(|number| {
            matrix.row_into(*number, &mut row)?;
            let entries = row.columns.iter().zip(&row.values);
            let entries = entries
                .filter_map(|(column, value)| Some(Entry { column: place_of(*column)?, value: *value }))
                .collect();
            let place = place_of(*number).expect("the interface has this rank's part of it");
            Ok(OwnUnknown { row: (*number - range.start) as usize, place, entries })
        });
        let own = own.collect::<Result<Vec<_>>>()?;
        let magnitudes: Vec<f64> =
            own.iter().map(|own| own.entries.iter().map(|entry| entry.value.abs()).sum()).collect();
        let magnitudes = comm.all_gather(&magnitudes);

        let mut place_inside = vec![usize::MAX; range.len()];
        inside.iter().enumerate().for_each(|(place, local)| place_inside[*local] = place);
        // Columns on the interface are numbered last, when all coupled ones are known.
        let (mut rows, mut coupled) = (Vec::with_capacity(inside.len()), Vec::new());
        for (place, local) in inside.iter().enumerate() {
            matrix.row_into(range.start + *local as Int, &mut row)?;
            let mut entries = Vec::with_capacity(row.columns.len());
            for (number, value) in row.columns.iter().zip(&row.values) {
                let within = range.contains(number).then(|| place_inside[(*number - range.start) as usize]);
                match within.filter(|place| *place != usize::MAX) {
                    Some(column) if column >= place => entries.push(Entry { column, value: *value }),
                    Some(_) => {}
                    None => {
                        let at = place_of(*number).expect("what is not inside is on the interface");
                        coupled.push(at);
                        entries.push(Entry { column: inside.len() + at, value: *value });
                    }
                }
            }
            rows.push(entries);
        }
        coupled.sort_unstable();
        coupled.dedup();
        for row in &mut rows {
            for entry in row.iter_mut().filter(|entry| entry.column >= inside.len()) {
                let at = coupled.binary_search(&(entry.column - inside.len())).expect("it was noted");
                entry.column = inside.len() + at;
            }
            row.sort_unstable_by_key(|entry| entry.column);
        }
        let bounds = coupled.iter().map(|place| magnitudes[*place]).collect();
        Ok(Self { interface, own, inside, rows, coupled, bounds })
    }

    /// Adds this rank's rows of A_bb to a full matrix, stored by rows.
    pub fn add_own(&self, to: &mut [f64]) {
        let count = self.interface.len();
        for own in &self.own {
            own.entries.iter().for_each(|entry| to[own.place * count + entry.column] += entry.value);
        }
    }
}
