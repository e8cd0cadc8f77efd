//! Reads files with two columns of numbers, such as indentation and force.

use std::path::Path;

/// Largest file size, bytes. Measured curves are smaller.
const LARGEST: u64 = 1 << 20;

/// Rows of a file with two columns, separated by commas, semicolons or tabs. With semicolons or tabs, a decimal comma
/// is accepted too. A first line without numbers is a header; `#` begins a comment.
///
/// # Errors
/// If the file cannot be read; the message has the name of the file and the line.
pub(super) fn read(path: &Path) -> Result<Vec<[f64; 2]>, String> {
    let shown = path.display();
    let wrong = |error: &dyn std::fmt::Display| format!("{shown} cannot be read: {error}");
    let metadata = std::fs::metadata(path).map_err(|error| wrong(&error))?;
    if !metadata.is_file() || metadata.len() > LARGEST {
        return Err(wrong(&format!("it is no file of at most {} MB", LARGEST >> 20)));
    }
    let text = std::fs::read_to_string(path).map_err(|error| wrong(&error))?;
    let text = text.trim_start_matches('\u{feff}');
    let is_comment = |line: &str| line.trim().is_empty() || line.trim_start().starts_with('#');
    let first = text.lines().find(|line| !is_comment(line)).unwrap_or_default();
    let delimiter = [';', '\t'].into_iter().find(|mark| first.contains(*mark)).unwrap_or(',');
    let number = |field: &str| match delimiter {
        ';' | '\t' => field.replace(',', ".").parse::<f64>().ok(),
        _ => field.parse::<f64>().ok(),
    };
    let (mut points, mut is_first) = (Vec::new(), true);
    for (index, line) in text.lines().enumerate().filter(|(_, line)| !is_comment(line)) {
        let fields: Vec<&str> = line.split(delimiter).map(str::trim).collect();
        let [x, y] = fields[..] else {
            let (columns, number) = (fields.len(), index + 1);
            return Err(format!(
                "{shown}: line {number} has not two columns but {columns}, separated by {delimiter:?}"
            ));
        };
        match (number(x), number(y)) {
            (Some(x), Some(y)) => points.push([x, y]),
            (None, None) if is_first => {}
            _ => return Err(format!("{shown}: line {} is not made of two numbers", index + 1)),
        }
        is_first = false;
    }
    Ok(points)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn tables_of_several_kinds() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("t.csv");
        let of = |text: &str| {
            std::fs::write(&path, text).unwrap();
            read(&path)
        };
        let points = vec![[0.0, 0.0], [0.001, 12.5]];
        for text in [
            "0,0\n0.001,12.5\n",
            "indentation (m), force (N)\n# measured\n0, 0\n\n1e-3, 12.5",
            "\u{feff}m;N\n0;0\n0,001;12,5\n",
            "0\t0\r\n0.001\t12.5\r\n",
            "0\t0\r\n0,001\t12,5\r\n",
        ] {
            assert_eq!(of(text).unwrap(), points, "{text}");
        }
        assert_eq!(of("").unwrap(), Vec::<[f64; 2]>::new());
        assert!(of("0,0\n1\n").unwrap_err().contains("line 2 has not two columns but 1"));
        assert!(of("0,0\n\n1,x\n").unwrap_err().contains("line 3"));
        assert!(read(folder.path()).unwrap_err().contains("cannot be read"));
        assert!(read(&folder.path().join("none")).unwrap_err().contains("cannot be read"));
    }
}
