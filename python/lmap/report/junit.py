"""JUnit XML for continuous integration: a testsuite for each spec, a testcase for each criterion and case."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ET

from lmap.report.numbers import percent, quantity, signed, with_unit
from lmap.verdict import Acceptance, CriterionVerdict, Outcome, SpecVerdict

_NOT_IN_XML = re.compile("[^\t\n\r\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")


def junit(acceptance: Acceptance) -> str:
    """The whole file. A fail is a `failure`, what could not be judged an `error`, what waits `skipped`."""
    root = ET.Element("testsuites", name="lmap check")
    suites = [_suite(spec) for spec in acceptance.specs]
    for key in ("tests", "failures", "errors", "skipped"):
        root.set(key, str(sum(int(suite.get(key, "0")) for suite in suites)))
    root.extend(suites)
    ET.indent(root)
    text = ET.tostring(root, encoding="unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{text}\n'


def _suite(spec: SpecVerdict) -> ET.Element:
    suite = ET.Element("testsuite", name=_text(f"{spec.id} {spec.title}"))
    tests = [_test(spec, criterion) for criterion in spec.criteria]
    if not tests:
        # A spec that judged nothing is never green.
        tests.append(ET.Element("testcase", classname=_text(spec.id), name="criteria"))
        ET.SubElement(tests[0], "error", message="no criterion was judged", type="error")
    elif spec.outcome is Outcome.NOT_ASSESSED and not any(criterion.judged for criterion in spec.criteria):
        tests.append(ET.Element("testcase", classname=_text(spec.id), name="criteria"))
        ET.SubElement(tests[-1], "skipped", message="no criterion has a limit: nothing was assessed")
    suite.set("tests", str(len(tests)))
    for key, tag in (("failures", "failure"), ("errors", "error"), ("skipped", "skipped")):
        suite.set(key, str(sum(test.find(tag) is not None for test in tests)))
    suite.set("file", _text(spec.file))
    suite.extend(tests)
    return suite


def _test(spec: SpecVerdict, criterion: CriterionVerdict) -> ET.Element:
    test = ET.Element(
        "testcase", classname=_text(spec.id), name=_text(f"{criterion.name} [{criterion.case}]")
    )
    summary = _summary(criterion)
    match criterion.outcome:
        case Outcome.PASS:
            ET.SubElement(test, "system-out").text = _text(summary)
        case Outcome.FAIL:
            ET.SubElement(test, "failure", message=_text(summary), type="fail")
        case Outcome.ERROR:
            message = criterion.message or "could not be judged"
            ET.SubElement(test, "error", message=_text(message), type="error").text = _text(summary)
        case Outcome.MANUAL | Outcome.NOT_ASSESSED:
            reason = criterion.message or str(criterion.outcome)
            ET.SubElement(test, "skipped", message=_text(reason))
    return test


def _summary(criterion: CriterionVerdict) -> str:
    parts = [f"value {quantity(criterion.value, criterion.unit)}"]
    if criterion.signal:
        parts.append(f"on {criterion.signal}")
    if criterion.limit:
        parts.append(f"limit {with_unit(criterion.limit, criterion.unit)}")
        parts.append(
            f"margin {signed(criterion.margin, criterion.unit)} ({percent(criterion.margin_percent)})"
        )
    else:
        parts.append("no limit: printed, not judged")
    parts.append(f"source {criterion.source}")
    return ", ".join(parts)


def _text(value: str) -> str:
    """Without the characters that XML cannot carry."""
    return _NOT_IN_XML.sub("\ufffd", value)
