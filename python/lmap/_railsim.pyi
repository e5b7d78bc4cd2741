"""The compiled simulator: plain data in, Arrow columns and JSON out.

Everything that runs for long releases the GIL. Documents, cases and overrides cross as JSON text, TOML as it
was written. SI units; profiles alone are in millimetres, as their files are.
"""

from collections.abc import Callable, Sequence
from typing import Any, Literal, TypedDict, final

from typing_extensions import CapsuleType

__all__ = [
    "ConvergenceError",
    "DivergenceError",
    "Frame",
    "InputError",
    "InternalError",
    "Interrupted",
    "RailsimError",
    "_run_probes",
    "channels",
    "check_case",
    "equivalent_conicity",
    "fingerprint",
    "lint_codes",
    "lint_vehicle",
    "read_profile",
    "run_cases",
    "toml_line",
    "toml_to_json",
    "track_extremes",
    "vehicle_resolve",
    "version",
]

class _Fault(TypedDict):
    key: list[str | int]  # ["vehicle", "body", 2, "mass"]
    path: str  # the same as text: "vehicle.body[2].mass"
    found: str
    allowed: str
    hint: str | None
    line: int | None  # from 1; known only where TOML was read

class _Ended(TypedDict):
    kind: Literal["end_of_track", "complete", "diverged"]
    t: float | None  # s; of the last row, or of the divergence
    s: float | None  # m
    message: str | None

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
    `conditions`, `design_condition`, `mass` (kg) and `bodies`. `InputError` with every fault.
    """

def lint_vehicle(document_json: str, overrides_json: str, condition: str | None = None) -> str:
    """What keeps a vehicle document, its parameters overridden, from being a vehicle: a JSON list of findings.

    Empty for a vehicle: then a case with `run.kind = "lint"` gives the rest. Each finding has `code`, `rule`,
    `severity`, `subject`, `key`, `path` (the key as a list), `found` and `usual`.
    """

def lint_codes() -> str:
    """Every code as a JSON list of `code`, `rule`, `severity` and `summary`."""

def read_profile(text: str, name: str) -> str:
    """The text of a profile file as JSON: `{"points": [[y, z], ...]}`, mm.

    `name` is what messages call it. `InputError` where it is none.
    """

def check_case(case_json: str) -> None:
    """Raise `InputError` with every fault of a case; key paths start at the root of the case."""

def channels(case_json: str) -> list[tuple[str, str, str]]:
    """Name, unit and meaning of every channel that a case records, in the order of its columns."""

def track_extremes(case_json: str) -> dict[str, tuple[float, float]]:
    """Smallest and largest `lateral`, `vertical`, `cross_level` and `gauge` deviation of a case's track, m."""

def equivalent_conicity(case_json: str, amplitude: float) -> float | None:
    """Equivalent conicity of a case's wheels on its rails at a lateral amplitude in metres (EN 15302).

    `None` where there is no oscillation of this amplitude: the rolling radius difference does not restore, or the
    wheel would leave the profiles.
    """

def run_cases(
    cases: Sequence[str],
    jobs: int,
    on_progress: Callable[[int, float, float, float], object],
    on_done: Callable[[int, Frame | RailsimError], object],
) -> None:
    """Run cases on `jobs` threads; returns when the last one has ended.

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
