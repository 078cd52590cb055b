"""Labels of markers that overlap neither each other nor a marker."""

from itertools import product

from matplotlib.patheffects import withStroke
from matplotlib.transforms import Bbox

DIRECTIONS = ((1, 0), (0, 1), (0, -1), (-1, 0), (1, 1), (1, -1), (-1, 1), (-1, -1))
DISTANCES = (5, 10, 16, 24, 34, 46, 60, 76, 94)  # points
ALIGNMENT = {-1: ("right", "top"), 0: ("center", "center"), 1: ("left", "bottom")}


def place_labels(axes, labels):
    """labels: (x, y, text). Takes the nearest free place, with a thin line where it is not beside
    the marker. The figure has been drawn, so that the axes lie where they will."""
    figure = axes.figure
    renderer = figure.canvas.get_renderer()
    scale = figure.dpi / 72
    marks = [axes.transData.transform((x, y)) for x, y, _ in labels]
    taken = [Bbox.from_bounds(x - 3.5 * scale, y - 3.5 * scale, 7 * scale, 7 * scale)
             for x, y in marks]
    inside = axes.get_window_extent(renderer)
    for (x, y, text), mark in zip(labels, marks):
        note = axes.annotate(text, (x, y), (0, 0), textcoords="offset points", zorder=6,
                             path_effects=[withStroke(linewidth=2, foreground="white")])
        taken.append(free_place(note, mark, taken, inside, renderer))


def free_place(note, mark, taken, inside, renderer):
    """Moves the note to where it overlaps least, and returns its box."""
    best = None
    for distance, (right, up) in product(DISTANCES, DIRECTIONS):
        put(note, right, up, distance)
        box = note.get_window_extent(renderer)
        cost = sum(overlap(box, other) for other in taken)
        cost += 5 * (box.width * box.height - overlap(box, inside))
        if best is None or cost < best[0] - 1e-6:
            best = (cost, right, up, distance)
        if best[0] < 1e-6:
            break
    _, right, up, distance = best
    put(note, right, up, distance)
    box = note.get_window_extent(renderer)
    if distance > DISTANCES[0]:
        corner = (min(max(mark[0], box.x0), box.x1), min(max(mark[1], box.y0), box.y1))
        end = note.axes.transData.inverted().transform(corner)
        note.axes.plot([note.xy[0], end[0]], [note.xy[1], end[1]], color="#888888", linewidth=0.5,
                       zorder=2)
    return box


def put(note, right, up, distance):
    note.set_position((right * distance, up * distance))
    note.set_horizontalalignment(ALIGNMENT[right][0])
    note.set_verticalalignment(ALIGNMENT[up][1])


def overlap(a, b):
    common = Bbox.intersection(a, b)
    return common.width * common.height if common else 0.0
