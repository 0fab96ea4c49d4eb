#![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

use std::io::Cursor;

use tiff::decoder::{Decoder, DecodingResult};

use super::*;

const FRAME: [f64; 6] = [-180.5, 1.0, 0.0, 90.5, 0.0, -2.0];

fn written(body: &Body, size: [u32; 2], values: &[u8]) -> Vec<u8> {
    let mut out = Cursor::new(Vec::new());
    let metadata = [("RELIEF_LEVEL", "3".to_owned()), ("NOTE", "a < b & \u{e9}".to_owned())];
    write_mask(&mut out, size, values, &Georeference { body, geo_transform: FRAME, metadata: &metadata }).unwrap();
    out.into_inner()
}

#[test]
fn pixels_and_places_come_back() {
    let values: Vec<u8> = (0..300 * 131u32).map(|k| (k / 300 * 7 + k % 300) as u8).collect();
    let bytes = written(&Body::earth(), [300, 131], &values);
    let mut decoder = Decoder::new(Cursor::new(bytes)).unwrap();
    assert_eq!(decoder.dimensions().unwrap(), (300, 131));
    let DecodingResult::U8(found) = decoder.read_image().unwrap() else { panic!("8 bits") };
    assert_eq!(found, values);
    assert_eq!(decoder.get_tag_f64_vec(Tag::ModelPixelScaleTag).unwrap(), [1.0, 2.0, 0.0]);
    assert_eq!(decoder.get_tag_f64_vec(Tag::ModelTiepointTag).unwrap(), [0.0, 0.0, 0.0, -180.5, 90.5, 0.0]);
    let keys = decoder.get_tag_u16_vec(Tag::GeoKeyDirectoryTag).unwrap();
    assert_eq!(keys, [1, 1, 1, 3, 1024, 0, 1, 2, 1025, 0, 1, 1, 2048, 0, 1, 4326]);
    let metadata = decoder.get_tag_ascii_string(Tag::Unknown(GDAL_METADATA)).unwrap();
    assert_eq!(
        metadata,
        r#"<GDALMetadata><Item name="RELIEF_LEVEL">3</Item><Item name="NOTE">a &lt; b &amp; ?</Item></GDALMetadata>"#
    );
}

#[test]
fn rasters_that_are_none_are_refused() {
    let georeference = Georeference { body: &Body::earth(), geo_transform: FRAME, metadata: &[] };
    for (size, count) in [([0, 5], 0), ([5, 0], 0), ([5, 5], 24), ([5, 5], 26)] {
        let values = vec![0; count];
        let error = write_mask(Cursor::new(Vec::new()), size, &values, &georeference).unwrap_err();
        assert!(error.to_string().contains("as many values"), "{error}");
    }
}

#[test]
fn keys_ascend_and_point_into_their_parameters() {
    let plane = |wkt: &str| Body::Plane { crs_wkt: wkt.into(), x0: 0.0, y0: 0.0, dx: 1.0, dy: 1.0 };
    let custom = r#"PROJCS["mine",GEOGCS["WGS 84",AUTHORITY["EPSG","4326"]],UNIT["metre",1,AUTHORITY["EPSG","9001"]]]"#;
    let bodies = [
        (Body::moon(), 0),
        (plane(custom), 32767),
        (plane(r#"PROJCS["a [,b",GEOGCS["x"],AUTHORITY["EPSG","32611"]]"#), 32611),
        (plane(r#"PROJCRS["u",BASEGEOGCRS["b",ID["EPSG",4326]],ID["EPSG",3031]]"#), 3031),
        (plane(r#"GEOGCS["WGS 84",AUTHORITY["EPSG","4326"]]"#), 0),
        (plane(""), 0),
    ];
    for (body, projected) in bodies {
        let keys = GeoKeys::of(&body);
        let directory = keys.directory();
        assert_eq!(directory.len(), 4 * (1 + directory[3] as usize));
        let rows: Vec<&[u16]> = directory[4..].chunks(4).collect();
        assert!(rows.windows(2).all(|pair| pair[0][0] < pair[1][0]), "{rows:?}");
        for row in &rows {
            match row[1] {
                0 => assert_eq!(row[2], 1),
                DOUBLES => assert!((row[3] as usize) < keys.doubles().len()),
                ASCII => assert!(keys.ascii()[row[3] as usize..][..row[2] as usize].ends_with('|')),
                tag => panic!("{tag}"),
            }
        }
        let found = rows.iter().find(|row| row[0] == 3072).map_or(0, |row| row[3]);
        assert_eq!(found, projected, "{body:?}");
    }
}

#[test]
fn a_crs_without_a_code_goes_beside_the_raster() {
    let plane = |wkt: &str| Body::Plane { crs_wkt: wkt.into(), x0: 0.0, y0: 0.0, dx: 1.0, dy: 1.0 };
    let custom = sidecar(&plane(r#"PROJCS["a < b",GEOGCS["WGS 84",AUTHORITY["EPSG","4326"]]]"#)).unwrap();
    assert!(custom.contains(r#">PROJCS["a &lt; b",GEOGCS["WGS 84",AUTHORITY["EPSG","4326"]]]</SRS>"#), "{custom}");
    for known in [plane(r#"PROJCS["x",AUTHORITY["EPSG","32611"]]"#), plane(""), plane("LOCAL"), Body::moon()] {
        assert_eq!(sidecar(&known), None);
    }
}

const DOUBLES: u16 = 34736;
const ASCII: u16 = 34737;
