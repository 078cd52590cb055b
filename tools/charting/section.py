"""The time of a section, and what the same knowledge costs otherwise."""

import numpy as np

from charting.plot import (handle_of, legend_in, line, log_axis, panels, room_for_failures,
                           seconds_axis)
from charting.sheet import Sheet
from charting.style import styles_of

PANELS = (("bin", "length of a bin (m)"), ("cell", "side of a cell (m)"),
          ("length", "length of the load (m)"), ("threads", "threads"))
METHODS = ("brute force", "200 runs", "section, 1 thread", "section, all threads", "section, GPU")


def draw(record):
    sheet = Sheet(record, "Sections: by method, bins, cells, length of the load and threads", 7.4,
                  times=("search",))
    axes, place = panels(sheet, 3, 2, legend_lines=1)
    scenes = record.names("scene")
    styles = styles_of(scenes)
    draw_methods(sheet, axes[0], record, styles)
    for letter, panel, (vary, label) in zip("bcde", axes[1:].flat, PANELS):
        for name in scenes:
            line(sheet, panel, record.where(vary=vary, scene=name),
                 lambda case: float(case["value"]), lambda case: case.seconds("search"),
                 styles[name], name)
        panel.set(title=f"{letter}  by {vary}", xlabel=label, ylabel="search (s)")
        log_axis(panel.xaxis)
        seconds_axis(panel.yaxis)
        room_for_failures(panel)
    legend_in(place, [handle_of(styles[name]) for name in scenes], scenes, len(scenes))
    sheet.say("a: the time of one answer for all outlines. Brute force is computed at some of the "
              "poses, on one thread, and scaled to all of them; 200 runs are 20 times the whole "
              "commands of 10 widths, a closed box each. b to e: one section on the CPU, with "
              "bins of 5 m, cells of 0.02 m, a load of 4.5 m and all threads where these are not "
              "varied. " + speed_text(record, scenes))
    return sheet


def seconds_of(record, scene, method):
    """The seconds of a method; None where it was not measured."""
    if method == "200 runs":
        cases = [case for case in record.where(vary="width", scene=scene) if case.runs]
        if not cases:
            return None
        mean = np.mean([np.median(case.values("wall_seconds")) for case in cases])
        return float(mean) * cases[0]["widths"]
    for case in record.where(vary="method", value=method, scene=scene):
        if case.runs:
            return float(np.median(case.seconds("search", "engine")))
        if "seconds" in case.findings:
            return case.findings["seconds"]
    return None


def draw_methods(sheet, row, record, styles):
    """One wide panel over a row of two: a group of bars a method."""
    grid = row[0].get_gridspec()
    axes = sheet.figure.add_subplot(grid[0, :])
    for unused in row:
        unused.remove()
    methods = [method for method in METHODS
               if any(seconds_of(record, scene, method) is not None for scene in styles)]
    height = 0.8 / max(len(styles), 1)
    for i, (scene, style) in enumerate(styles.items()):
        for k, method in enumerate(methods):
            seconds = seconds_of(record, scene, method)
            if seconds is None:
                continue
            y = k + (i - (len(styles) - 1) / 2) * height
            axes.barh(y, seconds, height * 0.9, color=style.colour, hatch=style.hatch,
                      edgecolor="black", linewidth=0.4)
            axes.text(seconds * 1.1, y, f"{seconds:.3g}", va="center", fontsize=6)
    axes.set_yticks(range(len(methods)), methods)
    axes.invert_yaxis()
    axes.set_xscale("log")
    axes.set_xlim(right=axes.get_xlim()[1] * 2)
    axes.set(title="a  the largest load, by method", xlabel="seconds")


def speed_text(record, scenes):
    """How many pairs brute force has."""
    parts = []
    for name in scenes:
        for case in record.where(vary="method", value="brute force", scene=name):
            parts.append(f"{name}: {case.findings['pairs']:.3g} pairs of a point and a pose in "
                         "reach")
    return "; ".join(parts) + "." if parts else ""
