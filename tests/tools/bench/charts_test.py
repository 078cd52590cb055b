"""tools/charts.py draws the records of docs/figures: every experiment becomes an SVG and a PNG, no text
is outside the page or over another, what failed is shown with its reason, and the same numbers stand in
the text beside the figure."""

import contextlib
import gzip
import io
import itertools
import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from unittest import mock

ROOT = Path(__file__).resolve().parents[3]
TOOLS, FIGURES = ROOT / "tools", ROOT / "docs" / "figures" / "evaluation"
sys.path.insert(0, str(TOOLS))


def texts_of(figure):
    """Every text that is seen, with its box."""
    from matplotlib.axes import Axes
    from matplotlib.axis import Axis
    from matplotlib.text import Text

    renderer = figure.canvas.get_renderer()
    of_axes = {text for axes in figure.findobj(Axes) for axis in axes.findobj(Axis)
               for text in axis.findobj(Text)}
    shown = [text for text in figure.findobj(Text) if text not in of_axes]
    for axes in figure.findobj(Axes):
        if axes.axison:
            shown += [text for axis in (axes.xaxis, axes.yaxis) for text in texts_of_axis(axis)]
    return [(text.get_text(), text.get_window_extent(renderer)) for text in shown
            if text.get_visible() and text.get_text().strip()]


def texts_of_axis(axis):
    """Its label, and the labels of ticks within its limits: others are kept, but not drawn."""
    low, high = sorted(axis.get_view_interval())
    slack = 1e-9 * max(abs(low), abs(high))
    ticks = [tick for tick in axis.get_major_ticks() + axis.get_minor_ticks()
             if low - slack <= tick.get_loc() <= high + slack]
    return [axis.label, axis.get_offset_text(), *(tick.label1 for tick in ticks),
            *(tick.label2 for tick in ticks)]


def faults_of(texts, page):
    """Texts outside the page and texts that overlap, but for numbers of failures that lie close."""
    faults = [f"outside the page: {text!r}" for text, box in texts
              if box.x0 < page.x0 or box.y0 < page.y0 or box.x1 > page.x1 or box.y1 > page.y1]
    for (one, a), (other, b) in itertools.combinations(texts, 2):
        width = min(a.x1, b.x1) - max(a.x0, b.x0)
        height = min(a.y1, b.y1) - max(a.y0, b.y0)
        if width > 1.5 and height > 2.5 and not one.isdigit():
            faults.append(f"overlap: {one!r}, {other!r}")
    return faults


def words_of(texts):
    """All of them, in a line."""
    return " ".join(" ".join(text for text, _ in texts).split())


def draw(*arguments):
    """tools/charts.py in this process: every process takes a second to start."""
    import charts

    with mock.patch.object(sys, "argv", ["charts.py", *map(str, arguments)]), \
            contextlib.redirect_stdout(io.StringIO()) as written:
        charts.main()
    return written.getvalue()


def save_as_laid_out(figure, path, metadata=None, dpi=None):
    """Figure.savefig() of a figure that has its layout. savefig() draws twice, to find it first."""
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    canvas, pixels = figure.canvas, figure.dpi
    if path.suffix == ".svg":
        FigureCanvasSVG(figure).print_svg(path, metadata=metadata)
    else:
        figure.set_dpi(dpi)
        canvas.print_png(path)
    figure.set_canvas(canvas)
    figure.set_dpi(pixels)


def drawn_sheets(*arguments):
    """What tools/charts.py draws, by experiment; looked at before it is written."""
    from charting.sheet import Sheet
    from matplotlib.figure import Figure

    sheets = {}
    save = Sheet.save

    def look_and_save(sheet, folder, name):
        figure = sheet.finish()
        figure.draw_without_rendering()
        texts = texts_of(figure)
        faults = faults_of(texts, figure.bbox)
        assert not faults, f"{name}:\n" + "\n".join(faults)
        sheets[name] = words_of(texts)
        figure.set_layout_engine("none")  # it has its layout: finding it takes half the time
        with mock.patch.object(Figure, "savefig", save_as_laid_out):
            return save(sheet, folder, name)

    with mock.patch.object(Sheet, "save", look_and_save):
        draw(*arguments)
    return sheets


def committed(folder):
    """A record of each experiment: that at full size where there is one, or else of the street."""
    for size in ("small", "street", "full"):
        for record in (FIGURES / size).glob("*.json.gz"):
            shutil.copy(record, folder)
            yield record.name.removesuffix(".json.gz"), record.parent


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        sizes = dict(committed(folder))
        sizes["engines"] = sizes["table"]
        (folder / "other.json").write_text("[1]")
        sheets = drawn_sheets(folder, "-o", folder / "charts")
        assert sheets.keys() == sizes.keys(), sheets.keys() ^ sizes.keys()
        for experiment, words in sheets.items():
            for kind, start in (("svg", b"<?xml"), ("png", b"\x89PNG")):
                assert (folder / "charts" / f"{experiment}.{kind}").read_bytes().startswith(start), experiment
            text = (folder / "charts" / f"{experiment}.md").read_text()
            assert text == (sizes[experiment] / f"{experiment}.md").read_text(), experiment
        for experiment in ("engines", "grid", "section", "stability"):
            file = folder / f"{'table' if experiment == 'engines' else experiment}.json.gz"
            failed = any("failed" in {*case, *case.get("findings", {})}
                         for case in json.loads(gzip.decompress(file.read_bytes()))["cases"])
            assert ("× failed: 1 " in sheets[experiment]) == failed, experiment
        cut = folder / "cut" / "threads.json.gz"
        cut.parent.mkdir()
        cut.write_bytes((folder / "threads.json.gz").read_bytes()[:-100])
        done = subprocess.run([TOOLS / "charts.py", cut.parent], capture_output=True, text=True)
        assert done.returncode == 1 and f"{cut}: is not JSON" in done.stderr, done.stderr


main()
