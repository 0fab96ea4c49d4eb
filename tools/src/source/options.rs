//! What the user may say about the inputs; everything else comes from the files.

use std::path::PathBuf;

/// Linear unit of the stored heights.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Metre.
    M,
    /// International foot, 0.3048 m.
    Ft,
    /// US survey foot, 1200/3937 m.
    UsFt,
}

impl Unit {
    /// Metres in one unit.
    #[must_use]
    pub fn metres(self) -> f64 {
        match self {
            Self::M => 1.0,
            Self::Ft => 0.3048,
            Self::UsFt => 1200.0 / 3937.0,
        }
    }
}

/// Where the samples of a raster without georeference lie in its `bounds`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Registration {
    /// Samples are centres of cells; the bounds are the outer edges of the cells.
    #[default]
    Cell,
    /// The outermost samples lie on the bounds.
    Node,
}

/// What has to be added to the stored heights to make them ellipsoidal.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Vertical {
    /// Nothing: the heights are ellipsoidal.
    Ellipsoid,
    /// The undulation of EGM96, from PROJ's `egm96_15.gtx`.
    Egm96,
    /// The undulation in this grid (any raster GDAL reads, in longitude and latitude).
    Gtx(PathBuf),
    /// Nothing, by the user's explicit word.
    AsGiven,
}

/// The body the user names in place of the CRS's.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum BodyChoice {
    /// WGS-84.
    Earth,
    /// The IAU Moon.
    Moon,
    /// The IAU Mars.
    Mars,
    /// Semi-axes a and b, metres.
    Axes(f64, f64),
    /// A flat map in the source's CRS.
    Plane,
}

/// Resampling kernel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Resample {
    /// [`Resample::Average`] where a source is finer than the finest nodes, else [`Resample::Cubic`].
    #[default]
    Auto,
    /// The pixel that contains the node.
    Nearest,
    /// Linear in both directions.
    Bilinear,
    /// Keys (1981) with a = -1/2, also called Catmull-Rom.
    Cubic,
    /// Windowed sinc over three lobes, normalised.
    Lanczos,
    /// Mean over the cell of the finest node grid, weighted by covered area.
    Average,
}

/// What becomes of nodes whose pixel is void.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Fill {
    /// They stay void.
    #[default]
    None,
    /// Smooth interpolation from the rim of the void, on the source's own pixels.
    Interpolate,
    /// They stay void here; the caller writes this height, metres.
    Constant(f64),
}

/// Everything the user may say about the inputs.
#[derive(Clone, Debug)]
pub struct SourceOptions {
    /// Stored value that means void; replaces the file's own.
    pub nodata: Option<f64>,
    /// Height units per stored unit; replaces the file's own.
    pub scale: Option<f64>,
    /// Height of the stored zero; replaces the file's own.
    pub offset: Option<f64>,
    /// Unit of the scaled values; replaces the file's own.
    pub unit: Option<Unit>,
    /// West, south, east, north in degrees (plane: in its units) of inputs without georeference.
    pub bounds: Option<[f64; 4]>,
    /// How such an input's samples lie in its bounds.
    pub registration: Option<Registration>,
    /// EXR channel by name; for other formats a band by number or description.
    pub channel: Option<String>,
    /// What the heights are measured from.
    pub vertical: Option<Vertical>,
    /// The body, in place of the CRS's; longitudes and latitudes are then taken as they are.
    pub body: Option<BodyChoice>,
    /// Kernel from pixels to nodes.
    pub resample: Resample,
    /// What becomes of voids.
    pub fill: Fill,
    /// Memory the whole bake may use, bytes; pixels get at most a third.
    pub memory_bytes: u64,
    /// Threads that may read and decode, at least 1.
    pub threads: usize,
}

impl Default for SourceOptions {
    fn default() -> Self {
        Self {
            nodata: None,
            scale: None,
            offset: None,
            unit: None,
            bounds: None,
            registration: None,
            channel: None,
            vertical: None,
            body: None,
            resample: Resample::Auto,
            fill: Fill::None,
            memory_bytes: 1 << 30,
            threads: 1,
        }
    }
}
