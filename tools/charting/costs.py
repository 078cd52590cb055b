"""What it costs to know more, by what it grows with: the whole of `clearway check`, searches, seen
space, sections, and what a search touches."""

from itertools import product

import numpy as np

from charting.labels import place_labels
from charting.plot import (bar_look, legend_in, line, lines, log_axis, log_panels, panels,
                           room_for_failures, rows_of_bars, seconds_axis, short, spread, value_of,
                           wide_bars, with_unit)
from charting.record import markdown_table
from charting.sheet import Sheet
from charting.style import BLACK, BLUE, GREY, ORANGE, PURPLE, SKY, Style, styles_of

# --- The whole of clearway check, by the number of points and by step -------------------------------

STEPS = ("convert", "path", "run", "conflicts", "stations", "report")


def draw_check(record):
    scenes, ways = record.names("scene"), record.names("way")
    sheet = Sheet(record, "What clearway check takes, from the scan to the report", 3.3, times=())
    axes, place = panels(sheet, 1, 2, legend_lines=1)
    whole, steps = axes.flat
    styles = styles_of(ways)
    for scene in scenes:
        lines(sheet, whole, record.where(scene=scene), styles, "way",
              lambda case: case.seconds("total"), lambda case: case["points"], markersize=4)
    log_axis(whole.xaxis)
    seconds_axis(whole.yaxis)
    whole.set(title="a  the whole check", xlabel="environment points", ylabel="seconds")
    draw_steps(steps, [max(record.where(way=way), key=lambda case: case["points"]) for way in ways])
    steps.set_title("b  the steps of the largest scene of each")
    legend_in(place, styles, 4)
    sheet.say(f"Scenes: {', '.join(scenes)}, as clearway scene makes them, with the radius of 0.1 m, "
              "clearances up to 0.3 m, and the profile up to 0.5 m that check asks for by itself. "
              "The scan is in the page cache, and nothing is made before. Markers: medians.")
    return sheet


def draw_steps(axes, cases):
    """A bar for each way, of the medians of its steps."""
    bottom = np.zeros(len(cases))
    for number, step in enumerate(STEPS):
        heights = np.array([case.median(step) for case in cases])
        axes.bar(range(len(cases)), heights, bottom=bottom, label=step, width=0.6,
                 **bar_look(str(0.25 + 0.12 * number), ("", "", "///", "...", "", "xxx")[number], 0.4))
        bottom += heights
    axes.set_xticks(range(len(cases)),
                    [f"{case['way']},\n{short(case['points'])} points" for case in cases])
    axes.set(ylabel="seconds", ylim=(0, 1.4 * max(bottom.max(), 1e-3)))
    axes.legend(loc="upper right", ncols=2)


# --- Seen space, and what more is asked -------------------------------------------------------------


def draw_seen(record):
    sheet = Sheet(record, "What knowing costs: by question, beams, cubes, path and threads", 7.4,
                  times=("total",))
    axes, place = panels(sheet, 3, 2, legend_lines=1)
    styles = styles_of(record.names("scene"))
    questions = dict.fromkeys(case["value"] for case in record.where(vary="question"))

    def draw_bar(panel, scene, question, y, height, how):
        for case in record.measured(vary="question", scene=scene, value=question):
            x, below, above = spread(case.seconds("total"))
            panel.barh(y, x, height, xerr=[[below], [above]], **how)

    wide_bars(sheet, axes[0], list(questions), styles, "a  the whole command, by question",
              "total (s)", draw_bar)

    def draw_lines(panel, vary):
        for name, style in styles.items():
            cases = record.where(vary=vary, scene=name)
            line(sheet, panel, cases, value_of, lambda case: case.seconds("swept", "beams"), style, name)
            line(sheet, panel, [case for case in cases if case.runs], value_of,
                 lambda case: case.seconds("swept"), style, name, alpha=0.4)

    log_panels(sheet, axes[1:].flat, "bcde",
               (("beams", "beams (points of the environment)"), ("cube", "side of a cube (m)"),
                ("path", "part of the path that is searched"), ("threads", "threads")),
               "seen space ", "seen space (s)", draw_lines)
    legend_in(place, styles, len(styles))
    swept = []  # how many cubes and beams the whole path has
    for name in styles:
        for case in record.measured(vary="question", value="seen, 0.2 m", scene=name)[:1]:
            run = case.runs[-1]
            swept.append(f"{name}: {run['environment_points']:,} beams, "
                         f"{run['seen']['swept']:,} cubes swept, {run['seen']['unseen']:,} unseen")
    sheet.say("a: the whole command, by what is asked. b to e: the part of seen space alone, in "
              "cubes of 0.2 m where their side is not varied; pale: the part of it that finds the "
              "swept cubes, so that the distance between the two lines is what the beams take. "
              + ("; ".join(swept) + "." if swept else ""))
    return sheet


# --- A section, and what the same knowledge costs otherwise -----------------------------------------

METHODS = ("brute force", "200 runs", "section, 1 thread", "section, all threads", "section, GPU")


def draw_section(record):
    sheet = Sheet(record, "Sections: by method, bins, cells, length of the load and threads", 7.4,
                  times=("search",))
    axes, place = panels(sheet, 3, 2, legend_lines=1)
    styles = styles_of(record.names("scene"))
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
    seconds_axis(wide.xaxis)
    log_panels(sheet, axes[1:].flat, "bcde",
               (("bin", "length of a bin (m)"), ("cell", "side of a cell (m)"),
                ("length", "length of the load (m)"), ("threads", "threads")), "", "search (s)",
               lambda panel, vary: lines(sheet, panel, record.where(vary=vary), styles, "scene",
                                         lambda case: case.seconds("search")))
    legend_in(place, styles, len(styles))
    brute_force = ("Brute force is computed at some of the poses, on one thread, and scaled to all of "
                   "them; ") if "brute force" in methods else ""
    pairs = [f"{case['scene']}: {case.findings['pairs']:.3g} pairs of a point and a pose in reach"
             for case in record.where(vary="method", value="brute force")]
    sheet.say(f"a: the time of one answer for all outlines. {brute_force}200 runs are 20 times the whole "
              "commands of 10 widths, a closed box each. b to e: one section on the CPU, with "
              "bins of 5 m, cells of 0.02 m, a load of 4.5 m and all threads where these are not "
              "varied. " + ("; ".join(pairs) + "." if pairs else ""))
    return sheet


def seconds_of(record, scene, method):
    """The seconds of a method; None where it was not measured."""
    if method == "200 runs":
        cases = record.measured(vary="width", scene=scene)
        if not cases:
            return None
        mean = np.mean([np.median(case.values("wall_seconds")) for case in cases])
        return float(mean) * cases[0]["widths"]
    for case in record.where(vary="method", value=method, scene=scene):
        if case.runs:
            return float(case.median("search", "engine"))
        if "seconds" in case.findings:
            return case.findings["seconds"]
    return None


# --- What share of a scene a search touches, and what touching more would cost ----------------------

WAYS = {"as it is": "as it is", "all cells": "every cell read", "whole field": "whole field made",
        "poses one by one": "every pose by itself"}


def shares(record, scene):
    """Rows (what, touched, all)."""
    found = record.where(scene=scene, way="as it is")[0].findings
    pairs = found["points"] * found["poses"]
    rows = [("cells read", found["cells_read"], found["cells"]),
            ("bytes read", found["bytes_read"], found["bytes"]),
            ("points looked at one by one", found["points_tested"], found["points"]),
            ("bricks of the field made", found["bricks_made"], found["bricks"]),
            ("pairs of point and pose looked up", found["point_tests"], pairs),
            ("pairs searched in the model", found["exact_tests"], pairs)]
    for on_gpu in record.measured(scene=scene, way="GPU")[:1]:
        rows.append(("GPU memory, of the points as floats",
                     max(run["peak_device_bytes"] for run in on_gpu.runs), 12 * found["points"]))
    return rows


def seconds_by_way(record, scene):
    taken = {case["way"]: case.findings["seconds"] for case in record.where(scene=scene)
             if "seconds" in case.findings}
    return {way: taken[way] for way in WAYS if way in taken}


def draw_share(record):
    scenes = record.names("scene")
    sheet = Sheet(record, "What a search touches, and what touching more costs", 1.75 * len(scenes),
                  times=())
    axes, _ = panels(sheet, len(scenes), 2)
    for letter, scene, (touched, cost) in zip("abcd", scenes, axes):
        draw_shares(touched, shares(record, scene))
        draw_cost(cost, seconds_by_way(record, scene))
        touched.set_title(f"{letter}  {scene}")
    sheet.say("Left: what the search of the set touches on the CPU, in percent of all there is; "
              "beside the bars the numbers. Right: seconds of plan, field and search, "
              "median of the runs, when it is made to read and search every cell, to make the whole "
              "model field before, or to answer every pose as a question of its own, with the "
              "field kept (the mean of 64 poses, scaled).")
    return sheet


def draw_shares(axes, rows):
    limit = max(100, *(100 * touched / max(every, 1) for _, touched, every in rows))
    for y, (_, touched, every) in enumerate(rows):
        value = 100 * touched / max(every, 1)
        axes.barh(y, value, height=0.62, **bar_look(SKY, linewidth=0.4))
        inside = value > 0.6 * limit
        rarely = f", 1 in {short(float(f'{every / touched:.3g}'))}" if 0 < value < 1 else ""
        axes.annotate(f"{short(touched)} of {short(every)}{rarely}", (value, y), (-3 if inside else 3, 0),
                      textcoords="offset points", ha="right" if inside else "left", va="center")
    axes.set(xlim=(0, limit), xlabel="%")
    rows_of_bars(axes, [what for what, *_ in rows])


def draw_cost(axes, taken):
    for y, (way, seconds) in enumerate(taken.items()):
        look = bar_look(BLUE, "", 0.4) if way == "as it is" else bar_look(ORANGE, "////", 0.4)
        axes.barh(y, seconds, height=0.62, **look)
        axes.annotate(with_unit(seconds, "s"), (seconds, y), (3, 0), textcoords="offset points",
                      va="center")
    axes.set_xlim(min(taken.values()) / 3, max(taken.values()) * 6)
    seconds_axis(axes.xaxis)
    rows_of_bars(axes, [WAYS[way] for way in taken])
    axes.set_xlabel("seconds")


def share_markdown(record):
    """The same numbers as a Markdown table."""
    scenes = record.names("scene")
    rows = []
    for cells in zip(*(shares(record, scene) for scene in scenes)):
        rows.append([cells[0][0], *(
            f"{touched:,} of {every:,} ({percent(touched / every if every else 0)})"
            for _, touched, every in cells)])
    taken = [seconds_by_way(record, scene) for scene in scenes]
    rows += [[name, *(with_unit(of[way], "s") if way in of else "" for of in taken)]
             for way, name in WAYS.items()]
    return markdown_table(["", *scenes], rows)


def percent(share):
    return f"{float(f'{100 * share:.2g}'):.9g} %"


# --- What each step brings on the way from a k-d tree to the sweep ----------------------------------

ROWS = {"kdtree cpu": "k-d tree over the scan (kdtree)", "poses": "inverse: nanoflann over the model, by pose",
        "tree": "… poses together by the motion tree", "field": "… the model field in place of nanoflann",
        "sweep cpu": "… blocks of points together (sweep)", "voxels": "voxels of 2 cm in place of the field"}


def ablation_rows(record, scene):
    """Rows (method, seconds, what to say of it) in the order of ROWS; the factor is of the step before."""
    before = None
    for method in ROWS:
        for case in record.where(scene=scene, method=method):
            found = case.findings
            seconds = np.median(case.answer_seconds()) if case.runs else found.get("all_poses_seconds")
            if seconds is None:
                yield method, None, f"failed: {case.failure}"
                continue
            said = with_unit(seconds, "s")
            if method == "voxels":
                said += (f" after {with_unit(found['peer']['voxels_seconds'], 's')}; "
                         f"{case.wrong():,} of {found['colliding_points']:,} points wrong")
            elif before:
                factor = max(before / seconds, seconds / before)
                said += (f", {factor:,.{1 if factor < 10 else 0}f} times as "
                         + ("fast" if before > seconds else "slow"))
            said += f" (1/{found['every_pose']})" if found.get("every_pose", 1) > 1 else ""
            yield method, seconds, said
            before = seconds


def draw_ablation(record):
    scenes = record.names("scene")
    sheet = Sheet(record, "What each step brings, from a k-d tree to the sweep", 1.7 * len(scenes), times=())
    axes, _ = panels(sheet, len(scenes), 1)
    for letter, scene, panel in zip("abcd", scenes, axes[:, 0]):
        rows = list(ablation_rows(record, scene))
        taken = [seconds for _, seconds, _ in rows if seconds]
        for y, (method, seconds, said) in enumerate(rows):
            look = bar_look(BLUE, "", 0.4) if method.endswith("cpu") else bar_look(ORANGE, "////", 0.4)
            panel.barh(y, seconds or 0, height=0.62, **look)
            panel.annotate(said, (seconds or min(taken), y), (3, 0), textcoords="offset points",
                           va="center")
        panel.set_xlim(min(taken) / 2, max(taken) * 3 * (max(taken) / min(taken)) ** 0.7)
        seconds_axis(panel.xaxis)
        rows_of_bars(panel, [ROWS[method] for method, *_ in rows])
        panel.set(title=f"{letter}  {scene}", xlabel="seconds")
    sheet.say("Times of an answer, each beside that of the row above; all but the voxels find the same set, id "
              "by id. Blue: engines of Clearway, which read the scan from its store; hatched: with all points in "
              "memory. (1/n): only every n-th pose was searched, and the time is scaled. Voxels: after the time "
              "of making them; their distances are interpolated, and wrong points are false hits and misses.")
    return sheet


def ablation_markdown(record):
    """The same numbers as a Markdown table."""
    scenes = record.names("scene")
    said = [{method: text for method, _, text in ablation_rows(record, scene)} for scene in scenes]
    return markdown_table(["", *scenes], [[name, *(of.get(method, "") for of in said)]
                                          for method, name in ROWS.items()])


# --- Scans larger than memory -----------------------------------------------------------------------

QUESTIONS = {"conversion": Style(BLACK, "s", "-", ""), "check": Style(ORANGE, "o", "-", ""),
             "set": Style(BLUE, "^", "-", ""), "set, GPU": Style(PURPLE, "v", "-", "")}
STATES = {None: "-", "warm": "-", "cold": "--", "confined": ":"}
NUMBERS = {"seconds": ("wall_seconds", "{:.3g}".format), "processor seconds": ("cpu_seconds", "{:.3g}".format),
           "peak memory (bytes)": ("peak_resident_bytes", short), "read (bytes)": ("bytes_read", short),
           "from the disk (bytes)": ("disk_bytes", short), "temporary (bytes)": ("temporary_bytes", short),
           "store (bytes)": ("store_bytes", short), "colliding points": ("colliding_points", "{:,}".format)}


def number_of(case, name):
    """A number of a question's run or of a conversion, in an array; an empty one where there is none."""
    value = (case.runs[0] if case.runs else case.findings).get(name, ())
    return np.atleast_1d(sum(value.values()) if isinstance(value, dict) else value)


def draw_outofcore(record):
    sheet = Sheet(record, "Scans larger than memory (mine)", 6.2, times=())
    axes, _ = panels(sheet, 2, 2)
    labels = [draw_by_points(sheet, panel, record, *what) for panel, what in zip(axes.flat, (
        ("a  from the scan to answers", "wall_seconds", (None, "warm")),
        ("b  the store not in the page cache", "wall_seconds", ("cold", "confined")),
        ("c  peak memory", "peak_resident_bytes", (None, "warm", "confined")),
        ("d  bytes read", "bytes_read", ("warm",))))]
    sheet.figure.canvas.draw()
    for panel, of_panel in zip(axes.flat, labels):
        place_labels(panel, of_panel)
    memory = {f"{case.findings['memory_bytes'] >> 20}M" for case in made_of(record)}
    sheet.say(f"Every process has --memory {''.join(memory)} and all cores. Conversion: from a pipe, while another "
              "process makes the scan. Check: with the first poses, clearances and profile that clearway check "
              "asks for. a: the store is in the page cache. b: it is dropped before (cold), and then also read in "
              "a memory cgroup of 1.5 times --memory, where the cache finds no room (confined). c: resident "
              "memory, of which pages of the store are a part that the system may take back; dotted: confined; "
              "less than 60 MB is not measured. d: what the program takes from the store, some of it more than "
              "once.")
    for case in record.where(state="confined"):
        if "skipped" in case.findings:
            sheet.say(f"Confined: {case.findings['skipped']}.")
    return sheet


def made_of(record):
    """The conversions that made a store."""
    return [case for case in record.where(question="conversion") if not case.failure]


def draw_by_points(sheet, panel, record, title, name, states):
    """A line for each question and state, and returns their labels, (x, y, text); beside bytes also
    the sizes of the store, of the scan and of --memory."""
    of_bytes, labels = name != "wall_seconds", []
    scale, made = 1e9 if of_bytes else 1, made_of(record)
    for (question, style), state in product(QUESTIONS.items(), states):
        cases = record.where(question=question, state=state)
        line(sheet, panel, cases, lambda case: case["points"], lambda case: number_of(case, name) / scale,
             style._replace(line=STATES[state]), question)
        ends = [(case["points"], y / scale) for case in cases for y in number_of(case, name)]
        if ends and not (of_bytes and state == "confined"):
            labels.append((*ends[-1], question if state in (None, "warm") else f"{question}, {state}"))
    for label, size in (("store", lambda case: case.findings["store_bytes"]),
                        ("scan in doubles", lambda case: 24 * case["points"]),
                        ("memory allowed", lambda case: case.findings["memory_bytes"])) if of_bytes and made else ():
        ends = [(case["points"], size(case) / scale) for case in made]
        panel.plot(*zip(*ends), color=GREY, linewidth=0.8, linestyle="-.")
        labels.append((*ends[0], label))
    panel.set(title=title, xlabel="points of the scan", ylabel="GB" if of_bytes else "seconds")
    panel.margins(0.1, 0.12)
    log_axis(panel.xaxis)
    least, most = panel.get_xlim()
    panel.set_xlim(least, most * (most / least) ** 0.4)  # room for labels
    seconds_axis(panel.yaxis)
    room_for_failures(panel)
    return labels


def outofcore_markdown(record):
    """The same numbers as a Markdown table."""
    rows = [[f"{case['points']:,}", case["question"], case.get("state") or "", *(
        "".join(map(text, number_of(case, name))) for name, text in NUMBERS.values()), case.failure or ""]
            for case in record.cases if case.get("points")]
    return markdown_table(["points", "question", "state", *NUMBERS, "failed"], rows)
