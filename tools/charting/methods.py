"""Time against wrongly decided points: of exact and approximate methods, and of other libraries."""

from pathlib import Path

import numpy as np
from matplotlib.ticker import NullLocator

from charting.labels import place_labels
from charting.paper import like
from charting.plot import (fixed_ticks, legend_in, look_of, panels, power, rows_of_bars, seconds_axis,
                           spread, with_unit)
from charting.record import MEASURED, markdown_table
from charting.sheet import Sheet
from charting.style import (BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION, YELLOW, Style, engine_styles,
                            styles_of)

# --- Exact and approximate methods ------------------------------------------------------------------

# What a method's value is called beside a marker, its unit, and the method in the legend.
METHODS = {"model thinned": ("v", "m", "model thinned to a voxel v"),
           "every nth pose": ("n", "", "every n-th pose"),
           "environment quantised": ("q", "m", "environment rounded to q"),
           "tolerance": ("t", "m", "tolerance t (no longer in the program)"),
           "sampled": ("", "", "points on the surface, which is nowhere farther from one than written")}


def value_text(case):
    """The parameter of an approximate method: v 5 mm."""
    letter, unit, _ = METHODS.get(case["method"], (case["engine"], "", ""))
    value = case["value"]
    return f"{letter} {with_unit(float(value), unit) if unit else value}".strip()


def engine_text(case):
    """sweep cuda as sweep, GPU."""
    *words, device = case["engine"].split()
    return f"{' '.join(words)}, {'GPU' if device == 'cuda' else 'CPU'}"


def row_text(case):
    """What a row of methods that decide nothing wrongly is called; one far origin is as the other."""
    of = value_text(case) if case["method"] in METHODS else "surface" if case["method"] == "surface" else ""
    return f"{engine_text(case)}, {of}".removesuffix(", ")


def draw_surfaces(record):
    where = "hall" if "hall" in record.names("scene") else Path(record.parameters.get("env", "")).stem
    return draw_accuracy(record, f"A surface beside points on it ({where})", "answer")


def draw_accuracy(record, title="Speed against accuracy (hall)", time="search"):
    sheet = Sheet(record, title, 6.2, times=(time,))
    run, seconds = record.measured(), MEASURED[time]
    wrong = [case for case in run if case.wrong()]
    rows = {}  # of those that decide nothing wrongly, or did not end: the cases by name
    for case in sorted(record.cases, key=lambda case: np.median(seconds(case)) if case.runs else np.inf):
        if not case.wrong():
            rows.setdefault(row_text(case), []).append(case)
    styles = styles_of([name for name in METHODS if any(case["method"] == name for case in wrong)])
    of_engines = engine_styles(case["engine"] for case in record.cases)
    grid = sheet.figure.add_gridspec(3, 2, height_ratios=[0.3 + 0.2 * len(rows), 3.5, 0.4])
    right, place = (sheet.figure.add_subplot(grid[row, :]) for row in (0, 2))
    place.set_axis_off()
    for y, cases in enumerate(rows.values()):
        for case in cases:
            draw_right(sheet, right, case, y, of_engines[case["engine"]], seconds)
    rows_of_bars(right, list(rows))
    seconds_axis(right.xaxis)
    every = [value for case in run for value in seconds(case)]
    right.set(title="a  methods without wrong points", xlabel=f"{time} (s)")
    right.set_xlim(min([right.get_xlim()[0], *every]), max([right.get_xlim()[1], *every]))
    exact = min((case for case in run if not case.wrong() and case["method"] not in METHODS),
                key=lambda case: np.median(seconds(case)), default=None)
    panels = [sheet.figure.add_subplot(grid[1, column]) for column in (0, 1)]
    for panel, letter, label, y_of in zip(panels, "bc", (
            "wrong points", "largest |distance − radius| of wrong points (m)"), (
                lambda case: case.wrong(), lambda case: max(case.findings["largest_distance"], 1e-16))):
        for case in wrong:
            x, below, above = spread(seconds(case))
            look = look_of(styles.get(case["method"], of_engines[case["engine"]])._replace(line="none"))
            panel.errorbar(x, y_of(case), xerr=[[below], [above]], elinewidth=0.6, zorder=3, **look)
        what = "how many are wrong" if letter == "b" else "how far they are from the boundary"
        panel.set(title=f"{letter}  {what}", xlabel=f"{time} (s)", ylabel=label)
        panel.margins(0.22, 0.1)
        if exact:
            panel.axvline(np.median(seconds(exact)), color=BLACK, linewidth=1, linestyle=":")
        panel.set_yscale("log")
        panel.yaxis.set_minor_locator(NullLocator())
        if letter == "b":
            seconds_axis(panel.yaxis)
        else:
            panel.yaxis.set_major_formatter(lambda value, _: power(value))
        seconds_axis(panel.xaxis)
    sheet.figure.canvas.draw()
    for panel, y_of in zip(panels, (lambda case: case.wrong(), lambda case: case.findings["largest_distance"])):
        place_labels(panel, [(np.median(seconds(case)), y_of(case),
                              value_text(case) + " ↑" * bool(case.findings.get("beyond"))) for case in wrong])
    legend_in(place, {METHODS[name][2]: style._replace(line="none") for name, style in styles.items()}, 2)
    sheet.say("Wrong: false hits and misses against exact distances. a: methods that decide no point wrongly. "
              + "Hollow: at a far origin (UTM, 10,000 km); ×: stopped. "
              * any("far" in name for name in record.names("method"))
              + "b, c: methods that do, by "
              + " and ".join(dict.fromkeys(map(engine_text, wrong))) + "."
              + (f" Dotted: {row_text(exact)}, which is exact." if exact else "")
              + " ↑: some false hits are farther away than distances are known. All axes are logarithmic.")
    return sheet


def draw_right(sheet, axes, case, y, style, seconds):
    """A marker in a row, or a cross where the case was stopped."""
    if case.failure:
        sheet.number_of_failure(f"{case.key}: {case.failure}")
        if case.limit:
            axes.plot([case.limit], [y], "x", color=BLACK, markeredgewidth=1.5)
        return
    x, below, above = spread(seconds(case))
    far = {"markerfacecolor": "white", "zorder": 1} if "far origin" in case["method"] else {}
    axes.errorbar(x, y, xerr=[[below], [above]], elinewidth=0.8, **look_of(style._replace(line="none")) | far)


# --- Beside other libraries on each scene: the headline chart ---------------------------------------

# What each library is called, and its marker.
PEERS = {"nanoflann": ("nanoflann", Style(SKY, "p", "none", "")),
         "cgal": ("CGAL", Style(GREEN, "h", "none", "")), "pcl": ("PCL", Style(ORANGE, "<", "none", "")),
         "open3d": ("Open3D", Style(PURPLE, ">", "none", "")),
         "octomap": ("OctoMap", Style(YELLOW, "*", "none", "")),
         "3dtk": ("3DTK (the paper's)", Style(YELLOW, "8", "none", "")),
         "cugrid": ("3DTK's CuGrid, GPU", Style(VERMILION, "8", "none", "")),
         "cubql": ("cuBQL, GPU", Style(BLUE, "H", "none", ""))}
ROW = 0.4       # decades that a row of the band takes
SCENES = ("hall", "tunnel", "plant", "mine", "street")


class Mark:
    """A method on a scene: its label, seconds, and its wrong points as a share of those that
    collide. every: one pose of so many was searched."""

    def __init__(self, name, style, seconds, wrong, colliding, every=1):
        self.label = name + (f" (1/{every})" if every > 1 else "")
        self.style, self.seconds, self.every = style, seconds, every
        self.share = wrong / max(colliding, 1)


def peer_name(case):
    cell = case.get("cell")
    return PEERS[case["peer"]][0] + (f" {100 * cell:g} cm" if cell else "")


def marks_of(scene, record, table):
    for case in table.measured(scene=scene) if table else []:
        yield Mark(f"Clearway {engine_text(case)}", engine_styles([case["engine"]])[case["engine"]],
                   np.median(case.answer_seconds()), case.wrong(),
                   case.findings["common"] + case.findings["only_in_reference"])
    for case in record.where(scene=scene):
        found = case.findings
        if "search_seconds" in found:
            yield Mark(peer_name(case), PEERS[case["peer"]][1], found["all_poses_seconds"],
                       case.wrong(), found["colliding_points"], found["every_pose"])


def draw_peers(record, table=None):
    """table: the engines of Clearway on the same scenes, where they were measured."""
    of_libraries = record.machine["memory_bytes"] / 2**30
    if table:  # it knows the GPU and the build
        record.machine, record.clearway = table.machine, table.clearway
    marks = {scene: list(marks_of(scene, record, table)) for scene in SCENES
             if record.where(scene=scene) or (table and table.where(scene=scene))}
    rows, columns = -(-len(marks) // 2), min(2, len(marks))
    sheet = Sheet(record, "Wrong points against seconds: Clearway and other libraries", rows * 3.6,
                  times=())
    axes, _ = panels(sheet, rows, columns)
    for panel in axes.flat[len(marks):]:
        panel.set_axis_off()
    every = [mark for of_scene in marks.values() for mark in of_scene]
    seconds = [mark.seconds for mark in every]
    wrong = [np.log10(mark.share) for mark in every if mark.share]
    bottom = np.floor(min(wrong, default=-6))
    top = max(np.ceil(max(wrong, default=-3) + 0.3), bottom + 2)
    band = (max(sum(not mark.share for mark in of_scene) for of_scene in marks.values()) + 0.6) * ROW
    for letter, panel, scene in zip("abcde", axes.flat, marks):
        panel.set_xlim(min(seconds) / 2, max(seconds) * 8)
        panel.set_ylim(bottom - band, top)
        draw_scene(panel, marks[scene], bottom)
        panel.set_title(f"{letter}  {like(scene)}")
        seconds_axis(panel.xaxis)
        panel.set_xlabel("seconds for all poses")
    for panel in axes[:, 0]:
        panel.set_ylabel("wrong points / colliding points")
    sheet.figure.canvas.draw()
    for panel, of_scene in zip(axes.flat, marks.values()):
        place_labels(panel, [(mark.seconds, np.log10(mark.share), mark.label)
                             for mark in of_scene if mark.share])
    sheet.say("Left is faster, and the grey band holds methods without any wrong point; their heights "
              "in it mean nothing. Wrong: false hits and misses by id, as a share of the points "
              "that collide at the same poses. Hollow: only one in n poses was searched, (1/n), and the time is scaled. "
              f"Threads: {record.cases[0]['threads']}, or a GPU. Clearway's times are preparing the "
              "question and searching; those of others are their search alone, without building "
              "their tree. Both axes are logarithmic.")
    if round(of_libraries) != round(record.machine["memory_bytes"] / 2**30):
        sheet.say(f"Libraries other than CuGrid were measured on a host with {of_libraries:.0f} GiB.")
    alone = [scene for scene in marks if not record.where(scene=scene)]
    if alone:
        sheet.say(f"The others were not measured in: {', '.join(alone)}.")
    for cases, name_of in ((record.cases, peer_name), (table.cases if table else [], engine_text)):
        for case in cases:
            if case.failure:
                sheet.number_of_failure(f"{case['scene']}, {name_of(case)}: {case.failure}")
    return sheet


def draw_scene(axes, marks, bottom):
    low, top = axes.get_ylim()
    left, end = axes.get_xlim()
    axes.axhspan(low, bottom, color="#eeeeee", zorder=0)
    right = sorted((mark for mark in marks if not mark.share), key=lambda mark: mark.seconds)
    for row, mark in enumerate(right):
        y = bottom - (row + 0.8) * ROW
        put(axes, mark, y)
        place = np.log(mark.seconds / left) / np.log(end / left)
        side = -1 if place > 0.5 else 1
        axes.annotate(mark.label, (mark.seconds, y), (5 * side, 0), textcoords="offset points",
                      va="center", ha="right" if side < 0 else "left", zorder=6)
    for mark in marks:
        if mark.share:
            put(axes, mark, np.log10(mark.share))
    fixed_ticks(axes.yaxis, [low + (bottom - low) / 2, *range(int(bottom), int(top) + 1)],
                lambda value: "none" if value < bottom else power(10.0**value))


def put(axes, mark, y):
    hollow = mark.every > 1
    axes.plot([mark.seconds], [y], marker=mark.style.marker, linestyle="none", zorder=5,
              markersize=9 if mark.style.marker == "*" else 6, markeredgecolor=BLACK,
              markeredgewidth=0.9 if hollow else 0.5,
              markerfacecolor="white" if hollow else mark.style.colour)


def peer_cells(case):
    """The cells of a case in the table below."""
    found, name = case.findings, peer_name(case)
    if case.failure:
        return [name, f"failed: {case.failure} |" + 5 * " |"]  # and empty cells
    on_gpu, version = found["peer"].get("gpu"), found["peer"]["version"]
    all_poses, prepare = found["all_poses_seconds"], found["prepare_seconds"]
    return [f"{name}, {version}" if case["peer"] == "octomap" else
            f"{name} {version}".replace("OctoMap", "FCL, OctoMap"),
            f"{all_poses:,.3g} s" if all_poses < 1000 else f"{all_poses:,.0f} s",
            f"{found['every_pose']:,}", f"{prepare:.2g} s" if prepare < 10 else f"{prepare:.0f} s",
            f"{on_gpu['device_peak_bytes'] / 1e9:.1f} GB of the GPU" if on_gpu else
            f"{found['peak_bytes_of_peer'] / 1e9:.1f} GB",
            *(f"{found[count]:,}" for count in ("false_hits", "misses", "colliding_points"))]


def peers_markdown(record):
    """The figures of the other libraries as a Markdown table."""
    return markdown_table(
        ["scene", "library", "all poses", "one in", "preparation", "memory", "false hits", "misses",
         "colliding"],
        [[scene, *peer_cells(case)] for scene in SCENES for case in record.where(scene=scene)],
        "All poses: the median search, scaled where one in n poses was searched. Preparation "
        "and memory: of the library's tree or map, without the points on the host. False hits, "
        "misses and colliding points are of the poses that were searched.")
