//! Results in the JUnit XML dialect that CI systems read.

use std::fmt::Write as _;

/// One check.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Case {
    /// The group it belongs to.
    pub class: String,
    /// Its name.
    pub name: String,
    /// How it ended.
    pub outcome: Outcome,
    /// Text that does not change the outcome.
    pub note: String,
}

/// How a check ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Outcome {
    /// It holds.
    Passed,
    /// It was not tried, and why.
    Skipped(String),
    /// It does not hold: the message, and all details.
    Failed(String, String),
}

/// A document with one suite.
#[must_use]
pub fn document(suite: &str, cases: &[Case]) -> String {
    let count = |wanted: fn(&Outcome) -> bool| cases.iter().filter(|case| wanted(&case.outcome)).count();
    let failures = count(|outcome| matches!(outcome, Outcome::Failed(..)));
    let skipped = count(|outcome| matches!(outcome, Outcome::Skipped(_)));
    let totals = format!("tests=\"{}\" failures=\"{failures}\" errors=\"0\"", cases.len());
    let mut xml = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n");
    // Writing to a string cannot fail.
    let _ = writeln!(xml, "<testsuites {totals}>");
    let _ = writeln!(xml, "  <testsuite name=\"{}\" {totals} skipped=\"{skipped}\">", escape(suite));
    for case in cases {
        let _ = write!(xml, "    <testcase classname=\"{}\" name=\"{}\"", escape(&case.class), escape(&case.name));
        if case.outcome == Outcome::Passed && case.note.is_empty() {
            xml.push_str("/>\n");
            continue;
        }
        xml.push_str(">\n");
        match &case.outcome {
            Outcome::Passed => {}
            Outcome::Skipped(why) => {
                let _ = writeln!(xml, "      <skipped message=\"{}\"/>", escape(why));
            }
            Outcome::Failed(message, details) => {
                let (message, details) = (escape(message), escape(details));
                let _ = writeln!(xml, "      <failure message=\"{message}\" type=\"finding\">{details}</failure>");
            }
        }
        if !case.note.is_empty() {
            let _ = writeln!(xml, "      <system-out>{}</system-out>", escape(&case.note));
        }
        xml.push_str("    </testcase>\n");
    }
    xml.push_str("  </testsuite>\n</testsuites>\n");
    xml
}

/// Text as XML 1.0 can hold it; characters that it cannot become U+FFFD.
fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' => out.push('\n'),
            '\t' => out.push('\t'),
            '\u{0}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(name: &str, outcome: Outcome) -> Case {
        Case { class: "a".into(), name: name.into(), outcome, note: String::new() }
    }

    #[test]
    fn a_document() {
        let cases = [
            case("good", Outcome::Passed),
            case("none", Outcome::Skipped("not asked for".into())),
            case("bad \u{1}<&\"", Outcome::Failed("1 > 0".into(), "one\ntwo".into())),
            Case { note: "loose".into(), ..case("noted", Outcome::Passed) },
        ];
        let xml = document("x.relief", &cases);
        let expected = r#"<?xml version="1.0" encoding="UTF-8"?>
<testsuites tests="4" failures="1" errors="0">
  <testsuite name="x.relief" tests="4" failures="1" errors="0" skipped="1">
    <testcase classname="a" name="good"/>
    <testcase classname="a" name="none">
      <skipped message="not asked for"/>
    </testcase>
    <testcase classname="a" name="bad �&lt;&amp;&quot;">
      <failure message="1 &gt; 0" type="finding">one
two</failure>
    </testcase>
    <testcase classname="a" name="noted">
      <system-out>loose</system-out>
    </testcase>
  </testsuite>
</testsuites>
"#;
        assert_eq!(xml, expected);
    }
}
