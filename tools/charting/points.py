"""Fig. 4: time by the number of environment points."""

import numpy as np

from charting import paper
from charting.plot import (handle_of, legend_in, line, log_axis, panels, room_for_failures,
                           seconds_axis, with_unit)
from charting.sheet import Sheet
from charting.style import engine_style

RESAMPLES = 4000  # of the bootstrap


def medians(cases):
    """Points and median seconds of the search of each sample."""
    cases = [case for case in cases if case.runs]
    return (np.array([case["points"] for case in cases], float),
            np.array([np.median(case.seconds("search")) for case in cases]))


def bend(points, seconds):
    """How far the time bends from linear (0) to n log n (1): of a fixed time and a time per point
    that grows with the logarithm of n, fitted to relative errors, that growth over what n log n
    has."""
    most = np.log(points.max())
    terms = np.stack([np.ones_like(points), points, points * np.log(points / points.max())], 1)
    (_, linear, growing), *_ = np.linalg.lstsq(terms / seconds[:, None], np.ones_like(points),
                                               rcond=None)
    return growing / linear * most


def residuals(points, seconds):
    """The root mean square of relative residuals: of a line, and of n log n, both with a fixed
    time."""
    out = []
    for term in (points, points * np.log(points)):
        terms = np.stack([np.ones_like(points), term], 1) / seconds[:, None]
        fit, *_ = np.linalg.lstsq(terms, np.ones_like(points), rcond=None)
        out.append(np.sqrt(np.mean((terms @ fit - 1) ** 2)))
    return out


def interval(points, seconds):
    """The middle 95 % of what bend() gives for samples drawn anew."""
    chance = np.random.default_rng(1)
    bends = []
    for _ in range(RESAMPLES):
        drawn = chance.integers(len(points), size=len(points))
        bends.append(bend(points[drawn], seconds[drawn]))
    return np.percentile(bends, [2.5, 97.5])


def answer_of(low, high):
    """What an interval of bend() says."""
    if low <= 0 <= high:
        return "cannot be told apart" if high >= 1 else "linear"
    if high < 0:
        return "less than linear"
    return "n log n" if low <= 1 <= high else "between" if high < 1 else "more than n log n"


def markdown(record):
    """Whether the time is linear or n log n, as a Markdown table."""
    lines = ["| engine | samples | linear: residual | n log n: residual | bend (95 %) | answer |",
             "|---|---|---|---|---|---|"]
    for name in record.names("engine"):
        points, seconds = medians(record.where(engine=name))
        if len(points) < 8:
            continue
        line, curve = residuals(points, seconds)
        low, high = interval(points, seconds)
        answer = answer_of(low, high)
        lines.append(f"| {name} | {len(points)} | {100 * line:.1f} % | {100 * curve:.1f} % | "
                     f"{bend(points, seconds):.2f} ({low:.2f} to {high:.2f}) | {answer} |")
    lines += ["", "The search by the number of environment points. Residual: root mean square of the "
              "relative residuals of a fixed time and a term. Bend: of a fixed time and a time per "
              "point that grows with the logarithm of n, how much it grows: 0 is linear, 1 is n "
              f"log n; in brackets the middle 95 % of {RESAMPLES} bootstrap samples."]
    return "\n".join(lines) + "\n"


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
        panel.set_title(f"{letter}  {name}")
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
              "explain (R²).")
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
