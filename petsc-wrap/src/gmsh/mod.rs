//! Meshes from Gmsh files: DMPlex reads them, after a look at what it would take on trust.

mod nodes;
mod walk;
mod words;

use std::ffi::CString;
use std::path::{Path, PathBuf};

use petsc_sys as sys;

use crate::Int;
use crate::comm::Comm;
use crate::error::{Error, Result, check};
use crate::options::Scoped;
use crate::plex::Plex;

/// A mesh from a Gmsh file.
pub struct GmshMesh {
    /// The mesh, all on rank 0 until [`Plex::distribute`].
    pub plex: Plex,
    /// The physical surfaces that the file names, on every rank.
    pub surfaces: Vec<PhysicalGroup>,
    /// The physical volumes that the file names, on every rank.
    pub named_volumes: Vec<PhysicalGroup>,
    /// How many regions the cells are in that differ in their physical groups.
    pub volumes: usize,
    /// How many parts the cells make that share no node.
    pub parts: usize,
}

/// A physical group of faces or of cells.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct PhysicalGroup {
    /// The value of its faces in the label `Face Sets`, or of its cells in the label `Cell Sets`.
    pub number: Int,
    /// Its name.
    pub name: String,
}

/// What is taken of a file before PETSc reads it.
#[derive(Debug, PartialEq)]
struct Contents {
    surfaces: Vec<PhysicalGroup>,
    named_volumes: Vec<PhysicalGroup>,
    /// Whether all tags of an element are physical groups (4.1), or the first one only (2.2).
    all_tags: bool,
    /// Physical groups that its cells are in.
    volumes: usize,
    /// Parts of the cells that share no node.
    parts: usize,
}

impl Plex {
    /// A mesh of tetrahedra or of hexahedra, of first order, from a Gmsh file (2.2 or 4.1, text or binary), all on rank 0 until
    /// [`Plex::distribute`].
    ///
    /// The faces of physical group n have the value n of the label `Face Sets`, in files of version 4.1 for every group that they are in, in
    /// those of 2.2 for the first.
    ///
    /// Rank 0 alone reads. It walks through the file first, since PETSc uses the counts and references in it unchecked; nobody may write to
    /// the file meanwhile. Collective.
    ///
    /// # Errors
    /// [`Error::MeshFile`], on all ranks, for a file that is not there or does not keep what its format promises; PETSc's, on rank 0 alone.
    pub fn gmsh(comm: &Comm, path: &Path) -> Result<GmshMesh> {
        let Contents { surfaces, named_volumes, volumes, parts, all_tags } = read_contents(comm, path)?;
        // Rank 0 alone opens it.
        let path = if comm.is_root() { path_for_petsc(path).unwrap_or_default() } else { PathBuf::new() };
        /// What a mesh is made of here is not a matter of options: groups by number, and each surface for itself.
        const FIXED: [(&str, &str); 7] = [
            ("-dm_plex_gmsh_use_regions", "0"),
            ("-dm_plex_gmsh_periodic", "0"),
            ("-dm_plex_gmsh_highorder", "0"),
            ("-dm_plex_gmsh_project", "0"),
            ("-dm_plex_gmsh_hybrid", "0"),
            ("-dm_plex_gmsh_mark_vertices", "0"),
            // PETSc reads as many coordinates of a node, of which there are three.
            ("-dm_plex_gmsh_spacedim", "3"),
        ];
        let tags = ("-dm_plex_gmsh_multiple_tags", if all_tags { "1" } else { "0" });
        let fixed: Vec<(&str, &str)> = FIXED.into_iter().chain([tags]).collect();
        let scoped = Scoped::new(comm.session(), &fixed)?;
        let name = CString::new(path.as_os_str().as_encoded_bytes()).unwrap_or_default();
        let mut raw = std::ptr::null_mut();
        let interpolate = sys::TRUE;
        // SAFETY: the path is a C string that outlives the call; the file keeps what PETSc takes on trust.
        check(unsafe { sys::DMPlexCreateGmshFromFile(comm.petsc()?, name.as_ptr(), interpolate, &raw mut raw) })?;
        drop(scoped);
        // SAFETY: the new mesh is ours.
        Ok(GmshMesh { plex: unsafe { Plex::from_raw(raw, comm) }, surfaces, named_volumes, volumes, parts })
    }
}

/// Validates a file on rank 0; its contents, or what is wrong with it, on every rank. Collective.
fn read_contents(comm: &Comm, path: &Path) -> Result<Contents> {
    let mine = if comm.is_root() {
        let read = |path: PathBuf| std::fs::read(path).map_err(|error| format!("cannot be read: {error}"));
        Some(path_for_petsc(path).and_then(read).and_then(|bytes| walk::validate(&bytes)))
    } else {
        None
    };
    let message = mine.as_ref().and_then(|contents| contents.as_ref().err()).map_or("", String::as_str);
    let message = String::from_utf8_lossy(&comm.all_gather(message.as_bytes())).into_owned();
    if !message.is_empty() {
        return Err(Error::MeshFile { path: path.to_owned(), message });
    }
    let (mut numbers, mut names, mut counts) = (Vec::new(), String::new(), Vec::new());
    if let Some(Ok(contents)) = &mine {
        let flags = [usize::from(contents.all_tags), contents.volumes, contents.parts, contents.surfaces.len()];
        counts.extend(flags.map(|count| count as u64));
        for group in contents.surfaces.iter().chain(&contents.named_volumes) {
            numbers.push(group.number);
            // A name is a part of a line.
            names += &group.name;
            names.push('\n');
        }
    }
    // Rank 0 alone has any.
    let (numbers, counts) = (comm.all_gather(&numbers), comm.all_gather(&counts));
    let names = comm.all_gather(names.as_bytes());
    let names = String::from_utf8_lossy(&names).into_owned();
    let groups = numbers.into_iter().zip(names.lines());
    let mut surfaces: Vec<_> = groups.map(|(number, name)| PhysicalGroup { number, name: name.to_owned() }).collect();
    let named_volumes = surfaces.split_off(counts[3] as usize);
    Ok(Contents {
        surfaces,
        named_volumes,
        all_tags: counts[0] == 1,
        volumes: counts[1] as usize,
        parts: counts[2] as usize,
    })
}

/// The path by which PETSc opens this file and no other: it takes some names for streams, exchanges one kind of separator for the
/// other, and takes options from a file `.info` beside.
fn path_for_petsc(path: &Path) -> std::result::Result<PathBuf, String> {
    let whole = path.canonicalize().map_err(|error| format!("cannot be read: {error}"))?;
    if whole.as_os_str().as_encoded_bytes().contains(&b'\\') {
        return Err("PETSc cannot open a mesh file with a backslash in its path".to_owned());
    }
    let mut beside = whole.clone().into_os_string();
    beside.push(".info");
    if Path::new(&beside).exists() {
        return Err(format!("PETSc would take options from the file beside it: {}", Path::new(&beside).display()));
    }
    Ok(whole)
}
