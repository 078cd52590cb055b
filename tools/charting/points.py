"""Fig. 4: time by the number of environment points."""

import numpy as np

from charting import paper
from charting.plot import (handle_of, legend_in, line, log_axis, panels, room_for_failures,
                           seconds_axis, with_unit)
from charting.sheet import Sheet
from charting.style import engine_style


def draw(record):
    engines = record.names("engine")
    rows = -(-(len(engines) + 1) // 2)
    sheet = Sheet(record, "Fig. 4: time by the number of environment points (samples of the hall)",
                  rows * 1.85 + 0.3, paper.POINTS, ("answer", "search"))
    axes, place = panels(sheet, rows, 2, legend_lines=-(-len(engines) // 4))
    for panel in axes.flat[len(engines) + 1:]:
        panel.set_axis_off()
    together = axes.flat[0]
    for letter, panel, name in zip("bcdefgh", axes.flat[1:], engines):
        cases = record.where(engine=name)
        style = engine_style(name)._replace(line="none")
        small = {"markersize": 3}
        line(sheet, together, cases, lambda case: case["points"],
             lambda case: case.answer_seconds(), style, name, **small)
        line(sheet, panel, cases, lambda case: case["points"] / 1e6,
             lambda case: case.seconds("search"), style, name, **small)
        every = max(case["every"] for case in cases)
        panel.set_title(f"{letter}  {name}" + (" (every tenth)" if every == 10 else ""))
        draw_fit(panel, cases)
        panel.set_xlim(0, None)
        panel.set_ylim(0, None)
        room_for_failures(panel)
        panel.set(xlabel="environment points (million)", ylabel="search (s)")
    log_axis(together.xaxis)
    seconds_axis(together.yaxis)
    together.set(title="a  all, logarithmic", xlabel="environment points", ylabel="answer (s)")
    room_for_failures(together)
    sheet.say("Lines: least squares through the medians, with the share of the variance that they "
              "explain (R²). Every tenth: the slow engines ran every tenth of the samples.")
    legend_in(place, [handle_of(engine_style(name)._replace(line="none")) for name in engines],
              engines, 4)
    return sheet


def draw_fit(axes, cases):
    """The straight line through the medians of the search."""
    cases = [case for case in cases if case.runs]
    if len(cases) < 3:
        return
    x = np.array([case["points"] / 1e6 for case in cases])
    y = np.array([np.median(case.seconds("search")) for case in cases])
    slope, start = np.polyfit(x, y, 1)
    share = 1 - ((y - start - slope * x) ** 2).sum() / ((y - y.mean()) ** 2).sum()
    ends = np.array([0, x.max()])
    axes.plot(ends, start + slope * ends, color="black", linewidth=1, zorder=4)
    sign = "−" if slope < 0 else "+"
    axes.text(0.97, 0.05, f"{with_unit(start, 's')} {sign} {with_unit(abs(slope), 's')}/million"
              f"\nR² = {share:.3f}", transform=axes.transAxes, va="bottom", ha="right",
              bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1}, zorder=6)
