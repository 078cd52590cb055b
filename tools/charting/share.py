"""What share of a scene a search touches, and what touching more would cost."""

import numpy as np
from matplotlib.ticker import FixedLocator, FuncFormatter, NullLocator

from charting.plot import panels, power, seconds_axis, short, with_unit
from charting.sheet import Sheet
from charting.style import BLUE, ORANGE, SKY

WAYS = {"as it is": "as it is", "all cells": "every cell read", "whole field": "whole field made",
        "poses one by one": "every pose by itself"}


def shares(found, on_gpu):
    """Rows (what, touched, all)."""
    pairs = found["points"] * found["poses"]
    rows = [("cells read", found["cells_read"], found["cells"]),
            ("bytes read", found["bytes_read"], found["bytes"]),
            ("points looked at one by one", found["points_tested"], found["points"]),
            ("bricks of the field made", found["bricks_made"], found["bricks"]),
            ("pairs of point and pose looked up", found["point_tests"], pairs),
            ("pairs searched in the model", found["exact_tests"], pairs)]
    if on_gpu:
        rows.append(("GPU memory, of the points as floats",
                     max(run["peak_device_bytes"] for run in on_gpu.runs), 12 * found["points"]))
    return rows


def draw(record):
    scenes = record.names("scene")
    sheet = Sheet(record, "What a search touches, and what touching more costs", 1.75 * len(scenes),
                  times=())
    axes, _ = panels(sheet, len(scenes), 2)
    for row, scene in enumerate(scenes):
        touched, cost = axes[row]
        draw_shares(touched, record, scene)
        draw_cost(cost, record, scene)
        touched.set_title(f"{'abcd'[row]}  {scene}")
    sheet.say("Left: what the search of the set touches on the CPU, as a share of all there is, "
              "logarithmic; beside the bars the numbers. Right: seconds of plan, field and search, "
              "median of the runs, when it is made to read and search every cell, to make the whole "
              "model field before, or to answer every pose as a question of its own, with the "
              "field kept (the mean of 64 poses, scaled).")
    return sheet


def draw_shares(axes, record, scene):
    found = record.where(scene=scene, way="as it is")[0].findings
    on_gpu = [case for case in record.where(scene=scene, way="GPU") if case.runs]
    rows = shares(found, on_gpu[0] if on_gpu else None)
    values = [touched / every if every else 0 for _, touched, every in rows]
    low = 10.0 ** (np.floor(np.log10(min(value for value in values if value > 0))) - 0.3)
    for y, ((_, touched, every), value) in enumerate(zip(rows, values)):
        axes.barh(y, max(value, low), left=0, height=0.62, color=SKY, edgecolor="black",
                  linewidth=0.4)
        text = f"{short(touched)} of {short(every)}"
        inside = value > 1e-3
        axes.annotate(text, (value, y), (-3 if inside else 3, 0), textcoords="offset points",
                      ha="right" if inside else "left", va="center")
    axes.set_xscale("log")
    axes.set_xlim(low, max(1, *values))
    axes.set_yticks(range(len(rows)), [what for what, *_ in rows])
    axes.set_ylim(len(rows) - 0.4, -0.6)
    axes.grid(False, axis="y")
    decades = range(int(np.ceil(np.log10(low))), 1, 2 if low < 1e-5 else 1)
    axes.xaxis.set_major_locator(FixedLocator([10.0**i for i in decades]))
    axes.xaxis.set_minor_locator(NullLocator())
    axes.xaxis.set_major_formatter(FuncFormatter(lambda value, _: power(value)))


def draw_cost(axes, record, scene):
    taken = {case["way"]: case.findings["seconds"] for case in record.where(scene=scene)
             if "seconds" in case.findings}
    ways = [way for way in WAYS if way in taken]
    seconds = [taken[way] for way in ways]
    for y, (way, value) in enumerate(zip(ways, seconds)):
        axes.barh(y, value, height=0.62, color=BLUE if way == "as it is" else ORANGE,
                  edgecolor="black", linewidth=0.4, hatch="" if way == "as it is" else "////")
        axes.annotate(with_unit(value, "s"), (value, y), (3, 0), textcoords="offset points",
                      va="center")
    axes.set_xlim(min(seconds) / 3, max(seconds) * 6)
    seconds_axis(axes.xaxis)
    axes.set_yticks(range(len(ways)), [WAYS[way] for way in ways])
    axes.set_ylim(len(ways) - 0.4, -0.6)
    axes.grid(False, axis="y")
    axes.set_xlabel("seconds")


def markdown(record):
    """The same numbers as a Markdown table."""
    scenes = record.names("scene")
    lines = ["| | " + " | ".join(scenes) + " |", "|" + "---|" * (len(scenes) + 1)]
    columns = []
    for scene in scenes:
        on_gpu = [case for case in record.where(scene=scene, way="GPU") if case.runs]
        columns.append(shares(record.where(scene=scene, way="as it is")[0].findings,
                              on_gpu[0] if on_gpu else None))
    for cells in zip(*columns):
        lines.append(f"| {cells[0][0]} | " + " | ".join(
            f"{touched:,} of {every:,} ({percent(touched / every if every else 0)})"
            for _, touched, every in cells) + " |")
    for way, name in WAYS.items():
        found = [record.where(scene=scene, way=way) for scene in scenes]
        lines.append(f"| {name} | " + " | ".join(
            with_unit(cases[0].findings["seconds"], "s")
            if cases and "seconds" in cases[0].findings else "" for cases in found) + " |")
    return "\n".join(lines) + "\n"


def percent(share):
    return f"{float(f'{100 * share:.2g}'):.9g} %"
