//! The libraries that PETSc's needs.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use lddtree::{DependencyAnalyzer, DependencyTree};

/// All that a library needs, each after those that it needs itself; none where they cannot be told.
///
/// Loaded one by one in this order, each is bound among the few that it needs. Loaded together, each name of each is looked for in all of
/// them, a hundred: that takes twice as long.
pub fn in_order(library: &Path) -> Vec<PathBuf> {
    let Ok(tree) = DependencyAnalyzer::default().analyze(library) else { return Vec::new() };
    let (mut met, mut ordered) = (HashSet::new(), Vec::new());
    for name in &tree.needed {
        visit(&tree, name, &mut met, &mut ordered);
    }
    ordered
}

fn visit<'a>(tree: &'a DependencyTree, name: &'a str, met: &mut HashSet<&'a str>, ordered: &mut Vec<PathBuf>) {
    let Some(library) = tree.libraries.get(name).filter(|library| library.found()) else { return };
    if !met.insert(name) {
        return;
    }
    for needed in &library.needed {
        visit(tree, needed, met, ordered);
    }
    ordered.push(library.path.clone());
}
