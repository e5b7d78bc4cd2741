"""Closed forms of the procedure: tests that are a formula, and what runs are compared with. SI units throughout."""

from __future__ import annotations

import math

from lmap.errors import JudgementProblem

CANT_BASE = 1.5
"""m between the rails' running lines, over which cant is measured on standard gauge."""


def p2_force(
    *,
    static: float,
    dip_angle: float,
    speed: float,
    unsprung_mass: float,
    track_mass: float,
    track_stiffness: float,
    track_damping: float,
) -> float:
    """P2 force of a wheel over a dipped joint or weld, N (Jenkins, Stephenson, Clayton, Morland and Lyon 1974).

    `dip_angle` is the whole angle 2 alpha between both rail ends, rad; all masses (kg), the stiffness (N/m) and the
    damping (N s/m) are those of one wheel and one rail.

        P2 = P0 + 2 alpha V sqrt(Mu/(Mu + Mt)) (1 - pi Ct/(4 sqrt(Kt (Mu + Mt)))) sqrt(Kt Mu)

    A `JudgementProblem` from `p2_damping_limit` on: the bracket is the first order of a decay and would be negative.
    """
    both = unsprung_mass + track_mass
    damped = 1.0 - track_damping / p2_damping_limit(unsprung_mass, track_mass, track_stiffness)
    if damped <= 0.0:
        raise JudgementProblem(
            f"the formula of P2 holds for less damping of the track than {track_damping:g} N s/m"
        )
    force = math.sqrt(unsprung_mass / both) * damped * math.sqrt(track_stiffness * unsprung_mass)
    return static + dip_angle * speed * force


def p2_damping_limit(unsprung_mass: float, track_mass: float, track_stiffness: float) -> float:
    """Damping of the track (N s/m) from which the formula of P2 gives no force: 4 sqrt(Kt (Mu + Mt))/pi."""
    return 4.0 * math.sqrt(track_stiffness * (unsprung_mass + track_mass)) / math.pi


def unbalanced_acceleration(deficiency: float, gravity: float, base: float = CANT_BASE) -> float:
    """Lateral acceleration in the plane of the rails, m/s2, that goes with a cant deficiency (m)."""
    return gravity * deficiency / base


def en_twist(length: float, *, bogie: bool) -> float:
    """Twist of EN 14363 over a length (m), as a ratio: 7 - 5/l per mille within a bogie, 15/l + 2 between bogies."""
    return 1e-3 * ((7.0 - 5.0 / length) if bogie else (15.0 / length + 2.0))


def throw_centre(pivots: float, wheelbase: float, radius: float) -> float:
    """How far the middle of the body stands inside a curve of a radius, m.

    `pivots` is the distance of the bogie centres, `wheelbase` that of a bogie's outer axles.
    """
    return (pivots**2 + wheelbase**2) / (8.0 * radius)


def throw_end(length: float, pivots: float, wheelbase: float, radius: float) -> float:
    """How far the ends of a body of a length stand outside a curve of a radius, m."""
    return (length**2 - pivots**2 - wheelbase**2) / (8.0 * radius)


def x_factor(moment: float, wheelbase: float, axle_load: float) -> float:
    """Moment that turns a bogie under the body (N m) over wheelbase (m) times axle load (N)."""
    return moment / (wheelbase * axle_load)


def coupler_angle(length: float, radius: float) -> float:
    """Angle between the coupler and either body of two equal vehicles in a curve, rad.

    Two chords a `length` over couplers apart turn by length/radius against each other; by symmetry the coupler between
    them makes half of it with each, wherever its pivots are.
    """
    return length / (2.0 * radius)


def coupler_unloading(force: float, angle: float, height: float, half_base: float = CANT_BASE / 2) -> float:
    """What a longitudinal coupler force (N) in a curve takes off one rail at that end of the vehicle, N.

    F sin(angle) at the coupler's height (m) turns the vehicle about its rails: +- F_y h/(2 b) on either rail, shared
    over the wheels of the nearest bogie.
    """
    return force * math.sin(angle) * height / (2.0 * half_base)


def rollover_unloading(
    acceleration: float, height: float, gravity: float, half_base: float = CANT_BASE / 2
) -> float:
    """Share of the static load that the inner wheels of a rigid vehicle lose: a h/(g b)."""
    return acceleration * height / (gravity * half_base)


def nadal_limit(flange_angle: float, friction: float) -> float:
    """Y/Q at which a flange of an angle (rad) is on the point of climbing (Nadal 1896)."""
    tangent = math.tan(flange_angle)
    return (tangent - friction) / (1.0 + friction * tangent)


def prudhomme_limit(axle_load: float, factor: float = 1.0) -> float:
    """Lateral force of an axle (N) that track stands without shifting, K (10 kN + P0/3), from its load P0 (N).

    K is 1.0 for locomotives and passenger vehicles, 0.85 for wagons (UIC 518, EN 14363).
    """
    return factor * (10e3 + axle_load / 3.0)


def notch_effort(share: float, speed: float, max_effort: float, power: float) -> float:
    """Tractive effort (N) of a notch that is a share of the last one, at a speed (m/s).

    Share of the starting effort (N), up to the square of the share of the power at the rail (W).
    """
    force, limit = share * max_effort, share * share * power
    return limit / speed if force * speed > limit else force


def polach_adhesion(
    slip: float, friction: float, k_a: float, k_s: float, stiffness: float, load: float
) -> float:
    """Longitudinal creep force over wheel load by Polach (Wear 258 (2005) 992, eqs. 2-4) in pure longitudinal slip.

    `friction` at this slip velocity, reduction factors, `stiffness` G a b C11 of the patch (N), wheel load (N).
    """
    if friction <= 0.0:
        return 0.0
    eps = math.pi * stiffness * slip / (4.0 * load * friction)
    sliding = k_a * eps / (1.0 + (k_a * eps) ** 2) + math.atan(k_s * eps)
    return 2.0 * friction / math.pi * sliding


def falling_friction(friction: float, ratio: float, decay: float, velocity: float) -> float:
    """Coefficient of friction at a slip velocity (m/s), from that at none: mu0 ((1 - A) exp(-B w) + A)."""
    return friction * ((1.0 - ratio) * math.exp(-decay * velocity) + ratio)
