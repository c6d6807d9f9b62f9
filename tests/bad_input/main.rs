//! Hostile and broken files: each gives one clear sentence or a scene, reads nothing outside its
//! folder, and takes neither memory nor time without bound. One program, so that the modules share
//! [`support`] and [`strict`].

mod bounds;
#[path = "../support/dice.rs"]
mod dice;
mod finds;
#[path = "../fuzz/inputs.rs"]
mod inputs;
#[path = "../support/left_out.rs"]
mod left_out;
mod outside;
mod pictures;
mod pipes;
mod strict;
#[path = "../support/mod.rs"]
mod support;
mod tables;
