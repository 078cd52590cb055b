"""Colours, markers and hatches: every engine keeps its own in all charts."""

from collections import namedtuple

import matplotlib

matplotlib.use("Agg")

FONT_POINTS = 8
GREY = "#555555"

# Okabe and Ito's palette: distinguishable with every kind of colour vision.
BLACK, ORANGE, SKY, GREEN = "#000000", "#e69f00", "#56b4e9", "#009e73"
YELLOW, BLUE, VERMILION, PURPLE = "#f0e442", "#0072b2", "#d55e00", "#cc79a7"

Style = namedtuple("Style", "colour marker line hatch")

ENGINES = {
    "kdtree cpu": Style(BLUE, "o", "-", "////"),
    "sweep cpu": Style(ORANGE, "s", "--", "...."),
    "grid cpu": Style(GREEN, "^", "-.", "\\\\\\\\"),
    "grid cuda": Style(VERMILION, "D", (0, (5, 1, 1, 1, 1, 1)), "xxxx"),
    "sweep cuda": Style(PURPLE, "v", (0, (1, 1)), "++++"),
    "grid float cpu": Style(BLACK, "X", (0, (3, 1)), "||||"),
    "grid float cuda": Style(BLACK, "P", (0, (3, 1)), "||||"),
}
OTHERS = [Style(BLUE, "o", "-", "////"), Style(VERMILION, "s", "--", "...."),
          Style(GREEN, "^", "-.", "\\\\\\\\"), Style(ORANGE, "D", (0, (1, 1)), "xxxx"),
          Style(PURPLE, "v", (0, (5, 1, 1, 1)), "++++"), Style(SKY, "P", (0, (3, 1)), "||||"),
          Style(BLACK, "X", "-", "----"), Style(YELLOW, "*", "--", "oo")]


def engine_styles(names):
    return {name: ENGINES.get(name, OTHERS[-1]) for name in names}


def styles_of(names):
    """A style for each name that is not an engine's."""
    return {name: OTHERS[i % len(OTHERS)] for i, name in enumerate(names)}


matplotlib.rcParams.update({
    "font.size": FONT_POINTS, "axes.titlesize": FONT_POINTS, "axes.labelsize": FONT_POINTS,
    "xtick.labelsize": FONT_POINTS, "ytick.labelsize": FONT_POINTS,
    "legend.fontsize": FONT_POINTS, "legend.framealpha": 0.9, "legend.handlelength": 2.6,
    "axes.titlelocation": "left", "axes.titleweight": "bold",
    "axes.spines.top": False, "axes.spines.right": False,
    "axes.grid": True, "grid.color": "#dddddd", "grid.linewidth": 0.5, "axes.axisbelow": True,
    "lines.linewidth": 1.2, "lines.markersize": 4.5, "hatch.linewidth": 0.5,
    "errorbar.capsize": 2, "svg.hashsalt": "clearway",
})
