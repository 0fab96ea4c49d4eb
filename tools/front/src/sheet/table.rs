//! Tables of the page.

use super::number::escaped;

/// A row's cells, and whether it is the one to choose.
pub type Row = (bool, Vec<String>);

/// A table that scrolls sideways where the screen is narrow. Column names may carry a unit.
#[must_use]
pub fn html(columns: &[(&str, &str)], rows: &[Row]) -> String {
    let head: String = columns
        .iter()
        .map(|(name, unit)| match unit.is_empty() {
            true => format!("<th scope=\"col\">{}</th>", escaped(name)),
            false => format!("<th scope=\"col\">{}<br><small>{}</small></th>", escaped(name), escaped(unit)),
        })
        .collect();
    let body: String = rows
        .iter()
        .map(|(best, cells)| {
            let cells: String = cells.iter().map(|cell| format!("<td>{}</td>", escaped(cell))).collect();
            let class = if *best { " class=\"best\"" } else { "" };
            format!("<tr{class}>{cells}</tr>\n")
        })
        .collect();
    format!("<div class=\"wide\"><table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody>\n</table></div>\n")
}
