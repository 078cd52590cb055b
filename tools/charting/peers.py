"""Wrong points against seconds on each scene, beside other libraries: the headline chart."""

import numpy as np
from matplotlib.ticker import FixedLocator, NullLocator

from charting.labels import place_labels
from charting.paper import TABLE
from charting.plot import panels, seconds_axis
from charting.sheet import Sheet
from charting.style import BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, Style, YELLOW, engine_style

PEERS = {"nanoflann": Style(SKY, "p", "none", ""), "cgal": Style(GREEN, "h", "none", ""),
         "pcl": Style(ORANGE, "<", "none", ""), "open3d": Style(PURPLE, ">", "none", ""),
         "octomap": Style(YELLOW, "*", "none", ""), "3dtk": Style(YELLOW, "8", "none", ""),
         "cubql": Style(BLUE, "H", "none", "")}
NAMES = {"nanoflann": "nanoflann", "cgal": "CGAL", "pcl": "PCL", "open3d": "Open3D",
         "octomap": "OctoMap", "3dtk": "3DTK (the paper's)", "cubql": "cuBQL, GPU"}
ROW = 0.4       # decades that a row of the band takes
SCENES = ("hall", "tunnel", "plant", "mine", "street")


class Mark:
    """A method on a scene: its name, seconds, and its wrong points as a share of those that
    collide."""

    def __init__(self, name, style, seconds, wrong, colliding, every=1):
        self.name, self.style, self.seconds = name, style, seconds
        self.share, self.every = wrong / max(colliding, 1), every

    def label(self):
        return self.name + (f" (1/{self.every})" if self.every > 1 else "")


def peer_name(case):
    cell = case.get("cell")
    return NAMES[case["peer"]] + (f" {100 * cell:g} cm" if cell else "")


def engine_name(case):
    """sweep cuda as sweep, GPU."""
    *words, device = case["engine"].split()
    return f"{' '.join(words)}, {'GPU' if device == 'cuda' else 'CPU'}"


def marks_of(scene, record, table):
    for case in table.where(scene=scene) if table else []:
        if case.runs:
            wrong = case.findings["only_here"] + case.findings["only_in_reference"]
            yield Mark("Clearway " + engine_name(case), engine_style(case["engine"]),
                       np.median(case.answer_seconds()), wrong,
                       case.findings["common"] + case.findings["only_in_reference"])
    for case in record.where(scene=scene):
        found = case.findings
        if "search_seconds" in found:
            yield Mark(peer_name(case), PEERS[case["peer"]], found["all_poses_seconds"],
                       found["false_hits"] + found["misses"], found["colliding_points"],
                       found["every_pose"])


def draw(record, table=None):
    """table: the engines of Clearway on the same scenes, where they were measured."""
    if table:  # it knows the GPU and the build
        record.machine, record.clearway = table.machine, table.clearway
    scenes = [scene for scene in SCENES
              if record.where(scene=scene) or (table and table.where(scene=scene))]
    alone = [scene for scene in scenes if not record.where(scene=scene)]
    marks = {scene: list(marks_of(scene, record, table)) for scene in scenes}
    rows = -(-len(scenes) // 2)
    columns = min(2, len(scenes))
    sheet = Sheet(record, "Wrong points against seconds: Clearway and other libraries", rows * 3.6,
                  times=())
    axes, _ = panels(sheet, rows, columns)
    for panel in axes.flat[len(scenes):]:
        panel.set_axis_off()
    every = [mark for scene in scenes for mark in marks[scene]]
    seconds = [mark.seconds for mark in every]
    wrong = [np.log10(mark.share) for mark in every if mark.share]
    bottom = np.floor(min(wrong, default=-6))
    top = max(np.ceil(max(wrong, default=-3) + 0.3), bottom + 2)
    band = (max(sum(not mark.share for mark in marks[scene]) for scene in scenes) + 0.6) * ROW
    for letter, panel, scene in zip("abcde", axes.flat, scenes):
        panel.set_xlim(min(seconds) / 2, max(seconds) * 8)
        panel.set_ylim(bottom - band, top)
        draw_scene(panel, marks[scene], bottom)
        like = f" (like {TABLE[scene][0]})" if scene in TABLE else ""
        panel.set_title(f"{letter}  {scene}{like}")
        seconds_axis(panel.xaxis)
        panel.set_xlabel("seconds for all poses")
    for panel in axes[:, 0]:
        panel.set_ylabel("wrong points / colliding points")
    sheet.figure.canvas.draw()
    for panel in axes.flat[:len(scenes)]:
        place_labels(panel, panel.__dict__["clearway_labels"])
    sheet.say("Left is faster, and the grey band holds methods without any wrong point; their heights "
              "in it mean nothing. Wrong: false hits and misses by id, as a share of the points "
              "that collide at the same poses. Hollow: only one in n poses was searched, (1/n), and the time is scaled. "
              f"Threads: {record.cases[0]['threads']}, or a GPU. Clearway's times are preparing the "
              "question and searching; those of others are their search alone, without building "
              "their tree. Both axes are logarithmic.")
    if alone:
        sheet.say(f"The others were not measured in: {', '.join(alone)}.")
    named = [(case, peer_name(case)) for case in record.cases]
    named += [(case, "Clearway " + engine_name(case)) for case in (table.cases if table else [])]
    for case, name in named:
        if case.failure:
            sheet.number_of_failure(f"{case['scene']}, {name}: {case.failure}")
    return sheet


def draw_scene(axes, marks, bottom):
    low, _ = axes.get_ylim()
    left, end = axes.get_xlim()
    axes.axhspan(low, bottom, color="#eeeeee", zorder=0)
    labels = axes.__dict__["clearway_labels"] = []
    right = sorted((mark for mark in marks if not mark.share), key=lambda mark: mark.seconds)
    for row, mark in enumerate(right):
        y = bottom - (row + 0.8) * ROW
        put(axes, mark, y)
        place = np.log(mark.seconds / left) / np.log(end / left)
        side = -1 if place > 0.5 else 1
        axes.annotate(mark.label(), (mark.seconds, y), (5 * side, 0), textcoords="offset points",
                      va="center", ha="right" if side < 0 else "left", zorder=6)
    for mark in marks:
        if mark.share:
            put(axes, mark, np.log10(mark.share))
            labels.append((mark.seconds, np.log10(mark.share), mark.label()))
    ticks = range(int(bottom), int(axes.get_ylim()[1]) + 1)
    axes.yaxis.set_major_locator(FixedLocator([low + (bottom - low) / 2, *ticks]))
    axes.yaxis.set_minor_locator(NullLocator())
    axes.set_yticklabels(["none", *(f"$10^{{{tick}}}$" if tick else "1" for tick in ticks)])


def put(axes, mark, y):
    hollow = mark.every > 1
    axes.plot([mark.seconds], [y], marker=mark.style.marker, linestyle="none", zorder=5,
              markersize=9 if mark.style.marker == "*" else 6, markeredgecolor=BLACK,
              markeredgewidth=0.9 if hollow else 0.5,
              markerfacecolor="white" if hollow else mark.style.colour)


def memory_of(found):
    on_gpu = found["peer"].get("gpu")
    if on_gpu:
        return f"{on_gpu['device_peak_bytes'] / 1e9:.1f} GB of the GPU"
    return f"{found['peak_bytes_of_peer'] / 1e9:.1f} GB"


def markdown(record):
    """The figures of the other libraries as a Markdown table."""
    head = ["scene", "library", "all poses", "one in", "preparation", "memory", "false hits",
            "misses", "colliding"]
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    for scene in [scene for scene in SCENES if record.where(scene=scene)]:
        for case in record.where(scene=scene):
            name = peer_name(case)
            if case.failure:
                lines.append(f"| {scene} | {name} | failed: {case.failure} |" + " |" * 6)
                continue
            found = case.findings
            lines.append("| " + " | ".join([
                scene, f"{name} {found['peer']['version']}".replace("OctoMap", "FCL, OctoMap")
                if case["peer"] != "octomap" else f"{name}, {found['peer']['version']}",
                f"{found['all_poses_seconds']:,.3g} s" if found["all_poses_seconds"] < 1000
                else f"{found['all_poses_seconds']:,.0f} s", f"{found['every_pose']:,}",
                f"{found['prepare_seconds']:.2g} s" if found["prepare_seconds"] < 10
                else f"{found['prepare_seconds']:.0f} s",
                memory_of(found), f"{found['false_hits']:,}",
                f"{found['misses']:,}", f"{found['colliding_points']:,}"]) + " |")
    lines += ["", "All poses: the median search, scaled where one in n poses was searched. Preparation "
              "and memory: of the library's tree or map, without the points on the host. False hits, "
              "misses and colliding points are of the poses that were searched."]
    return "\n".join(lines) + "\n"
