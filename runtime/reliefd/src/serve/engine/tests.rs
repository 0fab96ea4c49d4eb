#![allow(clippy::unwrap_used, reason = "a test may end in a panic")]

use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};

use relief_runtime::gpu::{AdapterChoice, Device};

use super::*;

/// Keeps the faults that an engine tells of.
struct Faults(Sender<Code>);

impl Listener for Faults {
    fn drew(&self, _: &Picture) {}
    fn loaded(&self, _: usize, _: usize) {}
    fn replaced(&self, _: &Arc<Planet>) {}
    fn fault(&self, fault: Fault) {
        let _ = self.0.send(fault.code);
    }
}

/// A device; none where `RELIEF_NO_GPU=1` says that there is no adapter.
fn device() -> Option<Device> {
    if std::env::var_os("RELIEF_NO_GPU").is_some_and(|v| v == "1") {
        eprintln!("RELIEF_NO_GPU=1: nothing is tested on a GPU");
        return None;
    }
    Some(Device::headless(AdapterChoice::Fastest).unwrap())
}

fn engine(backend: Backend, choice: BackendChoice, find: recovery::Find) -> (Arc<Engine>, Receiver<Code>) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/golden/1.0/globe_m8.relief");
    let limits = Limits { backend: choice, atlas_bytes: 64 << 20, time_budget: Duration::from_millis(10) };
    let (sender, faults) = channel();
    let recovery = Recovery { find, waits: &[Duration::ZERO; 2], given_up: Duration::from_secs(1000) };
    let planet = Planet::open(&path).unwrap();
    (Arc::new(Engine::start_with(planet, backend, limits, Faults(sender), recovery).unwrap()), faults)
}

async fn draw(engine: &Arc<Engine>) -> Result<Picture, Fault> {
    let what = View::down([10.0, 20.0, 3e6], [64, 36]);
    engine.draw_once(1, Once { what, mesh: false, places: false, wait: Duration::from_secs(60) }).await
}

/// Takes the device away from under an engine.
async fn lose(engine: &Engine) {
    let lost = engine.run(1, |drawer| match drawer {
        Drawer::Gpu(gpu, _) => gpu.device().wgpu().destroy(),
        Drawer::Cpu(..) => panic!("it has no device"),
    });
    lost.await.unwrap();
}

#[tokio::test]
async fn a_lost_device_is_made_anew() {
    let Some(device) = device() else { return };
    let found = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&found);
    // The first attempt fails.
    let find = Box::new(move |choice| match counted.fetch_add(1, Ordering::Relaxed) {
        0 => Err(Fault::new(Code::Device, "none yet", "", "")),
        _ => (Recovery::default().find)(choice),
    });
    let (engine, faults) = engine(Backend::Gpu(device), BackendChoice::Gpu, find);
    let before = draw(&engine).await.unwrap();
    lose(&engine).await;
    let after = draw(&engine).await.unwrap();
    assert!(before.frame.colour == after.frame.colour && before.complete && after.complete);
    assert_eq!((faults.try_iter().collect::<Vec<_>>(), found.load(Ordering::Relaxed)), (vec![Code::Device], 2));
}

#[tokio::test]
async fn all_cores_take_over_where_no_device_can_be_had() {
    let Some(device) = device() else { return };
    let find = Box::new(|_| Err(Fault::new(Code::Device, "none", "", "")));
    let (engine, faults) = engine(Backend::Gpu(device), BackendChoice::Auto, find);
    draw(&engine).await.unwrap();
    lose(&engine).await;
    draw(&engine).await.unwrap();
    assert!(engine.run(1, |drawer| matches!(drawer, Drawer::Cpu(..))).await.unwrap());
    assert_eq!(faults.try_iter().collect::<Vec<_>>(), [Code::Device]);
}

#[tokio::test]
async fn without_any_backend_views_are_refused_at_once() {
    let Some(device) = device() else { return };
    let found = Arc::new(AtomicUsize::new(0));
    let counted = Arc::clone(&found);
    let find = Box::new(move |_| {
        counted.fetch_add(1, Ordering::Relaxed);
        Err(Fault::new(Code::Device, "none", "", ""))
    });
    let (engine, _faults) = engine(Backend::Gpu(device), BackendChoice::Gpu, find);
    lose(&engine).await;
    for _ in 0..3 {
        assert_eq!(draw(&engine).await.err().map(|fault| fault.code), Some(Code::Device));
    }
    assert_eq!(found.load(Ordering::Relaxed), 2, "only the first view tries for a device");
}

#[tokio::test]
async fn a_panic_ends_what_caused_it_and_nothing_else() {
    let (engine, faults) = engine(Backend::Cpu, BackendChoice::Cpu, Recovery::default().find);
    let before = draw(&engine).await.unwrap();
    assert!(engine.run(1, |_| -> () { panic!("a defect") }).await.is_err());
    assert!(draw(&engine).await.unwrap().frame.colour == before.frame.colour);
    assert_eq!(faults.try_iter().collect::<Vec<_>>(), [Code::Internal]);
}
