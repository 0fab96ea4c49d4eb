//! Geoid undulations: what turns orthometric heights into ellipsoidal ones, added once.

use std::path::PathBuf;
use std::sync::Arc;

use relief_formats::body::Body;
use relief_formats::grid::Grid;

use super::NodeWindow;
use super::crs::VerticalCrs;
use super::gdal_reader::{GdalReader, open_band};
use super::georef::Georef;
use super::heights::HeightRule;
use super::options::{SourceOptions, Vertical};
use super::place::lon_lat_axes;
use super::raster::{Raster, Reader};
use super::record::{file_name, hash_file};
use super::sample::lon_deg;
use crate::resample::axis::Axis;
use relief_front::error::ToolError;

/// PROJ's file of EGM96 on a grid of 15'.
const EGM96: &str = "egm96_15.gtx";

/// Undulations on a grid of longitudes and latitudes.
pub(crate) struct Geoid {
    path: String,
    columns: Axis,
    rows: Axis,
    pixels: Arc<Vec<f32>>,
    /// File name.
    pub file: String,
    pub blake3: Option<String>,
}

/// What heights are measured from once a source has been sampled.
#[derive(Clone)]
pub(crate) enum Reference {
    Ellipsoid,
    AsGiven,
    Geoid(Arc<Geoid>),
}

/// Decides what is added to a source's heights. Geoids opened for other sources are in `known`.
///
/// # Errors
/// [`ToolError::Source`] when Earth's heights have no known reference; [`ToolError::Usage`] when
/// a geoid is asked for where there is none, or cannot be found.
pub(crate) fn reference(
    path: &str,
    said: Option<&VerticalCrs>,
    body: &Body,
    options: &SourceOptions,
    known: &mut Vec<Arc<Geoid>>,
) -> Result<Reference, ToolError> {
    let earth = *body == Body::earth();
    let choice = match (&options.vertical, said) {
        (Some(choice), _) => choice.clone(),
        (None, Some(VerticalCrs::Ellipsoidal)) => Vertical::Ellipsoid,
        (None, Some(VerticalCrs::Egm96)) if earth => Vertical::Egm96,
        (None, _) if !earth => Vertical::AsGiven,
        (None, said) => {
            let what = match said {
                Some(VerticalCrs::Other(name)) => {
                    format!("its heights refer to {name:?}, which this tool has no grid for")
                }
                _ => "it does not say what its heights are measured from".to_owned(),
            };
            return Err(ToolError::source(
                path,
                what,
                "heights on Earth are made ellipsoidal once, by a known reference",
                "say --vertical egm96 (most DEMs: above sea level), ellipsoid, PATH.gtx, or as-given",
            ));
        }
    };
    let geoid_path = match choice {
        Vertical::Ellipsoid => return Ok(Reference::Ellipsoid),
        Vertical::AsGiven => return Ok(Reference::AsGiven),
        Vertical::Egm96 => find_egm96()?,
        Vertical::Gtx(path) => path,
    };
    if !earth {
        return Err(ToolError::usage(
            format!("--vertical with a geoid, {} for {path}", geoid_path.display()),
            "a geoid is added to heights on Earth, at known longitudes and latitudes",
            "say --vertical as-given or --vertical ellipsoid",
        ));
    }
    let geoid_path = geoid_path.to_string_lossy().into_owned();
    if let Some(geoid) = known.iter().find(|geoid| geoid.path == geoid_path) {
        return Ok(Reference::Geoid(geoid.clone()));
    }
    let geoid = Arc::new(Geoid::open(&geoid_path)?);
    known.push(geoid.clone());
    Ok(Reference::Geoid(geoid))
}

/// Sea level as EGM96 has it, for pictures of files whose heights are above the ellipsoid.
pub struct SeaLevel(Geoid);

impl SeaLevel {
    /// EGM96 from PROJ's data; none where it is not installed or cannot be read.
    #[must_use]
    pub fn egm96() -> Option<Self> {
        Geoid::open(&find_egm96().ok()?.to_string_lossy()).ok().map(Self)
    }

    /// Height of the sea above the ellipsoid at a place, metres.
    #[must_use]
    pub fn height_m(&self, lon_deg: f64, lat_deg: f64) -> Option<f64> {
        self.0.undulation_m(lon_deg, lat_deg)
    }
}

/// Looks where PROJ looks.
fn find_egm96() -> Result<PathBuf, ToolError> {
    let named = ["PROJ_DATA", "PROJ_LIB"].into_iter().filter_map(std::env::var_os);
    let mut folders: Vec<PathBuf> = named.flat_map(|list| std::env::split_paths(&list).collect::<Vec<_>>()).collect();
    folders.extend(["/usr/share/proj", "/usr/local/share/proj"].map(PathBuf::from));
    folders.iter().map(|folder| folder.join(EGM96)).find(|path| path.is_file()).ok_or_else(|| {
        let tried: Vec<_> = folders.iter().map(|folder| folder.display().to_string()).collect();
        ToolError::usage(
            format!("--vertical egm96: {EGM96} is not in {}", tried.join(", ")),
            "the EGM96 grid lies in a folder of PROJ's data",
            "install proj-data (Debian), set PROJ_DATA, or say --vertical PATH.gtx",
        )
    })
}

impl Geoid {
    fn open(path: &str) -> Result<Self, ToolError> {
        let plain = SourceOptions::default();
        let band = open_band(path, None)?;
        let georef = Georef::of_dataset(path, &band.dataset, &plain)?;
        if !georef.axis_aligned() || georef.crs.as_ref().is_some_and(|crs| !crs.geographic) {
            return Err(ToolError::source(
                path,
                "it is not a grid of longitudes and latitudes",
                "a geoid is a .gtx file or another raster in longitude and latitude",
                "convert it with gdalwarp -t_srs EPSG:4326",
            ));
        }
        let size = (band.width, band.height);
        let (columns, rows) = lon_lat_axes(size, &georef);
        let rule = HeightRule::new(path, &band.tags, &plain, &Body::earth())?;
        let raster = Raster::new(path, size, Reader::Gdal(GdalReader::new(path, band, rule)), u64::MAX, 1);
        let (pixels, blake3) = (raster.whole()?, hash_file(path)?);
        Ok(Self { path: path.to_owned(), columns, rows, pixels, file: file_name(path), blake3 })
    }

    /// Adds the undulation to every height of a window that is not NaN.
    ///
    /// # Errors
    /// [`ToolError::Source`] where the geoid has no value for a node that has data.
    pub fn add(&self, grid: &Grid, window: &NodeWindow, heights_m: &mut [f64]) -> Result<(), ToolError> {
        let lons = (0..window.nx as i64).map(|i| lon_deg(grid, window.level, window.x0 + i));
        let us: Vec<_> = lons.map(|lon| self.columns.longitude_position(lon).map(|u| taps(&self.columns, u))).collect();
        // A pole has one undulation whatever the column.
        let pole = self.columns.longitude_position(-180.0).map(|u| taps(&self.columns, u));
        for j in 0..window.ny {
            let lat_deg = grid.lat_deg(window.level, window.y0 + j as i64);
            let v = self.rows.position(lat_deg).map(|v| taps(&self.rows, v));
            for (i, height_m) in heights_m[j * window.nx..][..window.nx].iter_mut().enumerate() {
                if height_m.is_nan() {
                    continue;
                }
                let u = if lat_deg.abs() >= 90.0 { pole } else { us[i] };
                let undulation_m = match (u, v) {
                    (Some(u), Some(v)) => self.bilinear(u, v),
                    _ => f64::NAN,
                };
                if undulation_m.is_nan() {
                    let lon = lon_deg(grid, window.level, window.x0 + i as i64);
                    return Err(ToolError::source(
                        &self.path,
                        format!("it has no undulation at longitude {lon}, latitude {lat_deg}"),
                        "a geoid covers all of the source",
                        "name a geoid that does with --vertical PATH.gtx",
                    ));
                }
                *height_m += undulation_m;
            }
        }
        Ok(())
    }

    /// The undulation at a longitude and latitude, metres; none outside the grid and at its voids.
    pub fn undulation_m(&self, lon_deg: f64, lat_deg: f64) -> Option<f64> {
        let lon_deg = if lat_deg.abs() >= 90.0 { -180.0 } else { lon_deg };
        let u = taps(&self.columns, self.columns.longitude_position(lon_deg)?);
        let v = taps(&self.rows, self.rows.position(lat_deg)?);
        Some(self.bilinear(u, v)).filter(|undulation_m| undulation_m.is_finite())
    }

    fn bilinear(&self, u: (usize, usize, f64), v: (usize, usize, f64)) -> f64 {
        let line = |row: usize| {
            let at = |column: usize| f64::from(self.pixels[row * self.columns.n + column]);
            // A neighbour without weight may be void.
            if u.2 == 0.0 { at(u.0) } else { (1.0 - u.2) * at(u.0) + u.2 * at(u.1) }
        };
        if v.2 == 0.0 { line(v.0) } else { (1.0 - v.2) * line(v.0) + v.2 * line(v.1) }
    }
}

/// The samples on both sides of a position, and the share of the way to the second.
fn taps(axis: &Axis, u: f64) -> (usize, usize, f64) {
    let low = u.floor() as i64;
    (axis.stored(low).0, axis.stored(low + 1).0, u - u.floor())
}

impl Reference {
    /// What a record says.
    pub fn describe(&self) -> (String, Option<String>) {
        match self {
            Self::Ellipsoid => ("ellipsoid".into(), None),
            Self::AsGiven => ("as-given".into(), None),
            Self::Geoid(geoid) => (geoid.file.clone(), geoid.blake3.clone()),
        }
    }
}

/// Refuses a geoid on a plane.
///
/// # Errors
/// [`ToolError::Usage`] for `--vertical egm96` or a grid.
pub(crate) fn plane_reference(options: &SourceOptions) -> Result<Reference, ToolError> {
    match &options.vertical {
        Some(Vertical::Egm96 | Vertical::Gtx(_)) => Err(ToolError::usage(
            "--vertical with a geoid and --body plane",
            "a plane's heights are kept as the source gives them",
            "leave --vertical out, or say --vertical as-given",
        )),
        Some(Vertical::Ellipsoid) => Ok(Reference::Ellipsoid),
        _ => Ok(Reference::AsGiven),
    }
}
