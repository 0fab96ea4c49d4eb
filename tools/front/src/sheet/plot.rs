//! Plots as SVG: a drawing, and axes with round ticks.

use std::fmt::{Display, Write as _};

use super::number::{escaped, significant};

/// Colours and type of every plot, for light and dark surroundings.
pub const STYLE: &str = "\
.plot text{font:13px system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif;fill:#2b3138}\
.plot .soft{fill:#5d6773}.plot .strong{font-weight:600}\
.plot .grid{stroke:#dde2e8}.plot .axis{stroke:#8a949f}\
.plot .a{fill:#2f6fb0}.plot .b{fill:#d97a1f}.plot .c{fill:#3a9164}.plot .d{fill:#8a63b8}.plot .e{fill:#c9a227}.plot .f{fill:#98a2ad}\
.plot .la{stroke:#2f6fb0}.plot .lb{stroke:#d97a1f}\
.plot .la,.plot .lb{fill:none;stroke-width:2.2;stroke-linejoin:round}\
.plot .best{fill:none;stroke:#c2255c;stroke-width:2.4}.plot .besttext{fill:#c2255c;font-weight:600}\
.paper{fill:#fff}\
@media (prefers-color-scheme:dark){\
.plot text{fill:#e3e7ec}.plot .soft{fill:#a0aab5}\
.plot .grid{stroke:#30373f}.plot .axis{stroke:#6d7782}\
.plot .a{fill:#6aa9e9}.plot .b{fill:#f0a050}.plot .c{fill:#66bb8d}.plot .d{fill:#b493dc}.plot .e{fill:#dcbc55}.plot .f{fill:#7c8791}\
.plot .la{stroke:#6aa9e9}.plot .lb{stroke:#f0a050}\
.plot .best{stroke:#ff7aa8}.plot .besttext{fill:#ff7aa8}\
.paper{fill:#14181d}}";

/// A drawing, in units that are a pixel at full size.
#[derive(Clone, Debug)]
pub struct Svg {
    width: f64,
    height: f64,
    label: String,
    body: String,
}

/// Where a text's position is in it.
#[derive(Clone, Copy, Debug)]
pub enum Anchor {
    /// At its first letter.
    Start,
    /// In its middle.
    Middle,
    /// Behind its last letter.
    End,
}

impl Svg {
    /// An empty drawing; `label` says in words what it shows.
    #[must_use]
    pub fn new(width: f64, height: f64, label: &str) -> Self {
        Self { width, height, label: label.to_owned(), body: String::new() }
    }

    fn push(&mut self, element: impl Display) {
        // Writing to a string cannot fail.
        let _ = writeln!(self.body, "{element}");
    }

    /// Text with its baseline at y.
    pub fn text(&mut self, (x, y): (f64, f64), anchor: Anchor, class: &str, text: &str) {
        let anchor = match anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        self.push(format_args!(
            "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" class=\"{class}\">{}</text>",
            escaped(text)
        ));
    }

    /// Text that runs upwards, its middle at (x, y).
    pub fn upwards(&mut self, (x, y): (f64, f64), class: &str, text: &str) {
        self.push(format_args!(
            "<text transform=\"translate({x:.1} {y:.1}) rotate(-90)\" text-anchor=\"middle\" class=\"{class}\">{}</text>",
            escaped(text)
        ));
    }

    /// A straight line.
    pub fn line(&mut self, (x1, y1): (f64, f64), (x2, y2): (f64, f64), class: &str) {
        self.push(format_args!(
            "<line x1=\"{x1:.1}\" y1=\"{y1:.1}\" x2=\"{x2:.1}\" y2=\"{y2:.1}\" class=\"{class}\"/>"
        ));
    }

    /// A line through points.
    pub fn polyline(&mut self, points: &[(f64, f64)], class: &str) {
        let points: Vec<String> = points.iter().map(|(x, y)| format!("{x:.1},{y:.1}")).collect();
        self.push(format_args!("<polyline points=\"{}\" class=\"{class}\"/>", points.join(" ")));
    }

    /// A bar; the hint appears under the mouse.
    pub fn bar(&mut self, (x, y): (f64, f64), (width, height): (f64, f64), class: &str, hint: &str) {
        self.push(format_args!(
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{:.1}\" height=\"{height:.1}\" class=\"{class}\"><title>{}</title></rect>",
            width.max(0.0),
            escaped(hint)
        ));
    }

    /// A point; the hint appears under the mouse.
    pub fn point(&mut self, (x, y): (f64, f64), radius: f64, class: &str, hint: &str) {
        self.push(format_args!(
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"{radius}\" class=\"{class}\"><title>{}</title></circle>",
            escaped(hint)
        ));
    }

    /// For a page that has [`STYLE`].
    #[must_use]
    pub fn inline(&self) -> String {
        self.element("")
    }

    /// A file of its own.
    #[must_use]
    pub fn standalone(&self) -> String {
        let paper = format!(
            "<style>{STYLE}</style>\n<rect class=\"paper\" width=\"{}\" height=\"{}\"/>\n",
            self.width, self.height
        );
        format!("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n{}", self.element(&paper))
    }

    fn element(&self, first: &str) -> String {
        format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"plot\" role=\"img\" viewBox=\"0 0 {w} {h}\" \
             width=\"{w}\" height=\"{h}\" aria-label=\"{}\">\n{first}{}</svg>\n",
            escaped(&self.label),
            self.body,
            w = self.width,
            h = self.height,
        )
    }
}

/// A logarithmic axis from `values` onto `pixels`.
#[derive(Clone, Copy, Debug)]
pub struct Log {
    values: [f64; 2],
    pixels: [f64; 2],
}

impl Log {
    /// An axis on which all positive values have room, and a little beside them.
    #[must_use]
    pub fn around(values: impl Iterator<Item = f64>, pixels: [f64; 2]) -> Self {
        let positive = values.filter(|v| *v > 0.0 && v.is_finite());
        let (low, high) = positive.fold((f64::INFINITY, 0.0_f64), |(low, high), v| (low.min(v), high.max(v)));
        let (low, high) = if low <= high { (low, high) } else { (1.0, 10.0) };
        let room = (high / low).powf(0.06).max(1.15);
        Self { values: [low / room, high * room], pixels }
    }

    /// The same axis, reaching down to 0.6 and up to 1.6 of what it did.
    #[must_use]
    pub fn roomier(self) -> Self {
        Self { values: [self.values[0] * 0.6, self.values[1] * 1.6], ..self }
    }

    /// Where a value lies.
    #[must_use]
    pub fn at(&self, value: f64) -> f64 {
        let [low, high] = self.values;
        let share = (value.max(low) / low).ln() / (high / low).ln();
        self.pixels[0] + share * (self.pixels[1] - self.pixels[0])
    }

    /// Round values along it: 1, 2 and 5 of each decade, or the decades where those are many.
    #[must_use]
    pub fn ticks(&self) -> Vec<(f64, String)> {
        let [low, high] = self.values;
        let decades = low.log10().floor() as i32..=high.log10().ceil() as i32;
        let of = |factors: &[f64]| -> Vec<f64> {
            let all = decades.clone().flat_map(|d| factors.iter().map(move |f| f * 10f64.powi(d)));
            all.filter(|v| *v >= low * 0.999 && *v <= high * 1.001).collect()
        };
        let sets = [of(&[1.0]), of(&[1.0, 3.0]), of(&[1.0, 2.0, 5.0]), of(&[1.0, 1.5, 2.0, 3.0, 4.0, 5.0, 6.0, 8.0])];
        let chosen = sets.iter().find(|set| set.len() >= 3).unwrap_or(&sets[3]);
        chosen.iter().map(|&v| (v, significant(v, if v.log10().fract() == 0.0 { 1 } else { 2 }))).map(trimmed).collect()
    }
}

/// 0.50 is 0.5.
fn trimmed((value, text): (f64, String)) -> (f64, String) {
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_owned() } else { text };
    (value, short)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_on_the_axis() {
        let names = |low: f64, high: f64| -> Vec<String> {
            Log::around([low, high].into_iter(), [0.0, 100.0]).ticks().into_iter().map(|tick| tick.1).collect()
        };
        assert_eq!(names(0.008, 4.0), ["0.01", "0.1", "1"]);
        assert_eq!(names(2.0, 15.0), ["2", "5", "10"]);
        assert!(names(3.1, 3.9).len() >= 2, "{:?}", names(3.1, 3.9));
        let axis = Log::around([1.0, 100.0].into_iter(), [0.0, 100.0]);
        assert!((axis.at(10.0) - 50.0).abs() < 1e-9);
        assert!(axis.at(1.0) > 0.0 && axis.at(100.0) < 100.0);
    }

    #[test]
    fn words_are_escaped() {
        let mut svg = Svg::new(10.0, 10.0, "a & b");
        svg.text((0.0, 0.0), Anchor::Start, "", "<x>");
        assert!(svg.standalone().contains("a &amp; b") && svg.inline().contains("&lt;x&gt;"));
    }
}
