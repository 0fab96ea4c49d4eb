#![no_main]

libfuzzer_sys::fuzz_target!(|data: &[u8]| relief_formats_fuzz::metadata(data));
