"""A page with a chart: title, axes, what the paper says beside them, caption and footer."""

import textwrap

import matplotlib.pyplot as plt
from matplotlib.font_manager import FontProperties

from charting.style import FONT_POINTS, GREY

WIDTH = 7.2  # inches: a text width in print
MARGIN = 0.1
PAPER_WIDTH = 1.75
LINE = FONT_POINTS * 1.25 / 72
DPI = 150
TIMES = {
    "search": "search: wall clock from the first page of the environment to the last",
    "answer": "answer: wall clock of preparing the question (thinning, plan, field, engine) and of "
              "searching, without reading model and poses, starting CUDA and writing the result",
    "total": "total: wall clock of the whole run, from its inputs to the result file",
}


class Sheet:
    """Axes are made on `figure`; the rest is put around them by finish()."""

    def __init__(self, record, title, body_height, paper="", times=("search",)):
        self.record = record
        self.title = title
        self.body_height = body_height
        self.paper = paper
        self.caption = []
        self.times = times
        self.figure = plt.figure(figsize=(WIDTH, body_height), dpi=DPI, layout="constrained")
        self._failures = {}
        self._finished = False

    def say(self, sentence):
        """Adds a sentence to the caption."""
        self.caption.append(sentence)

    def number_of_failure(self, reason):
        """The number that a reason has in the caption, which has room for the begin of it."""
        reason = textwrap.shorten(reason, 170, placeholder=" ...")
        return self._failures.setdefault(reason, len(self._failures) + 1)

    def finish(self):
        """Puts the texts around the axes."""
        if self._finished:
            return self.figure
        self._finished = True
        inner = WIDTH - 2 * MARGIN
        title = self._wrapped(self.title, inner, 10, "bold")
        failures = "; ".join(f"{number} {reason}" for reason, number in self._failures.items())
        below = self._wrapped(" ".join(self.caption + [f"× failed: {failures}."] * bool(failures)), inner)
        footer = self._wrapped(footer_of(self.record, self.times), inner)
        beside = self._wrapped("In the paper\n" + self.paper, PAPER_WIDTH) if self.paper else []
        top = len(title) * LINE * 1.3 + MARGIN + 0.05
        bottom = (len(below) + len(footer) + 0.8) * LINE + MARGIN
        body = max(self.body_height, len(beside) * LINE + 0.2)
        height = top + body + bottom
        self.figure.set_size_inches(WIDTH, height)
        self._put(MARGIN, height - MARGIN, height, title, fontsize=10, weight="bold")
        self._put(MARGIN, bottom - 0.02, height, below)
        self._put(MARGIN, len(footer) * LINE + MARGIN / 2, height, footer, color=GREY)
        width = WIDTH
        if beside:
            width = WIDTH - PAPER_WIDTH - 3 * MARGIN
            self._put(width + 1.5 * MARGIN, height - top - 0.05, height, beside[:1], weight="bold")
            self._put(width + 1.5 * MARGIN, height - top - 0.05 - LINE, height, beside[1:])
            self.figure.add_artist(plt.Line2D([(width + MARGIN / 2) / WIDTH] * 2,
                                              [(bottom + 0.05) / height, (height - top) / height],
                                              color=GREY, linewidth=0.6))
        self.figure.get_layout_engine().set(
            rect=(0, bottom / height, width / WIDTH, body / height), w_pad=0.06, h_pad=0.05,
            wspace=0.03, hspace=0.03)
        return self.figure

    def save(self, folder, name):
        """As SVG and PNG. Returns their paths."""
        figure = self.finish()
        paths = [folder / f"{name}.{kind}" for kind in ("svg", "png")]
        figure.savefig(paths[0], metadata={"Date": None})
        figure.savefig(paths[1], dpi=DPI)
        plt.close(figure)
        return paths

    def _put(self, left, top, height, lines, **how):
        self.figure.text(left / WIDTH, top / height, "\n".join(lines), va="top", ha="left",
                         parse_math=False, **{"linespacing": 1.2, **how})

    def _wrapped(self, text, width, size=FONT_POINTS, weight="normal"):
        """Lines that are at most `width` inches wide."""
        renderer = self.figure.canvas.get_renderer()
        font = FontProperties(size=size, weight=weight)

        def fits(line):
            return renderer.get_text_width_height_descent(line, font, False)[0] <= width * DPI

        lines = []
        for paragraph in text.split("\n"):
            line = ""
            for word in paragraph.split():
                longer = f"{line} {word}".strip()
                if line and not fits(longer):
                    lines.append(line)
                    longer = word
                line = longer
            lines.append(line)
        return lines if text else []


def footer_of(record, times):
    """Machine, versions and what is measured."""
    machine = record.machine
    parts = [machine.get("processor") or "unknown processor",
             f"{machine.get('cores', '?')} logical cores",
             f"{machine.get('memory_bytes', 0) / 2**30:.0f} GiB",
             ", ".join(machine.get("gpus") or []) or "no GPU used or present",
             machine.get("system", ""), f"size {record.size}",
             " ".join(["Clearway", *(record.clearway.get(name, "")
                                     for name in ("version", "commit", "build"))]).strip()]
    text = "; ".join(part for part in parts if part) + "."
    measured = ". ".join(TIMES[time] for time in times)
    if measured:
        measured += ". Median of the runs; bars: least and greatest."
    return f"{text} {measured}".replace("(R)", "").replace("(TM)", "").strip()
