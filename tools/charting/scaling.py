"""Time by the number of poses, of model points, the radius, and the points of a cell."""

from charting.plot import (engine_handles, legend_in, line, log_axis, panels, room_for_failures,
                           seconds_axis)
from charting.sheet import Sheet
from charting.style import engine_style

PANELS = (("poses", "poses T"), ("model points", "model points M"), ("radius", "radius (m)"),
          ("cell points", "points of a cell, at most"))


def draw(record):
    sheet = Sheet(record, "Time by poses, model points, radius and cell size (hall)", 5.2,
                  times=("answer",))
    engines = record.names("engine")
    axes, place = panels(sheet, 2, 2, legend_lines=1)
    for letter, panel, (vary, label) in zip("abcd", axes.flat, PANELS):
        cases = record.where(vary=vary)
        for name in engines:
            line(sheet, panel, [case for case in cases if case["engine"] == name],
                 lambda case: case["value"], lambda case: case.answer_seconds(),
                 engine_style(name), name)
        panel.set(title=f"{letter}  by {vary}", xlabel=label, ylabel="answer (s)")
        log_axis(panel.xaxis)
        seconds_axis(panel.yaxis)
        room_for_failures(panel)
    legend_in(place, engine_handles(engines), engines, len(engines))
    sheet.say("All axes are logarithmic.")
    return sheet
