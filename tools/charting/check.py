"""What the whole of `clearway check` takes, by the number of points and by step."""

import numpy as np

from charting.plot import handle_of, legend_in, line, log_axis, panels, seconds_axis, short
from charting.sheet import Sheet
from charting.style import styles_of

STEPS = ("convert", "path", "run", "conflicts", "stations", "report")


def draw(record):
    scenes, ways = record.names("scene"), record.names("way")
    sheet = Sheet(record, "What clearway check takes, from the scan to the report", 3.3, times=())
    axes, place = panels(sheet, 1, 2, legend_lines=1)
    whole, steps = axes.flat
    styles = styles_of(ways)
    for scene in scenes:
        for way in ways:
            cases = record.where(scene=scene, way=way)
            if cases:
                line(sheet, whole, cases, lambda case: case["points"],
                     lambda case: case.seconds("total"), styles[way], way, markersize=4)
    log_axis(whole.xaxis)
    seconds_axis(whole.yaxis)
    whole.set(title="a  the whole check", xlabel="environment points", ylabel="seconds")
    largest = [max(record.where(way=way), key=lambda case: case["points"]) for way in ways]
    draw_steps(steps, largest)
    steps.set_title("b  the steps of the largest scene of each")
    legend_in(place, [handle_of(style) for style in styles.values()], ways, 4)
    sheet.say(f"Scenes: {', '.join(scenes)}, as clearway scene makes them, with the radius of 0.1 m, "
              "clearances up to 0.3 m, and the profile up to 0.5 m that check asks for by itself. "
              "The scan is in the page cache, and nothing is made before. Markers: medians.")
    return sheet


def draw_steps(axes, cases):
    """A bar for each way, of the medians of its steps."""
    bottom = np.zeros(len(cases))
    for number, step in enumerate(STEPS):
        heights = np.array([np.median(case.seconds(step)) for case in cases])
        axes.bar(range(len(cases)), heights, bottom=bottom, label=step, width=0.6,
                 color=str(0.25 + 0.12 * number), edgecolor="black", linewidth=0.4,
                 hatch=("", "", "///", "...", "", "xxx")[number])
        bottom += heights
    axes.set_xticks(range(len(cases)),
                    [f"{case['way']},\n{short(case['points'])} points" for case in cases])
    axes.set(ylabel="seconds", ylim=(0, 1.4 * max(bottom.max(), 1e-3)))
    axes.legend(loc="upper right", ncols=2)
