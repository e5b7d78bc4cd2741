"""Builds uic60.csv, the head of the rail UIC 60 (60 E1): `python3 models/profiles/build_uic60.py`.

A chain of arcs, each tangent to the next, symmetric about y = 0 (mm, z down, top of the rail at the origin):

- R300 with its centre on the axis, to |y| = 10.5;
- R80, to |y| = 25.988;
- R13, to where it meets the side;
- side 1:20, down to z = 30.

Radii and joins were recovered from the inclined rail of the Manchester contact benchmark (widths at the joins 21.000,
51.976 and 72.000 mm); `tests/validation/test_profiles.py` compares with its points. Points every 0.1 mm along the line.
"""

import math
from pathlib import Path

HERE = Path(__file__).resolve().parent

STEP = 0.1
"""mm, distance of points along the line."""
ARCS = ((300.0, 10.5), (80.0, 25.988), (13.0, None))
"""Radius and |y| of its end, mm, from the top; the last one ends where it meets the side."""
SIDE = 0.05
"""Slope of the side, 1:20."""
DEPTH = 30.0
"""Where the side is cut, mm."""

Points = list[tuple[float, float]]


def half() -> Points:
    """Points of the half with y > 0, from the top, without the top itself."""
    points: Points = []
    centre, old, angle = (0.0, 0.0), 0.0, 0.0  # angle from the vertical, where the last arc ended
    for radius, end in ARCS:
        # tangent: the new centre lies on the radius on which the old arc ended
        centre = (centre[0] + (old - radius) * math.sin(angle), centre[1] - (old - radius) * math.cos(angle))
        until = math.asin((end - centre[0]) / radius) if end else math.atan2(1.0, SIDE)
        count = round(radius * (until - angle) / STEP)
        for k in range(1, count + 1):
            at = angle + (until - angle) * k / count
            points.append((centre[0] + radius * math.sin(at), centre[1] - radius * math.cos(at)))
        old, angle = radius, until
    y, z = points[-1]
    count = round((DEPTH - z) / STEP)
    points += [(y + SIDE * (DEPTH - z) * k / count, z + (DEPTH - z) * k / count) for k in range(1, count + 1)]
    return points


def main() -> None:
    """Write uic60.csv beside this file."""
    right = half()
    points = [(-y, z) for y, z in reversed(right)] + [(0.0, 0.0), *right]
    lines = [
        "# uic60: head of the rail UIC 60 (60E1), tangent arcs R300, R80, R13 and sides 1:20, built by build_uic60.py.",
        "# Upright. mm; y outward (gauge corner negative), z down; origin top of rail. Sides cut 30 mm below the top.",
        "y_mm,z_mm",
    ]
    lines += [f"{y:.6f},{z:.6f}" for y, z in points]
    (HERE / "uic60.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
