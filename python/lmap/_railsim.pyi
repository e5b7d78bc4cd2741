"""The compiled simulator: plain data in, Arrow columns and JSON out.

Everything that runs for long releases the GIL. Documents, cases and overrides cross as JSON text, TOML as it
was written. SI units; profiles alone are in millimetres, as their files are.
"""

from collections.abc import Callable, Iterable, Sequence
from typing import Any, Literal, TypedDict, final

from typing_extensions import Buffer, CapsuleType

__all__ = [
    "ConvergenceError",
    "DivergenceError",
    "Frame",
    "InputError",
    "InternalError",
    "Interrupted",
    "RailsimError",
    "Tables",
    "_run_probes",
    "case_schema",
    "channel_parts",
    "channels",
    "check_case",
    "contact_gap",
    "contact_map",
    "creep_forces",
    "curve_conicity",
    "equivalent_conicity",
    "fingerprint",
    "hertz",
    "inspect_profile",
    "kalker_coefficients",
    "lint_codes",
    "lint_vehicle",
    "non_elliptic",
    "pair_conicity",
    "profile_quality",
    "read_profile",
    "rolling_radius_difference",
    "run_cases",
    "smooth_profile",
    "toml_line",
    "toml_to_json",
    "track_extremes",
    "vehicle_resolve",
    "vehicle_schema",
    "version",
    "write_profile",
]

class _Fault(TypedDict):
    key: list[str | int]  # ["vehicle", "body", 2, "mass"]
    path: str  # the same as text: "vehicle.body[2].mass"
    found: str
    allowed: str
    hint: str | None
    line: int | None  # from 1; known only where TOML was read

class _Ended(TypedDict):
    # the last: a table that is no run's
    kind: Literal["end_of_track", "complete", "diverged", "computed"]
    t: float | None  # s; of the last row, or of the divergence
    s: float | None  # m
    message: str | None

class _Law(TypedDict):
    name: str
    channels: Sequence[str]
    outputs: Sequence[str]
    sample: Callable[[float, float, list[float]], Sequence[float | None]]

class RailsimError(Exception):
    """Base of everything the core raises."""

class InputError(RailsimError):
    """Bad input. The message lists every fault that was found, a line each; `faults` has them as data."""

    faults: list[_Fault]

class ConvergenceError(RailsimError):
    """An iteration did not reach its tolerance."""

    what: str
    iterations: int
    residual: float
    unit: str
    worst: str

class DivergenceError(RailsimError):
    """A run left what the model describes before there was anything to return.

    A run that diverges on its way is no exception: its frame ends early and says so in `ended`.
    """

    t: float
    s: float
    body: str
    cause: str

class Interrupted(RailsimError):
    """Stopped from outside."""

class InternalError(RailsimError):
    """A fault of the program itself: a panic in the core."""

@final
class Frame:
    """One finished case: float64 columns of equal length, a row for each output step.

    `polars.DataFrame(frame)` takes the columns over without a copy.
    """

    @property
    def names(self) -> list[str]:
        """Names of the columns, in order."""
    @property
    def rows(self) -> int:
        """Number of rows."""
    @property
    def ended(self) -> _Ended:
        """How the run ended."""
    @property
    def statistics(self) -> dict[str, Any]:
        """What the run cost: counts of steps, right-hand sides, contact iterations."""
    @property
    def wall_s(self) -> float:
        """Wall time of this case, s."""
    def __arrow_c_stream__(self, requested_schema: CapsuleType | None = None) -> CapsuleType:
        """The columns as an Arrow C stream of one batch."""

def version() -> str:
    """Version of the package."""

def fingerprint() -> str:
    """SHA-256 of the core's sources, in hexadecimal: same fingerprint and same case, same result."""

def toml_to_json(text: str) -> str:
    """A TOML document as JSON text.

    `InputError` with line where it is not TOML, and with key and line for what JSON has no word for: dates,
    nan and infinity.
    """

def toml_line(text: str, key: Sequence[str | int]) -> int | None:
    """Line, from 1, of the deepest part of the key path that exists; `None` where not even its first part
    does.

    `InputError` where the text is not TOML.
    """

def vehicle_resolve(document_json: str, overrides_json: str, condition: str | None = None) -> str:
    """A vehicle document with its named parameters overridden, and what a procedure asks of it.

    `overrides_json` is an object of dotted parameter names and values. The answer has `document` (with the
    overrides in it), `name`, `title`, `design_speed` (m/s), `wheel_radius` (m), `wheel_profile`, `track`,
    `conditions`, `design_condition`, `mass` (kg), `bodies` and `model`: the vehicle with its templates copied, its
    references replaced and its mirrored elements made. `InputError` with every fault.
    """

def vehicle_schema() -> str:
    """JSON schema of a vehicle file as JSON text."""

def case_schema() -> str:
    """JSON schemas of a case's tables `track` and `run`, by name, as JSON text."""

def lint_vehicle(document_json: str, overrides_json: str, condition: str | None = None) -> str:
    """What keeps a vehicle document, its parameters overridden, from being a vehicle: a JSON list of findings.

    Empty for a vehicle: then a case with `run.kind = "lint"` gives the rest. Each finding has `code`, `rule`,
    `severity`, `subject`, `key`, `path` (the key as a list), `found` and `usual`.
    """

def lint_codes() -> str:
    """Every code as a JSON list of `code`, `rule`, `severity` and `summary`."""

def read_profile(text: str, name: str, options_json: str = "{}") -> str:
    """The text of a profile file as JSON: `{"points": [[y, z], ...]}`, mm.

    y points outward, z down, and the points run from the flange or gauge side outward, whichever way the file has them.

    `name` is the file's name or what messages call it: its extension, and before that the content, says which format
    this is: plain CSV, MiniProf (.whl, .ban, .mpt, .rail), SIMPACK and CONTACT (.prw, .prr), GENSYS (.wheel, .rail),
    VAMPIRE (.whe, .rai). `options_json` overrules what is detected: an object with any of `kind` (wheel, rail),
    `format` (csv, miniprof, simpack, gensys, vampire), `unit` (mm, cm, m, in), `mirror_y`, `mirror_z`. `InputError`
    where it is none, where it is plainly the other kind, and where its width is none of a profile.
    """

def inspect_profile(text: str, name: str, options_json: str = "{}") -> str:
    """`read_profile` with all that was found out: `kind` (wheel, rail or null), `detected`, `findings`, `smoothing`.

    `detected` has `format`, `kind`, `unit` (m), `mirrored_y`, `mirrored_z`, each with `value` and `because`, then
    `reversed` and `notes`. `findings` are as of `profile_quality`.
    """

def write_profile(points_json: str, name: str, options_json: str = "{}") -> str:
    """Points (JSON, `[[y, z], ...]`, mm; y outward, z down) as the text of a file called `name`.

    The extension says the format, unless `options_json` does: an object with any of `format`, `kind` (only SIMPACK
    files say it) and `title`. Reading it gives the same points. VAMPIRE files are not written.
    """

def profile_quality(points_json: str, kind: Literal["wheel", "rail"] | None = None) -> str:
    """What is remarkable about points, as JSON: a list, the most serious first, empty for a clean profile.

    Each has `code` (e.g. kink, gap, doubled_point, overhang, self_crossing, noise), `severity` (note, warning,
    error), `index` of the point and `place` [y, z] in mm, both null where it is about the whole, and `text`.
    """

def smooth_profile(points_json: str, kind: Literal["wheel", "rail"], half_width: float = 1.0) -> str:
    """The curve that contact sees, as JSON: lists `y`, `z` (mm), `angle` (atan2(dz, dy), rad), `curvature` (1/m).

    Smoothed over +-`half_width` mm (0.3 to 10). `InputError` for points that contact cannot be computed with.
    """

def check_case(case_json: str, tables: Tables | None = None) -> None:
    """Raise `InputError` with every fault of a case; key paths start at the root of the case."""

@final
class Tables:
    """What calls share: contact tables, each built once for a wheel, a rail and how they are placed (some 0.2 s), and
    the case that was read last.

    At most 16 tables are kept. Results do not depend on it.
    """

    def __new__(cls) -> Tables: ...

def channel_parts() -> list[tuple[str, str, str]]:
    """Last part of the name, unit and meaning of every channel that any case may have, sorted."""

def channels(case_json: str, tables: Tables | None = None) -> list[tuple[str, str, str]]:
    """Name, unit and meaning of every channel that a case records, in the order of its columns."""

def track_extremes(case_json: str, tables: Tables | None = None) -> dict[str, tuple[float, float]]:
    """Smallest and largest `lateral`, `vertical`, `cross_level` and `gauge` deviation of a case's track, m."""

def equivalent_conicity(case_json: str, amplitude: float, tables: Tables | None = None) -> float | None:
    """Equivalent conicity of a case's wheels on its rails at a lateral amplitude in metres (EN 15302).

    `None` where there is no oscillation of this amplitude: the rolling radius difference does not restore, or the
    wheel would leave the profiles.
    """

def hertz(force: Buffer, kx: Buffer, ky: Buffer, youngs_modulus: float, poisson: float) -> Frame:
    """Hertz's patch for arrays of float64 of one length: normal force (N), relative curvatures (1/m) along and across.

    Columns: semi-axes `a` along and `b` across (m), `approach` (m), `max_pressure` (Pa); NaN for a curvature that is
    not positive.
    """

def non_elliptic(
    y: Buffer,
    separation: Buffer,
    curvature: float,
    youngs_modulus: float,
    poisson: float,
    force: float | None,
    approach: float | None,
) -> tuple[dict[str, float], Frame]:
    """Patch by virtual penetration (Kik and Piotrowski) for a separation (m) at positions (m, rising), at a force (N)
    or an approach (m).

    The figures `approach`, `force`, `max_pressure`, `area`, `origin`, `a`, `b` (SI), and the outline: `y`,
    `half_length` (m).
    """

def contact_gap(pair_json: str, y: float, right: bool, half_width: float, step: float) -> Frame:
    """Normal distance of the undeformed surfaces across the place where a wheel of a wheelset standing at `y` (m)
    touches first: columns `s` (m, outward along the contact plane, every `step` up to `half_width`), `gap` (m),
    `k_xx` (1/m).
    """

def creep_forces(
    law_json: str,
    contacts: dict[str, float | Sequence[float] | Buffer],
    falling_json: str | None = None,
) -> Frame:
    """Creep forces on the wheel: a row of `fx`, `fy` (N) for each contact, and `mz` (N m) where `c33` is given.

    `law_json` is a law as `run.creep` has it. `contacts` has `a`, `b` (m, along rolling and across), `n` (N), `c11`,
    `c22`, `c23`, `shear_modulus` (Pa), `xi`, `eta`, `phi` (1/m), `mu`, and may have `c33` and `speed` (m/s): a number
    for all contacts, or an array of float64 or a list with one for each. `falling_json`, `{"ratio": A, "decay": B}`,
    makes `mu` fall with the slip velocity `speed` times creepage. `mz` is NaN for a law that gives no moment.

    Axes of the contact: x rolling, y lateral, right-handed with the normal; positive creepage gives negative force.
    `InputError` names the array and the index.
    """

def kalker_coefficients(a_over_b: Sequence[float], poisson: float) -> Frame:
    """Kalker's `c11`, `c22`, `c23`, `c33` for axis ratios (a along rolling) at one Poisson's ratio."""

# A pair, as JSON: `left` and `right` (the same as left where missing), each with `wheel` and `rail` (points [y, z] in
# mm; y outward, z down; wheel with its running circle at y = 0 and the flange at negative y, rail upright with its top
# at the origin) and `radius` (m); `gauge`, `gauge_point_depth` (0.014), `rail_inclination` (slope, 0),
# `flange_back_distance`, `tape_from_flange_back` (0.07), `smoothing` (half-width of the smoothing, 0.001), in m;
# `youngs_modulus` (Pa), `poisson`. The JSON of a case does as well: its vehicle's wheels on its track. Unknown or
# missing keys are an `InputError`.

def rolling_radius_difference(
    pair_json: str, shifts: Sequence[float], free_roll: bool = False
) -> list[float | None]:
    """Rolling radius of the right wheel less that of the left (m) with the wheelset shifted to the right by each of
    `shifts` (m), rigid contact by direct search; `None` where a wheel would stand beside or on the end of its profile.

    The axle stays level, as in the reference curves of EN 15302, or rolls until both wheels touch.
    """

def pair_conicity(
    pair_json: str,
    amplitudes: Sequence[float],
    method: str = "integration",
    free_roll: bool = False,
    step: float = 1e-4,
) -> list[float | None]:
    """Equivalent conicity of a pair at each lateral amplitude (m), from the rolling radius difference every `step` (m).

    `method`: `integration` (EN 15302's reference), `regression` (two-step linear), `harmonic`. `None` where there is no
    oscillation of that amplitude.
    """

def curve_conicity(
    y: Sequence[float],
    difference: Sequence[float],
    amplitudes: Sequence[float],
    method: str = "integration",
) -> list[float | None]:
    """The same of a rolling radius difference given by its points (m, y rising)."""

def contact_map(
    pair_json: str,
    shifts: Sequence[float],
    yaw: float = 0.0,
    free_roll: bool = True,
    load: float | None = None,
    rail_shift: tuple[float, float] | None = None,
    rail_roll: tuple[float, float] | None = None,
) -> Frame:
    """Every contact of both wheels at each shift (m), a row each, by direct search.

    Without `load` (N per wheel, vertical) rigid: the up to three closest places of a wheel in the order in which they
    touch, `gap` along the normal. With it elastic: patches, with `normal` (N), semi-axes `a` and `b` (m), relative
    lateral `curvature` (1/m) and `spread` (0 for Hertz; beyond 0.25 the patch is no ellipse). Columns: `y` (of the
    wheelset), `side` (-1 left, 1 right), `rank`, `part` (0 tread, 1 flange, 2 back of flange), `roll`, `z` of the
    wheelset, `gap`, `y_rail`, `z_rail`, `y_wheel`, `z_wheel` (side coordinates: outward, down), `x` (ahead of the
    axle), `angle`, `radius`, `k_xx`, `k_yy` and those. Shifts at which a wheel does not stand have no rows.
    `rail_shift` (m, outward) and `rail_roll` (rad, field side down): left, right.
    """

def run_cases(
    cases: Iterable[str | tuple[str, _Law]],
    jobs: int,
    on_progress: Callable[[int, float, float, float], object],
    on_done: Callable[[int, Frame | RailsimError], object],
    tables: Tables | None = None,
) -> None:
    """Run cases on `jobs` threads, begun in their order; returns when the last one has ended.

    `cases` is asked for the next case when a thread is free, on that thread; an exception in it stops every run as one
    from a callback does. A case is JSON, or a pair of JSON and a control law: `sample(t, period, seen)` is called on
    the thread of that case every `run.drive.period`, with the time, the period (s) and the values of `channels`; it
    gives a value for each of `outputs` (`<wheelset>.torque` and `<bogie>.torque`, N m; `independent_brake`, Pa), `None`
    for what stays with the vehicle's own controllers. An exception in it, or an answer that is no finite number, is the
    case's failure and names `name`.

    Both callbacks are called on the calling thread: `on_progress(index, fraction, distance_m,
    real_time_factor)` about ten times a second for each case that is on its way, `on_done(index, result)`
    once for each case, as they finish. A case that fails has its exception for a result and stops no other.

    An exception from a callback stops every run, within a step, and is raised again; so does Ctrl-C, as
    `KeyboardInterrupt`, within a second.
    """

def _run_probes(
    deeds: Sequence[str],
    jobs: int,
    on_progress: Callable[[int, float, float, float], object],
    on_done: Callable[[int, Frame | RailsimError], object],
) -> None:
    """`run_cases` with stand-in work, for tests: `rows`, `diverge`, `refuse`, `panic` or `endless` for each."""
