//! PETSc made safe, a file a class.
