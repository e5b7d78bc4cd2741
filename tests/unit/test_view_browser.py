"""The 3D page in a browser: it draws, its buttons work, motions move. Skipped without Chromium or WebGL."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

import pytest
import test_view as sample

from lmap.report.scene import render_scene
from lmap.view import Mode, mode_motions, resolved, run_motion, scene

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)

PROBE = """<script>
var said = [];
window.addEventListener("error", function (event) { said.push(event.message); });
window.addEventListener("unhandledrejection", function (event) { said.push(String(event.reason)); });
["error", "warn"].forEach(function (level) {
  var own = console[level];
  console[level] = function () { said.push(Array.prototype.join.call(arguments, " ")); own.apply(console, arguments); };
});
var gl = document.createElement("canvas").getContext("webgl");
document.documentElement.setAttribute("data-webgl", gl !== null);
</script>"""

# Each button, then the first mode and the run, paused; what was seen goes into attributes of <html>.
DRIVE = """<script>
setTimeout(function () {
  var root = document.documentElement, place = document.getElementById("drawing");
  function say(name, value) { root.setAttribute("data-" + name, value); }
  function trace(name) { return place.data.filter(function (one) { return one.name === name; })[0]; }
  function choose(value) {
    var which = document.getElementById("which");
    which.value = value;
    which.dispatchEvent(new Event("change"));
    document.getElementById("play").click();
  }
  function later(deed) { setTimeout(deed, 300); }
  say("meshes", place.data.filter(function (one) { return one.type === "mesh3d"; }).length);
  say("hover", trace("spring").hovertext[0]);
  var eyes = ["front", "side", "top", "iso"].map(function (view) {
    document.querySelector("[data-view=" + view + "]").click();
    var eye = place.layout.scene.camera.eye;
    return [eye.x, eye.y, eye.z].map(function (v) { return Math.sign(v); }).join(",");
  });
  say("eyes", eyes.join(" "));
  document.querySelector("[data-layer=spring]").click();
  say("hidden", trace("spring").visible);
  document.querySelector("[data-layer=spring]").click();
  var rest = trace("carbody").z[0];
  choose("0");
  later(function () {
    say("moved", (trace("carbody").z[0] - rest).toFixed(3));
    var slider = document.getElementById("magnification");
    slider.value = 1;
    slider.dispatchEvent(new Event("input"));
    later(function () {
      say("magnified", (trace("carbody").z[0] - rest).toFixed(3));
      choose("1");
      later(function () {
        var time = document.getElementById("time");
        time.value = 1;
        time.dispatchEvent(new Event("input"));
        later(function () {
          say("ran", (trace("carbody").z[0] - rest).toFixed(3));
          say("said", said.join("; "));
          say("done", "yes");
        });
      });
    });
  });
}, 1000);
</script>"""


@pytest.mark.slow
@pytest.mark.timeout(240)
@pytest.mark.skipif(CHROMIUM is None, reason="no chromium on this machine")
def test_the_page_draws_turns_and_moves_without_an_error(tmp_path: Path) -> None:
    import polars as pl

    assert CHROMIUM is not None
    model = resolved(sample.vehicle())
    bounce = [0.0, 0.0, 1.0 + 0.0j, 0.0, 0.0, 0.0]
    modes = [Mode(name="bounce", frequency=1.1, damping_ratio=0.3, shape={"carbody": bounce})]
    frame = pl.DataFrame({"t": [0.0, 0.1, 0.2], "carbody.z": [-1.5, -1.49, -1.5]})
    motions = [*mode_motions(modes, model), run_motion(frame, model, "run")]
    page = render_scene(scene(model, sample.GAUGE, [], motions)).decode("utf-8")
    head, _, rest = page.partition("<head>")
    body, _, tail = rest.rpartition("</body>")
    path = tmp_path / "view.html"
    path.write_text(f"{head}<head>{PROBE}{body}{DRIVE}</body>{tail}", encoding="utf-8")
    command = [CHROMIUM, "--headless=new", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
    command += ["--ignore-gpu-blocklist", "--virtual-time-budget=6000", "--window-size=600,500"]
    command += ["--no-sandbox"] if hasattr(os, "geteuid") and os.geteuid() == 0 else []
    command += [f"--user-data-dir={tmp_path / 'profile'}", "--dump-dom", path.as_uri()]
    done = subprocess.run(command, capture_output=True, text=True, timeout=220, check=False)
    said = done.stdout[: done.stdout.index("<head>")]
    if 'data-webgl="false"' in said:
        pytest.skip("no WebGL in this browser")
    assert 'data-done="yes"' in said
    assert 'data-said=""' in said
    assert 'data-meshes="4"' in said  # car body, two wheelsets, rails
    assert "stiffness 1e+06 / 1e+06 / 500000 N/m" in said
    # seen from ahead, from the right (y right is plotly's -y), from above, from ahead right above
    assert 'data-eyes="1,0,0 0,-1,0 0,0,1 1,-1,1"' in said
    assert 'data-hidden="false"' in said
    # plotly's z is up: 0.3 m down at magnification 1, ten times that at 10; the run's 10 mm down at 10
    assert 'data-moved="-0.300"' in said
    assert 'data-magnified="-3.000"' in said
    assert 'data-ran="-0.100"' in said
