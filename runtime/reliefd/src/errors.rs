//! What the library says, as messages with value, rule and remedy.

use std::path::Path;

use relief_front::error::ToolError;
use relief_runtime::frame::RenderError;
use relief_runtime::gpu::DeviceError;
use relief_runtime::planet::{CACHE_BYTES, OpenError, Planet};
use relief_runtime::sun::SunError;
use relief_runtime::view::ViewError;

use crate::truncated;

/// Opens a file, or says why not.
pub fn open(path: &Path) -> Result<std::sync::Arc<Planet>, ToolError> {
    let relief = truncated::open(path).map_err(ToolError::of_file(path))?;
    Planet::new(relief, CACHE_BYTES).map_err(opened(path))
}

/// A file that cannot be opened as a planet.
pub fn opened(path: &Path) -> impl Fn(OpenError) -> ToolError + Copy + '_ {
    move |error| match error {
        OpenError::File(error) => ToolError::of_file(path)(error),
        OpenError::Range { what, value, rule } => ToolError::source(
            path.display().to_string(),
            format!("{what} of {value} m"),
            format!("a body that can be drawn has {rule}"),
            "bake the file again with the body's semi-axes or the CRS's units in metres",
        ),
    }
}

/// A frame that was not drawn.
pub fn of_render(path: &Path) -> impl Fn(RenderError) -> ToolError + Copy + '_ {
    move |error| match error {
        RenderError::View(error) => of_view(error),
        RenderError::Device(error) => of_device(error),
        RenderError::File(error) => ToolError::of_file(path)(error),
        RenderError::Capacity(error) => ToolError::usage(
            error.to_string(),
            "the coarsest tiles and some finer ones fit the memory that a backend may use",
            "try --backend cpu",
        ),
    }
}

/// A view that shows nothing.
pub fn of_view(error: ViewError) -> ToolError {
    let (rule, remedy) = match error {
        ViewError::Angle(_) => {
            ("a longitude is finite, a latitude lies within -90 to 90 degrees", "correct the coordinates")
        }
        ViewError::Number { .. } => ("a camera and its sun are somewhere and look somewhere", "correct the number"),
        ViewError::Size { .. } => {
            ("a picture has pixels, and no more than the backend can hold", "give another --size")
        }
        ViewError::Kernel { rule, .. } => (rule, "give --shadow exact"),
        ViewError::Body { given: "plane", .. } => {
            ("a globe has longitudes and latitudes", "give LON,LAT; `relief-bake inspect` shows what the file holds")
        }
        ViewError::Body { .. } => (
            "a plane has X and Y in its CRS and a sun at AZIMUTH,ELEVATION",
            "give X,Y and AZIMUTH,ELEVATION; `relief-bake inspect` shows where the file lies",
        ),
    };
    ToolError::usage(error.to_string(), rule, remedy)
}

/// A GPU that is not there or gave up.
pub fn of_device(error: DeviceError) -> ToolError {
    let remedy = match error {
        DeviceError::OutOfMemory(_) => "give a smaller --size, or --backend cpu",
        DeviceError::Lost(_) => "run again; if it stays lost, --backend cpu needs no GPU",
        _ => "install a Vulkan, Metal or DirectX 12 driver, or give --backend cpu",
    };
    ToolError::usage(error.to_string(), "--backend gpu needs an adapter that works", remedy)
}

/// A time without a known sun.
pub fn of_sun(error: SunError) -> ToolError {
    ToolError::usage(
        error.to_string(),
        "a time is one at which the sun's place is known",
        "give another time, or the sub-solar point with --sun LON,LAT",
    )
}
