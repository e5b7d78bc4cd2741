"""The page and the table of `lmap contact`: what a survey of a pair of profiles found."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any

import numpy as np

from lmap.report.numbers import NOTHING, number
from lmap.report.sheet import Line, Note, Plot, Sheet

if TYPE_CHECKING:
    from rich.console import Console

    from lmap.contact import Profile
    from lmap.contact.pair import Contacts
    from lmap.contact.survey import Survey

_APART = 22.0
"""How far the wheel is drawn above the rail, mm."""

_SHOWN = (1, 2, 3, 4, 5, 6, 7)
"""Amplitudes of the table, mm."""


def facts(survey: Survey) -> list[tuple[str, str]]:
    """Name and value of what a table shows, in the units of the workshop."""
    pair = survey.pair
    centred = survey.centred
    left, right = (1e3 * play for play in survey.flange_play)
    rows = [
        (
            "equivalent conicity at 3 mm",
            f"{_n(survey.at(3e-3))} (linear regression {_n(survey.at(3e-3, 'regression'))})",
        ),
        ("flange play", f"{left:+.2f} mm to the left, {right:+.2f} mm to the right"),
        ("contact angle, centred", f"{_n(_only(centred.angle))} rad, right wheel"),
        (
            "contact angle, flange",
            f"{_n(survey.flange_angle)} rad ({_n(math.degrees(survey.flange_angle))} degrees)",
        ),
    ]
    for index, side in enumerate(("left", "right")):
        patches = survey.patches.where(survey.patches.side == (-1.0, 1.0)[index])
        for k in range(len(patches)):
            a, b, n = float(patches.a[k]), float(patches.b[k]), float(patches.normal[k])
            spread = float(patches.spread[k])
            area = math.pi * a * b
            text = f"{1e3 * a:.2f} x {1e3 * b:.2f} mm, {1e6 * area:.0f} mm2, {1.5e-6 * n / area:.0f} MPa"
            far = ", far from an ellipse" if spread > 0.5 else ""
            rows.append((f"patch, {side} wheel, {n / 1e3:.4g} kN", f"{text} (a x b, Hertz{far})"))
    patch = survey.non_elliptic
    if patch is not None:
        width = 1e3 * (patch.y[-1] - patch.y[0])
        text = f"{1e6 * patch.area:.0f} mm2, {1e-6 * patch.max_pressure:.0f} MPa, {width:.1f} mm wide"
        rows.append((f"patch, right wheel, {patch.force / 1e3:.4g} kN", f"{text} (Kik and Piotrowski)"))
    rows.append(("rolling radius", f"{1e3 * pair.radius:.6g} mm, gauge {1e3 * pair.gauge:.6g} mm"))
    return rows


def conicity_rows(survey: Survey) -> list[tuple[str, str, str]]:
    """Amplitude, and conicity by integration and by regression."""
    return [(f"{mm} mm", _n(survey.at(1e-3 * mm)), _n(survey.at(1e-3 * mm, "regression"))) for mm in _SHOWN]


def document(survey: Survey) -> dict[str, Any]:
    """What `--json` prints: plain data, SI; null for what there is not."""
    pair, patches = survey.pair, survey.patches
    patch = survey.non_elliptic
    return {
        "wheel": pair.wheel.name,
        "rail": pair.rail.name,
        "gauge": pair.gauge,
        "radius": pair.radius,
        "load": survey.load,
        "friction": survey.friction,
        "flange_play": [_plain(play) for play in survey.flange_play],
        "contact_angle": _plain(_only(survey.centred.angle)),
        "flange_angle": _plain(survey.flange_angle),
        "conicity": {
            "amplitude": survey.amplitude.tolist(),
            **{method: [_plain(value) for value in values] for method, values in survey.conicity.items()},
        },
        "rolling_radius_difference": {
            "y": survey.shift.tolist(),
            "level": [_plain(value) for value in survey.level],
            "free": [_plain(value) for value in survey.free],
        },
        "patches": [
            {
                "side": "left" if patches.side[k] < 0.0 else "right",
                **{
                    name: _plain(getattr(patches, name)[k])
                    for name in ("normal", "a", "b", "angle", "spread")
                },
            }
            for k in range(len(patches))
        ],
        "kik_piotrowski": None
        if patch is None
        else {name: getattr(patch, name) for name in ("force", "approach", "area", "max_pressure")},
        "creep": {
            "creepage": survey.creepage.tolist(),
            "spin": survey.spin.tolist(),
            "laws": {
                curve.law: {
                    name: getattr(curve, name).tolist() for name in ("longitudinal", "lateral", "spin")
                }
                for curve in survey.curves
            },
            "convergence": {
                found.law: {
                    name: getattr(found, name).tolist() for name in ("grids", "without_spin", "with_spin")
                }
                for found in survey.convergence
            },
        },
        "findings": {
            profile.name: [{"severity": f.severity, "code": f.code, "text": f.text} for f in profile.findings]
            for profile in (pair.wheel, pair.rail)
        },
    }


def table(survey: Survey, console: Console) -> None:
    """Prints facts and conicities: readable without colour, in 80 columns and in a log file."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    grid = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False, show_edge=False, header_style="")
    grid.add_column("figure", overflow="fold", min_width=12)
    grid.add_column("value", overflow="fold")
    for row in facts(survey):
        grid.add_row(*map(Text, row))
    console.print(Text(_title(survey), style="bold"))
    console.print(grid)
    console.print()
    grid = Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False, show_edge=False, header_style="")
    for title in ("amplitude", "conicity, integration", "conicity, regression"):
        grid.add_column(title)
    for cells in conicity_rows(survey):
        grid.add_row(*map(Text, cells))
    console.print(grid)
    for profile in (survey.pair.wheel, survey.pair.rail):
        for finding in profile.findings:
            console.print(
                Text(f"{finding.severity}: ", style="bold").append(
                    f"{profile.name}: {finding.text}", style="not bold"
                )
            )


def sheet(survey: Survey, version: str) -> Sheet:
    """The page."""
    pair = survey.pair
    findings = [
        (profile.name, finding.severity, finding.code, finding.text)
        for profile in (pair.wheel, pair.rail)
        for finding in profile.findings
    ]
    tables: list[tuple[str, Any, Any]] = [
        ("Equivalent conicity", ("Amplitude", "Integration", "Linear regression"), conicity_rows(survey)),
    ]
    if findings:
        tables.append(("Quality of the profiles", ("Profile", "Severity", "Code", "Finding"), findings))
    return Sheet(
        kind="Contact of wheel and rail",
        title=_title(survey),
        headline=f"Gauge {1e3 * pair.gauge:.6g} mm, wheel radius {1e3 * pair.radius:.6g} mm, "
        f"{survey.load / 1e3:.4g} kN a wheel, friction {survey.friction:g}.",
        facts=facts(survey),
        tables=tables,
        figures=[
            _radius_difference(survey),
            _conicity(survey),
            _map(survey),
            _patch(survey),
            _creep(survey),
            _traction(survey),
            _convergence(survey),
            _profiles(survey),
        ],
        messages=() if findings else ("Nothing remarkable about the points of either profile.",),
        footer=f"lmap {version}. Lateral shift of the wheelset to the right; profiles in side coordinates: "
        "y outward from the track centre, z down.",
    )


def _title(survey: Survey) -> str:
    return f"{survey.pair.wheel.name} on {survey.pair.rail.name}"


def _radius_difference(survey: Survey) -> tuple[str, str, list[Plot]]:
    y = 1e3 * survey.shift
    both = 1e3 * np.concatenate([survey.level, survey.free])
    lines = [
        Line("axle level, as EN 15302's curves", y, 1e3 * survey.level, "1"),
        Line("axle rolls until both wheels touch", y, 1e3 * survey.free, "2", dash="dash"),
        *_play_lines(survey, both),
    ]
    titles = ("lateral shift y (mm)", "rolling radius difference (mm)")
    plots = [Plot(*titles, lines, choice="with the flanges")]
    play = float(np.nanmin(np.abs(survey.flange_play))) if np.isfinite(survey.flange_play).any() else math.inf
    on_tread = both[np.tile(np.abs(survey.shift) < 0.95 * play, 2)]
    if math.isfinite(play) and np.isfinite(on_tread).any():
        top = 1.1 * float(np.nanmax(np.abs(on_tread))) or 1.0
        plots.insert(0, Plot(*titles, lines, choice="on the treads", y_range=(-top, top)))
    caption = "Rolling radius of the right wheel less that of the left. Dotted: the flanges bear."
    return "Rolling radius difference", caption, plots


def _play_lines(survey: Survey, values: Any) -> list[Line]:
    finite = values[np.isfinite(values)]
    if not len(finite):
        return []
    low, high = float(finite.min()), float(finite.max())
    return [
        Line(
            "flange play",
            [1e3 * play] * 2,
            [low, high],
            "raw",
            dash="dot",
            group="flange play",
            hover="flange bears<extra></extra>",
        )
        for play in survey.flange_play
        if math.isfinite(play)
    ]


def _conicity(survey: Survey) -> tuple[str, str, list[Plot]]:
    names = {"integration": "integration", "regression": "two-step linear regression"}
    amplitude = 1e3 * survey.amplitude
    lines = [
        Line(names[method], amplitude, values, str(k + 1), dash="dash" if k else "solid")
        for k, (method, values) in enumerate(survey.conicity.items())
    ]
    values = np.concatenate(list(survey.conicity.values()))
    top = float(np.nanmax(values)) if np.isfinite(values).any() else 0.1
    plot = Plot(
        "amplitude of the lateral motion (mm)", "equivalent conicity (1)", lines, y_range=(0.0, 1.1 * top)
    )
    caption = "EN 15302, axle level. A gap: no oscillation of that amplitude. Half of peak to peak."
    return "Equivalent conicity", caption, [plot]


def _map(survey: Survey) -> tuple[str, str, list[Plot]]:
    plots = [_map_of(survey, 1.0, "right"), _map_of(survey, -1.0, "left")]
    caption = (
        "Wheel, lifted, and inclined rail with the points that touch at shifts of the wheelset (rigid contact, both "
        "wheels touching). "
        "Dots on the wheel and on the rail that belong together are joined; a second colour tells the flange."
    )
    return "Contact points", caption, plots


def _map_of(survey: Survey, side: float, name: str) -> Plot:
    contacts, pair = survey.contacts, survey.pair
    first = contacts.where((contacts.side == side) & (contacts.rank == 0.0))
    wheel, rail = _drawn(pair.wheel, "wheel"), _placed(survey)
    lines = [
        Line(
            "wheel",
            wheel[:, 0],
            _APART - wheel[:, 1],
            "statistic",
            hover="wheel %{x:.2f}, %{y:.2f} mm<extra></extra>",
        ),
        Line(
            "rail",
            rail[:, 0],
            -rail[:, 1],
            "raw",
            width=2.4,
            hover="rail %{x:.2f}, %{y:.2f} mm<extra></extra>",
        ),
    ]
    for part, role, label in (
        (0.0, "1", "tread contact"),
        (1.0, "2", "flange contact"),
        (2.0, "3", "back of flange"),
    ):
        lines += _joined(first.where(first.part == part), role, label)
    return Plot(
        x_title="y, outward from the running circle and from the rail's origin (mm)",
        y_title="height (mm)",
        lines=lines,
        choice=f"{name} wheel",
        equal=True,
        height=460,
        x_range=(-75.0, 65.0),
        notes=[Note(*at, text) for at, text in _labels(first)],
    )


def _joined(rows: Contacts, role: str, label: str) -> list[Line]:
    if not len(rows):
        return []
    gap = np.full(len(rows), np.nan)
    x = np.stack([1e3 * rows.y_wheel, 1e3 * rows.y_rail, gap], axis=1).ravel()
    y = np.stack([_APART - 1e3 * rows.z_wheel, -1e3 * rows.z_rail, gap], axis=1).ravel()
    texts = [
        f"shift {1e3 * shift:+.1f} mm, angle {angle:.3f} rad, radius {1e3 * radius:.2f} mm"
        for shift, angle, radius in zip(rows.y, rows.angle, rows.radius, strict=True)
        for _ in range(3)
    ]
    hover = "%{text}<extra>" + label + "</extra>"
    return [
        Line(
            label,
            x,
            y,
            role,
            mode="lines+markers",
            width=1.0,
            size=5.0,
            group=label,
            texts=texts,
            hover=hover,
        )
    ]


def _labels(first: Contacts) -> list[tuple[tuple[float, float], str]]:
    """Shifts written beside the wheel, where there is room."""
    out: list[tuple[tuple[float, float], str]] = []
    last = math.inf
    for k in np.argsort(-first.y_wheel):
        x = 1e3 * float(first.y_wheel[k])
        if abs(x - last) > 6.0:
            last = x
            out.append(((x, _APART - 1e3 * float(first.z_wheel[k])), f"{1e3 * float(first.y[k]):+.1f}"))
    return out


def _patch(survey: Survey) -> tuple[str, str, list[Plot]]:
    patches = survey.patches.where(survey.patches.side == 1.0)
    angle = np.linspace(0.0, 2.0 * np.pi, 181)
    best = int(np.argmax(patches.normal))
    a, b = 1e3 * float(patches.a[best]), 1e3 * float(patches.b[best])
    n = float(patches.normal[best])
    lines = [
        Line(
            "Hertz",
            b * np.cos(angle),
            a * np.sin(angle),
            "1",
            hover="%{x:.2f}, %{y:.2f} mm<extra>Hertz</extra>",
        )
    ]
    b_axis = np.linspace(-b, b, 121)
    peak = 1.5 * n / (math.pi * a * b)
    across = [Line("Hertz", b_axis, peak * np.sqrt(np.maximum(1.0 - (b_axis / b) ** 2, 0.0)), "1")]
    found = survey.non_elliptic
    if found is not None:
        y, half = 1e3 * (found.y - found.origin), 1e3 * found.half_length
        outline_y, outline_x = np.concatenate([y, y[::-1]]), np.concatenate([half, -half[::-1]])
        lines.append(
            Line(
                "Kik and Piotrowski",
                outline_y,
                outline_x,
                "2",
                dash="dash",
                hover="%{x:.2f}, %{y:.2f} mm<extra>Kik and Piotrowski</extra>",
            )
        )
        across.append(Line("Kik and Piotrowski", y, 1e-6 * found.pressure(0.0, found.y), "2", dash="dash"))
    plots = [
        Plot(
            "across the rail, outward (mm)",
            "along the rail (mm)",
            lines,
            choice="outline",
            equal=True,
            height=380,
        ),
        Plot("across the rail, outward (mm)", "pressure (MPa)", across, choice="pressure in the middle"),
    ]
    caption = (
        f"Right wheel of the centred wheelset under {n / 1e3:.4g} kN, each about the place where it is deepest; "
        "Kik and Piotrowski's has no given shape."
    )
    return "Patch", caption, plots


def _creep(survey: Survey) -> tuple[str, str, list[Plot]]:
    xi = 100.0 * survey.creepage
    drawn = (
        ("longitudinal", "longitudinal creepage (%)", "-Fx / N (1)", xi),
        ("lateral", "lateral creepage (%)", "-Fy / N (1)", xi),
        ("spin", "spin (1/m)", "-Fy / N (1)", survey.spin),
    )
    plots = [
        Plot(
            x_title,
            y_title,
            [Line(c.law, x, getattr(c, name), str(k + 1)) for k, c in enumerate(survey.curves)],
            choice=name,
            y_range=(0.0, 1.25 * survey.friction),
        )
        for name, x_title, y_title, x in drawn
    ]
    caption = (
        "Force on the wheel against the creepage, in the patch of the right wheel, friction "
        f"{survey.friction:g} at any slip velocity. "
        "A law without limit leaves the picture; Vermeulen and Johnson's knows no spin."
    )
    return "Creep curves", caption, plots


def _traction(survey: Survey) -> tuple[str, str, list[Plot]]:
    creepage = 100.0 * survey.traction_creepage
    lines = [
        Line(name, creepage, values, str(k + 1)) for k, (name, values) in enumerate(survey.traction.items())
    ]
    caption = (
        f"Longitudinal creepage alone at {3.6 * survey.speed:.4g} km/h, same patch. Dry and wet: friction, reduction "
        "factors and falling friction of Spiryagin et al. (2013), Table 4."
    )
    return "Traction curve", caption, [Plot("longitudinal creepage (%)", "-Fx / N (1)", lines)]


def _convergence(survey: Survey) -> tuple[str, str, list[Plot]]:
    lines = [
        Line(
            f"{found.law}, {what}",
            found.grids,
            getattr(found, name),
            str(k + 1),
            mode="lines+markers",
            dash=dash,
            hover="%{x} x %{x}: %{y:.4f}<extra>" + f"{found.law}, {what}</extra>",
        )
        for k, found in enumerate(survey.convergence)
        for name, what, dash in (("without_spin", "no spin", "solid"), ("with_spin", "spin", "dash"))
    ]
    caption = (
        "Largest distance of the creep force from that of a grid of 200 x 200 over 20 creepages from stick to full "
        "slip in five directions, without spin and with two spins each; patch of the right wheel. Spin that turns the "
        "stress from one element to the next settles slowest; runs take 10 x 10 unless told otherwise."
    )
    titles = ("elements along and across (1)", "distance / mu N (1)")
    return "Convergence with the grid", caption, [Plot(*titles, lines, log=True)]


def _profiles(survey: Survey) -> tuple[str, str, list[Plot]]:
    plots = []
    for profile in (survey.pair.wheel, survey.pair.rail):
        lines = [Line("points", profile.y, -profile.z, "1", mode="lines+markers", width=1.0, size=3.0)]
        placed = [finding for finding in profile.findings if finding.place is not None]
        if placed:
            lines.append(
                Line(
                    "findings",
                    [finding.place[0] for finding in placed if finding.place],
                    [-finding.place[1] for finding in placed if finding.place],
                    "limit",
                    mode="markers",
                    size=9.0,
                    texts=[finding.text for finding in placed],
                    hover="%{text}<extra></extra>",
                )
            )
        plots.append(
            Plot(
                "y, outward (mm)",
                "height (mm)",
                lines,
                choice=f"{profile.kind}: {profile.name}",
                equal=True,
                height=420,
            )
        )
    return "Profiles as given", "Points of the files, with the places of findings.", plots


def _drawn(profile: Profile, kind: str) -> Any:
    """Points of a profile about the origin, mm: the part that a picture needs."""
    points = profile.points
    return points[(points[:, 1] < 45.0) & (np.abs(points[:, 0]) < 75.0)] if kind == "wheel" else points


def _placed(survey: Survey) -> Any:
    """The rail as it stands, mm: inclined, its highest point at z = 0."""
    slope = survey.pair.inclination
    points = survey.pair.rail.points
    cos, sin = math.cos(math.atan(slope)), math.sin(math.atan(slope))
    y = points[:, 0] * cos + points[:, 1] * sin
    z = points[:, 1] * cos - points[:, 0] * sin
    z = z - z.min()
    keep = z < 40.0
    return np.stack([y[keep], z[keep]], axis=1)


def _only(values: Any) -> float:
    return float(values[0]) if len(values) else float("nan")


def _n(value: float) -> str:
    return NOTHING if math.isnan(value) else number(value, 3)


def _plain(value: Any) -> float | None:
    """A number that JSON has; none for NaN."""
    return float(value) if math.isfinite(value) else None
