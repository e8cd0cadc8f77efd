//! Generates the bindings to the functions of PETSc's library.

use std::path::PathBuf;

use quote::quote;

use super::fail;
use super::functions::FUNCTIONS;
use super::petsc::Petsc;

/// Name that bindgen gives to the struct of the loaded library.
const LIBRARY: &str = "Library";

/// Writes the bindings.
pub fn generate(petsc: &Petsc, mpi: &[PathBuf]) {
    let include = petsc.include.iter().chain(mpi).map(|i| format!("-I{}", i.display()));
    let bindings = bindgen::Builder::default()
        .header("wrapper.h")
        .clang_args(include)
        .allowlist_function(FUNCTIONS.join("|"))
        .allowlist_var("PETSC_(DETERMINE|DEFAULT|COMM_WORLD|VERSION_.*)|PetscTrFree|PetscErrorPrintf")
        .blocklist_type("MPI_.*|ompi_.*|_?MPI.*")
        .blocklist_item("MPI_.*|ompi_.*")
        // If PETSc is configured with strict error codes, they are an enum of the same size.
        .blocklist_type("PetscErrorCode")
        .raw_line("pub type PetscErrorCode = ::std::os::raw::c_int;")
        .allowlist_recursively(true)
        .raw_line("use mpi::ffi::*;")
        .default_enum_style(bindgen::EnumVariation::NewType { is_bitfield: false, is_global: false })
        .layout_tests(false)
        .dynamic_library_name(LIBRARY)
        .dynamic_link_require_all(true)
        .wrap_unsafe_ops(true)
        .generate_comments(false)
        .generate()
        .unwrap_or_else(|error| fail(&format!("bindgen failed on PETSc's headers: {error}")));
    let bindings = bindings.to_string();
    tell_changes(&bindings);
    write("bindings.rs", &bindings);
    write("functions.rs", &functions(&bindings));
}

/// Sets the cfg flags that tell `src/versions.rs` which of PETSc's changes are present.
fn tell_changes(bindings: &str) {
    let arguments = |name: &str| {
        let list = bindings.split(&format!("fn {name}(")).nth(1).and_then(|rest| rest.split(')').next());
        list.map_or(0, |list| list.matches(": ").count())
    };
    for (name, is_new) in [
        ("box_mesh_is_localized", arguments("DMPlexCreateBoxMesh") == 11),
        ("line_search_has_apply", arguments("SNESLineSearchShellSetApply") > 0),
        ("bool_is_of_c", bindings.contains("pub type PetscBool = bool;")),
    ] {
        println!("cargo::rustc-check-cfg=cfg({name})");
        if is_new {
            println!("cargo::rustc-cfg={name}");
        }
    }
}

/// Writes a function for each method of the loaded library, with the same name.
fn functions(bindings: &str) -> String {
    let file = syn::parse_file(bindings).unwrap_or_else(|error| fail(&format!("the bindings are no Rust: {error}")));
    let methods = file.items.iter().filter_map(|item| match item {
        syn::Item::Impl(item) if item.self_ty == syn::parse_str(LIBRARY).expect("a type") => Some(&item.items),
        _ => None,
    });
    let of_petsc = methods.flatten().filter_map(|item| match item {
        // Constructors of the library have no `self` and are left out.
        syn::ImplItem::Fn(method) if method.sig.receiver().is_some() => Some(&method.sig),
        _ => None,
    });
    let function = |signature: &syn::Signature| {
        let (name, output) = (&signature.ident, &signature.output);
        let arguments: Vec<_> = signature.inputs.iter().skip(1).collect();
        let names = arguments.iter().filter_map(|argument| match argument {
            syn::FnArg::Typed(argument) => Some(&argument.pat),
            syn::FnArg::Receiver(_) => None,
        });
        quote! {
            #[inline]
            pub unsafe fn #name(#(#arguments),*) #output {
                unsafe { library().#name(#(#names),*) }
            }
        }
        .to_string()
    };
    of_petsc.map(|signature| function(signature) + "\n").collect()
}

fn write(name: &str, text: &str) {
    let path = PathBuf::from(std::env::var("OUT_DIR").expect("cargo sets OUT_DIR")).join(name);
    std::fs::write(&path, text).unwrap_or_else(|error| fail(&format!("cannot write {}: {error}", path.display())));
}
