"""What it costs to know more than the set: time by question, and of seen space by what it grows
with."""

from charting.plot import handle_of, legend_in, line, log_panels, panels, spread, wide_bars
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
    cases = record.where(vary="question")

    def draw_bars(panel, scene, question, y, height, how):
        for case in cases:
            if case["scene"] == scene and case["value"] == question and case.runs:
                x, below, above = spread(case.seconds("total"))
                panel.barh(y, x, height, xerr=[[below], [above]], **how)

    wide_bars(sheet, axes[0], list(dict.fromkeys(case["value"] for case in cases)), styles,
              "a  the whole command, by question", "total (s)", draw_bars)

    def draw_lines(panel, vary):
        for name in scenes:
            cases = record.where(vary=vary, scene=name)
            line(sheet, panel, cases, lambda case: float(case["value"]),
                 lambda case: case.seconds("swept", "beams"), styles[name], name)
            line(sheet, panel, [case for case in cases if case.runs],
                 lambda case: float(case["value"]), lambda case: case.seconds("swept"),
                 styles[name], name, alpha=0.4)

    log_panels(sheet, axes[1:].flat, "bcde", PANELS, "seen space ", "seen space (s)", draw_lines)
    legend_in(place, [handle_of(styles[name]) for name in scenes], scenes, len(scenes))
    sheet.say("a: the whole command, by what is asked. b to e: the part of seen space alone, in "
              "cubes of 0.2 m where their side is not varied; pale: the part of it that finds the "
              "swept cubes, so that the distance between the two lines is what the beams take. "
              + swept_text(record, scenes))
    return sheet


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
