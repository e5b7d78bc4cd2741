"""Root locus: eigenvalues over speed, as a page of its own."""

from __future__ import annotations

import polars as pl


def page(frame: pl.DataFrame, title: str, below_hz: float) -> str:
    """A self-contained page with damping and frequency of each branch over speed, and the locus itself.

    `frame` is what `lmap.analyse.modes` gives; branches that stay above `below_hz` are left out.
    """
    import plotly.graph_objects as go
    from plotly.subplots import make_subplots

    figure = make_subplots(
        rows=2,
        cols=2,
        specs=[[{"rowspan": 2}, {}], [None, {}]],
        subplot_titles=("eigenvalues", "damping over speed", "frequency over speed"),
    )
    shown = frame.filter(pl.col("frequency") > 0.0, pl.col("frequency") <= below_hz)
    for number, (_, branch) in enumerate(shown.group_by("branch", maintain_order=True)):
        rows = branch.sort("v")
        speeds = (rows["v"] * 3.6).to_list()
        name = str(rows["name"][-1])
        colour = f"hsl({137 * number % 360}, 65%, 42%)"
        hover = [
            f"{label}<br>{v:.0f} km/h, {hz:.2f} Hz, {100 * damping:.1f} %"
            for label, v, hz, damping in zip(
                rows["name"], speeds, rows["frequency"], rows["damping_ratio"], strict=True
            )
        ]
        hertz = rows["frequency"].to_list()
        lines: tuple[tuple[list[float], list[float], int, int], ...] = (
            (rows["real"].to_list(), hertz, 1, 1),
            (speeds, (100.0 * rows["damping_ratio"]).to_list(), 1, 2),
            (speeds, hertz, 2, 2),
        )
        for place, (across, up, row, column) in enumerate(lines):
            figure.add_trace(
                go.Scatter(
                    x=across,
                    y=up,
                    mode="lines+markers",
                    name=name,
                    legendgroup=name,
                    showlegend=place == 0,
                    line={"color": colour, "width": 1.5},
                    marker={"size": 4},
                    text=hover,
                    hoverinfo="text",
                ),
                row=row,
                col=column,
            )
    for column, row, below, beside in (
        (1, 1, "real part (1/s): right of 0 grows", "frequency (Hz)"),
        (2, 1, "speed (km/h)", "damping (%)"),
        (2, 2, "speed (km/h)", "frequency (Hz)"),
    ):
        figure.update_xaxes(title_text=below, row=row, col=column)
        figure.update_yaxes(title_text=beside, row=row, col=column)
    figure.add_vline(x=0.0, line_width=1, line_color="firebrick", row=1, col=1)
    figure.add_hline(y=0.0, line_width=1, line_color="firebrick", row=1, col=2)
    figure.update_layout(title=title, template="plotly_white", height=800)
    text: str = figure.to_html(include_plotlyjs=True, full_html=True)
    return text
