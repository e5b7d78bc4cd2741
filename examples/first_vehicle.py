"""A vehicle of one's own in Python: described as plain data, changed, its modes, a run, what comes out.

    python examples/first_vehicle.py

SI units; axes x forward, y right, z down from the vehicle's centre at top of rail.
"""

from __future__ import annotations

import polars as pl

import lmap

RADIUS = 0.46  # m


def spring(name: str, wheelset: str, x: float) -> dict[str, object]:
    """The suspension of one axle, on both sides."""
    return {
        "name": name,
        "kind": "bushing",
        "between": [wheelset, "body"],
        "position": [x, 1.0, -RADIUS],
        "mirror": True,
        "carries_weight": True,
        "stiffness": ["$primary.kx", "$primary.ky", "$primary.kz"],
        "damping": [1e4, 1e4, "$primary.cz"],
    }


def wheelset(name: str, x: float) -> dict[str, object]:
    """One wheelset."""
    return {
        "name": name,
        "mass": 1500.0,
        "inertia": [900.0, 110.0, 900.0],
        "radius": RADIUS,
        "tape_half_distance": 0.75,
        "position": [x, 0.0],
    }


# A two-axle trolley of 15 t: the keys are those of a vehicle file (docs/reference/vehicle.md).
trolley = lmap.Vehicle.of(
    {
        "name": "trolley",
        "title": "Two-axle trolley, 15 t",
        "design_speed_kmh": 80.0,
        "wheel_profile": "s1002",
        "condition": {"full": {}},
        "parameters": {"primary": {"kx": 8e6, "ky": 4e6, "kz": 1.2e6, "cz": 2e4}},
        "body": [
            {
                "name": "body",
                "mass": 12000.0,
                "inertia": [1.2e4, 9e4, 9.2e4],
                "position": [0.0, 0.0, -1.2],
            }
        ],
        "wheelset": [wheelset("ws1", 2.5), wheelset("ws2", -2.5)],
        "connection": [spring("front", "ws1", 2.5), spring("rear", "ws2", -2.5)],
        "contact": {"youngs_modulus": 2.1e11, "poisson": 0.28, "damping": 5e4},
        "speed_hold": {"body": "body", "stiffness": 1e5, "damping": 5e4},
    }
)

# Its modes at rest, as a polars frame; then with springs half as stiff.
soft = trolley.resolve({"primary.kz": 0.6e6})
bounce = {}
for name, vehicle in (("as described", trolley), ("soft", soft)):
    modes = vehicle.modes().filter(pl.col("frequency").is_between(0.1, 5.0))
    print(f"\n{name}:\n{modes.select('name', 'frequency', 'damping_ratio')}")
    bounce[name] = modes.filter(pl.col("name").str.contains("bounce"))["frequency"][0]
print(f"\nbounce: {bounce['as described']:.2f} Hz, with soft springs {bounce['soft']:.2f} Hz")

# 150 m at 60 km/h over a hump of 10 mm on 10 m; a row every 5 ms.
frame = trolley.run(
    {
        "kind": "time",
        "speed": 60.0 / 3.6,
        "integrator": {"kind": "ros2", "step": 0.001},
        "output_step": 0.005,
    },
    track={
        "length": 150.0,
        "irregularity": {
            "kind": "shape",
            "shape": "versine",
            "channel": "vertical",
            "start": 60.0,
            "length": 10.0,
            "height": 0.01,
        },
    },
)
forces = frame.select(pl.col("^ws.*\\.Q$"))
print(f"\n{frame.height} rows of {frame.width} channels; the last of them:")
print(frame.select("t", "s", "body.z", "ws1.left.Q").tail(3))
print(
    f"wheel forces {forces.min().min_horizontal()[0] / 1e3:.1f} to {forces.max().max_horizontal()[0] / 1e3:.1f} kN"
)

# A vehicle that ships, from its file, with a parameter changed; its file as TOML text does as well.
locomotive = lmap.Vehicle.load("coco134", overrides={"yaw_damper.cx": 2e5})
print(f"\n{locomotive.data.title}: {locomotive.data.mass:.0f} kg")
modes = locomotive.modes(locomotive.data.design_speed).filter(pl.col("frequency") > 0.1)
print(modes.select("name", "frequency", "damping_ratio").head(5))
