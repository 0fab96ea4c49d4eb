//! The frame of a page: one HTML file, nothing outside it is loaded.

use super::number::escaped;
use super::plot::STYLE;

const PAGE_STYLE: &str = "\
:root{color-scheme:light dark;--ink:#22272e;--soft:#5d6773;--paper:#fff;--card:#f4f6f8;--line:#dde2e8;--best:#c2255c;--bestpaper:#fdeef3}\
@media (prefers-color-scheme:dark){:root{--ink:#e3e7ec;--soft:#a0aab5;--paper:#14181d;--card:#1d232a;--line:#30373f;--best:#ff7aa8;--bestpaper:#33202a}}\
*{box-sizing:border-box}\
body{margin:0 auto;padding:1.5rem 1rem 4rem;max-width:46rem;background:var(--paper);color:var(--ink);\
font:1rem/1.55 system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif}\
h1{font-size:1.7rem;line-height:1.2;margin:.5rem 0 1rem;overflow-wrap:anywhere}\
h2{font-size:1.25rem;margin:2.8rem 0 .6rem}p{margin:.6rem 0}\
.lead,.note,figcaption,small{color:var(--soft)}.note,figcaption{font-size:.92rem}\
figure{margin:1rem 0}figcaption{margin-top:.3rem}\
svg.plot{display:block;width:100%;height:auto;max-width:38rem}\
.cards{display:grid;grid-template-columns:repeat(auto-fit,minmax(12rem,1fr));gap:.8rem;margin:1.4rem 0}\
.card{background:var(--card);border-radius:.6rem;padding:.8rem 1rem}\
.card b{display:block;font-size:1.3rem;line-height:1.3;color:var(--best)}.card span{font-size:.92rem;color:var(--soft)}\
.wide{overflow-x:auto}table{border-collapse:collapse;font-size:.92rem;font-variant-numeric:tabular-nums}td{white-space:nowrap}\
th,td{padding:.3rem .6rem;text-align:right;border-bottom:1px solid var(--line)}\
th{font-weight:600;vertical-align:bottom}th small{font-weight:400}\
th:first-child,td:first-child{text-align:left;padding-left:.3rem}\
tr.best td{background:var(--bestpaper)}tr.best td:first-child{color:var(--best);font-weight:600}\
a{color:inherit}code{font-size:.92em}";

/// A page with a title; `sections` is HTML.
#[must_use]
pub fn html(title: &str, sections: &str) -> String {
    format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n\
         <style>{PAGE_STYLE}{STYLE}</style>\n</head>\n<body>\n{sections}</body>\n</html>\n",
        escaped(title)
    )
}
