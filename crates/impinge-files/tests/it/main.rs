//! The integration tests of the file formats. They are one program, because each program is
//! compiled and linked separately.

mod baked;
mod changing;
mod characters;
mod clash;
mod cloth;
mod dialects;
mod hostile_paths;
mod hostile_rigs;
mod limits;
mod load;
mod mutants;
mod planning_scenes;
mod real_files;
mod rigs;
mod robots;
mod scenes;
mod winding_numbers;
