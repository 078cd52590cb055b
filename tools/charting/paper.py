"""The paper's table and figures, with what it (see README.md) reports of its own data sets and
machines, in our words."""

import numpy as np
from matplotlib.patches import Patch

from charting.plot import (bar_look, fail, legend_in, line, log_axis, look_of, panels,
                           right_axes, room_for_failures, rows_of_bars, seconds_axis, short, spread)
from charting.record import markdown_table
from charting.sheet import Sheet
from charting.style import (BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION, Style,
                            engine_styles)

# Table 1 by the scene like it: points, model points, poses, colliding points on the CPU (double)
# and on the GPU (float).
TABLE = {
    "mine": ("El Teniente", 806183400, 100000, 17795, 35225149, 35225399),
    "hall": ("Hannover", 55872714, 214489, 17234, 2495803, 2495804),
    "plant": ("Wolfsburg", 350109065, 434700, 398999, 26089196, 26089208),
    "tunnel": ("Train Tunnel", 18919000, 28622, 19392, 1627225, 1627233),
}

THREADS = """Fig. 1 (Hannover, 3DTK's k-d tree on 20 cores of two Xeon E5-2680 v2): speed grows \
linearly with the threads up to the number of cores.
With hyper-threading it grows on, less steeply, to about 1.2 times at 40 threads (17.3 % more).
Beyond the number of virtual cores nothing is gained."""

GRID = """Fig. 2 (Hannover, GPU method by grid resolution, stacked time of its steps, number of \
cells as a line):
Many cells make building the grid dearer, but it stays below 5 % of the time.
Most time goes into the search for neighbours.
Time grows with the size of a grid cell, and fluctuates much: slightly different decompositions \
bring different numbers of cells to the GPU.
It wishes for a heuristic that picks the cell size."""

ENGINES = """Fig. 3 (k-d tree on 8 and on 20 cores with all their threads; grid on Titan X, GTX \
980 and Tesla K40, grid size 50; search time only):
Which is ahead depends on the data set.
Wolfsburg (plant): the grid on the Titan X is the fastest.
Train Tunnel (tunnel): the k-d tree on 20 cores is far ahead of every GPU.
El Teniente (mine) and Train Tunnel are mostly empty space: a regular grid has many empty cells, \
and the others cover too much.
Wolfsburg takes longest of all."""

POINTS = """Fig. 4 (Hannover, 111 random samples of 0.5 to 55.5 million points; k-d tree on 20 cores, \
grid on a Titan X):
The time of both is nearly linear in the number of points, with perhaps a very shallow logarithm \
beneath; the paper leaves that open."""


def like(scene):
    """Which of the paper's data sets a scene is like, for a title."""
    return f"{scene} (like {TABLE[scene][0]})" if scene in TABLE else scene


# --- Table 1: colliding points of every engine on the four scenes, beside the paper's ---------------

NO_PAPER = ("", "", "", "", "", "")  # of a scene that is not like one of the paper's


def grouped(number):
    return f"{number:,}" if number != "" else ""


def is_float(case):
    return not case.get("exact")


def counted(case):
    """What to say of a case's colliding points."""
    return "failed" if case.failure else grouped(case.runs[-1]["colliding_points"])


def equality(case):
    if case.failure or is_float(case):
        return ""
    return "=" if case.findings["equal"] else f"differs by {grouped(case.wrong())}"


def sizes_of(cases):
    """Points E and M and poses T of a scene, as far as a case has run."""
    run = next((case.runs[-1] for case in cases if case.runs), {})
    return [grouped(run.get(name, "")) for name in ("environment_points", "model_points", "poses")]


def rows_of(record, scene):
    """Rows (what, here, beside it a note, the paper's)."""
    cases = record.where(scene=scene)
    _, *sizes, on_cpu, on_gpu = TABLE.get(scene, NO_PAPER)
    rows = [(what, here, "", grouped(theirs)) for what, here, theirs in
            zip(("points E", "model points M", "poses T"), sizes_of(cases), sizes)]
    for case in cases:
        theirs = on_cpu if case["engine"] == "kdtree cpu" else on_gpu if is_float(case) else ""
        rows.append((case["engine"], counted(case), equality(case), grouped(theirs)))
    for case in cases:
        if is_float(case) and not case.failure:
            rows.append(("float differs by", grouped(case.wrong()),
                         f"+{case.findings['only_here']} −{case.findings['only_in_reference']}",
                         f"{on_gpu - on_cpu} or more" if on_gpu else ""))
    return rows


def draw_table(record):
    rows = {scene: rows_of(record, scene) for scene in record.names("scene")}
    count, lines = max(map(len, rows.values())), -(-len(rows) // 2)
    sheet = Sheet(record, "Table 1: colliding points of every engine", lines * (count + 2) * 0.19,
                  times=())
    axes, _ = panels(sheet, lines, 2)
    for place in axes.flat:
        place.set_axis_off()
    for place, scene in zip(axes.flat, rows):
        draw_rows(place, rows[scene], scene, count)
    sheet.say("Rows of engines: colliding points; = the same set, point by point, as sweep cpu. "
              "Float differs by: points that only float finds (+) and that it misses (−). The "
              "paper's columns are its own data sets with its k-d tree (double) on the row of "
              "kdtree and its GPU method (float) on that of float; of its difference only that "
              "of the counts is known, so at least as many points differ.")
    for case in record.cases:
        if case.failure:
            sheet.number_of_failure(f"{case.key}: {case.failure}")
    return sheet


def draw_rows(axes, rows, scene, count):
    axes.set_xlim(0, 1)
    axes.set_ylim(count + 1.6, -0.2)
    columns = ((0.0, "left"), (0.5, "right"), (0.52, "left"), (1.0, "right"))
    head = (scene, "Clearway", "", TABLE.get(scene, NO_PAPER)[0])
    for row, cells in enumerate([head, *rows]):
        for (x, side), text in zip(columns, cells):
            axes.text(x, row + 0.5, text, ha=side, va="center",
                      weight="bold" if row == 0 else "normal")
    for y, width in ((0, 1.0), (1, 0.7), (4, 0.5), (len(rows) + 1, 1.0)):
        axes.plot([0, 1], [y, y], color="black", linewidth=width)


def table_markdown(record):
    """The same as a Markdown table, a row a scene."""
    engines, rows = record.names("engine"), []
    for scene in record.names("scene"):
        cases = record.where(scene=scene)
        found = {case["engine"]: f"{counted(case)} {equality(case)}".strip() for case in cases}
        floats = [grouped(case.wrong()) for case in cases if is_float(case) and not case.failure]
        name, *numbers, on_cpu, on_gpu = TABLE.get(scene, NO_PAPER)
        rows.append([scene, *sizes_of(cases), *(found.get(engine, "") for engine in engines),
                     "".join(floats[:1]), name, *map(grouped, [*numbers, on_cpu, on_gpu]),
                     grouped(on_gpu - on_cpu) if on_gpu else ""])
    return markdown_table(
        ["scene", "E", "M", "T", *engines, "float differs by", "paper's data set", "its E", "its M",
         "its T", "CPU", "GPU", "counts differ by"], rows,
        "Points of the environment E, of the model M, poses T; colliding points of each "
        "engine, = where the set is that of sweep cpu point by point. The paper's columns are "
        "its own data sets, k-d tree in double on the CPU and grid in float on the GPU.")


# --- Fig. 1: speed by the number of threads ---------------------------------------------------------


def draw_threads(record):
    sheet = Sheet(record, "Fig. 1: speed by the number of threads (hall)", 3.9, THREADS)
    cores = record.machine["cores"]
    axes, _ = panels(sheet, 2, 1)
    absolute, relative = axes[:, 0]
    most = max(case["threads"] for case in record.cases)
    dotted = {"linewidth": 0.8, "linestyle": ":"}
    absolute.plot([0, most], [0, most], color=GREY, label="linear", **dotted)
    draw_speed(sheet, absolute, "a", record, 1, 1)
    absolute.set(title="a  relative to 1 thread", xlabel="threads", ylabel="speed (1 thread = 1)")
    relative.plot([0, 1, most / cores], [0, 1, 1 + 0.173 * (min(most / cores, 2) - 1)],
                  color=BLACK, label="as the paper says", **dotted)
    draw_speed(sheet, relative, "b", record, cores, cores)
    relative.set(title=f"b  relative to all {cores} logical cores",
                 xlabel="threads / logical cores", ylabel=f"speed ({cores} threads = 1)")
    for panel, all_cores, corner in ((absolute, cores, "upper left"),
                                     (relative, 1, "lower right")):
        panel.axvline(all_cores, color=GREY, linewidth=0.8, linestyle="--", zorder=0)
        panel.set(xlim=(0, None), ylim=(0, None))
        room_for_failures(panel)
        panel.legend(loc=corner)
    sheet.say(f"Dashed, upright: the {cores} logical cores of this machine. The dotted line of b is "
              "drawn from the paper's words, its physical cores at 1: where logical cores share "
              "physical ones, ours bends before.")
    return sheet


def draw_speed(sheet, axes, letter, record, reference_threads, unit):
    """unit: threads that count as 1 on the x axis."""
    for name, style in engine_styles(record.names("engine")).items():
        cases = record.where(engine=name)
        reference = record.measured(engine=name, threads=reference_threads)
        if not reference:
            sheet.say(f"{letter}: no line of {name}, which has no run with {reference_threads} "
                      "threads to relate to.")
            for case in cases:
                if case.failure:
                    fail(sheet, axes, case["threads"] / unit, case.failure, style)
            continue
        seconds = reference[0].median("search")
        line(sheet, axes, cases, lambda case: case["threads"] / unit,
             lambda case: seconds / case.seconds("search"), style, name)


# --- Fig. 2: time of each step by grid resolution, in the adaptive layout and a regular one ---------

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
    return [case.median("plan", "field"), case.median("engine"), np.median(compute),
            np.median(case.seconds("search") - compute)]


def draw_grid(record):
    sheet = Sheet(record, "Fig. 2: time of the grid engine's steps by grid resolution (hall)", 6.6, GRID)
    axes, place = panels(sheet, 3, 1, legend_lines=4)
    chosen = record.measured(vary="grid cell", value="chosen")
    most = record.names("chunk_points")
    chunks = "chunks read" + (f",\n{most[0]:,} points at most" if most else "")
    for panel, (vary, title, of_x, cells) in zip(axes[:, 0], (
            ("grid cell", "a  by grid cell, adaptive layout", "edge of a grid cell (m)", None),
            ("adaptive layout", "b  by points of a cell, adaptive layout", "points of a cell, at most",
             "cells read"),
            ("regular layout", "c  by edge of a cell, regular layout", "edge of a cell (m)", chunks))):
        draw_bars(sheet, panel, record.where(vary=vary), cells)
        panel.set(title=title, xlabel=of_x)
    entries = {name: Patch(**bar_look(colour, hatch)) for name, colour, hatch in STEPS}
    for handle, name in zip(*axes[1, 0].get_legend_handles_labels()):
        entries[f"{name} (overlaps)"] = handle
    entries |= {CELLS: one for panel in sheet.figure.axes for one in panel.lines
                if one.get_label() == CELLS}
    legend_in(place, entries, 2)
    if chosen:
        sheet.say(f"a: the heuristic chose {chosen[0].runs[0]['grid_cell']:g} m.")
    sheet.say("The bars stack what follows one another. In the search the stages overlap: it is "
              "split into the time in which at least one worker computed, and the rest, when data "
              "only moved; the markers are the time in which each other stage was busy, not added. "
              "Grid cells of a are hashed and their number is not reported; the line of b is "
              "the number of the store's cells that were read; c cuts the regular cells, which "
              "are of any number of points, to chunks and counts those.")
    return sheet


def size_of(case):
    """Where a case stands in the order of its panel."""
    if case["value"] != "chosen":
        return float(case["value"])
    return case.runs[0]["grid_cell"] + 1e-9 if case.runs else 1e9


def size_label(case):
    if case["value"] == "chosen":
        return f"{case.runs[0]['grid_cell']:g}\nchosen" if case.runs else "chosen"
    if case["vary"] != "adaptive layout":
        return case["value"]
    value = int(case["value"])
    return f"{value:,}" + ("\ndefault" if value == DEFAULT_CELL_POINTS else "")


def draw_bars(sheet, axes, cases, cells):
    cases = sorted(cases, key=size_of)
    axes.set_xticks(range(len(cases)), [size_label(case) for case in cases])
    axes.set_xlim(-0.6, len(cases) - 0.4)
    axes.set_ylabel("time (s)")
    axes.grid(False, axis="x")
    x = [at for at, case in enumerate(cases) if case.runs]
    run = [cases[at] for at in x]
    bottom = np.zeros(len(run))
    for (_, colour, hatch), seconds in zip(STEPS, np.array([steps_of(case) for case in run]).T):
        axes.bar(x, seconds, 0.62, bottom, **bar_look(colour, hatch))
        bottom += seconds
    whole = np.array([spread(case.seconds("plan", "field", "engine", "search")) for case in run]).T
    if run:
        axes.errorbar(x, whole[0], whole[1:], color="black", linestyle="none", elinewidth=0.8)
    for name, colour, marker in STAGES:
        axes.plot([at + 0.38 for at in x], [case.median(name) for case in run], color=colour,
                  marker=marker, linestyle="none", label=name, markersize=4, clip_on=False, zorder=5)
    for at, case in enumerate(cases):
        if case.failure:
            fail(sheet, axes, at, case.failure)
    axes.set_ylim(0, None)
    axes.margins(y=0.08)
    room_for_failures(axes)
    if cells and run:
        draw_cells(right_axes(axes), x, [case.runs[-1]["cells_read"] for case in run], cells)


def draw_cells(right, x, cells, name):
    right.plot(x, cells, markersize=4, label=CELLS, **look_of(Style(GREEN, "D", "--", "")))
    right.set_yscale("log")
    # Between powers of ten, so that at least two are named.
    right.set_ylim(10 ** np.floor(np.log10(min(cells))),
                   10 ** (np.floor(np.log10(max(cells))) + 1))
    right.yaxis.set_major_formatter(lambda value, _: short(value))
    right.set_ylabel(name)


# --- Fig. 3: time of every engine and device on the four scenes -------------------------------------

HEIGHT = 0.36  # of a bar


def draw_engines(record):
    sheet = Sheet(record, "Fig. 3: time of every engine on the four scenes", 4.6, ENGINES,
                  ("search", "total"))
    scenes, engines = record.names("scene"), record.names("engine")
    axes, place = panels(sheet, -(-len(scenes) // 2), 2, legend_lines=1, sharey=True)
    for panel in axes.flat[len(scenes):]:
        panel.set_axis_off()
    seconds = [case.median(name) for case in record.measured() for name in ("search", "total")]
    for letter, panel, scene in zip("abcd", axes.flat, scenes):
        draw_scene(sheet, panel, record.where(scene=scene), engines)
        panel.set_title(f"{letter}  {like(scene)}")
        if seconds:
            panel.set_xlim(min(seconds) / 2, max(seconds) * 2)
            seconds_axis(panel.xaxis)
    for panel in axes[-1]:
        panel.set_xlabel("time (s)")
    for panel in axes[:, 1]:
        panel.tick_params(labelleft=False)
    legend_in(place, {"search (full bar)": Patch(**bar_look("#888888")),
                      "total (hatched bar)": Patch(**bar_look("white", "////"))}, 2)
    sheet.say("The time axes are logarithmic, and the same in all panels.")
    return sheet


def draw_scene(sheet, axes, cases, engines):
    for case in cases:
        style = engine_styles(engines)[case["engine"]]
        y = engines.index(case["engine"])
        for offset, name, look in ((-HEIGHT / 2, "search", bar_look(style.colour)),
                                   (HEIGHT / 2, "total", bar_look("white", style.hatch))):
            if not case.runs:
                continue
            median, below, above = spread(case.seconds(name))
            axes.barh(y + offset, median, HEIGHT, **look)
            axes.errorbar(median, y + offset, xerr=[[below], [above]], color="black",
                          elinewidth=0.8, linestyle="none")
        if case.failure:
            place = axes.get_yaxis_transform()
            axes.plot([0.96], [y], marker="x", color=VERMILION, markersize=6, markeredgewidth=1.8,
                      transform=place, clip_on=False)
            axes.annotate(str(sheet.number_of_failure(case.failure)), (0.96, y), xycoords=place,
                          xytext=(4.5, 0), textcoords="offset points", va="center")
    rows_of_bars(axes, engines)


# --- Fig. 4: time by the number of environment points -----------------------------------------------

RESAMPLES = 4000  # of the bootstrap
FEWEST = 8        # samples that are fitted
EXPONENTS = np.arange(1, 201) / 100
LINE = 99  # the exponent 1


def medians(cases):
    """Points and median seconds of the search of each sample."""
    cases = [case for case in cases if case.runs]
    return (np.array([case["points"] for case in cases], float),
            np.array([case.median("search") for case in cases]))


class Power:
    """t = a + b n^p with a >= 0 and b >= 0, fitted to relative errors. p: of that fit; low, high: the
    middle 95 % of its values for samples drawn anew; residual, of_line: the root mean square of the
    relative residuals, and that of the best fit with p = 1."""

    def __init__(self, points, seconds):
        count = len(points)
        drawn = np.random.default_rng(1).multinomial(count, np.full(count, 1 / count), RESAMPLES)
        weights = np.vstack([np.ones(count), drawn])  # first, each sample once
        fits = [self.at(exponent, points, seconds, weights) for exponent in EXPONENTS]
        squares = np.array([left for *_, left in fits])
        best = squares.argmin(0)
        self.p = EXPONENTS[best[0]]
        self.low, self.high = np.percentile(EXPONENTS[best[1:]], [2.5, 97.5])
        self.a, self.b = (term[0] for term in fits[best[0]][:2])
        self.residual, self.of_line = np.sqrt([squares[best[0], 0], squares[LINE, 0]] / np.float64(count))

    @staticmethod
    def at(exponent, points, seconds, weights):
        """a, b and the sum of squares by the weights of the samples, for one p."""
        one, grown = 1 / seconds, points**exponent / seconds
        terms = np.stack([one * one, one * grown, grown * grown, one, grown], 1)
        ss, sg, gg, s, g = (weights @ terms).T
        b = np.maximum((ss * g - sg * s) / (ss * gg - sg * sg), 0)
        a = (s - b * sg) / ss
        b = np.where(a < 0, g / gg, b)
        a = np.maximum(a, 0)
        return a, b, weights.sum(1) - 2 * (a * s + b * g) + a * a * ss + 2 * a * b * sg + b * b * gg

    def __str__(self):
        return f"{self.p:.2f} ({self.low:.2f} to {self.high:.2f})"


def n_log_n(record):
    """A sentence: with which power n log n grows at the middle of the samples."""
    middle = np.median([case["points"] for case in record.cases])
    return f"n log n grows with a p of {1 + 1 / np.log(middle):.2f} at these n."


def points_markdown(record):
    """With which power of the number of points the time grows, as a Markdown table."""
    rows = []
    for name in record.names("engine"):
        points, seconds = medians(record.where(engine=name))
        if len(points) >= FEWEST:
            fit = Power(points, seconds)
            rows.append([name, str(len(points)), str(fit), f"{100 * fit.residual:.1f} %",
                         f"{100 * fit.of_line:.1f} %"])
    return markdown_table(["engine", "samples", "p (95 %)", "residual", "with p = 1"], rows,
                          "The search takes a + b n^p for n environment points: a fit to relative errors, and in "
                          f"brackets the middle 95 % of {RESAMPLES} bootstrap samples. {n_log_n(record)} "
                          "Residual: root mean square of the relative residuals.")


def draw_points(record):
    styles = {name: style._replace(line="none")
              for name, style in engine_styles(record.names("engine")).items()}
    rows = -(-(len(styles) + 1) // 2)
    sheet = Sheet(record, "Fig. 4: time by the number of environment points (samples of the hall)",
                  rows * 1.85 + 0.3, POINTS, ("answer", "search"))
    axes, place = panels(sheet, rows, 2, legend_lines=-(-len(styles) // 4))
    for panel in axes.flat[len(styles) + 1:]:
        panel.set_axis_off()
    together = axes.flat[0]
    for letter, panel, (name, style) in zip("bcdefgh", axes.flat[1:], styles.items()):
        cases = record.where(engine=name)
        line(sheet, together, cases, lambda case: case["points"],
             lambda case: case.answer_seconds(), style, name, markersize=3)
        line(sheet, panel, cases, lambda case: case["points"] / 1e6,
             lambda case: case.seconds("search"), style, name, markersize=3)
        draw_fit(panel, *medians(cases))
        panel.set(title=f"{letter}  {name}", xlim=(0, None), ylim=(0, None))
        room_for_failures(panel)
        panel.set(xlabel="environment points (million)", ylabel="search (s)")
    log_axis(together.xaxis)
    seconds_axis(together.yaxis)
    together.set(title="a  all, logarithmic", xlabel="environment points", ylabel="answer (s)")
    room_for_failures(together)
    sheet.say("Lines: the search takes a + b n^p for n points, a fit to relative errors; in brackets "
              f"the middle 95 % of {RESAMPLES} bootstrap samples. {n_log_n(record)}")
    legend_in(place, styles, 4)
    return sheet


def draw_fit(axes, points, seconds):
    """The curve through the medians of the search."""
    if len(points) < FEWEST:
        return
    fit = Power(points, seconds)
    n = np.linspace(0, points.max(), 100)
    axes.plot(n / 1e6, fit.a + fit.b * n**fit.p, color="black", linewidth=1, zorder=4)
    axes.text(0.97, 0.05, f"p = {fit}\nresidual {100 * fit.residual:.1f} %", transform=axes.transAxes,
              va="bottom", ha="right", zorder=6,
              bbox={"facecolor": "white", "alpha": 0.8, "edgecolor": "none", "pad": 1})
