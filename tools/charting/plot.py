"""Lines with spread, failures and labels."""

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.ticker import FixedLocator, FuncFormatter, LogLocator, NullFormatter, NullLocator

from charting.style import VERMILION, Style


def spread(values):
    """Median, and how far the least and the greatest are from it."""
    median = np.median(values)
    return median, median - np.min(values), np.max(values) - median


def look_of(style):
    """What a line and its markers look like, as matplotlib names it."""
    return {"color": style.colour, "marker": style.marker, "linestyle": style.line,
            "markeredgecolor": "black", "markeredgewidth": 0.4}


def value_of(case):
    return float(case["value"])


def lines(sheet, axes, cases, styles, by, y_of, x_of=value_of, **how):
    """A line for each value of the parameter `by` that the cases have. styles: of these values."""
    for name in dict.fromkeys(case[by] for case in cases):
        line(sheet, axes, [case for case in cases if case[by] == name], x_of, y_of, styles[name],
             name, **how)


def line(sheet, axes, cases, x_of, y_of, style, label, **how):
    """A marker a case at the median of its runs, the least and the greatest as a bar, in the order
    of x. A case that failed is a cross at the top, numbered as its reason in the caption."""
    cases = sorted(cases, key=x_of)
    drawn = [(x_of(case), *spread(y_of(case))) for case in cases if len(y_of(case))]
    x, y, below, above = np.array(drawn).reshape(-1, 4).T
    axes.errorbar(x, y, [below, above], elinewidth=0.8, label=label, **{**look_of(style), **how})
    for case in cases:
        if case.failure:
            fail(sheet, axes, x_of(case), case.failure, style)


ROW_OF_FAILURES = 0.14  # of the height of a panel


def fail(sheet, axes, x, reason, style=None, before=""):
    """A cross at the top at x, over the marker of its style, below the number of its reason, a text
    before it; those at one x below each other."""
    crosses = axes.__dict__.setdefault("clearway_crosses", {})
    row = crosses[x] = crosses.get(x, -1) + 1
    place = axes.get_xaxis_transform()
    y = 0.93 - ROW_OF_FAILURES * row
    if style:
        axes.plot([x], [y], marker=style.marker, markersize=7, markerfacecolor="white",
                  markeredgecolor=style.colour, transform=place, clip_on=False, zorder=5)
    axes.plot([x], [y], marker="x", markersize=5.5, markeredgewidth=1.5,
              color="black" if style else VERMILION, transform=place, clip_on=False, zorder=6)
    axes.annotate(str(sheet.number_of_failure(reason)), (x, y), xycoords=place, xytext=(0, 3.5),
                  textcoords="offset points", va="bottom", ha="center", fontsize=6)
    axes.annotate(before, (x, y), xycoords=place, xytext=(-6, 0), textcoords="offset points",
                  va="center", ha="right")


def room_for_failures(axes):
    """Keeps the data below the crosses."""
    crosses = axes.__dict__.get("clearway_crosses", {})
    if not crosses:
        return
    share = 0.06 + ROW_OF_FAILURES * (max(crosses.values()) + 1)
    transform = axes.yaxis.get_transform()
    low, high = transform.transform(np.array(axes.get_ylim()))
    top = low + (high - low) / (1 - share)
    axes.set_ylim(*transform.inverted().transform(np.array([low, top])))


def with_unit(value, unit):
    """Two digits: 0.00095 s as 950 µs."""
    for factor, name in ((1, ""), (1e-3, "m"), (1e-6, "µ")):
        if abs(value) >= factor:
            return f"{float(f'{value / factor:.2g}'):g} {name}{unit}".replace("-", "−")
    return f"{value:.2g} {unit}"


def short(value):
    """30000 as 30k, 0.01 as it is."""
    for factor, name in ((1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k")):
        if abs(value) >= factor:
            return f"{value / factor:.3g}{name}"
    return f"{value:g}"


def setter(axis, what):
    """set_xlim or set_ylim, set_xscale or set_yscale."""
    return getattr(axis.axes, f"set_{axis.axis_name}{what}")


def fixed_ticks(axis, ticks, text):
    """Ticks at these values alone, labelled with what text(value) makes of them."""
    axis.set_major_locator(FixedLocator(ticks))
    axis.set_minor_locator(NullLocator())
    axis.set_major_formatter(FuncFormatter(lambda value, _: text(value)))


def log_axis(axis):
    """Log scale with plain numbers, and 2 and 5 where there are few decades. True where there is
    something to show, else no ticks."""
    limits = axis.get_data_interval()
    empty = not np.isfinite(limits).all() or limits.max() <= 0
    if empty:
        setter(axis, "lim")(0.1, 1)
    setter(axis, "scale")("log")
    if empty:
        fixed_ticks(axis, [], short)
    else:
        axis.set_major_formatter(FuncFormatter(lambda value, _: short(value)))
        if limits.max() < 100 * max(limits.min(), 1e-300):
            axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_minor_formatter(NullFormatter())
    return not empty


def seconds_axis(axis):
    """Log scale with ticks every decade, and 2 and 5 where there are few."""
    if not log_axis(axis):
        return
    low, high = axis.get_view_interval()
    decades = np.log10(high / low)
    if decades < 0.8:
        setter(axis, "lim")(low / 1.4, high * 1.4)
    subs = (1, 2, 5) if decades < 2 else (1, 3) if decades < 3 else (1,)
    axis.set_major_locator(LogLocator(subs=subs, numticks=20))


def axis_with_zero(axis, values, every=1):
    """Log scale from the least positive value on, with 0 a decade before it and ticks at the
    values (every n-th); plain log where 0 is not among them."""
    positive = sorted({value for value in values if value > 0})
    if not positive:
        return
    if 0 in values:
        setter(axis, "scale")("symlog", linthresh=positive[0], linscale=0.8)
        axis.set_view_interval(-0.3 * positive[0], positive[-1] * 2, ignore=True)
    else:
        setter(axis, "scale")("log")
    fixed_ticks(axis, ([0] if 0 in values else []) + positive[::every], power)


def power(value):
    """Plain where that is short, else 10 to the power; rounded to it."""
    if value == 0 or 0.01 <= abs(value) < 10_000:
        return f"{value:g}"
    exponent = int(np.floor(np.log10(abs(value)) + 1e-9))
    mantissa = value / 10.0**exponent
    if abs(mantissa - 1) < 1e-6:
        return f"$10^{{{exponent}}}$"
    return f"${mantissa:.2g}·10^{{{exponent}}}$"


def count_axis(axes, most, label):
    """Numbers of points with 0, linear up to 1, then log."""
    axes.set_yscale("symlog", linthresh=1, linscale=0.6)
    top = int(np.ceil(np.log10(max(most, 10))))
    axes.set_ylim(-0.35, 10.0**top * 2)
    fixed_ticks(axes.yaxis, [0] + [10.0**i for i in range(0, top + 1)], short)
    axes.set_ylabel(label)


def right_axes(axes):
    """Axes over these, with a scale of their own on the right."""
    right = axes.twinx()
    right.spines["right"].set_visible(True)
    right.grid(False)
    return right


def panels(sheet, rows, columns, legend_lines=0, **how):
    """Axes in rows and columns, and below them, where asked for, room for a legend of all."""
    heights = [1.0] * rows
    if legend_lines:
        room = legend_lines * 0.19 + 0.02
        heights = [(sheet.body_height - room) / rows] * rows + [room]
    grid = sheet.figure.add_gridspec(len(heights), columns, height_ratios=heights)
    share_y = how.pop("sharey", False)
    axes = np.empty((rows, columns), object)
    for row in range(rows):
        for column in range(columns):
            first = axes[row, 0] if share_y and column else None
            axes[row, column] = sheet.figure.add_subplot(grid[row, column], sharey=first)
    if not legend_lines:
        return axes, None
    place = sheet.figure.add_subplot(grid[rows, :])
    place.set_axis_off()
    return axes, place


def log_panels(sheet, axes, letters, parts, title, label, draw):
    """A panel with logarithmic axes for each of `parts`, (what is varied, its label), which
    draw(panel, what) fills."""
    for letter, panel, (vary, of_x) in zip(letters, axes, parts):
        draw(panel, vary)
        panel.set(title=f"{letter}  {title}by {vary}", xlabel=of_x, ylabel=label)
        log_axis(panel.xaxis)
        seconds_axis(panel.yaxis)
        room_for_failures(panel)


def wide_bars(sheet, row, names, styles, title, label, bars):
    """One wide panel over a row of two: a group of bars for each name, in each a bar a style, which
    bars(axes, style's name, name, y, height, how) draws."""
    axes = sheet.figure.add_subplot(row[0].get_gridspec()[0, :])
    for unused in row:
        unused.remove()
    height = 0.8 / max(len(styles), 1)
    for i, (of, style) in enumerate(styles.items()):
        for k, name in enumerate(names):
            bars(axes, of, name, k + (i - (len(styles) - 1) / 2) * height, height * 0.9,
                 bar_look(style.colour, style.hatch, 0.4))
    axes.set_yticks(range(len(names)), names)
    axes.invert_yaxis()
    axes.set(title=title, xlabel=label)
    return axes


def bar_look(colour, hatch="", linewidth=0.5):
    """What a bar looks like, as matplotlib names it."""
    return {"facecolor": colour, "hatch": hatch, "edgecolor": "black", "linewidth": linewidth}


def rows_of_bars(axes, names):
    """A row for each name, the first one at the top."""
    axes.set_yticks(range(len(names)), names)
    axes.set_ylim(len(names) - 0.4, -0.6)
    axes.grid(False, axis="y")


def legend_in(place, entries, columns):
    """entries: what each label stands beside, the style of a line or what matplotlib draws there."""
    handles = [Line2D([], [], **look_of(entry)) if isinstance(entry, Style) else entry
               for entry in entries.values()]
    legend = place.legend(handles, list(entries), loc="center", ncol=columns, frameon=False,
                          borderaxespad=0, columnspacing=1.4)
    legend.set_in_layout(False)
