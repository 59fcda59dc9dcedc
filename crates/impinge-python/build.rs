//! What the linker of some systems must be told so that the interpreter's symbols may be left open.

fn main() {
    pyo3_build_config::add_extension_module_link_args();
}
