"""Time by the number of poses, of model points, the radius, and the points of a cell."""

from charting.plot import engine_handles, legend_in, line, log_panels, panels
from charting.sheet import Sheet
from charting.style import engine_style

PANELS = (("poses", "poses T"), ("model points", "model points M"), ("radius", "radius (m)"),
          ("cell points", "points of a cell, at most"))


def draw(record):
    sheet = Sheet(record, "Time by poses, model points, radius and cell size (hall)", 5.2,
                  times=("answer",))
    engines = record.names("engine")
    axes, place = panels(sheet, 2, 2, legend_lines=1)

    def draw_lines(panel, vary):
        cases = record.where(vary=vary)
        for name in engines:
            line(sheet, panel, [case for case in cases if case["engine"] == name],
                 lambda case: case["value"], lambda case: case.answer_seconds(),
                 engine_style(name), name)

    log_panels(sheet, axes.flat, "abcd", PANELS, "", "answer (s)", draw_lines)
    legend_in(place, engine_handles(engines), engines, len(engines))
    sheet.say("All axes are logarithmic.")
    return sheet
