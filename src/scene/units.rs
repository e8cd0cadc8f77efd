//! Units of the keys of a scene.

/// SI unit of the value of a key, given by its dotted path. `1` for a number without a unit, and for text.
pub fn unit(path: &str) -> &'static str {
    let names: Vec<&str> = path.split('.').filter(|name| name.parse::<usize>().is_err()).collect();
    // The names below `strength.face` and `material` are chosen by the user.
    let named: Vec<&str>;
    let known = match &names[..] {
        ["strength", "face", ..] => &names[..2],
        ["material", _, of @ ..] => {
            named = [&["material", "NAME"], of].concat();
            &named[..]
        }
        all => all,
    };
    match known.join(".").as_str() {
        "body.young"
        | "impactor.young"
        | "material.NAME.young"
        | "material.NAME.bulk"
        | "material.NAME.shear"
        | "material.NAME.prony.modulus"
        | "strength.tension"
        | "strength.face" => "Pa",
        "material.NAME.prony" => "Pa, s",
        "body.density" | "material.NAME.density" => "kg/m3",
        "body.temperature" | "material.NAME.wlf.reference" => "°C",
        "material.NAME.wlf.c2" => "K",
        "body.size"
        | "body.layer.thickness"
        | "support.displacement"
        | "support.within.rim"
        | "support.within.box"
        | "support.within.disc.centre"
        | "support.within.disc.radius"
        | "load.traction.within.rim"
        | "load.traction.within.box"
        | "load.traction.within.disc.centre"
        | "load.traction.within.disc.radius"
        | "impactor.radius"
        | "impactor.point"
        | "impactor.gap"
        | "impactor.drop_height"
        | "output.probes.point"
        | "contact.patch_radius"
        | "contact.area.square"
        | "contact.area.radius"
        | "contact.disc_radius" => "m",
        "support.stiffness" | "load.body_force" => "N/m3",
        "support.damping" => "N s/m3",
        "impactor.mass" => "kg",
        "impactor.speed" => "m/s",
        "load.gravity" => "m/s2",
        "impactor.stiffness" => "N/m^1.5",
        "contact.stiffness" => "N/m^exponent",
        "contact.damping" => "s/m",
        "contact.table" => "m, N",
        "load.traction.value" => "N/m2",
        "time.end" | "time.step" | "material.NAME.prony.time" => "s",
        "output.checkpoint_minutes" => "min",
        _ => "1",
    }
}

#[cfg(test)]
mod tests {
    use super::unit;

    #[test]
    fn units_are_those_of_the_document() {
        let document = include_str!("../../docs/scene.md");
        let rows = document.lines().filter_map(|line| {
            let cells: Vec<&str> = line.split('|').map(str::trim).collect();
            let key = cells.get(1)?.strip_prefix('`')?.strip_suffix('`')?;
            // The table of keys has five columns; other tables have fewer.
            (cells.len() == 7).then(|| (key.to_owned(), cells[3].replace('²', "2").replace('³', "3")))
        });
        let rows: Vec<_> = rows.collect();
        assert!(rows.len() > 30, "{rows:?}");
        for (key, written) in rows {
            let written = if written.is_empty() { "1".to_owned() } else { written };
            assert_eq!(unit(&key), written, "{key}");
        }
        assert_eq!((unit("support.0.stiffness"), unit("body.size.2")), ("N/m3", "m"));
    }
}
