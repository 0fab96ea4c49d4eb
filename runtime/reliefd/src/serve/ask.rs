//! A viewer's view as the library's.

use std::sync::Arc;

use relief_front::error::ToolError;
use relief_protocol::error::{Code, Fault};
use relief_protocol::view::{self as protocol, View};
use relief_runtime::frame::{RenderError, Settings};
use relief_runtime::gpu::DeviceError;
use relief_runtime::planet::Planet;
use relief_runtime::view as library;

use crate::errors::of_render;
use crate::light::SunArgs;
use crate::typed::{AnglesArg, CameraArg, SizeArg, plain, time};
use crate::view_args::{OverlayChoice, SchemeChoice, ShadowChoice, ViewArgs};

/// A view of a planet, how it is drawn, and where its sun stands: sub-solar longitude and latitude,
/// or azimuth and elevation, degrees.
pub struct Asked {
    /// The view.
    pub view: library::View,
    /// How it is drawn.
    pub settings: Settings,
    /// Where the sun stands.
    pub sun_deg: [f64; 2],
}

/// What a viewer asked of a planet, checked.
///
/// # Errors
/// A view that shows nothing of this planet.
pub fn asked(view: &View, planet: &Arc<Planet>) -> Result<Asked, Fault> {
    view.check()?;
    let args = args(view)?;
    let (view, sun_deg) = args.lit_view(planet).map_err(|error| of_tool(Code::BadView, &error))?;
    Ok(Asked { view, settings: args.settings(), sun_deg })
}

fn args(view: &View) -> Result<ViewArgs, Fault> {
    let [x, y, height_m, heading, pitch, roll] = view.six();
    let at = match &view.time {
        None => None,
        Some(text) => Some(time(text).map_err(|error| {
            Fault::new(Code::BadView, error, "a time is RFC 3339", "send one such as 2026-06-21T12:00:00Z")
        })?),
    };
    Ok(ViewArgs {
        camera: CameraArg { x, y, height_m, turned_deg: [heading, pitch, roll] },
        fov: view.fov,
        size: SizeArg(view.size),
        sun: SunArgs::new(view.sun.map(AnglesArg), at),
        pixel_error: view.pixel_error,
        scheme: match view.scheme {
            protocol::Scheme::Leb => SchemeChoice::Leb,
            protocol::Scheme::Paper => SchemeChoice::Paper,
        },
        shadow: match view.shadow {
            protocol::Shadow::Exact => ShadowChoice::Exact,
            protocol::Shadow::Paper => ShadowChoice::Paper,
            protocol::Shadow::None => ShadowChoice::None,
        },
        air: view.air,
        soft: view.soft,
        overlay: match view.overlay {
            protocol::Overlay::None => None,
            protocol::Overlay::Wireframe => Some(OverlayChoice::Wireframe),
            protocol::Overlay::Lod => Some(OverlayChoice::Lod),
            protocol::Overlay::Pages => Some(OverlayChoice::Pages),
            protocol::Overlay::Error => Some(OverlayChoice::Error),
        },
    })
}

/// What was asked in the words of the command line, as a viewer says it.
pub fn view_of(args: &ViewArgs) -> View {
    let CameraArg { x, y, height_m, turned_deg: [heading, pitch, roll] } = args.camera;
    let (sun, at) = args.sun.given();
    View {
        pose: vec![x, y, height_m, heading, pitch, roll],
        fov: args.fov,
        size: args.size.0,
        sun,
        time: at.map(plain),
        pixel_error: args.pixel_error,
        scheme: match args.scheme {
            SchemeChoice::Leb => protocol::Scheme::Leb,
            SchemeChoice::Paper => protocol::Scheme::Paper,
        },
        shadow: match args.shadow {
            ShadowChoice::Exact => protocol::Shadow::Exact,
            ShadowChoice::Paper => protocol::Shadow::Paper,
            ShadowChoice::None => protocol::Shadow::None,
        },
        soft: args.soft,
        air: args.air,
        overlay: match args.overlay {
            None => protocol::Overlay::None,
            Some(OverlayChoice::Wireframe) => protocol::Overlay::Wireframe,
            Some(OverlayChoice::Lod) => protocol::Overlay::Lod,
            Some(OverlayChoice::Pages) => protocol::Overlay::Pages,
            Some(OverlayChoice::Error) => protocol::Overlay::Error,
        },
    }
}

/// What a command would print, as a fault. Flags lose their dashes: viewers know their names without.
pub fn of_tool(code: Code, error: &ToolError) -> Fault {
    let bare = |text: &str| text.replace("--", "");
    match error {
        ToolError::Usage { what, rule, remedy } => Fault::new(code, bare(what), bare(rule), bare(remedy)),
        other => Fault::new(
            Code::Internal,
            other.to_string(),
            "the daemon can read its files",
            "tell whoever runs the daemon; its log says more",
        ),
    }
}

/// A frame that was not drawn, as a fault.
pub fn of_draw(error: RenderError) -> Fault {
    if let RenderError::File(error) = &error {
        return Fault::new(
            Code::Damaged,
            error.to_string(),
            "every tile of a file is as it was published",
            "whoever runs the daemon copies or bakes the file again",
        );
    }
    let code = match &error {
        RenderError::View(_) => Code::BadView,
        RenderError::Device(DeviceError::OutOfMemory(_)) => Code::TooLarge,
        RenderError::Device(_) => Code::Device,
        RenderError::File(_) => Code::Damaged,
        RenderError::Capacity(_) => Code::Internal,
    };
    of_tool(code, &of_render(std::path::Path::new(""))(error))
}
