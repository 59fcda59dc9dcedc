//! Passes linker arguments that allow the interpreter's symbols to stay undefined, on systems that
//! need them.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
