"""The page in a browser: its script runs and draws. Skipped where there is no Chromium."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest
import report_sample as sample

from lmap.report import write_report

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)

PROBE = """<script>
window.addEventListener("error", function (event) {
  document.documentElement.setAttribute("data-error", event.message);
});
</script>"""

COUNT = """<script>
setTimeout(function () {
  document.documentElement.setAttribute("data-plots", document.querySelectorAll("figure .main-svg").length);
  document.querySelectorAll("select.stretch").forEach(function (box) {
    box.value = "around the extreme";
    box.dispatchEvent(new Event("change"));
  });
  document.querySelectorAll(".legend button").forEach(function (button) { button.click(); });
  var wide = document.documentElement.scrollWidth > window.innerWidth;
  document.documentElement.setAttribute("data-wide", wide);
  window.dispatchEvent(new Event("beforeprint"));
  document.documentElement.setAttribute("data-printed", document.querySelectorAll(".view .canvas").length);
  window.dispatchEvent(new Event("afterprint"));
  document.documentElement.setAttribute("data-after", document.querySelectorAll(".view .canvas").length);
}, 1000);
</script>"""


@pytest.mark.slow
@pytest.mark.timeout(180)
@pytest.mark.skipif(CHROMIUM is None, reason="no chromium on this machine")
def test_page_draws_every_figure_without_an_error(tmp_path: Path) -> None:
    write_report(sample.passing(), tmp_path)
    head = opened(tmp_path / "index.html")
    assert "data-error" not in head
    # 6 figures (plotly.js stacks several drawings in each); on paper every case of each, then one again.
    plots = int(head.split('data-plots="')[1].split('"')[0])
    assert plots >= 6
    assert 'data-wide="false"' in head
    assert 'data-printed="12"' in head
    assert 'data-after="6"' in head


@pytest.mark.slow
@pytest.mark.needs_core
@pytest.mark.timeout(180)
@pytest.mark.skipif(CHROMIUM is None, reason="no chromium on this machine")
def test_contact_page_draws_every_figure_without_an_error(tmp_path: Path) -> None:
    from lmap.contact.pair import Pair
    from lmap.contact.survey import survey
    from lmap.report import contact_sheet
    from lmap.report.sheet import render

    pair = Pair("anzr1", "as60", inclination=0.05, gauge_point_depth=0.016)
    (tmp_path / "contact.html").write_bytes(render(contact_sheet.sheet(survey(pair), "0")))
    head = opened(tmp_path / "contact.html")
    assert "data-error" not in head
    assert int(head.split('data-plots="')[1].split('"')[0]) >= 7
    assert 'data-wide="false"' in head
    assert 'data-after="8"' in head


def opened(path: Path) -> str:
    """The page's head after the browser has drawn it, with what the probes found as attributes."""
    assert CHROMIUM is not None
    text = path.read_text(encoding="utf-8")
    text = text.replace("<head>", "<head>" + PROBE, 1).replace("</body>", COUNT + "</body>")
    path.write_text(text, encoding="utf-8")
    command = [
        CHROMIUM,
        "--headless=new",
        "--disable-gpu",
        "--virtual-time-budget=20000",
        "--window-size=1400,9000",
    ]
    command += ["--no-sandbox"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []
    command += [f"--user-data-dir={path.parent / 'profile'}", "--dump-dom", path.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=150, check=False)
    return done.stdout[: done.stdout.index("<head>")]
