//! The local field under the impact point: comparison with an independent solid, with closed forms, and with direct
//! integration.

use std::f64::consts::PI;

use ricochet::element::{adaptive, gauss_legendre};
use ricochet::form::{Spread, hertz_wave};
use ricochet::stack::half_space::{hertz, ring_tension};
use ricochet::stack::{
    Carrier, Cylindrical, Layer, Layerwise, LocalField, Pressure, Response, Section, Sections, Stack, Wave,
};

fn one_layer(thickness: f64, poisson: f64) -> Stack {
    Stack::new(&[Layer { thickness, young: 1.0, poisson }]).expect("an elastic layer")
}

fn laminate(young: f64, poisson: f64) -> Stack {
    let glass = Layer { thickness: 0.45, young: 1.0, poisson: 0.23 };
    Stack::new(&[glass, Layer { thickness: 0.1, young, poisson }, glass]).expect("elastic layers")
}

fn values(stress: Cylindrical) -> [f64; 4] {
    [stress.rr, stress.tt, stress.zz, stress.rz]
}

/// Comparison with the difference of finite elements of a thick circular plate and Kirchhoff's plate
/// (scripts/independent/thick_plate.py): at the impact point, inside, and on both faces. Cells of twice the size change
/// the reference by 7e-4. The edge of the plate adds (h/R)² = 1e-3 for a curvature of 1. So the tolerance is 1e-3 of
/// 1/h², where the pressure is 48 and the stresses on the lower face are 0.6 to 2.
#[test]
fn differences_of_a_solid_and_a_plate() {
    let text = include_str!("../fixtures/independent/thick-plate.csv");
    let pressure = Pressure::Spread { spread: Spread::new(0.0), radius: 2.0 };
    let field = LocalField::new(one_layer(1.0, 0.23), Carrier::Plate { pressure }, 0.3);
    let mut most = 0.0_f64;
    for row in text.lines().skip(1) {
        let row: Vec<f64> = row.split(',').map(|word| word.parse().expect("a number")).collect();
        let found = values(field.at(row[0], row[1]).stress(0.1));
        for (found, exact) in found.iter().zip(&row[2..]) {
            most = most.max((found - exact).abs());
            assert!((found - exact).abs() < 1e-3, "{row:?}: {found}");
        }
    }
    println!("largest difference: {most:.1e}");
}

/// The stresses rr, tt, zz, rz from the sum and the difference of rr and tt, and zz and rz.
fn inverted([sum, difference, zz, rz]: [f64; 4]) -> [f64; 4] {
    [0.5 * (sum + difference), 0.5 * (sum - difference), zz, rz]
}

fn four(response: &Response) -> [f64; 4] {
    [response.sum, response.difference, response.sigma_zz, response.sigma_rz]
}

/// Sections of a wave: the mean and the moment of the in-plane stresses, and the parabola of the shear force, by a
/// finer rule than the library's.
fn sections(stack: &Stack, wave: &Wave, z: f64, has_mean: bool) -> [f64; 4] {
    let h = stack.thickness();
    let (mut mean, mut moment, mut shear) = ([0.0; 2], [0.0; 2], 0.0);
    for (at, weight) in gauss_legendre(40) {
        let depth = 0.5 * h * (1.0 + at);
        let [sum, difference, _, rz] = four(&wave.response(stack, depth));
        for (i, value) in [sum, difference].into_iter().enumerate() {
            mean[i] += 0.5 * weight * value;
            moment[i] += 0.5 * weight * value * (depth - 0.5 * h) * h;
        }
        shear += 0.5 * weight * rz;
    }
    let place = z - 0.5 * h;
    let along = |i: usize| f64::from(u8::from(has_mean)) * mean[i] + 12.0 * place * moment[i] / h.powi(3);
    [along(0), along(1), 0.0, 1.5 * (1.0 - (2.0 * place / h).powi(2)) * shear]
}

/// (1/2π) ∫ ξ [A P_c − A_w P_w] J dξ, computed directly up to an end.
fn plain(stack: &Stack, carrier: &Carrier, (r, z): (f64, f64), contact: f64, end: f64) -> [f64; 4] {
    let section = Section::new(stack);
    let mut f = |x: f64| {
        let wave = stack.wave(x);
        let exact = four(&wave.response(stack, z));
        let other = four(&wave.response(stack, stack.thickness() - z));
        let mut carried = carrier.pressure().transform(x);
        if let Carrier::Sections { smoothing, .. } | Carrier::Layerwise { smoothing: Some(smoothing), .. } = carrier {
            carried *= smoothing.transform(x);
        }
        let body = match carrier {
            Carrier::Solid { .. } => exact,
            Carrier::Layerwise { theory, .. } => four(&theory.response(&theory.wave(x), z)),
            Carrier::BentSolid { .. } => {
                let signs = [-1.0, -1.0, -1.0, 1.0];
                std::array::from_fn(|i| 0.5 * (exact[i] + signs[i] * other[i]))
            }
            Carrier::Sections { body: Sections::Solid | Sections::BentSolid, .. } => {
                let has_mean = matches!(carrier, Carrier::Sections { body: Sections::Solid, .. });
                sections(stack, &wave, z, has_mean)
            }
            Carrier::Plate { .. } | Carrier::Sections { body: Sections::Plate, .. } => {
                four(&section.response(stack, x, z))
            }
        };
        let (j0, j1) = (libm::j0(x * r), libm::j1(x * r));
        let j2 = if r > 0.0 { 2.0 * j1 / (x * r) - j0 } else { 0.0 };
        let bessel = [j0, j2, j0, j1];
        std::array::from_fn(|i| x / (2.0 * PI) * (exact[i] * hertz_wave(x * contact) - body[i] * carried) * bessel[i])
    };
    inverted(adaptive((1e-6, end), 1e-10, &mut f))
}

fn carriers(stack: &Stack) -> Vec<Carrier> {
    let theory = Layerwise::new(stack);
    let spread = Pressure::Spread { spread: Spread::new(0.0), radius: 2.0 };
    let patch = Pressure::Spread { spread: Spread::new(0.4), radius: 1.0 };
    let hertz = Pressure::Hertz { radius: 0.25 };
    vec![
        Carrier::Plate { pressure: spread },
        Carrier::Plate { pressure: hertz },
        Carrier::Solid { pressure: spread },
        Carrier::Solid { pressure: patch },
        Carrier::Solid { pressure: hertz },
        Carrier::BentSolid { pressure: spread },
        Carrier::Layerwise { pressure: spread, theory: theory.clone(), smoothing: None },
        Carrier::Layerwise { pressure: spread, theory, smoothing: Some(spread) },
        Carrier::Sections { pressure: spread, smoothing: spread, body: Sections::Plate },
        Carrier::Sections { pressure: spread, smoothing: patch, body: Sections::Solid },
        Carrier::Sections { pressure: patch, smoothing: spread, body: Sections::BentSolid },
    ]
}

/// Direct integration for every carrier, in the middle of the layer and on its lower face, for two contacts. The
/// integral is cut off at ξ = 200. The remaining part of a plate's field is missing: P_w J₁, 1e-5; 3e-4 with Hertz's pressure. For the bent solid, ξ P_w on the loaded
/// lower face is missing too, 1e-5. The layerwise theory is summed over waves up to ξ = 24. Without averaging over a
/// disc, shorter waves have a shear stress of 2e-4, because the load acts on the face.
#[test]
fn integrals_as_they_stand() {
    let stacks = [(one_layer(1.0, 0.3), true), (laminate(1e-3, 0.45), false), (laminate(1e-6, 0.4999), false)];
    for (stack, is_layer) in stacks {
        for carrier in carriers(&stack) {
            if !is_layer && matches!(carrier, Carrier::BentSolid { .. } | Carrier::Sections { .. }) {
                continue;
            }
            let field = LocalField::new(stack.clone(), carrier.clone(), 0.5);
            for (r, z) in [(0.0, 1.0), (0.7, 1.0), (0.3, 0.35), (1.3, 0.62), (3.3, 0.8)] {
                let table = field.at(r, z);
                for contact in [0.03, 0.45] {
                    let (found, exact) =
                        (values(table.stress(contact)), plain(&stack, &carrier, (r, z), contact, 200.0));
                    let tail = match carrier {
                        Carrier::Plate { pressure: Pressure::Hertz { .. } } => 3e-4,
                        Carrier::Layerwise { smoothing: None, .. } => 3e-4,
                        Carrier::Plate { .. } | Carrier::Layerwise { .. } => 3e-5,
                        // Quadrature with twelve points over the thickness, where waves of half the thickness remain.
                        Carrier::Sections { .. } => 3e-5,
                        Carrier::BentSolid { .. } => 1e-5,
                        Carrier::Solid { .. } => 1e-6,
                    };
                    assert!(
                        found.iter().zip(&exact).all(|(a, b)| (a - b).abs() < tail),
                        "{carrier:?} {is_layer} {r} {z} {contact}: {found:?} {exact:?}"
                    );
                }
            }
        }
    }
}

/// A layer with a thickness of a thousand contact radii is a half-space. The remaining difference is (r_c/h)² of a
/// stress of 1/h².
#[test]
fn a_thick_layer_is_a_half_space() {
    let (contact, patch) = (1e-3, 3e-3);
    let field =
        LocalField::new(one_layer(1.0, 0.23), Carrier::Solid { pressure: Pressure::Hertz { radius: patch } }, 5e-3);
    for (r, z) in [(0.0, 0.0), (1e-3, 0.0), (5e-4, 4e-4), (2e-3, 1e-3), (0.0, 3e-3), (4e-3, 0.0)] {
        let found = values(field.at(r, z).stress(contact));
        let (near, wide) = (values(hertz(0.23, r, z, contact)), values(hertz(0.23, r, z, patch)));
        let exact: [f64; 4] = std::array::from_fn(|i| near[i] - wide[i]);
        assert!(found.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-4), "{r} {z}: {found:?} {exact:?}");
    }
}

/// Hertz's field at several depths on the axis (Johnson, (3.45)), on the surface (3.42, 3.43), and by its transform in
/// between.
#[test]
fn hertz_field() {
    let (nu, a) = (0.23, 0.2);
    let p0 = 1.5 / (PI * a * a);
    for z in [1e-6, 0.05, 0.2, 1.0, 5.0] {
        let found = hertz(nu, 0.0, z, a);
        let s = z / a;
        let side = p0 * (0.5 / (1.0 + s * s) - (1.0 + nu) * (1.0 - s * (1.0 / s).atan()));
        // The last subtraction loses s².
        let size = 1e-15 * p0 * (1.0 + s * s);
        assert!((found.rr - side).abs() < size && (found.tt - side).abs() < size, "{z}: {found:?} {side}");
        assert!((found.zz + p0 / (1.0 + s * s)).abs() < size && found.rz == 0.0, "{z}: {found:?}");
    }
    for r in [0.0, 0.01, 0.1, 0.199, 0.2, 0.201, 0.5, 3.0] {
        let found = hertz(nu, r, 0.0, a);
        let root = (1.0 - r * r / (a * a)).max(0.0).sqrt();
        let of_ring = if r == 0.0 { 0.5 } else { (1.0 - root.powi(3)) * a * a / (3.0 * r * r) };
        let ring = (1.0 - 2.0 * nu) * of_ring;
        let exact = [p0 * (ring - root), -p0 * (ring + 2.0 * nu * root), -p0 * root, 0.0];
        // (1 − root³)/r² loses digits.
        let size = 1e-12 * p0;
        assert!(values(found).iter().zip(&exact).all(|(a, b)| (a - b).abs() < size), "{r}: {found:?} {exact:?}");
    }
    assert!((hertz(nu, a, 0.0, a).rr / ring_tension(nu, a) - 1.0).abs() < 1e-12);
    // As an integral over wavenumbers: the short waves of any stack.
    for (r, z) in [(0.1, 0.1), (0.2, 0.05), (0.5, 0.3), (0.05, 0.4)] {
        let mut f = |x: f64| {
            let (s, weight) = (x * z, x / (2.0 * PI) * hertz_wave(x * a) * (-x * z).exp());
            let (j0, j1) = (libm::j0(x * r), libm::j1(x * r));
            let j2 = 2.0 * j1 / (x * r) - j0;
            [(s - 1.0 - 2.0 * nu) * j0, -(s - 1.0 + 2.0 * nu) * j2, -(1.0 + s) * j0, -s * j1].map(|v| v * weight)
        };
        let exact = inverted(adaptive((1e-9, 40.0 / z), 1e-11, &mut f));
        let found = values(hertz(nu, r, z, a));
        assert!(found.iter().zip(&exact).all(|(a, b)| (a - b).abs() < 1e-8), "{r} {z}: {found:?} {exact:?}");
    }
    // A contact of radius zero is a point force.
    let [point, small] = [0.0, 1e-3].map(|a| values(hertz(nu, 0.6, 0.8, a)));
    assert!(point.iter().zip(&small).all(|(a, b)| (a - b).abs() < 1e-5), "{point:?} {small:?}");
    assert_eq!(hertz(nu, 0.0, 0.0, 0.0), Cylindrical::default());
}

/// Under a point load the tension on the lower face equals the tension of Kirchhoff's plate under a uniform disc of
/// radius 0.3253 h (Westergaard's fit: 0.325).
#[test]
fn the_disc_that_stands_for_a_point_load() {
    let (nu, h) = (0.23, 1.0);
    let field = LocalField::new(one_layer(h, nu), Carrier::Plate { pressure: Pressure::Point }, 0.1);
    // On the axis of a disc, the plate's stress is 6 (1 + ν)/(2π) (½ − ln R). At a radius r from a point force, the
    // bracket is −ln r.
    let r = 1e-6_f64;
    let unit = 6.0 * (1.0 + nu) / (2.0 * PI);
    let found = field.at(r, h).stress(0.0);
    let radius = (0.5 - ((found.rr + found.tt) / unit - r.ln())).exp();
    assert!((radius - 0.3253).abs() < 5e-5, "{radius}");
}

/// In the stresses of solids, the difference between Hertz's pressure over h/4 and over h/8 was measured as 0.452 MPa;
/// the formula gives 0.465 MPa.
#[test]
fn patches_of_a_quarter_and_an_eighth() {
    let layer = Layer { thickness: 0.1, young: 70e9, poisson: 0.23 };
    let carrier = Carrier::Solid { pressure: Pressure::Hertz { radius: 0.025 } };
    let field = LocalField::new(Stack::new(&[layer]).expect("an elastic layer"), carrier, 0.02);
    let found = 101.66e3 * field.at(0.0, 0.1).stress(0.0125).rr;
    assert!((found - 0.465e6).abs() < 0.5e3, "{found:e}");
}

/// Tables for small and for large contacts agree at all depths; the series are cut off at 1e-9 of the field.
#[test]
fn tables_for_any_largest_contact() {
    let pressure = Pressure::Spread { spread: Spread::new(0.0), radius: 2.0 };
    let of = |largest| LocalField::new(one_layer(1.0, 0.23), Carrier::Plate { pressure }, largest);
    let fields = [0.1, 0.3, 1.0, 2.0].map(of);
    for (r, z) in [(0.0, 0.0), (0.2, 0.0), (0.0, 1.0), (0.5, 0.89), (0.5, 0.91), (0.1, 0.5), (9.0, 0.3)] {
        let found = fields.each_ref().map(|field| values(field.at(r, z).stress(0.09)));
        let apart = |a: &[f64; 4], b: &[f64; 4]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(found.iter().all(|f| apart(f, &found[0]) < 3e-7), "{r} {z}: {found:?}");
    }
}

/// On the line of the force, the stresses computed for a single contact radius agree with the table, cut off at 1e-9 of
/// the field; also for a radius of zero.
#[test]
fn one_contact_radius_on_the_axis() {
    let smoothing = Pressure::Spread { spread: Spread::new(0.0), radius: 3.0 };
    let pressure = Pressure::Spread { spread: Spread::new(0.0), radius: 2.0 };
    let carriers = [Carrier::Sections { pressure, smoothing, body: Sections::Plate }, Carrier::Plate { pressure }];
    for (carrier, radius) in carriers.into_iter().flat_map(|carrier| [0.0, 0.09, 0.3].map(|r| (carrier.clone(), r))) {
        let table = LocalField::new(one_layer(1.0, 0.23), carrier.clone(), 0.4);
        let alone = LocalField::on_axis(one_layer(1.0, 0.23), carrier.clone(), radius);
        for z in [0.5, 1.0] {
            let [found, exact] = [&alone, &table].map(|field| values(field.at(0.0, z).stress(radius)));
            let apart = found.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            assert!(apart < 1e-7, "{carrier:?} {radius} {z}: {found:?} {exact:?}");
        }
    }
}

/// Without Hertz's field, the stresses on the loaded face have no jump at the edge of the contact, and their only
/// pressure comes from the layer.
#[test]
fn the_smooth_part_on_the_loaded_face() {
    let pressure = Pressure::Spread { spread: Spread::new(0.0), radius: 2.0 };
    let field = LocalField::new(one_layer(1.0, 0.23), Carrier::Plate { pressure }, 0.3);
    for r in [0.0, 0.05, 0.099, 0.101, 0.4] {
        let point = field.at(r, 0.0);
        let [all, smooth] = [point.stress(0.1), point.smooth_stress(0.1)].map(values);
        let contact = values(hertz(0.23, r, 0.0, 0.1));
        assert!((0..4).all(|i| (all[i] - smooth[i] - contact[i]).abs() < 1e-13 * 48.0), "{r}: {all:?} {smooth:?}");
        // The tolerance of the summed waves is 1e-7.
        assert!(smooth[2].abs() < 1e-6 && smooth[3].abs() < 1e-6, "{r}: {smooth:?}");
        let near = values(field.at(r + 1e-3, 0.0).smooth_stress(0.1));
        assert!((0..2).all(|i| (near[i] - smooth[i]).abs() < 1e-2), "{r}: {near:?} {smooth:?}");
    }
}

/// Beyond the radius up to which waves are summed, the field continues without a jump, to 1e-4 of the largest tension
/// on the lower face, 2/h².
#[test]
fn far_from_the_hit() {
    let pressure = Pressure::Spread { spread: Spread::new(0.0), radius: 2.0 };
    let field = LocalField::new(one_layer(1.0, 0.23), Carrier::Plate { pressure }, 0.3);
    for z in [0.0, 0.3, 1.0] {
        let [near, far] = [5.9, 6.1].map(|r| values(field.at(r, z).stress(0.2)).map(|v| v * r * r / 36.0));
        assert!(near.iter().zip(&far).all(|(a, b)| (a - b).abs() < 2e-4), "{z}: {near:?} {far:?}");
    }
}

/// Components in Cartesian axes equal the components of the rotated tensor.
#[test]
fn cartesian_components() {
    let stress = Cylindrical { rr: 3.0, tt: -2.0, zz: 5.0, rz: 0.7 };
    let same = stress.cartesian([1.0, 0.0, 0.0], [0.0, 0.0, 1.0]);
    assert_eq!(same, [3.0, -2.0, 5.0, 0.0, 0.7, 0.0]);
    let down = stress.cartesian([0.0, 1.0, 0.0], [0.0, 0.0, -1.0]);
    assert_eq!(down, [-2.0, 3.0, 5.0, -0.7, 0.0, 0.0]);
    let turned = stress.cartesian([0.6, 0.8, 0.0], [0.0, 0.0, 1.0]);
    let exact = [0.36 * 3.0 - 0.64 * 2.0, 0.64 * 3.0 - 0.36 * 2.0, 5.0, 0.56, 0.42, 0.48 * 5.0];
    assert!(turned.iter().zip(exact).all(|(a, b)| (a - b).abs() < 1e-15), "{turned:?}");
}

/// Prints the cost of the field with --nocapture; nothing is asserted.
#[test]
fn cost() {
    let pressure = Pressure::Spread { spread: Spread::new(0.0), radius: 2.0 };
    for (name, stack, carrier) in [
        ("plate", one_layer(1.0, 0.23), Carrier::Plate { pressure }),
        ("bent solid", one_layer(1.0, 0.23), Carrier::BentSolid { pressure }),
        ("laminate", laminate(1e-3, 0.45), Carrier::Solid { pressure }),
    ] {
        let begin = std::time::Instant::now();
        let field = LocalField::new(stack, carrier, 0.3);
        let made = begin.elapsed();
        let points: Vec<_> = (0..300).map(|i| (f64::from(i % 100) * 0.03, [0.0, 0.5, 1.0][i as usize / 100])).collect();
        let begin = std::time::Instant::now();
        let tables: Vec<_> = points
            .chunks(100)
            .flat_map(|on| {
                let level = field.at_depth(on[0].1);
                on.iter().map(move |p| level.at(p.0)).collect::<Vec<_>>()
            })
            .collect();
        let tabulated = begin.elapsed();
        for (depth, tables) in ["upper face", "middle", "lower face"].iter().zip(tables.chunks(100)) {
            let begin = std::time::Instant::now();
            let mut sum = 0.0;
            for i in 0..1000 {
                let contact = 3e-4 * f64::from(i);
                sum += tables.iter().map(|table| table.stress(contact).rr).sum::<f64>();
            }
            let each = begin.elapsed() / 100_000;
            println!("{name}, {depth}: new {made:?}, 300 points {tabulated:?}, a stress {each:?} ({sum:.3e})");
        }
    }
}
