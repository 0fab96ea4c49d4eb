//! Who is drawn when: the latest view, and every viewer in turn.

use std::time::{Duration, Instant};

use relief_tests::folder::Folder;

use crate::daemon::Daemon;
use crate::raw::{CAMERA, Raw};
use crate::viewer::{Viewer, down, rgba};

#[test]
fn of_two_hundred_views_in_a_burst_few_are_drawn_and_the_last_is_the_last() {
    let folder = Folder::new();
    let daemon = Daemon::serve(&[&folder.globe("a.relief", 8)]);
    let mut raw = Raw::welcomed(&daemon);
    raw.say(CAMERA);
    for number in 1..=200 {
        raw.view(number, [320, 180]);
    }
    let mut views = Vec::new();
    loop {
        let (seq, view, complete) = raw.payload();
        raw.ack(seq);
        views.push(view);
        if view == 200 && complete {
            break;
        }
    }
    assert!(views.is_sorted(), "{views:?}");
    let of_earlier_views = views.iter().filter(|&&view| view < 200).count();
    assert!(of_earlier_views < 40, "{views:?}");
}

#[test]
fn a_viewer_with_sixteen_cameras_slows_itself() {
    let folder = Folder::new();
    let daemon = Daemon::serve(&[&folder.globe("a.relief", 8)]);
    let (mut one, mut many) = (Viewer::of(&daemon, "a"), Viewer::of(&daemon, "a"));
    let names: Vec<String> = (0..16).map(|k| format!("camera {k}")).collect();
    many.attached.detach("main").unwrap();
    for name in &names {
        many.attached.camera(name, "a", rgba()).unwrap();
    }
    one.look(down(0.0, 0.0, 3e6));
    let span = Duration::from_secs(3);
    let (of_one, of_many) = std::thread::scope(|scope| {
        let many = scope.spawn(move || {
            let (begin, mut pictures) = (Instant::now(), vec![0u32; names.len()]);
            for name in &names {
                many.attached.view(name, down(1.0, 0.0, 3e6)).unwrap();
            }
            while begin.elapsed() < span {
                let (header, _) = many.payload();
                many.attached
                    .view(&header.camera, down(f64::from(pictures.iter().sum::<u32>() % 90), 0.0, 3e6))
                    .unwrap();
                if let Some(at) = names.iter().position(|name| *name == header.camera) {
                    pictures[at] += 1;
                }
            }
            pictures
        });
        let (begin, mut pictures) = (Instant::now(), 0u32);
        while begin.elapsed() < span {
            one.look(down(f64::from(pictures % 90), 0.0, 3e6));
            pictures += 1;
        }
        (pictures, many.join().unwrap())
    });
    let all: u32 = of_many.iter().sum();
    // One is asked again only after its answer was seen, so it may miss a turn, not more.
    assert!(of_one * 3 >= all, "{of_one} pictures against {of_many:?}");
    let (least, most) = (of_many.iter().min().unwrap(), of_many.iter().max().unwrap());
    assert!(most - least <= 2 + most / 4, "cameras of one viewer take turns: {of_many:?}");
}
