"""Builds the worn wheel profiles from anzr1.csv: `python3 models/profiles/build_worn.py`.

Each worn shape is anzr1 less two stated wear functions (mm, y outward, z down, flange at negative y):

- tread: the surface is lifted by
  - Hollow: d exp(-((y - c)/w)^2), a hollow of radius w^2/(2 d) at its bottom y = c;
  - Flank: a tread worn down evenly on its field side, y > c, and less and less towards the root, by a concave
    parabola of radius R over a length u and a convex one over the length v beside it: depth u (u + v)/(2 R);
  faded out over the root between z = 1.5 and 9 mm;
- flange: the flange face moves towards its back by t, faded in over the same stretch.

The result is shifted so that the running circle (y = 0) is z = 0 again, and resampled every 0.1 mm.
"""

import itertools
import math
from dataclasses import dataclass
from pathlib import Path

HERE = Path(__file__).resolve().parent

Points = list[tuple[float, float]]

ROOT = (1.5, 9.0)


@dataclass(frozen=True)
class Hollow:
    """Bell-shaped loss of the tread, mm."""

    depth: float  # d
    centre: float  # c
    width: float  # w

    def loss(self, y: float) -> float:
        """Depth of the wear at `y`, mm."""
        return self.depth * math.exp(-(((y - self.centre) / self.width) ** 2))

    def __str__(self) -> str:
        radius = self.width**2 / (2.0 * self.depth)
        return f"{self.depth} mm * exp(-((y - {self.centre})/{self.width})^2), a hollow of radius {radius:.0f} mm"


@dataclass(frozen=True)
class Flank:
    """Even loss of the field side that fades towards the root, mm."""

    radius: float  # R
    centre: float  # c
    concave: float  # u
    convex: float  # v

    def loss(self, y: float) -> float:
        """Depth of the wear at `y`, mm."""
        x = min(max(self.centre - y, 0.0), self.concave + self.convex)
        if x > self.concave:
            return self.concave / self.convex * (self.concave + self.convex - x) ** 2 / (2.0 * self.radius)
        return (self.concave * (self.concave + self.convex) - x * x) / (2.0 * self.radius)

    def __str__(self) -> str:
        depth = self.loss(self.centre)
        return (
            f"{depth:.2f} mm on the field side of y = {self.centre}, falling to 0 at y = "
            f"{self.centre - self.concave - self.convex} "
            f"(concave, radius {self.radius} mm, over {self.concave} mm, then convex)"
        )


@dataclass(frozen=True)
class Wear:
    """One worn shape, all lengths in mm."""

    meaning: str
    tread: Hollow | Flank
    flange: float  # t


WORN: dict[str, Wear] = {
    "anzr1_worn_1": Wear("moderately worn", Hollow(1.0, 2.0, 40.0), 1.0),
    "anzr1_worn_2": Wear("worn", Hollow(1.5, 2.0, 37.5), 2.0),
    "anzr1_worn_high": Wear("heavily worn, of high conicity", Flank(150.0, 5.0, 27.5, 9.5), 1.5),
}


def read(path: Path) -> Points:
    """Points of a CSV profile, mm; lines that are no numbers are comments or headings."""
    points = []
    for line in path.read_text(encoding="utf-8").splitlines():
        fields = line.split(",")
        try:
            points.append((float(fields[0]), float(fields[1])))
        except ValueError:
            continue
    return points


def resample(points: Points, step: float) -> Points:
    """Points every `step` along the polyline."""
    out = [points[0]]
    carry = 0.0
    for (y0, z0), (y1, z1) in itertools.pairwise(points):
        length = math.hypot(y1 - y0, z1 - z0)
        at = step - carry
        while at <= length:
            out.append((y0 + (y1 - y0) * at / length, z0 + (z1 - z0) * at / length))
            at += step
        carry = length - (at - step)
    return out


def smootherstep(x: float) -> float:
    """From 0 at 0 to 1 at 1, flat to the second derivative at both."""
    x = min(max(x, 0.0), 1.0)
    return x**3 * (10.0 - 15.0 * x + 6.0 * x * x)


def worn(new: Points, wear: Wear) -> Points:
    """The worn shape of a new profile, mm, the running circle at z = 0 again."""
    moved = []
    for y, z in new:
        on_flange = smootherstep((z - ROOT[0]) / (ROOT[1] - ROOT[0]))
        moved.append((y - wear.flange * on_flange, z - wear.tread.loss(y) * (1.0 - on_flange)))
    zero = next(
        z0 + (z1 - z0) * (0.0 - y0) / (y1 - y0)
        for (y0, z0), (y1, z1) in itertools.pairwise(moved)
        if y0 <= 0.0 < y1
    )
    return resample([(y, z - zero) for y, z in moved], 0.1)


def main() -> None:
    """Write every worn profile beside this file."""
    new = resample(read(HERE / "anzr1.csv"), 0.02)
    for name, wear in WORN.items():
        lines = [
            f"# {name}: {wear.meaning} shape of the SUBSTITUTE anzr1, built by build_worn.py; not measured.",
            f"# tread wear {wear.tread};",
            f"# flange {wear.flange} mm thinner; fading over the root, z = {ROOT[0]} to {ROOT[1]} mm.",
            "# mm; y outward (flange negative), z down; y = 0 running circle.",
            "y_mm,z_mm",
        ]
        lines += [f"{y:.6f},{z:.6f}" for y, z in worn(new, wear)]
        (HERE / f"{name}.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
