"""Time against wrongly decided points: of exact and approximate methods, and of other libraries."""

import numpy as np

from charting.labels import place_labels
from charting.paper import like
from charting.plot import (count_axis, fail, fixed_ticks, legend_in, look_of, panels, power,
                           room_for_failures, seconds_axis, short, spread)
from charting.record import markdown_table
from charting.sheet import Sheet
from charting.style import (BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, YELLOW, Style, engine_styles,
                            styles_of)

# --- Exact and approximate methods ------------------------------------------------------------------

# What a method's value is called beside a marker and in the legend.
METHODS = {"model thinned": ("v", "model thinned to a voxel v (m)"),
           "every nth pose": ("n", "every n-th pose"),
           "environment quantised": ("q", "environment quantised to q (m)")}
# Of surfaces: how it is called in the legend.
SHAPES = {"surface": "the surface itself",
          "sampled": "points on it: no place of the surface is farther from one than written"}


def label_of(case):
    if case["method"] in METHODS:
        name = f"{METHODS[case['method']][0]} {power(float(case['value']))}"
    elif case["method"] in SHAPES:
        name = case["value"] or "surface"
    else:
        name = f"{case['engine']} {case['value']}".strip()
    return name + (" ↑" if case.findings.get("beyond") else "")


def draw_surfaces(record):
    where = "hall" if "hall" in record.names("scene") else record.parameters.get("env", "")
    return draw_accuracy(record, f"A surface beside points on it ({where})")


def draw_accuracy(record, title="Speed against accuracy (hall)"):
    sheet = Sheet(record, title, 8.3, times=("answer",))
    axes, place = panels(sheet, 2, 1, legend_lines=3)
    styles = styles_of(record.names("method"))
    number, distance = axes[:, 0]
    run = record.measured()
    labels = {number: draw_markers(number, run, styles, lambda case: case.wrong())}
    count_axis(number, max([case.wrong() for case in run], default=1), "wrongly decided points")
    number.set_title("a  how many points are decided wrongly")
    draw_millionths(number, run)

    distances = [case.findings["largest_distance"] for case in run if case.wrong()]
    none = 10.0 ** (np.floor(np.log10(min([d for d in distances if d > 0], default=1e-3))) - 2)
    labels[distance] = draw_markers(
        distance, run, styles, lambda case:
        max(case.findings["largest_distance"], none * 10) if case.wrong() else none)
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
    draw_front(number, run, lambda case: case.wrong(), 0)
    draw_front(distance, run, lambda case: case.findings["largest_distance"], none)
    sheet.figure.canvas.draw()
    for panel in (number, distance):
        place_labels(panel, labels[panel])
    legend_in(place, {SHAPES.get(name) or METHODS.get(name, ("", name))[1]: style._replace(line="none")
                      for name, style in styles.items()}, 3)
    sheet.say("Wrong: false hits and misses against exact distances. Engine and parameter are "
              "written beside the markers. Grey steps: the front, no other is both faster and more "
              "accurate. ↑: some false hits are farther away than distances are known. Time "
              "axes are logarithmic; what was stopped stands at their end.")
    return sheet


def draw_markers(axes, run, styles, y_of):
    """Returns the labels of the markers, for place_labels()."""
    labels = []
    for case in run:
        if not case.findings:
            continue
        x, below, above = spread(case.answer_seconds())
        look = look_of(styles[case["method"]]._replace(line=None))
        axes.errorbar(x, y_of(case), xerr=[[below], [above]], elinewidth=0.8, zorder=3, **look)
        labels.append((x, y_of(case), label_of(case)))
    return labels


def draw_millionths(axes, run):
    """A second scale: of a million environment points."""
    millions = (run[0].runs[0]["environment_points"] if run else 1) / 1e6
    right = axes.secondary_yaxis(1.0, functions=(lambda n: n / millions, lambda share: share * millions))
    right.set_yscale("symlog", linthresh=1 / millions, linscale=0.6)
    low, high = axes.get_ylim()
    fixed_ticks(right.yaxis, [0] + [10.0**i for i in range(-3, 7) if low < 10.0**i * millions < high
                                    and 10.0**i * millions >= 1], short)
    right.set_ylabel("of a million environment points")
    right.spines["right"].set_visible(True)


def distance_axis(axes, none, most):
    axes.set_yscale("log")
    axes.set_ylim(none / 5, most * 10)
    low, high = np.log10(none) + 1, int(np.floor(np.log10(most * 10)))
    step = 1 if high - low < 9 else 2
    fixed_ticks(axes.yaxis, [none] + [10.0**i for i in range(high, int(low), -step)],
                lambda value: "none" if value < none * 3 else power(value))
    axes.set_ylabel("largest |distance − radius|\nof wrong points (m)")


def draw_front(axes, run, y_of, floor):
    """Steps through those that no other beats in both."""
    points = sorted((np.median(case.answer_seconds()), y_of(case) if case.wrong() else floor)
                    for case in run)
    front = []
    for x, y in points:
        if not front or y < front[-1][1]:
            front.append((x, y))
    if not front:
        return
    x, y = np.array(front).T
    limits = axes.axis()
    axes.plot([x[0], *x, limits[1]], [limits[3], *np.maximum(y, floor), max(y[-1], floor)],
              color="#999999", drawstyle="steps-post", linewidth=1, zorder=1)
    axes.axis(limits)


# --- Beside other libraries on each scene: the headline chart ---------------------------------------

# What each library is called, and its marker.
PEERS = {"nanoflann": ("nanoflann", Style(SKY, "p", "none", "")),
         "cgal": ("CGAL", Style(GREEN, "h", "none", "")), "pcl": ("PCL", Style(ORANGE, "<", "none", "")),
         "open3d": ("Open3D", Style(PURPLE, ">", "none", "")),
         "octomap": ("OctoMap", Style(YELLOW, "*", "none", "")),
         "3dtk": ("3DTK (the paper's)", Style(YELLOW, "8", "none", "")),
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


def engine_name(case):
    """sweep cuda as Clearway sweep, GPU."""
    *words, device = case["engine"].split()
    return f"Clearway {' '.join(words)}, {'GPU' if device == 'cuda' else 'CPU'}"


def marks_of(scene, record, table):
    for case in table.measured(scene=scene) if table else []:
        yield Mark(engine_name(case), engine_styles([case["engine"]])[case["engine"]],
                   np.median(case.answer_seconds()), case.wrong(),
                   case.findings["common"] + case.findings["only_in_reference"])
    for case in record.where(scene=scene):
        found = case.findings
        if "search_seconds" in found:
            yield Mark(peer_name(case), PEERS[case["peer"]][1], found["all_poses_seconds"],
                       case.wrong(), found["colliding_points"], found["every_pose"])


def draw_peers(record, table=None):
    """table: the engines of Clearway on the same scenes, where they were measured."""
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
    alone = [scene for scene in marks if not record.where(scene=scene)]
    if alone:
        sheet.say(f"The others were not measured in: {', '.join(alone)}.")
    for cases, name_of in ((record.cases, peer_name), (table.cases if table else [], engine_name)):
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
                lambda value: "none" if value < bottom else f"$10^{{{value:.0f}}}$" if value else "1")


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
