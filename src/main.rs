//! The program `ricochet`.

fn main() {}
