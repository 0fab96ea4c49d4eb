use relief_formats::codec::residual::{PlaneReader, PlaneWriter};
#[test]
fn show() {
    let r = [0, -1, 3, 40, 0, -2];
    let a = [0, 0, 1, 9, 0, 1];
    let mut w = PlaneWriter::default();
    w.class(&r, &a);
    w.class(&[0; 6], &a);
    let b = w.finish();
    println!("{}", b.iter().map(|x| format!("{x:02x}")).collect::<Vec<_>>().join(" "));
    let mut rd = PlaneReader::new(&b).unwrap();
    let mut o = [0; 6];
    rd.class(&a, &mut o).unwrap();
    println!("{o:?}");
    let mut bk=[0u8;6]; relief_formats::codec::residual::buckets(&a,&mut bk); println!("{bk:?}");
}
