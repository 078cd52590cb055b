"""Small scenes, their pages, and what a browser shows of them. Where chromium is not installed, the
pages are made and not looked at."""

import json
import sys
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))
from browser import Browser, Page, find_chromium  # noqa: E402
from place import Place, Scratch  # noqa: E402

DATE = "2026-01-02 03:04 UTC"
CHROMIUM = find_chromium()
ROWS = "document.querySelectorAll('#conflicts-table tbody tr')"


class Scene(Place):
    """Store, model, trajectory and results in a folder of their own."""

    model, trajectory, store = "model.ply", "trajectory.txt", "site.h5"

    def vehicle(self):
        kind = "--vehicle" if self.model.endswith(".json") else "--model"
        return f"{kind} {self.model} --trajectory {self.trajectory}"

    def inputs(self):
        return f"--env {self.store} {self.vehicle()}"

    def search(self, name, options):
        self.ask(f"run {self.inputs()} --radius 0.1 {options} -o {name}.h5 --force")

    def report(self, name, options="", code=0, *said, result=None):
        """The facts of the page name.html of a result."""
        done = self.ask(f"report {result or name}.h5 {self.inputs()} -o {name}.html --force --json --date '{DATE}' "
                        f"{options}", code, *said)
        return json.loads(done.stdout) if code == 0 else None

    def conflicts(self, name, options=""):
        self.ask(f"conflicts {name}.h5 {self.vehicle()} -o listed.json --force {options}")
        return json.loads((self / "listed.json").read_text())


def hall(folder):
    scene = Scene(folder)
    scene.make_hall(30000, 2500, 400)
    return scene


class Pages(Scratch):
    browser = None

    @classmethod
    def setUpClass(cls):
        if CHROMIUM:
            cls.browser = Browser(CHROMIUM)
            cls.addClassCleanup(cls.browser.close)
        super().setUpClass()

    def open(self, path, **size):
        if self.browser is None:
            self.skipTest("chromium is not installed: the page is made, but not looked at")
        page = Page(self.browser, path, **size)
        self.addCleanup(page.close)
        self.addCleanup(lambda: self.assertEqual(page.complaints(), []))
        return page

    def shown(self, scene, name, facts, **size):
        """The open page of a run, which has its verdict, its numbers, its inputs and its facts."""
        page = self.open(scene / f"{name}.html", **size)
        warned = facts["verdict"] == "clear" and facts["warnings"]
        text = page.run("document.body.innerText")
        self.gives(page, {"document.body.dataset.ready": "true",
                          "byId('verdict-word').textContent.toLowerCase()":
                          "clear with warnings" if warned else facts["verdict"],
                          "JSON.parse(byId('facts').textContent)": facts})
        self.assertEqual({"false", "undefined", "null", "NaN"} & set(text.split()), set())
        for words in (f"{facts['colliding_points']:,}", *(facts["inputs"][kind]["hash"] for kind in
                                                          ("environment", "model", "trajectory"))):
            self.assertIn(words, text)
        return page

    def gives(self, page, values):
        """values: by expressions that are run in the page."""
        for expression, value in values.items():
            self.assertEqual(page.run(expression), value, expression)

    def says(self, page, words):
        """words: texts by the element that has them, or by an expression."""
        for where, parts in words.items():
            text = page.run(where if "(" in where or "." in where else f"byId('{where}').innerText")
            for part in [parts] if isinstance(parts, str) else parts:
                self.assertIn(part, text, where)

    def verdict_of(self, page, facts, part="verdict"):
        """What an open page says of a run, which may be another one of the same kind: opening a page
        takes a second, and most of it draws pictures."""
        return page.run(f"""(() => {{ const mine = page.facts, body = byId('verdict-body');
            const fill = (facts) => {{ page.facts = facts; body.replaceChildren(); buildVerdict(); }};
            fill({json.dumps(facts)});
            const text = byId('{part}').innerText;
            fill(mine);
            return text; }})()""")

    def column(self, page, title):
        """The cells of a column of the table of conflicts."""
        return page.run(f"conflictList().map((c) => tableColumns().find((one) => one.title === '{title}').cell(c))")

    def same_values(self, some, others, keys):
        self.assertEqual(*([[one[key] for key in keys.split()] for one in rows] for rows in (some, others)))

    def check_shaded(self, page, kind, stretches):
        """Stretches from one chainage to another are shaded where the chart has them."""
        shaded = page.run(f"""[...document.querySelectorAll('#profile-chart rect.{kind}')]
            .map((r) => [+r.getAttribute('x'), +r.getAttribute('x') + +r.getAttribute('width')])""")
        for drawn, stretch in zip(shaded, stretches, strict=True):
            for x, chainage in zip(drawn, stretch):
                self.assertAlmostEqual(x, page.run(f"profileX({chainage})"), 6)
