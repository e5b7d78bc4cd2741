"""A sweep for people: a line for each criterion, and a page with each criterion over the parameters."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, Any

from lmap.report.numbers import NOTHING, number, with_unit
from lmap.report.sheet import Line, Plot, Sheet, render

if TYPE_CHECKING:
    import polars as pl

MOST_LINES = 40
"""Lines of a plot: more cannot be told apart."""


def summary(frame: pl.DataFrame, keys: Sequence[str]) -> str:
    """How many variants pass, and the variant with the smallest margin of each criterion."""
    import polars as pl

    counts = [
        f"{frame.filter(pl.col('verdict') == verdict)['variant'].n_unique()} {words}"
        for verdict, words in (("fail", "fail"), ("error", "cannot be judged"))
        if verdict in frame["verdict"]
    ]
    bad = frame.filter(~pl.col("verdict").is_in(["pass", "shown"]))["variant"].n_unique()
    total = frame["variant"].n_unique()
    lines = [", ".join([f"{total - bad} of {total} variants pass", *counts])]
    judged = frame.filter(pl.col("margin").is_not_null())
    for (name,), rows in judged.group_by("criterion", maintain_order=True):
        row = rows.row(int(rows["margin"].arg_min() or 0), named=True)
        at = ", ".join(f"{key} = {shown(row[key])}" for key in keys)
        value = with_unit(number(row["value"]), row["unit"])
        lines.append(
            f"{name}: worst {value}, limit {row['limit']}, {row['verdict']}, at {at} ({row['case']})"
        )
    errors = frame.filter(pl.col("verdict") == "error").unique("variant", maintain_order=True)
    for row in errors.head(3).iter_rows(named=True):
        at = ", ".join(f"{key} = {shown(row[key])}" for key in keys)
        lines.append(f"error at {at}: {row['message']}")
    return "\n".join(lines)


def page(spec: str, frame: pl.DataFrame, keys: Sequence[str]) -> bytes:
    """The page, in UTF-8; needs no network."""
    import polars as pl

    judged = frame.filter(pl.col("value").is_not_null())
    figures = [
        (str(name), _caption(rows), list(_plots(rows, keys)))
        for (name,), rows in judged.group_by("criterion", maintain_order=True)
    ]
    heads = ["variant", *keys, "criterion", "case", "value", "limit", "margin", "verdict"]
    rows = [_cells(row, keys) for row in frame.iter_rows(named=True)]
    return render(
        Sheet(
            kind="Sweep",
            title=f"{spec} over {', '.join(keys)}",
            headline=summary(frame, keys).partition("\n")[0],
            tables=[("All of it", heads, rows)],
            figures=figures,
            messages=[
                str(message) for message in frame["message"].drop_nulls().unique(maintain_order=True).head(10)
            ],
        )
    )


def shown(value: Any) -> str:
    """A parameter's value."""
    return f"{value:.6g}" if isinstance(value, float) else str(value)


def _caption(rows: pl.DataFrame) -> str:
    limit = rows["limit"][0]
    return (
        f"Limit {with_unit(limit, rows['unit'][0])}; what fails has a cross." if limit else "No limit: shown."
    )


def _plots(rows: pl.DataFrame, keys: Sequence[str]) -> Iterator[Plot]:
    """One drawing for each key that has several values, along the page's horizontal axis."""
    for key in [key for key in keys if rows[key].n_unique() > 1] or list(keys[:1]):
        others = [name for name in keys if name != key]
        places = _places(rows, key)
        lines = list(itertools.islice(_lines(rows, key, others, places), MOST_LINES))
        ends = [min(places.values()), max(places.values())]
        for bound in ("limit_min", "limit_max"):
            value = rows[bound][0]
            if value is not None:
                lines.append(Line("limit", ends, [value, value], role="limit", mode="lines", dash="dash"))
        wrong = rows.filter(rows["verdict"] == "fail")
        if wrong.height:
            x = [places[value] for value in wrong[key]]
            lines.append(Line("fails", x, wrong["value"].to_numpy(), role="limit", mode="markers", size=11.0))
        text = (
            ""
            if rows[key].dtype.is_numeric()
            else f": {', '.join(f'{at:g} {v}' for v, at in places.items())}"
        )
        yield Plot(x_title=f"{key}{text}", y_title=f"value ({rows['unit'][0]})", lines=lines, choice=key)


def _places(rows: pl.DataFrame, key: str) -> dict[Any, float]:
    """Where the values of a key stand on the axis: numbers at themselves, texts in their order."""
    values = rows[key].unique(maintain_order=True)
    if values.dtype.is_numeric():
        return {value: float(value) for value in values}
    return {value: float(place) for place, value in enumerate(values)}


def _lines(rows: pl.DataFrame, key: str, others: Sequence[str], places: dict[Any, float]) -> Iterator[Line]:
    for position, (group, part) in enumerate(rows.group_by([*others, "case"], maintain_order=True)):
        points = sorted(zip((places[value] for value in part[key]), part["value"], strict=True))
        parts = [f"{name} = {shown(value)}" for name, value in zip(others, group[:-1], strict=True)]
        yield Line(
            ", ".join([*parts, str(group[-1])]),
            [x for x, _ in points],
            [y for _, y in points],
            role=str(1 + position % 8),
            mode="lines+markers",
        )


def _cells(row: dict[str, Any], keys: Sequence[str]) -> list[str]:
    unit = row["unit"] or ""
    return [
        str(row["variant"]),
        *(shown(row[key]) for key in keys),
        row["criterion"] or NOTHING,
        row["case"] or NOTHING,
        NOTHING if row["value"] is None else with_unit(number(row["value"]), unit),
        with_unit(row["limit"], unit) if row["limit"] else NOTHING,
        NOTHING if row["margin"] is None else with_unit(number(row["margin"]), unit),
        row["verdict"],
    ]
