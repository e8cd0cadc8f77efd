//! Blocks of three by three times vectors of nodes, as a processor multiplies four numbers at a time.
//!
//! A row of a block is read with the number behind it, so that a node has a fourth number, zero, which that one is multiplied with.

/// Unknowns of a node.
pub(super) const SIZE: usize = 3;

/// Numbers of a block, by rows.
pub(super) const BLOCK: usize = SIZE * SIZE;

/// By rows.
pub(super) type Block = [f64; BLOCK];

/// The unknowns of a node and a fourth number, in one line of a cache.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(align(32))]
pub(super) struct Lanes(pub [f64; 4]);

impl Lanes {
    /// A node's unknowns.
    #[inline(always)]
    pub fn of([x, y, z]: [f64; SIZE]) -> Self {
        Self([x, y, z, 0.0])
    }

    /// The node's unknowns.
    #[inline(always)]
    pub fn node(self) -> [f64; SIZE] {
        [self.0[0], self.0[1], self.0[2]]
    }

    /// self + factor · row.
    #[inline(always)]
    fn plus(self, factor: f64, row: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + factor * row.0[i]))
    }

    /// self + x · row, number by number.
    #[inline(always)]
    fn plus_products(self, x: Self, row: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + x.0[i] * row.0[i]))
    }
}

/// A block whose rows have been read, each with the number behind it.
#[derive(Clone, Copy)]
pub(super) struct Rows([Lanes; SIZE]);

impl Rows {
    /// Of the numbers of a block and the one behind it.
    #[inline(always)]
    pub fn read<T: Copy + Into<f64>>(numbers: &[T]) -> Self {
        let row = |first: usize| -> Lanes {
            let four: [T; 4] = numbers[first..first + 4].try_into().expect("four numbers");
            Lanes(four.map(T::into))
        };
        Self([row(0), row(SIZE), row(2 * SIZE)])
    }

    /// y + blockᵀ · x; the fourth number comes out as anything.
    #[inline(always)]
    pub fn add_transposed(self, [p, q, r]: [f64; SIZE], y: Lanes) -> Lanes {
        y.plus(p, self.0[0]).plus(q, self.0[1]).plus(r, self.0[2])
    }
}

/// Sums of products of rows of blocks with nodes, whose numbers are not added up yet.
#[derive(Clone, Copy, Default)]
pub(super) struct Sums([Lanes; SIZE]);

impl Sums {
    /// Adds block · x; the fourth number of x is zero.
    #[inline(always)]
    pub fn add(&mut self, Rows(rows): Rows, x: Lanes) {
        for (sum, row) in self.0.iter_mut().zip(rows) {
            *sum = sum.plus_products(x, row);
        }
    }

    /// The sums. (Not inlined: the compiler would keep the rows' numbers apart all through the loop.)
    #[inline(never)]
    pub fn total(&self) -> [f64; SIZE] {
        self.0.map(|Lanes([a, b, c, d])| (a + c) + (b + d))
    }
}

/// block · x.
#[inline(always)]
pub(super) fn apply(block: &Block, [x, y, z]: [f64; SIZE]) -> [f64; SIZE] {
    std::array::from_fn(|i| block[SIZE * i] * x + block[SIZE * i + 1] * y + block[SIZE * i + 2] * z)
}
