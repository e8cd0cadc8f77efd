//! Products of 3×3 blocks with vectors of nodes, in vector registers of four numbers.
//!
//! A row of a block is read together with the number that follows it. A node has a fourth number, zero, which is
//! multiplied with that number.

/// Number of unknowns of a node.
pub(super) const SIZE: usize = 3;

/// Numbers of a block, stored by rows.
pub(super) const BLOCK: usize = SIZE * SIZE;

/// Block of 3×3 numbers, stored by rows.
pub(super) type Block = [f64; BLOCK];

/// Unknowns of a node and a fourth number, aligned so that they are in one cache line.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[repr(align(32))]
pub(super) struct Lanes(pub [f64; 4]);

impl Lanes {
    /// Stores the unknowns of a node; the fourth number is zero.
    #[inline(always)]
    pub fn of([x, y, z]: [f64; SIZE]) -> Self {
        Self([x, y, z, 0.0])
    }

    /// Returns the unknowns of the node.
    #[inline(always)]
    pub fn node(self) -> [f64; SIZE] {
        [self.0[0], self.0[1], self.0[2]]
    }

    /// Computes self + factor · row.
    #[inline(always)]
    pub fn plus(self, factor: f64, row: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + factor * row.0[i]))
    }

    /// Computes self + x · row, element by element.
    #[inline(always)]
    fn plus_products(self, x: Self, row: Self) -> Self {
        Self(std::array::from_fn(|i| self.0[i] + x.0[i] * row.0[i]))
    }
}

/// Rows of a block, each with the number that follows it.
#[derive(Clone, Copy)]
pub(super) struct Rows([Lanes; SIZE]);

impl Rows {
    /// Reads the numbers of a block and the number that follows them.
    #[inline(always)]
    pub fn read<T: Copy + Into<f64>>(numbers: &[T]) -> Self {
        let row = |first: usize| -> Lanes {
            let four: [T; 4] = numbers[first..first + 4].try_into().expect("four numbers");
            Lanes(four.map(T::into))
        };
        Self([row(0), row(SIZE), row(2 * SIZE)])
    }

    /// Computes y + blockᵀ · x; the fourth number of the result is arbitrary.
    #[inline(always)]
    pub fn add_transposed(self, [p, q, r]: [f64; SIZE], y: Lanes) -> Lanes {
        y.plus(p, self.0[0]).plus(q, self.0[1]).plus(r, self.0[2])
    }
}

/// Products of rows of blocks with nodes, before the four lanes are added up.
#[derive(Clone, Copy, Default)]
pub(super) struct Sums([Lanes; SIZE]);

impl Sums {
    /// Adds block · x; the fourth number of x must be zero.
    #[inline(always)]
    pub fn add(&mut self, Rows(rows): Rows, x: Lanes) {
        for (sum, row) in self.0.iter_mut().zip(rows) {
            *sum = sum.plus_products(x, row);
        }
    }

    /// Adds up the lanes. Not inlined, because the compiler would otherwise keep the lanes separate throughout the
    /// loop.
    #[inline(never)]
    pub fn total(&self) -> [f64; SIZE] {
        self.0.map(|Lanes([a, b, c, d])| (a + c) + (b + d))
    }
}

/// Computes block · x.
#[inline(always)]
pub(super) fn apply(block: &Block, [x, y, z]: [f64; SIZE]) -> [f64; SIZE] {
    std::array::from_fn(|i| block[SIZE * i] * x + block[SIZE * i + 1] * y + block[SIZE * i + 2] * z)
}
