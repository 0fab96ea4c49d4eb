//! Where on a globe a projected raster may have data.

use super::projection::Transformer;

/// Longitudes and latitudes outside which the raster has nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Bounds {
    pub west_deg: f64,
    /// At most 360.
    pub span_deg: f64,
    pub south_deg: f64,
    pub north_deg: f64,
}

impl Bounds {
    /// Whether a rectangle may have data; a longitude span of 0 is a single meridian.
    pub fn meet(&self, west_deg: f64, span_deg: f64, south_deg: f64, north_deg: f64) -> bool {
        let ahead_deg = (west_deg - self.west_deg).rem_euclid(360.0);
        let pole = south_deg <= -90.0 || north_deg >= 90.0;
        south_deg <= self.north_deg
            && north_deg >= self.south_deg
            && (pole || self.span_deg >= 360.0 || ahead_deg <= self.span_deg || ahead_deg + span_deg >= 360.0)
    }

    /// Whether a parallel may have data.
    pub fn has_latitude(&self, lat_deg: f64) -> bool {
        (self.south_deg..=self.north_deg).contains(&lat_deg)
    }

    /// Whether a meridian may have data.
    pub fn has_longitude(&self, lon_deg: f64) -> bool {
        self.span_deg >= 360.0 || (lon_deg - self.west_deg).rem_euclid(360.0) <= self.span_deg
    }
}

/// Longitudes and latitudes the raster may reach, with a margin; everything where part of the
/// raster lies off the body.
pub(super) fn bounds(
    lon_lat: &dyn Fn(f64, f64) -> Option<[f64; 2]>,
    transformer: &Transformer<'_>,
    (nx, ny): (usize, usize),
) -> Bounds {
    const SIDE: usize = 64;
    let everything = Bounds { west_deg: -180.0, span_deg: 360.0, south_deg: -90.0, north_deg: 90.0 };
    let (w, h) = (nx as f64, ny as f64);
    let mut points = Vec::new();
    for j in 0..=SIDE {
        for i in 0..=SIDE {
            let (fx, fy) = (i as f64 / SIDE as f64, j as f64 / SIDE as f64);
            let rim = i == 0 || j == 0 || i == SIDE || j == SIDE;
            if rim || (i % 8 == 0 && j % 8 == 0) {
                let Some(point) = lon_lat(fx * w, fy * h) else {
                    return everything;
                };
                points.push(point);
            }
        }
    }
    let holds = |lat_deg: f64| {
        transformer.pixel(0.0, lat_deg).is_some_and(|[x, y]| x >= -1.0 && y >= -1.0 && x <= w + 1.0 && y <= h + 1.0)
    };
    let (north_pole, south_pole) = (holds(90.0), holds(-90.0));
    let lats = points.iter().map(|point| point[1]);
    let (south, north) = (lats.clone().fold(90.0, f64::min), lats.fold(-90.0, f64::max));
    let margin = (north - south) / 16.0 + 1e-6;
    let mut lons: Vec<f64> = points.iter().map(|point| point[0].rem_euclid(360.0)).collect();
    lons.sort_by(f64::total_cmp);
    // The raster lies where the widest gap between its longitudes is not.
    let wraps = lons.iter().skip(1).chain([&(lons[0] + 360.0)]).copied().collect::<Vec<_>>();
    let gap = (0..lons.len()).max_by(|a, b| (wraps[*a] - lons[*a]).total_cmp(&(wraps[*b] - lons[*b]))).unwrap_or(0);
    let (west, span) = (wraps[gap], 360.0 - (wraps[gap] - lons[gap]));
    let side = span / 16.0 + 1e-6;
    let all_round = north_pole || south_pole || span + 2.0 * side > 300.0;
    Bounds {
        west_deg: if all_round { -180.0 } else { west - side },
        span_deg: if all_round { 360.0 } else { span + 2.0 * side },
        south_deg: if south_pole { -90.0 } else { (south - margin).max(-90.0) },
        north_deg: if north_pole { 90.0 } else { (north + margin).min(90.0) },
    }
}
