"""The table at the end of a check: readable without colour, in 80 columns and in a log file."""

from __future__ import annotations

from collections.abc import Sequence

from rich import box
from rich.console import Console
from rich.table import Table
from rich.text import Text

from lmap.report import runs, words
from lmap.report.numbers import NOTHING, given, number, percent, quantity, signed
from lmap.verdict import Acceptance, CriterionVerdict, Outcome, SpecVerdict

_STYLES = {
    Outcome.PASS: "bold green",
    Outcome.FAIL: "bold red",
    Outcome.ERROR: "bold magenta",
    Outcome.MANUAL: "bold yellow",
    Outcome.NOT_ASSESSED: "bold yellow",
}

_FEW = 3
"""Up to this many specs say all; of more, what needs no attention is in the report."""

_SIGNAL_COLUMNS = 120
"""From this width on the worst signal has a column of its own."""


def table(acceptance: Acceptance, console: Console) -> None:
    """Prints criteria, facts, assumed limits and run figures of every spec, and the verdict of the whole.

    The reasons of assumed limits, which fill pages, are left to the report where there are many specs.
    """
    few = len(acceptance.specs) <= _FEW
    for spec in acceptance.specs:
        _spec(spec, console, reasons=few)
    if len(acceptance.specs) > 1:
        console.print(_summary(acceptance))
        if not few and any(words.assumptions(spec) for spec in acceptance.specs):
            where = "the report (--report DIR), and a check of one spec, give the reason of each"
            _note("assumed", where, console)
        console.print()
        _headline(
            "all specs",
            acceptance.outcome,
            words.headline(words.all_criteria(acceptance)),
            console,
            blank=False,
        )


def _summary(acceptance: Acceptance) -> Table:
    """One row for each spec."""
    grid = _grid()
    for title in ("id", "test", "verdict", "margin", "smallest margin, or what decided"):
        grid.add_column(title, overflow="fold")
    for line in words.summary(acceptance):
        style = _STYLES[line.outcome]
        cells = (
            line.id,
            line.title,
            Text(words.VERDICTS[line.outcome], style=style),
            line.margin,
            line.decisive,
        )
        grid.add_row(*(Text(cell) if isinstance(cell, str) else cell for cell in cells))
    return grid


def _spec(spec: SpecVerdict, console: Console, *, reasons: bool = True) -> None:
    title = Text(f"{spec.id} {spec.title}", style="bold")
    model = ", ".join(part for part in (spec.vehicle, spec.condition) if part)
    title.append(f"   {model}   {spec.file}", style="not bold")
    console.print(title, highlight=False)
    for key, value in spec.overrides.items():
        _note("set", f"{key} = {value}", console)
    console.print()
    if spec.criteria:
        console.print(_criteria(spec, wide=console.width >= _SIGNAL_COLUMNS))
    for name, reason in words.assumptions(spec) if reasons else ():
        _note("assumed", f"{name}: {reason}", console)
    for name, message in words.messages(spec):
        _note("note", f"{name}: {message}", console)
    if spec.facts:
        console.print()
        console.print(_facts(spec))
    if spec.cases:
        console.print()
        console.print(_runs(spec))
        _endings(spec, console)
    console.print()
    mark = "; test assumed" if spec.assumed else ""
    _headline(f"{spec.id} {spec.title}", spec.outcome, words.headline(spec.criteria) + mark, console)


def _criteria(spec: SpecVerdict, *, wide: bool) -> Table:
    grid = _grid()
    grid.add_column("criterion", overflow="fold", min_width=12)
    grid.add_column("case", overflow="fold")
    if wide:
        grid.add_column("worst signal", overflow="fold")
    for title in ("value", "limit", "margin", "paper"):
        grid.add_column(title, justify="left", overflow="fold")
    grid.add_column("verdict", overflow="fold")
    previous = None
    for criterion in sorted(spec.criteria, key=lambda criterion: criterion.index):
        # The name stands once, above all of its cases.
        name = "" if criterion.index == previous else criterion.name
        if previous is not None and name:
            grid.add_section()
        previous = criterion.index
        cells = [Text(name), Text(criterion.case)]
        if wide:
            cells.append(Text(criterion.signal or ""))
        cells += [
            Text(quantity(criterion.value, criterion.unit, criterion.published)),
            Text(_limit(criterion)),
            Text(_margin(criterion)),
            Text(given(criterion.published, "")),
            Text(words.verdict(criterion), style=_STYLES[criterion.outcome] if criterion.judged else ""),
        ]
        grid.add_row(*cells)
    return grid


def _limit(criterion: CriterionVerdict) -> str:
    if not criterion.limit:
        return "none"
    return f"{criterion.limit}\n{words.ASSUMED}" if criterion.source == words.ASSUMED else criterion.limit


def _margin(criterion: CriterionVerdict) -> str:
    if criterion.margin is None:
        return number(None)
    text = signed(criterion.margin, criterion.unit)
    return text if criterion.margin_percent is None else f"{text}\n{percent(criterion.margin_percent)}"


def _facts(spec: SpecVerdict) -> Table:
    grid = _grid()
    for title in ("shown beside", "case", "value", "paper"):
        grid.add_column(title, overflow="fold")
    for fact in spec.facts:
        grid.add_row(
            Text(fact.name), Text(fact.case or "all"), Text(fact.value), Text(fact.published or number(None))
        )
    return grid


def _runs(spec: SpecVerdict) -> Table:
    grid = _grid()
    for title in ("run", "distance", "simulated", "wall", "real time", "scheme", "ended"):
        grid.add_column(title, overflow="fold")
    for case in spec.cases:
        run = runs.figures(case)
        cells: Sequence[str] = (
            run.case,
            run.distance,
            run.simulated,
            run.wall,
            run.real_time_factor if run.real_time_factor == NOTHING else f"{run.real_time_factor} x",
            run.scheme if run.step == NOTHING else f"{run.scheme} {run.step}",
            run.ended,
        )
        grid.add_row(*(Text(cell) for cell in cells))
    return grid


def _endings(spec: SpecVerdict, console: Console) -> None:
    """Why runs ended early, where no criterion has said it already."""
    said = " ".join(message for _, message in words.messages(spec))
    for case in spec.cases:
        message = case.ended.get("message")
        if not case.complete and message and str(message) not in said:
            _note("run ended early", f"{case.label}: {message}", console)


def _grid() -> Table:
    return Table(box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False, show_edge=False, header_style="")


def _note(mark: str, text: str, console: Console) -> None:
    console.print(Text(f"{mark}: ", style="bold").append(text, style="not bold"), highlight=False)


def _headline(name: str, outcome: Outcome, text: str, console: Console, *, blank: bool = True) -> None:
    line = Text(words.VERDICTS[outcome], style=_STYLES[outcome])
    line.append(f"  {name}: {text}", style="not bold")
    console.print(line, highlight=False)
    if blank:
        console.print()
