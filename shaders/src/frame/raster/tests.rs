use proptest::prelude::*;

use super::*;

/// A plane of 2^31 m a side with the camera in its middle, looking straight down.
fn looking_down(width: u32, height: u32, camera_m: f32) -> (Planet, View) {
    let planet = Planet { m: 8, plane: 1, unit_x_m: 1.0, unit_y_m: 1.0, ..Planet::default() };
    let view = View {
        camera_s: 1 << 30,
        camera_t: 1 << 30,
        width,
        height,
        camera_h_hi_m: camera_m,
        tan_x: 0.5 * width as f32 / height as f32,
        tan_y: 0.5,
        right: [1.0, 0.0, 0.0, height as f32],
        up: [0.0, 1.0, 0.0, 1.0],
        forward: [0.0, 0.0, -1.0, 0.05],
        ..View::default()
    };
    (planet, view)
}

fn corner(x_m: i32, y_m: i32, height_m: f32) -> Corner {
    let at = |m: i32| (1u32 << 30).wrapping_add_signed(m);
    Corner { s: at(x_m), t: at(y_m), height_m, level: 3 }
}

#[test]
fn a_pixel_holds_the_place_it_shows() {
    let (planet, view) = looking_down(64, 48, 1000.0);
    // A slope that rises 0.5 m a metre eastwards, far larger than the picture.
    let slope = |x: i32, y: i32| corner(x, y, x as f32 * 0.5);
    let quad = [slope(-1900, -4000), slope(1900, -4000), slope(-1900, 4000), slope(1900, 4000)];
    let places = draw(&planet, &view, &[[quad[0], quad[1], quad[2]], [quad[3], quad[2], quad[1]]]);
    for row in 0..48 {
        for column in 0..64 {
            let k = row * 64 + column;
            // Where the pixel's ray meets the slope, in f64.
            let ray = [(column as f64 + 0.5 - 32.0) / 48.0, (23.5 - row as f64) / 48.0];
            let depth_m = 1000.0 / (1.0 + 0.5 * ray[0]);
            let found = places.places[k];
            let metres = [found[0], found[1]].map(|u| (i64::from(u) - (1 << 30)) as f64);
            assert!((metres[0] - ray[0] * depth_m).abs() < 3.0, "{column} {row}: {metres:?}");
            assert!((metres[1] - ray[1] * depth_m).abs() < 3.0, "{column} {row}: {metres:?}");
            assert!((0.05 / f64::from(places.depths[k]) / depth_m - 1.0).abs() < 3e-3);
            assert_eq!(found[2] & 255, 131);
        }
    }
}

#[test]
fn what_lies_behind_or_before_the_near_plane_is_cut() {
    let (planet, mut view) = looking_down(32, 32, 10.0);
    // Looking north along the ground.
    view.forward = [0.0, 1.0, 0.0, 0.05];
    view.up = [0.0, 0.0, 1.0, 1.0];
    let (behind, ahead) = (corner(0, -100_000, 0.0), [corner(90_000, 100_000, 0.0), corner(-90_000, 100_000, 0.0)]);
    let places = draw(&planet, &view, &[[behind, ahead[0], ahead[1]]]);
    for k in 0..32 * 32 {
        let below = k / 32 >= 16;
        assert_eq!(places.depths[k] > 0.0, below, "{k}");
        if below {
            let metres = (i64::from(places.places[k][1]) - (1 << 30)) as f64;
            let depth_m = 10.0 * 32.0 / (k as f64 / 32.0).floor().mul_add(1.0, 0.5 - 16.0);
            assert!((metres / depth_m - 1.0).abs() < 0.02, "{metres} {depth_m}");
        }
    }
    assert!(
        draw(&planet, &view, &[[behind; 3], [behind, behind, corner(5, -7, 3.0)]]).depths.iter().all(|&d| d == 0.0)
    );
}

#[test]
fn the_nearest_wins_whatever_the_order() {
    let (planet, view) = looking_down(16, 16, 100.0);
    let sheet = |h: f32| [corner(-500, -500, h), corner(700, -500, h), corner(-500, 700, h)];
    let (low, high) = (sheet(0.0), sheet(20.0));
    let depths = draw(&planet, &view, &[low, high]).depths;
    assert_eq!(depths, draw(&planet, &view, &[high, low]).depths);
    assert!(depths.iter().all(|&d| (d - 0.05 / 80.0).abs() < 1e-9));
}

#[test]
fn distances_to_edges_are_pixels() {
    let (planet, view) = looking_down(40, 40, 40.0);
    // A pixel is a metre; a vertical side runs through the picture's middle.
    let triangle = [corner(0, -300, 0.0), corner(300, 0, 0.0), corner(0, 300, 0.0)];
    let places = draw(&planet, &view, &[triangle]);
    for column in 20..26 {
        let edge = (places.places[20 * 40 + column][2] >> 8) as f32 / 32.0;
        assert!((edge - (column as f32 + 0.5 - 20.0)).abs() < 0.05, "{column} {edge}");
    }
    assert_eq!(places.depths[20 * 40 + 19], 0.0);
}

proptest! {
    /// A fan around a point covers each pixel exactly once.
    #[test]
    fn neighbours_share_no_pixel_and_leave_none(
        rim in prop::collection::vec((0.0..360f64, 60i32..200), 5..14), x in -30i32..30, y in -30i32..30,
    ) {
        let (planet, view) = looking_down(50, 40, 40.0);
        let mut rim = rim;
        rim.sort_by(|a, b| a.0.total_cmp(&b.0));
        // Apart enough that whole metres keep their order, and round the point.
        let last = rim[0].0 + 360.0 - rim[rim.len() - 1].0;
        let gaps = rim.windows(2).map(|w| w[1].0 - w[0].0).chain([last]);
        prop_assume!(gaps.into_iter().all(|gap| (2.0..120.0).contains(&gap)));
        let at = |(turn, r): (f64, i32)| {
            let (sin, cos) = turn.to_radians().sin_cos();
            corner((f64::from(2 * r) * cos) as i32 + x, (f64::from(2 * r) * sin) as i32 + y, 0.0)
        };
        let mut covered = vec![0; 50 * 40];
        for k in 0..rim.len() {
            let triangle = [corner(x, y, 0.0), at(rim[k]), at(rim[(k + 1) % rim.len()])];
            for (count, depth) in covered.iter_mut().zip(draw(&planet, &view, &[triangle]).depths) {
                *count += usize::from(depth > 0.0);
            }
        }
        prop_assert_eq!(covered.iter().position(|&count| count != 1), None);
    }
}
