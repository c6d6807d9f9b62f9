#![no_main]
#![doc = "Fuzzes what `inputs::sidecar` makes of bytes."]

#[path = "../inputs.rs"]
mod inputs;

libfuzzer_sys::fuzz_target!(|data: &[u8]| inputs::sidecar(data));
