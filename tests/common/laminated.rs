//! Reference results of a viscoelastic laminate from an independent program (tests/fixtures/laminated).

/// Reference force, and the shear data of its interlayer.
pub struct Reference {
    /// Time t (s) and force F (N).
    pub force: Vec<[f64; 2]>,
    /// The same with finer cells, during the first contact.
    pub finer: Vec<[f64; 2]>,
    /// Keys `shear` and `prony` of the interlayer, as in a scene.
    pub chain: String,
}

/// Reads the reference results and the interlayer.
pub fn reference() -> Reference {
    let rows = |series: &str| {
        let row = |line: &str| {
            let mut fields = line.split(',').map(|field| field.parse().unwrap());
            [fields.next().unwrap(), fields.next().unwrap()]
        };
        series.lines().skip(1).map(row).collect()
    };
    let force = rows(include_str!("../fixtures/laminated/series.csv"));
    let finer = rows(include_str!("../fixtures/laminated/finer.csv"));
    let terms = [
        (6933.9e3, 1e-5),
        (3898.6e3, 1e-4),
        (2289.2e3, 1e-3),
        (1672.7e3, 1e-2),
        (761.6e3, 1e-1),
        (2401.0e3, 1.0),
        (65.2e3, 10.0),
        (248.0e3, 100.0),
        (575.6e3, 1000.0),
    ];
    let list: Vec<String> =
        terms.iter().map(|(modulus, time)| format!("{{ modulus = {modulus:e}, time = {time:e} }}")).collect();
    let chain = format!("shear = 3.02196e6\nprony = [{}]", list.join(", "));
    Reference { force, finer, chain }
}
