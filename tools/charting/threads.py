"""Fig. 1: speed by the number of threads."""

import numpy as np

from charting import paper
from charting.plot import fail, line, panels, room_for_failures
from charting.sheet import Sheet
from charting.style import BLACK, GREY, engine_style


def draw(record):
    sheet = Sheet(record, "Fig. 1: speed by the number of threads (hall)", 3.9,
                  paper.THREADS)
    cores = record.machine["cores"]
    axes, _ = panels(sheet, 2, 1)
    absolute, relative = axes[:, 0]
    most = max(case["threads"] for case in record.cases)
    absolute.plot([0, most], [0, most], color=GREY, linewidth=0.8, linestyle=":",
                  label="linear")
    draw_speed(sheet, absolute, "a", record, 1, lambda threads: threads)
    absolute.set(title="a  relative to 1 thread", xlabel="threads", ylabel="speed (1 thread = 1)")
    relative.plot([0, 1, most / cores], [0, 1, 1 + 0.173 * (min(most / cores, 2) - 1)],
                  color=BLACK, linewidth=0.8, linestyle=":", label="as the paper says")
    draw_speed(sheet, relative, "b", record, cores, lambda threads: threads / cores)
    relative.set(title=f"b  relative to all {cores} logical cores",
                 xlabel="threads / logical cores",
                 ylabel=f"speed ({cores} threads = 1)")
    for panel, all_cores, corner in ((absolute, cores, "upper left"),
                                     (relative, 1, "lower right")):
        panel.axvline(all_cores, color=GREY, linewidth=0.8, linestyle="--", zorder=0)
        panel.set_xlim(0, None)
        panel.set_ylim(0, None)
        room_for_failures(panel)
        panel.legend(loc=corner)
    sheet.say(f"Dashed, upright: the {cores} logical cores of this machine. The dotted line of b is "
              "drawn from the paper's words, its physical cores at 1: where logical cores share "
              "physical ones, ours bends before.")
    return sheet


def draw_speed(sheet, axes, letter, record, reference_threads, x_of):
    for name in record.names("engine"):
        cases = record.where(engine=name)
        reference = [case for case in cases if case["threads"] == reference_threads and case.runs]
        if not reference:
            sheet.say(f"{letter}: no line of {name}, which has no run with {reference_threads} "
                      "threads to relate to.")
            for case in cases:
                if case.failure:
                    fail(sheet, axes, x_of(case["threads"]), case.failure, engine_style(name))
            continue
        seconds = np.median(reference[0].seconds("search"))
        line(sheet, axes, cases, lambda case: x_of(case["threads"]),
             lambda case: seconds / case.seconds("search"), engine_style(name), name)
