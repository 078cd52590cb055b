"""Time against wrongly decided points, exact and approximate."""

import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from charting.labels import place_labels
from charting.plot import (count_axis, fail, handle_of, legend_in, panels, power, room_for_failures,
                           seconds_axis, short, spread)
from charting.sheet import Sheet
from charting.style import styles_of

# What a method's value is called beside a marker and in the legend.
METHODS = {"tolerance": ("t", "tolerance t (m)"),
           "model thinned": ("v", "model thinned to a voxel v (m)"),
           "every nth pose": ("n", "every n-th pose"),
           "environment quantised": ("q", "environment quantised to q (m)")}
# Of surfaces: how it is called in the legend.
SHAPES = {"surface": "the surface itself",
          "sampled": "points on it: no place of the surface is farther from one than written"}


def wrong(case):
    return case.findings["false_hits"] + case.findings["misses"]


def label_of(case):
    if case["method"] in METHODS:
        name = f"{METHODS[case['method']][0]} {power(float(case['value']))}"
    elif case["method"] in SHAPES:
        name = case["value"] or "surface"
    else:
        name = f"{case['engine']} {case['value']}".strip()
    return name + (" ↑" if case.findings.get("beyond") else "")


def draw(record, title="Speed against accuracy (hall)"):
    sheet = Sheet(record, title, 8.3, times=("answer",))
    axes, place = panels(sheet, 2, 1, legend_lines=3)
    styles = styles_of(record.names("method"))
    number, distance = axes[:, 0]
    draw_panel(number, record, styles, wrong)
    run = [case for case in record.cases if case.runs]
    count_axis(number, max([wrong(case) for case in run], default=1), "wrongly decided points")
    number.set_title("a  how many points are decided wrongly")
    draw_share(number, run)

    distances = [case.findings["largest_distance"] for case in run if wrong(case)]
    none = 10.0 ** (np.floor(np.log10(min([d for d in distances if d > 0], default=1e-3))) - 2)
    draw_panel(distance, record, styles,
               lambda case: max(case.findings["largest_distance"], none * 10) if wrong(case)
               else none)
    distance_axis(distance, none, max(distances, default=1e-3))
    distance.set_title("b  how far they are from the boundary, at most")
    for panel in (number, distance):
        if run:
            seconds = [np.median(case.answer_seconds()) for case in run]
            panel.set_xlim(min(seconds) / 3, max(seconds) * 3)
        seconds_axis(panel.xaxis)
        panel.set_xlabel("answer (s)")
        low, high = panel.get_xlim()
        for case in record.cases:
            if case.failure:
                fail(sheet, panel, high * (low / high) ** 0.03, f"{case.key}: {case.failure}",
                     styles[case["method"]], f"> {case.limit:.0f} s" if case.limit else "")
        room_for_failures(panel)
    for panel, y_of in ((number, wrong),
                        (distance, lambda case: case.findings["largest_distance"])):
        draw_front(panel, run, y_of, none if panel is distance else 0)
    sheet.figure.canvas.draw()
    for panel in (number, distance):
        place_labels(panel, panel.__dict__["clearway_labels"])
    names = list(styles)
    legend_in(place, [handle_of(styles[name]._replace(line="none")) for name in names],
              [SHAPES.get(name) or METHODS.get(name, ("", name))[1] for name in names], 3)
    sheet.say("Wrong: false hits and misses against exact distances. Engine and parameter are "
              "written beside the markers. Grey steps: the front, no other is both faster and more "
              "accurate. ↑: some false hits are farther away than distances are known. Time "
              "axes are logarithmic; what was stopped stands at their end.")
    return sheet


def draw_panel(axes, record, styles, y_of):
    labels = axes.__dict__["clearway_labels"] = []
    for case in record.cases:
        style = styles[case["method"]]
        if not case.runs or not case.findings:
            continue
        x, below, above = spread(case.answer_seconds())
        y = y_of(case)
        axes.errorbar(x, y, xerr=[[below], [above]], color=style.colour, marker=style.marker,
                      markeredgecolor="black", markeredgewidth=0.4, elinewidth=0.8, zorder=3)
        labels.append((x, y, label_of(case)))


def draw_share(axes, run):
    points = run[0].runs[0]["environment_points"] if run else 1
    right = axes.secondary_yaxis(1.0, functions=(lambda n: n / points * 1e6,
                                                 lambda share: share * points / 1e6))
    right.set_yscale("symlog", linthresh=1e6 / points, linscale=0.6)
    low, high = axes.get_ylim()
    right.yaxis.set_major_locator(FixedLocator([0] + [10.0**i for i in range(-3, 7)
                                                      if low < 10.0**i * points / 1e6 < high
                                                      and 10.0**i * points / 1e6 >= 1]))
    right.yaxis.set_minor_locator(NullLocator())
    right.yaxis.set_major_formatter(FuncFormatter(lambda value, _: short(value)))
    right.set_ylabel("of a million environment points")
    right.spines["right"].set_visible(True)


def distance_axis(axes, none, most):
    axes.set_yscale("log")
    axes.set_ylim(none / 5, most * 10)
    low, high = np.log10(none) + 1, int(np.floor(np.log10(most * 10)))
    step = 1 if high - low < 9 else 2
    ticks = [none] + [10.0**i for i in range(high, int(low), -step)]
    axes.yaxis.set_major_locator(FixedLocator(ticks))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.yaxis.set_major_formatter(
        FuncFormatter(lambda value, _: "none" if value < none * 3 else power(value)))
    axes.set_ylabel("largest |distance − radius|\nof wrong points (m)")


def draw_front(axes, run, y_of, floor):
    """Steps through those that no other beats in both."""
    points = sorted((np.median(case.answer_seconds()), y_of(case) if wrong(case) else floor)
                    for case in run)
    front = []
    for x, y in points:
        if not front or y < front[-1][1]:
            front.append((x, y))
    if not front:
        return
    x, y = np.array(front).T
    low, high = axes.get_xlim()
    bottom, top = axes.get_ylim()
    axes.plot([x[0], *x, high], [top, *np.maximum(y, floor), max(y[-1], floor)], color="#999999",
              drawstyle="steps-post", linewidth=1, zorder=1)
    axes.set_xlim(low, high)
    axes.set_ylim(bottom, top)
