//! From stored values to metres: voids, scale, offset, unit, and radii that pose as heights.

use relief_formats::body::Body;

use super::options::SourceOptions;
use relief_front::error::ToolError;

/// Values of this magnitude and beyond are void whatever the tags say.
const ABSURD: f64 = 1e30;

/// What a band says about its own values.
#[derive(Clone, Debug, Default)]
pub(crate) struct BandTags {
    pub nodata: Option<f64>,
    pub scale: Option<f64>,
    pub offset: Option<f64>,
    /// Unit text as in the file, empty when absent.
    pub unit: String,
    /// Metres per unit where something other than the band's text says it.
    pub unit_m: Option<f64>,
    /// Stored as 32-bit floats: a nodata tag is compared after the same rounding.
    pub float32: bool,
    /// Stored as integers.
    pub integer: bool,
}

/// height = `raw * scale + offset` metres, unless void.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HeightRule {
    pub nodata: Option<f64>,
    pub scale: f64,
    pub offset: f64,
    pub unit_m: f64,
    /// The semi-axis taken off, metres: the stored values were radii.
    pub radius_m: f64,
    float32: bool,
    integer: bool,
    scale_m: f64,
    offset_m: f64,
}

impl HeightRule {
    /// Joins the band's tags with the user's word.
    ///
    /// # Errors
    /// [`ToolError::Source`] for a unit that is not known, [`ToolError::Usage`] for a scale of 0.
    pub fn new(path: &str, tags: &BandTags, options: &SourceOptions, body: &Body) -> Result<Self, ToolError> {
        let unit_m = match options.unit {
            Some(unit) => unit.metres(),
            None => tags.unit_m.or_else(|| unit_metres(&tags.unit)).ok_or_else(|| {
                ToolError::source(
                    path,
                    format!("the band's unit is {:?}", tags.unit),
                    "heights are in a linear unit this tool knows (m, ft, us-ft, km, cm, mm)",
                    "say the unit with --unit m, --unit ft or --unit us-ft, and --scale for others",
                )
            })?,
        };
        let scale = options.scale.or(tags.scale).unwrap_or(1.0);
        let offset = options.offset.or(tags.offset).unwrap_or(0.0);
        if !scale.is_finite() || scale == 0.0 || !offset.is_finite() {
            return Err(ToolError::usage(
                format!("{path}: scale {scale}, offset {offset}"),
                "scale is finite and not 0, offset is finite",
                "give --scale and --offset, or repair the tags of the file",
            ));
        }
        let mut offset_m = offset * unit_m;
        let mut radius_m = 0.0;
        if let Body::Ellipsoid { a_m, .. } = body
            && (offset_m - a_m).abs() < 0.01 * a_m
        {
            radius_m = *a_m;
            offset_m -= a_m;
        }
        Ok(Self {
            nodata: options.nodata.or(tags.nodata),
            scale,
            offset,
            unit_m,
            radius_m,
            float32: tags.float32,
            integer: tags.integer,
            scale_m: scale * unit_m,
            offset_m,
        })
    }

    /// Metres above the reference, NaN for a void.
    #[inline]
    pub fn height_m(&self, raw: f64) -> f32 {
        if raw.is_nan() || raw.abs() >= ABSURD || self.is_nodata(raw) {
            return f32::NAN;
        }
        (raw * self.scale_m + self.offset_m) as f32
    }

    #[inline]
    fn is_nodata(&self, raw: f64) -> bool {
        match self.nodata {
            Some(nodata) if self.float32 => raw as f32 == nodata as f32,
            Some(nodata) => raw == nodata,
            None => false,
        }
    }

    /// The largest power of two that divides every height this rule can give, if there is a
    /// sensible one: integers with a binary scale.
    pub fn native_step_m(&self) -> Option<f64> {
        if !self.integer {
            return None;
        }
        let step = power_of_two_divisor(self.scale_m)?;
        let step = power_of_two_divisor(self.offset_m).map_or(step, |offset| step.min(offset));
        (step >= 1.0 / 1024.0).then_some(step)
    }
}

/// The largest power of two of which `value` is a multiple; none for 0.
fn power_of_two_divisor(value: f64) -> Option<f64> {
    if value == 0.0 || !value.is_finite() {
        return None;
    }
    let mut step = 2f64.powi(20);
    while (value / step).fract() != 0.0 {
        step /= 2.0;
    }
    Some(step)
}

/// Metres in the unit a file names; 1 for the empty string.
fn unit_metres(text: &str) -> Option<f64> {
    let plain = text.trim().trim_matches(['[', ']', '(', ')']).to_ascii_lowercase().replace(['_', '-'], " ");
    Some(match plain.as_str() {
        "" | "m" | "metre" | "metres" | "meter" | "meters" | "unknown" => 1.0,
        "km" | "kilometre" | "kilometres" | "kilometer" | "kilometers" => 1000.0,
        "dm" | "decimetre" | "decimeter" => 0.1,
        "cm" | "centimetre" | "centimeter" | "centimetres" | "centimeters" => 0.01,
        "mm" | "millimetre" | "millimeter" | "millimetres" | "millimeters" => 0.001,
        "ft" | "foot" | "feet" | "international foot" | "international feet" => 0.3048,
        "us ft" | "ftus" | "us survey foot" | "us survey feet" | "foot us" | "us foot" | "us feet" | "sft" => {
            1200.0 / 3937.0
        }
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::source::options::Unit;

    fn rule(tags: &BandTags, options: &SourceOptions) -> Result<HeightRule, ToolError> {
        HeightRule::new("f.tif", tags, options, &Body::moon())
    }

    #[test]
    fn units_scales_and_voids() {
        let tags =
            BandTags { unit: "US survey foot".into(), nodata: Some(-9999.9), float32: true, ..BandTags::default() };
        let feet = rule(&tags, &SourceOptions::default()).unwrap();
        assert_eq!(feet.height_m(3937.0), 1200.0);
        for void in [f64::NAN, f64::INFINITY, -3.4e38, f64::from(-9999.9_f32)] {
            assert!(feet.height_m(void).is_nan(), "{void}");
        }
        assert!(!feet.height_m(-32768.0).is_nan());
        let options =
            SourceOptions { unit: Some(Unit::M), nodata: Some(0.0), scale: Some(2.0), ..SourceOptions::default() };
        let metres = rule(&tags, &options).unwrap();
        assert_eq!(metres.height_m(-9999.0), -19998.0);
        assert!(metres.height_m(0.0).is_nan());
    }

    #[test]
    fn unknown_units_and_zero_scales_are_refused() {
        let tags = BandTags { unit: "degC".into(), ..BandTags::default() };
        assert!(rule(&tags, &SourceOptions::default()).unwrap_err().to_string().contains("degC"));
        let options = SourceOptions { scale: Some(0.0), ..SourceOptions::default() };
        assert!(matches!(rule(&BandTags::default(), &options), Err(ToolError::Usage { .. })));
    }

    #[test]
    fn radii_become_heights() {
        let tags = BandTags { scale: Some(0.5), offset: Some(1_737_400.0), integer: true, ..BandTags::default() };
        let moon = rule(&tags, &SourceOptions::default()).unwrap();
        assert_eq!((moon.height_m(-3.0), moon.radius_m, moon.native_step_m()), (-1.5, 1_737_400.0, Some(0.5)));
        let tags = BandTags { offset: Some(1737.4), unit: "KM".into(), ..BandTags::default() };
        assert!((rule(&tags, &SourceOptions::default()).unwrap().height_m(1.5) - 1500.0).abs() < 1e-3);
    }

    #[test]
    fn native_steps() {
        let step = |scale, offset, integer| {
            let tags = BandTags { scale: Some(scale), offset: Some(offset), integer, ..BandTags::default() };
            rule(&tags, &SourceOptions::default()).unwrap().native_step_m()
        };
        assert_eq!(step(1.0, 0.0, true), Some(1.0));
        assert_eq!(step(0.5, 0.0, true), Some(0.5));
        assert_eq!(step(6.0, 0.25, true), Some(0.25));
        assert_eq!((step(0.1, 0.0, true), step(1.0, 0.0, false)), (None, None));
    }
}
