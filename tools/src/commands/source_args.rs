//! What every command that reads rasters may be told about them, and the words for it.

use clap::ValueEnum;

use crate::source::{BodyChoice, Fill, Registration, Resample, SourceOptions, Unit, Vertical};
use relief_front::bytes::parse_bytes;
use relief_front::error::ToolError;

/// How the inputs are to be understood; each replaces what the files say of themselves.
#[derive(Clone, Debug, clap::Args)]
pub struct SourceArgs {
    /// earth, moon, mars, semi-axes A,B in metres, or plane; default: from the source's CRS.
    #[arg(long, value_parser = parse_body)]
    body: Option<BodyChoice>,
    /// What heights are measured from: ellipsoid, egm96 (added), a geoid grid PATH.gtx (added), as-given.
    #[arg(long, value_parser = parse_vertical)]
    vertical: Option<Vertical>,
    /// Stored value that means void; replaces the file's own tag.
    #[arg(long, value_name = "V", allow_negative_numbers = true)]
    nodata: Option<f64>,
    /// Nodes without data: none (0 m, marked), interpolate, or a height in metres.
    #[arg(long, value_parser = parse_fill, default_value = "none", allow_negative_numbers = true)]
    fill: Fill,
    /// Height units per stored unit; replaces the file's own tag.
    #[arg(long, allow_negative_numbers = true)]
    scale: Option<f64>,
    /// Height of the stored zero; replaces the file's own tag.
    #[arg(long, allow_negative_numbers = true)]
    offset: Option<f64>,
    /// Unit of the heights; replaces the file's own tag.
    #[arg(long, value_enum)]
    unit: Option<UnitArg>,
    /// West, south, east, north in degrees, for inputs without georeference.
    #[arg(long, value_name = "W,S,E,N", value_parser = parse_bounds, allow_hyphen_values = true)]
    bounds: Option<[f64; 4]>,
    /// What the bounds are: edges of cells, or the outermost samples.
    #[arg(long, value_enum)]
    registration: Option<RegistrationArg>,
    /// EXR channel.
    #[arg(long, value_name = "NAME")]
    channel: Option<String>,
    /// Threads; default: all cores. The bytes of a file do not depend on it.
    #[arg(long)]
    threads: Option<usize>,
    /// Memory to stay within, such as 512MiB or 2GiB.
    #[arg(long, value_name = "BYTES", default_value = "1GiB", value_parser = parse_bytes)]
    memory: u64,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum UnitArg {
    M,
    Ft,
    UsFt,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum RegistrationArg {
    Cell,
    Node,
}

impl SourceArgs {
    /// The options they stand for, with a kernel.
    ///
    /// # Errors
    /// [`ToolError::Usage`] for no threads.
    pub(super) fn options(&self, resample: Resample) -> Result<SourceOptions, ToolError> {
        let threads = self.threads.unwrap_or_else(|| std::thread::available_parallelism().map_or(1, Into::into));
        if threads == 0 {
            return Err(ToolError::usage("--threads 0", "at least one thread", "leave --threads out to use all cores"));
        }
        Ok(SourceOptions {
            nodata: self.nodata,
            scale: self.scale,
            offset: self.offset,
            unit: self.unit.map(|u| match u {
                UnitArg::M => Unit::M,
                UnitArg::Ft => Unit::Ft,
                UnitArg::UsFt => Unit::UsFt,
            }),
            bounds: self.bounds,
            registration: self.registration.map(|r| match r {
                RegistrationArg::Cell => Registration::Cell,
                RegistrationArg::Node => Registration::Node,
            }),
            channel: self.channel.clone(),
            vertical: self.vertical.clone(),
            body: self.body,
            resample,
            fill: self.fill,
            memory_bytes: self.memory,
            threads,
        })
    }
}

/// What clap prints after the value that it names.
pub(crate) fn refusal(rule: &str, remedy: &str) -> String {
    format!("\n  rule: {rule}\n  remedy: {remedy}")
}

fn parse_body(text: &str) -> Result<BodyChoice, String> {
    Ok(match text {
        "earth" => BodyChoice::Earth,
        "moon" => BodyChoice::Moon,
        "mars" => BodyChoice::Mars,
        "plane" => BodyChoice::Plane,
        axes => match parse_numbers::<2>(axes) {
            Some([a, b]) if a > 0.0 && b > 0.0 => BodyChoice::Axes(a, b),
            _ => {
                let rule = "a body is earth, moon, mars, plane, or two semi-axes A,B in metres";
                return Err(refusal(rule, "name one, such as --body moon or --body 6051800,6051800"));
            }
        },
    })
}

fn parse_vertical(text: &str) -> Result<Vertical, String> {
    Ok(match text {
        "ellipsoid" => Vertical::Ellipsoid,
        "egm96" => Vertical::Egm96,
        "as-given" => Vertical::AsGiven,
        path if path.contains('.') => Vertical::Gtx(path.into()),
        _ => {
            let rule = "it is ellipsoid, egm96, as-given, or the path of a geoid grid such as PATH.gtx";
            return Err(refusal(rule, "say --vertical egm96 for heights above sea level"));
        }
    })
}

fn parse_fill(text: &str) -> Result<Fill, String> {
    Ok(match text {
        "none" => Fill::None,
        "interpolate" => Fill::Interpolate,
        metres => match metres.parse::<f64>() {
            Ok(v) if v.is_finite() => Fill::Constant(v),
            _ => return Err(refusal("a fill is none, interpolate, or a height in metres", "say --fill none")),
        },
    })
}

fn parse_bounds(text: &str) -> Result<[f64; 4], String> {
    let remedy = "give them as in --bounds=-180,-90,180,90";
    parse_numbers(text).ok_or_else(|| refusal("bounds are four finite numbers of degrees W,S,E,N", remedy))
}

fn parse_numbers<const N: usize>(text: &str) -> Option<[f64; N]> {
    let numbers: Option<Vec<f64>> =
        text.split(',').map(|t| t.trim().parse().ok().filter(|v: &f64| v.is_finite())).collect();
    numbers?.try_into().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_of_the_command_line() {
        assert_eq!(parse_body("6378137,6356752"), Ok(BodyChoice::Axes(6_378_137.0, 6_356_752.0)));
        assert!(parse_body("pluto").is_err());
        assert_eq!(parse_fill("-3.5"), Ok(Fill::Constant(-3.5)));
        assert!(parse_fill("nan").is_err());
        assert_eq!(parse_vertical("geoid/x.gtx"), Ok(Vertical::Gtx("geoid/x.gtx".into())));
        assert!(parse_vertical("msl").is_err());
        assert_eq!(parse_bounds("-180,-90,180,90"), Ok([-180.0, -90.0, 180.0, 90.0]));
        assert!(parse_bounds("1,2,3").is_err());
    }
}
