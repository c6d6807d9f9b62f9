//! Fuzzes what `inputs::glb` makes of bytes.

#![no_main]

#[expect(dead_code, reason = "each fuzzer uses one of several inputs")]
#[path = "../inputs.rs"]
mod inputs;

libfuzzer_sys::fuzz_target!(|data: &[u8]| inputs::glb(data));
