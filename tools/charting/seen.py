"""What it costs to know more than the set: time by question, and of seen space by what it grows
with."""

from charting.plot import (handle_of, legend_in, line, log_axis, panels, room_for_failures,
                           seconds_axis, spread)
from charting.sheet import Sheet
from charting.style import styles_of

PANELS = (("beams", "beams (points of the environment)"), ("cube", "side of a cube (m)"),
          ("path", "part of the path that is searched"), ("threads", "threads"))


def draw(record):
    sheet = Sheet(record, "What knowing costs: by question, beams, cubes, path and threads", 7.4,
                  times=("total",))
    axes, place = panels(sheet, 3, 2, legend_lines=1)
    scenes = record.names("scene")
    styles = styles_of(scenes)
    draw_questions(sheet, axes[0], record, styles)
    for letter, panel, (vary, label) in zip("bcde", axes[1:].flat, PANELS):
        for name in scenes:
            cases = record.where(vary=vary, scene=name)
            line(sheet, panel, cases, lambda case: float(case["value"]),
                 lambda case: case.seconds("swept", "beams"), styles[name], name)
            line(sheet, panel, [case for case in cases if case.runs],
                 lambda case: float(case["value"]), lambda case: case.seconds("swept"),
                 styles[name], name, alpha=0.4)
        panel.set(title=f"{letter}  seen space by {vary}", xlabel=label, ylabel="seen space (s)")
        log_axis(panel.xaxis)
        seconds_axis(panel.yaxis)
        room_for_failures(panel)
    legend_in(place, [handle_of(styles[name]) for name in scenes], scenes, len(scenes))
    sheet.say("a: the whole command, by what is asked. b to e: the part of seen space alone, in "
              "cubes of 0.2 m where their side is not varied; pale: the part of it that finds the "
              "swept cubes, so that the distance between the two lines is what the beams take. "
              + swept_text(record, scenes))
    return sheet


def draw_questions(sheet, row, record, styles):
    """One wide panel over a row of two: a group of bars a question."""
    grid = row[0].get_gridspec()
    axes = sheet.figure.add_subplot(grid[0, :])
    for unused in row:
        unused.remove()
    cases = record.where(vary="question")
    names = list(dict.fromkeys(case["value"] for case in cases))
    height = 0.8 / max(len(styles), 1)
    for i, (scene, style) in enumerate(styles.items()):
        for case in cases:
            if case["scene"] != scene or not case.runs:
                continue
            x, below, above = spread(case.seconds("total"))
            y = names.index(case["value"]) + (i - (len(styles) - 1) / 2) * height
            axes.barh(y, x, height * 0.9, color=style.colour, hatch=style.hatch,
                      edgecolor="black", linewidth=0.4, xerr=[[below], [above]])
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set(title="a  the whole command, by question", xlabel="total (s)")


def swept_text(record, scenes):
    """How many cubes and beams the whole path has."""
    parts = []
    for name in scenes:
        cases = [case for case in record.where(vary="question", value="seen, 0.2 m", scene=name)
                 if case.runs]
        if cases:
            run = cases[0].runs[-1]
            parts.append(f"{name}: {run['environment_points']:,} beams, "
                         f"{run['seen']['swept']:,} cubes swept, {run['seen']['unseen']:,} unseen")
    return "; ".join(parts) + "." if parts else ""
