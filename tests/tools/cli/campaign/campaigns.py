"""A small hall and campaigns in it, for the tests of `clearway campaign`."""

import json
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[2]))
from place import PROGRAM, Place, Scratch  # noqa: E402, F401
from report.browser import Browser, Page, find_chromium  # noqa: E402

LIMITS = {"memory": "300M", "threads": 1}
CAMPAIGN = {"name": "Test", "environments": {"hall": "site.h5"},
            "vehicles": {"all": {"model": "vehicles/*.ply"}}, "routes": {"all": {"trajectory": "routes/*.txt"}},
            "radii": [0.1], "query": {"first_pose": True}, "outputs": {"conflicts": ["csv"]}, "limits": LIMITS}


def make_scene(place, vehicles, routes, slow=()):
    """site.h5, vehicles/vNN.ply and routes/rNN.txt. slow: numbers of vehicles with a large model."""
    place.make_hall(30000, 300, 150, "--cell-points 1000")
    if slow:
        Place(place / "large").ask("scene hall --points 1000 --model-points 200000 --poses 10 -o .")
    for folder in ("vehicles", "routes"):
        (place / folder).mkdir()
    for i in range(vehicles):
        model = place / ("large/model.ply" if i in slow else "model.ply")
        (place / f"vehicles/v{i:02}.ply").write_bytes(model.read_bytes())
    lines = (place / "trajectory.txt").read_text().splitlines(keepends=True)
    for i in range(routes):
        place.put(f"routes/r{i:02}.txt", "".join(lines[i:]))


def put_campaign(place, changes, name="campaign.json", base=None):
    """changes: values by key, or by keys with dots between, which are put into the objects there."""
    campaign = json.loads(json.dumps(base or CAMPAIGN))
    for path, value in changes.items():
        *above, key = path.split(".")
        at = campaign
        for one in above:
            at = at.setdefault(one, {})
        at[key] = value
    place.put(name, campaign)


def status(place, name):
    return place.json(f"campaign status {name}")


def tasks_of(place, name):
    return [json.loads(line.rstrip(",")) for line in (place / name / "plan.json").read_text().splitlines()[1:-1]]


class Campaigns(Scratch):
    base, browser = CAMPAIGN, None

    def plan(self, name, changes=None, code=0, *said, more="", lacks=()):
        put_campaign(self.place, changes or {}, base=self.base)
        return self.place.ask(f"campaign plan campaign.json -o {name} {more}", code, *said, lacks=lacks)

    def refused(self, changes, *said):
        with self.subTest(changes):
            self.plan("refused", changes, 3, *said)
            self.assertFalse((self.place / "refused").exists(), "a refused plan was written")

    def run_tasks(self, name, words="--all", code=0, *said):
        return self.place.ask(f"campaign run {name} {words}", code, *said)

    def done(self, name, changes=None):
        """Plans a campaign and runs it."""
        self.plan(name, changes)
        self.run_tasks(name, "--all --jobs 2")

    def status(self, name):
        return status(self.place, name)

    def listed(self, name, which="missing"):
        return self.place.ask(f"campaign status {name} --{which}").stdout.strip()

    def report(self, name):
        return self.place.json(f"campaign report {name} --force")

    def shown(self, name):
        """The elements that a browser shows of the page; nothing where chromium is not installed."""
        if self.browser is None and find_chromium():
            type(self).browser = Browser(find_chromium())
            self.addClassCleanup(self.browser.close)
        if self.browser is None:
            return None
        page = Page(self.browser, self.place / name / "index.html")
        self.addCleanup(page.close)
        self.assertEqual(page.complaints(), [])
        return page.run("document.querySelector('main').innerHTML")

    def files(self, name, pattern):
        """When and as which file each was made."""
        return {file: (file.stat().st_ino, file.stat().st_mtime_ns) for file in (self.place / name).glob(pattern)}


def told(text):
    """The counts of "5 runs: 1 conflict, ..."."""
    found = re.search(r"(\d+) runs?: (.*)$", text, re.M)
    counts = {part.split(" ", 1)[1].replace(" ", "_"): int(part.split(" ", 1)[0]) for part in found[2].split(", ")}
    return int(found[1]), counts
