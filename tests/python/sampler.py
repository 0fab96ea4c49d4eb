"""Heights of a raster at pixel coordinates in f64, for `oracle_resample`, which states the rules."""

import math

import numpy as np

VOID, DATA, FILLED, EITHER = 0, 1, 2, 3
TIE_PX = {True: 1e-6, False: 1e-4}  # by is_lonlat: a projection's pixel coordinates are less exact


class Sampler:
    """Heights at pixel coordinates (sample centres are integers; f64)."""

    def __init__(self, raster):
        self.raster = raster
        self.h = raster.height_m
        self.rows, self.columns = self.h.shape
        self.period, self.period_px = 0, math.inf  # period: whole columns of a raster that wraps
        self.north_row = self.south_row = None  # the rows on or next to the poles
        self.pole_step = {0: 0, self.rows - 1: 0}  # how far a row beyond reflects: 1 on, 0 next to
        if raster.is_lonlat() and raster.is_axis_aligned():
            self._find_wrap()
            self._find_poles()

    def _find_wrap(self):
        self.period_px = 360.0 / abs(self.raster.geotransform[1])
        period = round(self.period_px)
        if abs(self.period_px - period) < 0.01 and self.columns >= period:
            self.period = period

    def _find_poles(self):
        _, _, _, top, _, dy = self.raster.geotransform
        for row in (0, self.rows - 1):
            outwards = -0.5 if row == 0 else 0.5
            for pole in (-90.0, 90.0):
                at_sample = abs(top + dy * (row + 0.5) - pole) < 0.01 * abs(dy)
                at_edge = abs(top + dy * (row + 0.5 + outwards) - pole) < 0.01 * abs(dy)
                if at_sample or (at_edge and not self.raster.samples_bound):
                    self.pole_step[row] = int(at_sample)
                    if pole > 0:
                        self.north_row = row
                    else:
                        self.south_row = row

    def pole_height_m(self, row):
        """Mean over the distinct columns of a pole row, NaN without data."""
        line = self.h[row, : self.period or self.columns]
        line = line[np.isfinite(line)]
        return line.mean() if line.size else math.nan

    def into_period(self, c):
        """Pixel columns moved by whole turns to [-0.5, period - 0.5)."""
        if math.isinf(self.period_px):
            return c
        c = c - self.period_px * np.floor((c + 0.5) / self.period_px)
        return np.where(c + 0.5 > self.period_px - 1e-9, c - self.period_px, c)

    def tap(self, c, r):
        """Samples at integer pixel coordinates: wrapped, reflected or clamped."""
        c, r = np.broadcast_arrays(c, r)
        if self.period and self.period % 2 == 0:
            north_of = (r < 0) & (0 in (self.north_row, self.south_row))
            south_of = (r >= self.rows) & (self.rows - 1 in (self.north_row, self.south_row))
            r = np.where(north_of, -r - 1 + self.pole_step[0], r)
            r = np.where(south_of, 2 * self.rows - 1 - self.pole_step[self.rows - 1] - r, r)
            c = np.where(north_of | south_of, c + self.period // 2, c)
        c = c % self.period if self.period else np.clip(c, 0, self.columns - 1)
        return self.h[np.clip(r, 0, self.rows - 1), c]

    def containing(self, c, r, nudge):
        """The sample of the pixel that contains (c, r) moved by `nudge`, NaN outside the extent."""
        cc, rr = c + 0.5 + nudge[0], r + 0.5 + nudge[1]
        inside = np.isfinite(cc) & np.isfinite(rr)
        cc, rr = np.where(inside, cc, 0), np.where(inside, rr, 0)
        margin = 0.5 if self.raster.samples_bound else 0.0
        if not self.period:
            inside = inside & (cc >= margin) & (cc <= self.columns - margin)
        inside = inside & (rr >= margin) & (rr <= self.rows - margin)
        height_m = self.tap(np.floor(cc).astype(np.int64), np.floor(rr).astype(np.int64))
        return np.where(inside, height_m, np.nan)

    def bilinear(self, c, r):
        """Four taps, void ones dropped, weights renormalised; NaN without any."""
        c, r = np.where(np.isfinite(c), c, 0), np.where(np.isfinite(r), r, 0)
        c0, r0 = np.floor(c).astype(np.int64), np.floor(r).astype(np.int64)
        fc, fr = c - c0, r - r0
        total, weights = 0.0, 0.0
        for dc, wc in ((0, 1 - fc), (1, fc)):
            for dr, wr in ((0, 1 - fr), (1, fr)):
                height_m = self.tap(c0 + dc, r0 + dr)
                weight = np.where(np.isnan(height_m), 0.0, wc * wr)
                total = total + weight * np.nan_to_num(height_m)
                weights = weights + weight
        with np.errstate(invalid="ignore", divide="ignore"):
            return np.where(weights > 0, total / weights, np.nan)

    def sample(self, c, r, kernel):
        """(low_m, high_m, state) at pixel coordinates that broadcast against each other."""
        c, r = np.broadcast_arrays(self.into_period(c), r)
        tie = TIE_PX[self.raster.is_lonlat()]
        candidates = [self.containing(c, r, (dc, dr)) for dc in (-tie, tie) for dr in (-tie, tie)]
        valid = np.sum([np.isfinite(v) for v in candidates], axis=0)
        state = np.where(valid == 4, DATA, np.where(valid == 0, VOID, EITHER)).astype(np.uint8)
        if kernel == "nearest":
            low, high = np.fmin.reduce(candidates), np.fmax.reduce(candidates)
        else:
            low = high = np.where(state == VOID, np.nan, self.bilinear(c, r))
        return low, high, state
