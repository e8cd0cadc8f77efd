//! Measures the kernels that assembly and Newton iterations with pads call most often.

use std::hint::black_box;

use criterion::{Criterion, criterion_group, criterion_main};
use ricochet::description::Extent;
use ricochet::element::{Element, Shape};
use ricochet::form::{Foundation, Material, PadElement, SolidForms};
use ricochet::space::finite_element::FacetRule;

const GLASS: Material = Material { young: 70e9, poisson: 0.23, density: 2500. };

/// The vertices of the reference element, slightly distorted.
fn vertices(shape: Shape) -> Vec<[f64; 3]> {
    let shift = |v: usize, d: usize| 0.02 * ((3 * v + d) as f64).sin();
    shape.reference_vertices().iter().enumerate().map(|(v, x)| [0, 1, 2].map(|d| x[d] + shift(v, d))).collect()
}

fn cells(c: &mut Criterion) {
    for (name, shape) in [("P2 tetrahedron", Shape::Tetrahedron), ("Q2 hexahedron", Shape::Hexahedron)] {
        let x = vertices(shape);
        let mut forms = SolidForms::new(shape, 2, GLASS);
        let mut out = vec![0.; 9 * forms.nodes() * forms.nodes()];
        c.bench_function(&format!("{name} stiffness"), |b| {
            b.iter(|| forms.stiffness(black_box(&x), &mut out));
        });
        c.bench_function(&format!("{name} mass"), |b| {
            b.iter(|| forms.mass(black_box(&x), &mut out));
        });
    }
}

fn facets(c: &mut Criterion) {
    for (name, shape) in [("P2 triangle", Shape::Triangle), ("Q2 quadrilateral", Shape::Quadrilateral)] {
        let x = vertices(shape);
        let n = Element::new(shape, 2).nodes();
        let mut out = vec![0.; 9 * n * n];
        let rule = FacetRule::new(shape, 2);
        c.bench_function(&format!("{name} spring"), |b| {
            b.iter(|| rule.element(black_box(&x), &Extent::All).spring([1e9; 3], &mut out));
        });
        let foundation = Foundation { stiffness: [1e9; 3], normal: [0., 0., -1.], displacement: [0.; 3] };
        let pad = PadElement::new(&rule.element(&x, &Extent::All), &foundation);
        let u: Vec<f64> = (0..3 * n).map(|i| (i as f64).sin()).collect();
        c.bench_function(&format!("{name} pad residual"), |b| {
            b.iter(|| pad.residual(None, black_box(&u), &mut out[..3 * n]));
        });
        c.bench_function(&format!("{name} pad tangent"), |b| {
            b.iter(|| pad.tangent(None, black_box(&u), &mut out));
        });
    }
}

criterion_group! {
    name = benches;
    // Criterion's plots need a registered font. The plotters build of this program has none.
    config = Criterion::default().without_plots();
    targets = cells, facets
}
criterion_main!(benches);
