"""Fig. 2: time of each step by grid resolution, in the adaptive layout and a regular one."""

import numpy as np
from matplotlib.patches import Patch

from charting import paper
from charting.plot import fail, legend_in, panels, room_for_failures, short, spread
from charting.sheet import Sheet
from charting.style import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION

DEFAULT_CELL_POINTS = 65536  # of `clearway convert`

# What follows one another; the last is what search does not spend computing.
STEPS = (("plan and field", SKY, "...."), ("making the engine", PURPLE, "xxxx"),
         ("search: computing", BLUE, ""), ("search: only moving data", ORANGE, "////"))
CELLS = "cells (c: chunks) read (right axis)"
# Stages of the search, which overlap.
STAGES = (("read", VERMILION, "v"), ("upload", GREEN, "^"), ("collect", BLACK, "x"))


def steps_of(case):
    """Medians of the steps, seconds."""
    compute = np.minimum(case.seconds("compute"), case.seconds("search"))
    return [np.median(values) for values in (
        case.seconds("plan", "field"), case.seconds("engine"), compute,
        case.seconds("search") - compute)]


def draw(record):
    sheet = Sheet(record, "Fig. 2: time of the grid engine's steps by grid resolution (hall)", 6.6,
                  paper.GRID)
    axes, place = panels(sheet, 3, 1, legend_lines=4)
    cell, adaptive, regular = axes[:, 0]
    chosen = record.where(vary="grid cell", value="chosen")
    draw_bars(sheet, cell, record.where(vary="grid cell"), cell_label, cell_size, cells=None)
    cell.set(title="a  by grid cell, adaptive layout", xlabel="edge of a grid cell (m)")
    draw_bars(sheet, adaptive, record.where(vary="adaptive layout"), points_label, number)
    adaptive.set(title="b  by points of a cell, adaptive layout",
                 xlabel="points of a cell, at most")
    draw_bars(sheet, regular, record.where(vary="regular layout"), lambda case: case["value"],
              number, cells=chunks_name(record))
    regular.set(title="c  by edge of a cell, regular layout", xlabel="edge of a cell (m)")
    handles = [Patch(facecolor=colour, hatch=hatch, edgecolor="black", linewidth=0.5)
               for _, colour, hatch in STEPS]
    marks = adaptive.get_legend_handles_labels()
    handles += marks[0]
    names = [f"{name} (overlaps)" for name in marks[1]]
    cells = [line for panel in sheet.figure.axes for line in panel.lines
             if line.get_label() == CELLS]
    legend_in(place, handles + cells[:1],
              [name for name, *_ in STEPS] + names + [CELLS][:len(cells)], 2)
    if chosen and chosen[0].runs:
        sheet.say(f"a: the heuristic chose {chosen[0].runs[0]['grid_cell']:g} m.")
    sheet.say("The bars stack what follows one another. In the search the stages overlap: it is "
              "split into the time in which at least one worker computed, and the rest, when data "
              "only moved; the markers are the time in which each other stage was busy, not added. "
              "Grid cells of a are hashed and their number is not reported; the line of b is "
              "the number of the store's cells that were read; c cuts the regular cells, which "
              "are of any number of points, to chunks and counts those.")
    return sheet


def chunks_name(record):
    most = record.names("chunk_points")
    return "chunks read" + (f",\n{most[0]:,} points at most" if most else "")


def number(case):
    return float(case["value"])


def cell_size(case):
    if case["value"] != "chosen":
        return float(case["value"])
    return case.runs[0]["grid_cell"] + 1e-9 if case.runs else 1e9


def cell_label(case):
    if case["value"] != "chosen":
        return case["value"]
    return f"{case.runs[0]['grid_cell']:g}\nchosen" if case.runs else "chosen"


def points_label(case):
    value = int(case["value"])
    return f"{value:,}" + ("\ndefault" if value == DEFAULT_CELL_POINTS else "")


def draw_bars(sheet, axes, cases, label_of, order, cells="cells read"):
    cases = sorted(cases, key=order)
    axes.set_xticks(range(len(cases)), [label_of(case) for case in cases])
    axes.set_xlim(-0.6, len(cases) - 0.4)
    axes.set_ylabel("time (s)")
    axes.grid(False, axis="x")
    run = [(x, case) for x, case in enumerate(cases) if case.runs]
    x = [at for at, _ in run]
    bottom = np.zeros(len(run))
    for (_, colour, hatch), seconds in zip(STEPS, np.array([steps_of(c) for _, c in run]).T):
        axes.bar(x, seconds, 0.62, bottom, color=colour, hatch=hatch, edgecolor="black",
                 linewidth=0.5)
        bottom += seconds
    whole = np.array([spread(c.seconds("plan", "field", "engine", "search")) for _, c in run]).T
    if run:
        axes.errorbar(x, whole[0], whole[1:], color="black", linestyle="none", elinewidth=0.8)
    for name, colour, marker in STAGES:
        seconds = [np.median(c.seconds(name)) for _, c in run]
        axes.plot([at + 0.38 for at in x], seconds, color=colour, marker=marker, linestyle="none",
                  label=name, markersize=4)
    for at, case in enumerate(cases):
        if case.failure:
            fail(sheet, axes, at, case.failure)
    axes.set_ylim(0, None)
    axes.margins(y=0.08)
    room_for_failures(axes)
    if cells and run:
        draw_cells(axes, x, [c.runs[-1]["cells_read"] for _, c in run], cells)


def draw_cells(axes, x, cells, name):
    right = axes.twinx()
    right.spines["right"].set_visible(True)
    right.grid(False)
    right.plot(x, cells, color=GREEN, marker="D", markersize=4, linestyle="--",
               markeredgecolor="black", markeredgewidth=0.4, label=CELLS)
    right.set_yscale("log")
    # Between powers of ten, so that at least two are named.
    right.set_ylim(10 ** np.floor(np.log10(min(cells))),
                   10 ** (np.floor(np.log10(max(cells))) + 1))
    right.yaxis.set_major_formatter(lambda value, _: short(value))
    right.set_ylabel(name)
