"""The time of a section, and what the same knowledge costs otherwise."""

import numpy as np

from charting.plot import handle_of, legend_in, line, log_panels, panels, wide_bars
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
    methods = [method for method in METHODS
               if any(seconds_of(record, scene, method) is not None for scene in styles)]

    def draw_bar(panel, scene, method, y, height, how):
        seconds = seconds_of(record, scene, method)
        if seconds is not None:
            panel.barh(y, seconds, height, **how)
            panel.text(seconds * 1.1, y, f"{seconds:.3g}", va="center", fontsize=6)

    wide = wide_bars(sheet, axes[0], methods, styles, "a  the largest load, by method", "seconds",
                     draw_bar)
    wide.set_xscale("log")
    wide.set_xlim(right=wide.get_xlim()[1] * 2)

    def draw_lines(panel, vary):
        for name in scenes:
            line(sheet, panel, record.where(vary=vary, scene=name),
                 lambda case: float(case["value"]), lambda case: case.seconds("search"),
                 styles[name], name)

    log_panels(sheet, axes[1:].flat, "bcde", PANELS, "", "search (s)", draw_lines)
    legend_in(place, [handle_of(styles[name]) for name in scenes], scenes, len(scenes))
    brute_force = ("Brute force is computed at some of the poses, on one thread, and scaled to all of "
                   "them; ") if "brute force" in methods else ""
    sheet.say(f"a: the time of one answer for all outlines. {brute_force}200 runs are 20 times the whole "
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


def speed_text(record, scenes):
    """How many pairs brute force has."""
    parts = []
    for name in scenes:
        for case in record.where(vary="method", value="brute force", scene=name):
            parts.append(f"{name}: {case.findings['pairs']:.3g} pairs of a point and a pose in "
                         "reach")
    return "; ".join(parts) + "." if parts else ""
