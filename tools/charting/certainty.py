"""How often a verdict is sure and wrong, and how often a cube inside a thing is called seen."""

from charting.plot import legend_in, look_of, panels, power
from charting.sheet import Sheet
from charting.style import BLACK, BLUE, ORANGE, SKY, VERMILION, Style, styles_of

ERRORS = {"position": "-", "all": ":"}
GROUPS = {"1": Style(BLUE, "o", "-", ""), "10": Style(ORANGE, "s", "--", ""),
          "100": Style(VERMILION, "^", ":", "")}
SIDES = {0.1: Style(VERMILION, "o", "-", ""), 0.2: Style(BLUE, "s", "--", ""),
         0.4: Style(SKY, "^", ":", "")}


def draw(record):
    sheet = Sheet(record, "How often Clearway is sure and wrong", 6.6, times=())
    axes, place = panels(sheet, 2, 2, legend_lines=2)
    shapes = styles_of(record.names("shape"))
    clear, conflict, places, seen = axes.flat
    draw_places(clear, record, shapes, "clear")
    clear.set_title("a  called clear at the margin")
    draw_places(conflict, record, shapes, "conflict")
    conflict.set_title("b  called a conflict at the margin")
    draw_groups(places, record)
    places.set_title("c  any of n places is called clear")
    draw_seen(seen, record)
    seen.set_title("d  cubes inside things called seen")
    legend_in(place, shapes, 3)
    sheet.say("a and b: a place whose true distance is the margin of 0 (pale) or 0.1 m, by --sigmas. "
              "Lines: Monte Carlo; dotted with errors of scan and angle too. Crosses: what Clearway "
              "says of such places; nothing is drawn where none was found. c: of n independent "
              "walls, with errors of position alone. d: of the cubes at the surface of things, by "
              "the standard deviation of a range in sides of the cube.")
    return sheet


def draw_percents(axes, cases, x_of, count_of, style, **how):
    """A line of shares in percent, without those of nothing. count_of: (how many, of how many)."""
    drawn = [(x_of(case), 100 * count / of) for case in cases for count, of in [count_of(case)] if count]
    if drawn:
        axes.plot(*zip(*drawn), **look_of(style), **how)


def percent_axis(axes, label):
    axes.set_yscale("log")
    axes.yaxis.set_major_formatter(lambda value, _: power(value))
    axes.set_ylabel(label)


def sigmas_of(case):
    return case["sigmas"]


def draw_places(axes, record, shapes, name):
    for case in record.where(vary="program"):
        count, all_places = case.findings[name], case.findings["places"]
        if count:
            axes.plot(case["sigmas"], 100 * count / all_places, "x", color=BLACK, markersize=5,
                      zorder=4)
    for shape, style in shapes.items():
        for errors, line in ERRORS.items():
            for margin in record.names("margin"):
                draw_percents(axes, record.where(vary="place", shape=shape, errors=errors, margin=margin),
                              sigmas_of, lambda case: (case.findings[name], case.findings["trials"]),
                              style._replace(line=line), alpha=0.45 if margin == 0 else 1)
    axes.set(xlabel="--sigmas", xticks=[2, 3, 4])
    percent_axis(axes, "places (%)")


def draw_groups(axes, record):
    cases = record.where(vary="place", shape="wall and plane", errors="position", margin=0.1)
    for n, style in GROUPS.items():
        draw_percents(axes, cases, sigmas_of, lambda case: (
            case.findings["groups"][n], case.findings["trials"] / int(n)), style, label=f"n = {n}")
    axes.set(xlabel="--sigmas", xticks=[2, 3, 4])
    percent_axis(axes, "groups (%)")
    axes.legend(loc="lower left")


def draw_seen(axes, record):
    for side, style in SIDES.items():
        draw_percents(axes, record.where(vary="noise", noise="normal", side=side),
                      lambda case: case["size"] / side,
                      lambda case: (case.findings["skin_seen"], case.findings["skin"]), style,
                      label=f"cubes of {side} m")
    axes.axvline(1 / 12, color=BLACK, linewidth=0.8, linestyle=":")
    axes.set(xlabel="standard deviation / side (line: 1 / 12)")
    percent_axis(axes, "cubes at a surface (%)")
    if axes.get_legend_handles_labels()[0]:
        axes.legend(loc="lower right")
