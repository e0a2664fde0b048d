//! Results of tests as JUnit XML, which CI systems show.

use std::fmt::Write;
use stickslip_scene::shown;

/// A test and its result.
pub struct TestCase {
    pub name: String,
    /// Duration of the test.
    pub seconds: f64,
    pub result: TestResult,
}

/// Result of a test.
pub enum TestResult {
    Passed,
    /// The result is not the expected one: a summary and the details.
    Failed(String, String),
    /// The test could not be run, and why.
    Error(String),
}

/// A suite of tests as a document.
pub fn document(suite: &str, cases: &[TestCase]) -> String {
    let count = |of: fn(&TestResult) -> bool| cases.iter().filter(|case| of(&case.result)).count();
    let failures = count(|result| matches!(result, TestResult::Failed(..)));
    let errors = count(|result| matches!(result, TestResult::Error(_)));
    let seconds: f64 = cases.iter().map(|case| case.seconds).sum();
    let suite = attribute(suite);
    let mut text = format!(
        "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuite name=\"{suite}\" tests=\"{}\" failures=\"{failures}\" errors=\"{errors}\" skipped=\"0\" time=\"{seconds:.3}\">\n",
        cases.len()
    );
    for case in cases {
        // Writing to a string does not fail.
        let _ = write!(
            text,
            "  <testcase classname=\"{suite}\" name=\"{}\" time=\"{:.3}\"",
            attribute(&case.name),
            case.seconds
        );
        text += &match &case.result {
            TestResult::Passed => "/>\n".to_owned(),
            TestResult::Failed(summary, details) => format!(
                ">\n    <failure message=\"{}\">{}</failure>\n  </testcase>\n",
                attribute(summary),
                escaped(details)
            ),
            TestResult::Error(why) => {
                format!(
                    ">\n    <error message=\"{}\"/>\n  </testcase>\n",
                    attribute(why)
                )
            }
        };
    }
    text + "</testsuite>\n"
}

/// Text for an attribute, in which plain line ends would be read as spaces.
fn attribute(text: &str) -> String {
    escaped(text).replace('\n', "&#10;").replace('\t', "&#9;")
}

/// Text for an element. Characters that XML does not allow are shown as `\u{1b}`.
fn escaped(text: &str) -> String {
    let mut safe = String::with_capacity(text.len());
    for letter in shown::text(text).chars() {
        match letter {
            '&' => safe += "&amp;",
            '<' => safe += "&lt;",
            '>' => safe += "&gt;",
            '"' => safe += "&quot;",
            '\'' => safe += "&apos;",
            '\u{fffe}' | '\u{ffff}' => safe.extend(letter.escape_unicode()),
            other => safe.push(other),
        }
    }
    safe
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_cannot_end_its_element_or_attribute() {
        let details = "a < b && \"c\" > 'd'\n]]></failure>\u{1b}\u{ffff}";
        let case = |name: &str, result| TestCase {
            name: name.into(),
            seconds: 0.25,
            result,
        };
        let cases = [
            case(
                "a<b>.ron",
                TestResult::Failed("1 \"difference\"".into(), details.into()),
            ),
            case("c.ron", TestResult::Passed),
            case("d.ron", TestResult::Error("no\nfile".into())),
        ];
        assert_eq!(
            document("stickslip replay", &cases),
            "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n\
             <testsuite name=\"stickslip replay\" tests=\"3\" failures=\"1\" errors=\"1\" skipped=\"0\" time=\"0.750\">\n  \
             <testcase classname=\"stickslip replay\" name=\"a&lt;b&gt;.ron\" time=\"0.250\">\n    \
             <failure message=\"1 &quot;difference&quot;\">a &lt; b &amp;&amp; &quot;c&quot; &gt; &apos;d&apos;\n]]&gt;&lt;/failure&gt;\\u{1b}\\u{ffff}</failure>\n  \
             </testcase>\n  \
             <testcase classname=\"stickslip replay\" name=\"c.ron\" time=\"0.250\"/>\n  \
             <testcase classname=\"stickslip replay\" name=\"d.ron\" time=\"0.250\">\n    \
             <error message=\"no&#10;file\"/>\n  \
             </testcase>\n\
             </testsuite>\n"
        );
    }
}
