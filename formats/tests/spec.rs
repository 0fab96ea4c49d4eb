//! SPEC.md says what the code does: its worked examples and its tables.

use relief_formats::body::Body;
use relief_formats::codec::residual::PlaneReader;
use relief_formats::codec::tables::FREQUENCIES;
use relief_formats::file::Header;

const SPEC: &str = include_str!("../SPEC.md");

fn block(start: &str) -> &'static str {
    let mut blocks = SPEC.split("```\n").skip(1).step_by(2);
    blocks.find(|block| block.trim_start().starts_with(start)).unwrap_or_else(|| panic!("no block starts with {start}"))
}

fn bytes(start: &str) -> Vec<u8> {
    block(start).split_whitespace().map(|byte| u8::from_str_radix(byte, 16).expect("two digits")).collect()
}

#[test]
fn the_worked_header_is_a_header() {
    let bytes = bytes("89 52 4c 46");
    let header = Header::decode(&bytes).expect("a header");
    assert_eq!(header.encode()[..], bytes);
    assert_eq!((header.m, header.step_exponent, header.tile_count, header.file_bytes), (8, -4, 2, 59_328));
    assert_eq!((header.south_pole_q, header.north_pole_q), (77, 77));
    let Body::Ellipsoid { a_m, b_m, .. } = header.body else { panic!("an ellipsoid") };
    assert_eq!((a_m, b_m), (6_378_137.0, 6_356_752.314_245_179));
}

#[test]
fn the_worked_residual_stream_is_what_the_coder_reads() {
    let residuals = [[0, -1, 3, 40, 0, -2], [0; 6]];
    let activity = [0, 0, 1, 9, 0, 1];
    let bytes = bytes("0b 00 80");
    let mut reader = PlaneReader::new(&bytes).expect("a stream");
    for class in residuals {
        let mut found = activity;
        reader.class(&mut found, 6).expect("a class");
        assert_eq!(found, class);
    }
    reader.finish().expect("the stream's end");
}

#[test]
fn the_tables_are_the_codes() {
    let rows: Vec<Vec<u16>> = block("0: 1962")
        .lines()
        .map(|line| {
            let row = line.split_once(':').expect("a numbered row").1;
            row.split_whitespace().map(|f| f.parse().expect("a frequency")).collect()
        })
        .collect();
    assert_eq!(rows.len(), FREQUENCIES.len());
    for (row, table) in rows.iter().zip(&FREQUENCIES) {
        let (printed, rest) = table.split_at(row.len());
        assert_eq!(row, printed);
        assert!(rest.iter().all(|&f| f == 1), "a row may end only where ones follow");
    }
}
