"""The compiled module as arrays: what goes in is checked here once, what comes out has the broadcast shape."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping
from typing import Any, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from lmap import toml
from lmap.errors import InputProblem, KeyPath, Problem, SimulationProblem

Array = NDArray[np.float64]
Result = TypeVar("Result")


def broadcast(values: Mapping[str, ArrayLike]) -> tuple[dict[str, Array], tuple[int, ...]]:
    """Numbers and arrays by name as arrays of double precision of one shape, and that shape."""
    arrays: dict[str, Array] = {}
    for name, value in values.items():
        try:
            arrays[name] = np.asarray(value, dtype=np.float64)
        except (TypeError, ValueError):
            found = f"{value!r}" if np.ndim(value) == 0 else "something that is no array of numbers"
            raise InputProblem(
                Problem(key=(name,), found=found, allowed="a number or an array of numbers")
            ) from None
    try:
        shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError:
        shapes = ", ".join(f"{name} {array.shape}" for name, array in arrays.items() if array.ndim)
        raise InputProblem(
            Problem(found=f"arrays of {shapes}", allowed="shapes that numpy broadcasts")
        ) from None
    return {name: np.broadcast_to(array, shape) for name, array in arrays.items()}, shape


def refuse(arrays: Mapping[str, Array], rules: Mapping[str, tuple[Callable[[Array], Any], str]]) -> None:
    """An `InputProblem` for every array with a value that is not finite or that its rule refuses: the first
    such value of each.
    """
    problems = []
    for name, array in arrays.items():
        rule, allowed = rules.get(name, (np.isfinite, "a finite number"))
        bad = np.argwhere(~(np.isfinite(array) & np.asarray(rule(array), dtype=bool)))
        if len(bad):
            index = tuple(int(i) for i in bad[0])
            value = float(array[index])
            # one number for all contacts is written once: its broadcast array has no strides
            key: KeyPath = (name, *index) if any(array.strides) else (name,)
            problems.append(Problem(key=key, found=f"{value:g}", allowed=allowed))
    if problems:
        raise InputProblem(problems)


def call(
    function: Callable[..., Result], *arguments: Any, shape: tuple[int, ...] = (), **options: Any
) -> Result:
    """A function of the core, with its errors as ours; `shape` turns the index of a flattened array into that
    of the array.
    """
    railsim = toml.core()
    try:
        return function(*arguments, **options)
    except railsim.InputError as error:
        raise InputProblem(
            [_unravelled(problem, shape) for problem in toml.problems_of_core(error)]
        ) from None
    except railsim.RailsimError as error:
        raise SimulationProblem(str(error)) from None


def _unravelled(problem: Problem, shape: tuple[int, ...]) -> Problem:
    if len(shape) > 1 and len(problem.key) == 2 and isinstance(problem.key[1], int):
        index = (int(i) for i in np.unravel_index(problem.key[1], shape))
        return Problem(
            key=(problem.key[0], *index), found=problem.found, allowed=problem.allowed, hint=problem.hint
        )
    return problem


def columns(frame: Any, names: Iterable[str] | None = None) -> dict[str, Array]:
    """The columns of a table from the core, by name."""
    import polars as pl

    table = pl.DataFrame(frame)
    return {name: table.get_column(name).to_numpy().copy() for name in (names or table.columns)}


POSITIVE = (lambda array: array > 0.0, "a number > 0")
NOT_NEGATIVE = (lambda array: array >= 0.0, "a number >= 0")
POISSON = (lambda array: (array >= 0.0) & (array <= 0.5), "0 to 0.5")
