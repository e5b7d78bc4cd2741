"""Displaced sections and clearances by hand."""

from __future__ import annotations

import math

import pytest

from lmap.outline import clearance, closed, displaced

GAUGE = closed([(1.5, -1.0), (1.5, -4.0)])  # 3 m wide, from 1 to 4 m above rail
BODY = closed([(1.4, -1.1), (1.4, -3.8)])


def test_a_box_in_the_middle_of_a_box() -> None:
    found = clearance(BODY, GAUGE)
    assert found.distance == pytest.approx(0.1)
    assert abs(found.outline[0]) == pytest.approx(1.5) or found.outline[1] == pytest.approx(-1.0)


def test_shifted_to_the_right_and_down() -> None:
    moved = displaced(BODY, y=0.06, z=0.02, roll=0.0, centre=-2.0)
    assert clearance(moved, GAUGE).distance == pytest.approx(0.04)
    assert clearance(moved, GAUGE).outline[0] == pytest.approx(1.5)


def test_a_roll_to_the_right_moves_what_is_above_its_centre_to_the_right() -> None:
    moved = displaced(BODY, y=0.0, z=0.0, roll=0.02, centre=-2.0)
    top = moved[1]
    assert top[0] == pytest.approx(1.4 * math.cos(0.02) + 1.8 * math.sin(0.02))
    assert top[1] == pytest.approx(-2.0 + 1.4 * math.sin(0.02) - 1.8 * math.cos(0.02))
    assert clearance(moved, GAUGE).distance == pytest.approx(1.5 - top[0])


def test_what_sticks_out_is_negative() -> None:
    moved = displaced(BODY, y=0.13, z=0.0, roll=0.0, centre=-2.0)
    assert clearance(moved, GAUGE).distance == pytest.approx(-0.03)


def test_a_corner_of_the_outline_within_the_body_is_negative() -> None:
    notched = closed([(1.5, -1.0), (1.5, -2.0), (1.2, -2.5), (1.5, -3.0), (1.5, -4.0)])
    assert clearance(BODY, notched).distance < -0.1
