"""tools/charts.py draws files as `clearway-bench` writes them: every experiment becomes an SVG and
a PNG, no text is outside the page or over another, and what failed is shown with its reason."""

import contextlib
import gzip
import io
import itertools
import subprocess
import sys
import tempfile
from pathlib import Path
from unittest import mock

import numpy as np
from chart_records import EXPERIMENTS, accuracy, case, threads, write_records

TOOLS = Path(__file__).resolve().parents[3] / "tools"
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
    """Texts outside the page and texts that overlap."""
    faults = [f"outside the page: {text!r}" for text, box in texts
              if box.x0 < page.x0 or box.y0 < page.y0 or box.x1 > page.x1 or box.y1 > page.y1]
    for (one, a), (other, b) in itertools.combinations(texts, 2):
        width = min(a.x1, b.x1) - max(a.x0, b.x0)
        height = min(a.y1, b.y1) - max(a.y0, b.y0)
        if width > 1.5 and height > 2.5:
            faults.append(f"overlap: {one!r}, {other!r}")
    return faults


def words_of(texts):
    """All of them, in a line."""
    return " ".join(" ".join(text for text, _ in texts).split())


def shown_in(sheet):
    return words_of(texts_of(sheet.figure))


def record_of(cases, **more):
    from charting.record import Record

    return Record(Path("x.json"), {"experiment": "x", "machine": {"cores": 16}, "cases": cases,
                                   **more})


def check_bars_of_the_whole():
    """Medians of steps and of their sum differ; the bar is the sum's own spread."""
    from charting import grid as chart

    one = case({"vary": "regular layout", "value": "1"}, 1)
    for run, (plan, search) in zip(one["runs"], ((1, 9), (2, 2), (3, 5))):
        run["seconds"].update(plan=plan, field=0, engine=0, search=search, compute=search)
    bars = [bars for axes in chart.draw(record_of([one])).figure.axes for bars in axes.containers
            if getattr(bars, "has_yerr", False)]
    assert [list(middle.get_ydata()) for middle, *_ in bars] == [[8]]
    assert [list(bar.get_segments()[0][:, 1]) for *_, (bar,) in bars] == [[4, 10]]


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


def check_compressed_records(folder):
    """A compressed file is drawn like the plain one; one that was cut off is named."""
    plain = (folder / "threads.json").read_bytes()
    (folder / "compressed").mkdir()
    compressed = folder / "compressed" / "threads.json.gz"
    compressed.write_bytes(gzip.compress(plain))
    assert str(compressed.parent / "threads.png") in draw(compressed.parent)
    assert ((compressed.parent / "threads.png").read_bytes()
            == (folder / "charts" / "threads.png").read_bytes())
    compressed.write_bytes(compressed.read_bytes()[:-100])
    cut = subprocess.run([TOOLS / "charts.py", compressed.parent], capture_output=True, text=True)
    assert cut.returncode == 1 and f"{compressed}: is not JSON" in cut.stderr, cut.stderr


def check_missing_reference():
    """Nothing has failed where only the number of threads to relate to was not measured."""
    from charting import threads as chart

    sheet = chart.draw(record_of([one for one in threads() if one["parameters"]["threads"] != 16]))
    sheet.finish()
    assert "b: no line of sweep cpu, which has no run with 16 threads" in shown_in(sheet)
    assert "× failed" not in shown_in(sheet)


def check_stopped_runs():
    """They stand at the end of the time axis, with the limit; that of older files is not known."""
    from charting import accuracy as chart

    sheet = chart.draw(record_of(list(accuracy())))
    sheet.finish()
    for text in ("> 60 s", "> 64 s"):
        assert shown_in(sheet).count(text) == 2, text
    for axes in sheet.figure.axes:
        for x in axes.__dict__.get("clearway_crosses", {}):
            low, high = np.log(axes.get_xlim())
            assert 0.95 < (np.log(x) - low) / (high - low) <= 1, x


def check_bend():
    """Noise of two percent decides between linear and n log n."""
    from charting.points import answer_of, interval

    points = 500_000.0 * np.arange(1, 112)
    noise = 1 + 0.02 * np.random.default_rng(3).standard_normal(111)
    for power, answer in ((0, "linear"), (1, "n log n")):
        seconds = (0.001 + 1e-8 * points * np.log(points) ** power) * noise
        assert answer_of(*interval(points, seconds)) == answer, (power, interval(points, seconds))


def main():
    with tempfile.TemporaryDirectory() as name:
        folder = Path(sys.argv[1]) if len(sys.argv) > 1 else Path(name)
        write_records(folder)
        (folder / "other.json").write_text("[1]")
        sheets = drawn_sheets(folder, "-o", folder / "charts")
        assert set(sheets) == {experiment.__name__ for experiment in EXPERIMENTS} | {"engines"}
        for name, words in sheets.items():
            for kind, start in (("svg", b"<?xml"), ("png", b"\x89PNG")):
                assert (folder / "charts" / f"{name}.{kind}").read_bytes().startswith(start), name
            if name in ("grid", "engines", "stability", "scaling", "seen", "section"):
                assert "× failed: 1 " in words, name
            if name == "stability":
                assert "from 1 to 1.001 and determinant 1.001" in words
                assert "singular values within 1e-04 of 1" in words
        check_compressed_records(folder)
        check_bars_of_the_whole()
        check_missing_reference()
        check_stopped_runs()
        assert (folder / "charts" / "table.md").read_text().count("| mine | 806,183,400 |") == 1
        text = (folder / "charts/peers.md").read_text()
        assert "| mine | CGAL | failed: std::bad_alloc" in text
        assert "| 5.0 GB of the GPU |" in text
        assert "6,418 of 12,552 (51 %)" in (folder / "charts/share.md").read_text()
        assert "| stopped after 120 s |" in (folder / "charts/engines.md").read_text()
        assert "| sweep cpu | 111 |" in (folder / "charts/points.md").read_text()
        check_bend()


main()
