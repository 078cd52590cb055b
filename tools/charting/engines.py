"""Fig. 3: time of every engine and device on the four scenes."""

import numpy as np
from matplotlib.patches import Patch

from charting import paper
from charting.paper import TABLE
from charting.plot import legend_in, panels, seconds_axis, spread
from charting.sheet import Sheet
from charting.style import VERMILION, engine_style

HEIGHT = 0.36  # of a bar


def draw(record):
    sheet = Sheet(record, "Fig. 3: time of every engine on the four scenes", 4.6, paper.ENGINES,
                  ("search", "total"))
    scenes, engines = record.names("scene"), record.names("engine")
    axes, place = panels(sheet, -(-len(scenes) // 2), 2, legend_lines=1, sharey=True)
    for panel in axes.flat[len(scenes):]:
        panel.set_axis_off()
    seconds = [np.median(case.seconds(name)) for case in record.cases if case.runs
               for name in ("search", "total")]
    for letter, panel, scene in zip("abcd", axes.flat, scenes):
        draw_scene(sheet, panel, record.where(scene=scene), engines)
        like = f" (like {TABLE[scene][0]})" if scene in TABLE else ""
        panel.set_title(f"{letter}  {scene}{like}")
        if seconds:
            panel.set_xlim(min(seconds) / 2, max(seconds) * 2)
            seconds_axis(panel.xaxis)
    for panel in axes[-1]:
        panel.set_xlabel("time (s)")
    for panel in axes[:, 1]:
        panel.tick_params(labelleft=False)
    legend_in(place, [Patch(facecolor="#888888", edgecolor="black", linewidth=0.5),
                      Patch(facecolor="white", hatch="////", edgecolor="black", linewidth=0.5)],
              ["search (full bar)", "total (hatched bar)"], 2)
    sheet.say("The time axes are logarithmic, and the same in all panels.")
    return sheet


def draw_scene(sheet, axes, cases, engines):
    for case in cases:
        style = engine_style(case["engine"])
        y = engines.index(case["engine"])
        for offset, name in ((-HEIGHT / 2, "search"), (HEIGHT / 2, "total")):
            if not case.runs:
                continue
            median, below, above = spread(case.seconds(name))
            axes.barh(y + offset, median, HEIGHT, edgecolor="black", linewidth=0.5,
                      color=style.colour if name == "search" else "white",
                      hatch="" if name == "search" else style.hatch)
            axes.errorbar(median, y + offset, xerr=[[below], [above]], color="black",
                          elinewidth=0.8, linestyle="none")
        if case.failure:
            number = sheet.number_of_failure(case.failure)
            axes.plot([0.96], [y], marker="x", color=VERMILION, markersize=6, markeredgewidth=1.8,
                      transform=axes.get_yaxis_transform(), clip_on=False)
            axes.annotate(str(number), (0.96, y), xycoords=axes.get_yaxis_transform(),
                          xytext=(4.5, 0), textcoords="offset points", va="center")
    axes.set_yticks(range(len(engines)), engines)
    axes.set_ylim(len(engines) - 0.4, -0.6)
    axes.grid(False, axis="y")
