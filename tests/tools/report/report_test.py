#!/usr/bin/python3
"""Reports of small scenes: bytes, refusals, and what a browser shows of them.

Usage: report_test.py PROGRAM. Standard library only. CLEARWAY_TEST_DATA adds the street.
"""

import base64
import csv
import json
import math
import os
import shutil
import unittest

from pages import ROWS, Pages, Scene, hall

BLANK = """(id) => { const from = document.querySelector(id);
  const copy = new OffscreenCanvas(from.width, from.height), c = copy.getContext("2d");
  c.drawImage(from, 0, 0);
  const pixels = new Uint32Array(c.getImageData(0, 0, from.width, from.height).data.buffer);
  return new Set(pixels).size; }"""


def make_empty(scene):
    """A box that is carried one metre above a floor."""
    scene.model, scene.trajectory = "model.xyz", "path.txt"
    scene.put("floor.xyz", "".join(f"{x / 10} {y / 10} 0\n" for x in range(200) for y in range(-20, 21)))
    scene.put("model.xyz", "".join(f"{x} {y} {z}\n" for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (0, 1)))
    scene.put_path("path.txt", [(5 + i / 10, 0, 1 + abs(i - 30) / 100) for i in range(100)])
    scene.ask("convert floor.xyz -o site.h5")
    return scene


def make_lane(scene):
    """A box of 2 x 1 x 1 m that meets a wall on its left, one on its right, and a gate of 0.8 m."""
    scene.model, scene.trajectory = "box:2,1,1", "path.txt"
    scene.put_path("path.txt", [(0.5 * i,) for i in range(41)])
    scene.put("scan.xyz", "".join(f"{x + 0.1 * i:.1f} {y} {0.1 + 0.2 * k:.1f}\n"
                                  for x, y in ((3, 0.4), (8, -0.3), (14, 0.4), (14, -0.4))
                                  for i in range(11) for k in range(5)))
    scene.ask("convert scan.xyz -o site.h5")
    return scene


def make_epoch(scene, name, panels, poses):
    """A box of 2 x 1 x 1 m in a lane with walls, where panels of 1 m stand: (chainage, left) of each."""
    scene.model, scene.store, scene.trajectory = "box:2,1,1", f"{name}.h5", f"{name}.txt"
    scene.put_path(f"{name}.txt", [(0.05 * i,) for i in range(poses)])
    points = [(x + 0.1 * i, y, 0.1 + 0.1 * k) for x, y in panels for i in range(11) for k in range(9)]
    points += [(-2 + 0.25 * i, y, 0.25 * k) for i in range(105) for y in (-1.1, 1.1) for k in range(5)]
    points += [(-2 + 0.25 * i, -1 + 0.25 * k, -0.5) for i in range(105) for k in range(9)]
    scene.put(f"{name}.xyz", "".join("%g %g %g\n" % point for point in points))
    scene.ask(f"convert {name}.xyz -o {name}.h5")
    return scene


def make_road(scene):
    """A car that drives towards a wall, which a scanner saw but for a wedge behind a board."""
    scene.model, scene.trajectory = "model.xyz", "path.txt"
    scene.put("model.xyz", "".join(f"{x} {-0.5 + 0.1 * i:.1f} {-0.3 + 0.1 * j:.1f}\n" for x in
                                   (-0.6, -0.3, 0, 0.3, 0.6) for i in range(11) for j in range(7)))
    scene.put_path("path.txt", [(8 + 0.1 * i,) for i in range(71)])
    points = [(0.25 if 0 <= y / 4 < 0.3 else 1, y, 0.05 * j + 0.011)
              for y in (0.05 * i + 0.013 for i in range(-60, 61)) for j in range(-40, 41)]
    scene.put("scan.xyz", "".join(f"{20 * part} {y * part:.5f} {z * part:.5f}\n" for part, y, z in points))
    scene.put("origins.csv", "first,x,y,z\n0,0,0,0\n")
    scene.ask("convert scan.xyz --origins origins.csv -o site.h5")
    return scene


class Reports(Pages):
    @classmethod
    def make(cls):
        cls.hall = hall(cls.place / "hall")
        cls.hall.search("out", "--first-pose --clearance 0.3 --profile 0.5")
        cls.empty = make_empty(Scene(cls.place / "empty"))
        cls.road = make_road(Scene(cls.place / "road"))

    def other_hall(self, **changes):
        other = Scene(self.hall.folder)
        for name, value in changes.items():
            setattr(other, name, value)
        return other

    def test_bytes_depend_on_nothing_but_the_inputs_and_facts_are_those_of_other_commands(self):
        facts = self.hall.report("one", "--threads 1", result="out")
        self.hall.report("two", "--threads 3 --memory 1G", result="out")
        self.assertEqual(*self.hall.bytes("one.html", "two.html"))
        self.assertEqual(facts["colliding_points"], self.hall.json("info out.h5")["colliding_points"])
        listed = self.hall.conflicts("out")["conflicts"]
        self.assertEqual([len(listed), len(listed) > 3], [facts["conflicts"]["count"], True])
        self.same_values(listed[:len(facts["conflicts"]["list"])], facts["conflicts"]["list"],
                         "id points source first_pose last_pose chainage_from chainage_to least_distance nearest_pose "
                         "side lateral height")

    def test_what_is_not_of_the_run_is_refused(self):
        lines = (self.hall / "trajectory.txt").read_text().splitlines(keepends=True)
        self.hall.put("shorter.txt", "".join(lines[:-1]))
        for change, option in (({"trajectory": "shorter.txt"}, "--trajectory"),
                               ({"model": str(self.empty / "model.xyz")}, "--model"),
                               ({"store": str(self.empty / "site.h5")}, "--env")):
            self.other_hall(**change).report("bad", "", 3, option, result="out")
        for options, word in (("--classes 0.1,0.4", "--clearance"), ("--every 0.001", "too long for a page"),
                              ("--ledger no.csv", "--update makes it")):
            self.hall.report("bad", options, 2, word, result="out")
        self.assertFalse((self.hall / "bad.html").exists())

    def test_what_to_check_on_site(self):
        """A lorry that drives east, then a quarter of a circle of 12 m to the left; its front is behind."""
        lorry = self.other_hall(trajectory="bend.txt --trajectory-format pose-xyzw", model="box:8,2.5,3.4")
        places = [(x / 4, 0, 0) for x in range(161)]
        places += [(40 + 12 * math.sin(a), 12 - 12 * math.cos(a), a) for a in (math.pi / 160 * k for k in range(1, 81))]
        places += [(52, 12 + y / 4, math.pi / 2) for y in range(1, 81)]
        shown = None
        for name, turn in (("ahead", 0), ("backwards", math.pi)):
            lorry.put("bend.txt", "".join(
                f"{1000 + x} {500 + y} 7 0 0 {math.sin((a + turn) / 2):.12f} {math.cos((a + turn) / 2):.12f}\n"
                for x, y, a in places))
            lorry.search("bend", "--first-pose")
            facts = lorry.report("bend", "--chainage-start 100")
            site = facts["on_site"]
            first, last = site["first"], site["last"]
            self.assertEqual([site["bodies"][0]["hi"], first["position"], last["position"]],
                             [[4, 1.25, 3.4], [1000, 500, 7], [1052, 532, 7]])
            for found, expected in ((first["bearing"], 90), (last["bearing"], 0), (site["bend"]["radius"], 12),
                                    (first["front_bearing"], 270 if turn else 90),
                                    (last["chainage"], 160 + 6 * math.pi), (site["bend"]["chainage"], 150)):
                self.assertAlmostEqual(found, expected, delta=10 if expected == 150 else 0.01)
            shown = shown or self.open(lorry / "bend.html")
            words = self.verdict_of(shown, facts, "on-site")
            self.assertEqual("its front points the other way" in words, name == "backwards")
            for part in ("8.00 × 2.50 × 3.40 m", "1000.00, 500.00, 7.00", "towards 90° at the beginning",
                         "0° at the end", "left is towards 0°", "radius of about 12.00 m"):
                self.assertIn(part, words)
        self.empty.search("straight", "")
        self.assertIsNone(self.empty.report("straight")["on_site"]["bend"])

    def test_a_hall(self):
        odd = '<b>"Nord" & \\</script>'
        names = dict(zip(("title", "project", "client", "author"), (odd, odd + "1", odd + "2", odd + "3")))
        options = " ".join(f"--{key} '{value}'" for key, value in names.items())
        facts = self.hall.report("hall", f"--classes 0.05,0.1,0.3 {options}", result="out")
        self.assertEqual({key: facts[key] for key in names}, names)
        self.assertEqual([facts["verdict"], [c["name"] for c in facts["classes"]], "seen" in facts],
                         ["conflict", ["hit", "near", "watch"], False])
        page = self.shown(self.hall, "hall", facts)
        conflicts = facts["conflicts"]
        # Without --seen, the page has nothing of seen space; without --section, no section.
        self.gives(page, {"document.title": odd, "document.querySelector('h1').textContent": odd,
                          "byId('about').textContent": f"Project: {odd}1Client: {odd}2Author: {odd}3",
                          "[byId('unseen'), byId('basis'), byId('scanned'), byId('section')]": [None] * 4,
                          "document.body.innerText.includes('Not scanned')": False,
                          "page.conflict.id": conflicts["worst"]})
        page.run("document.documentElement.style.scrollBehavior = 'auto'")
        for canvas in ("#plan-canvas", "#view-canvas", "[data-kind=front]", "[data-kind=above]", "[data-kind=section]"):
            page.frames()
            self.assertGreater(page.run(f"({BLANK})('{canvas}')"), 20, canvas)
        self.check_pose_and_numbers(page, conflicts["list"])
        self.check_table(page, conflicts)
        self.check_keys_and_camera(page)
        self.check_paper(page, conflicts["count"])
        for size, picture in ((20000, page.call("Page.captureScreenshot", format="png")),
                              (50000, page.call("Page.printToPDF", preferCSSPageSize=True, printBackground=True))):
            self.assertGreater(len(base64.b64decode(picture["data"])), size)

    def check_pose_and_numbers(self, page, conflicts):
        page.run("{ const s = byId('pose-slider'); s.value = 7; s.dispatchEvent(new Event('input')); }")
        page.frames()
        index = page.run("page.poses.index[7]")
        self.says(page, {"byId('pose-text').textContent": f"pose {index:,},",
                         "byId('profile-readout').textContent": f"Pose {index:,},"})
        for title in ("Lateral", "Height"):
            for cell, conflict in zip(self.column(page, title), conflicts):
                self.assertAlmostEqual(float(cell.replace("\u2212", "-")), conflict[title.lower()], 2)
        classes = set(page.run("conflictList().map((c) => classOf(c.least_distance).name)"))
        self.gives(page, {"tableColumns().some((c) => c.title === 'Class')": len(classes) > 1,
                          "[0, 0.0004, 0.00002].map((v) => metres(v))": ["0.000 m", "0.0004 m", "< 0.0001 m"],
                          "[-0.001, -1.5, 2].map(signed)": ["0.00", "\u22121.50", "+2.00"]})
        # A chosen conflict that is out of sight takes no number away from a bar at the edge.
        bars = """Object.assign(new Chart(40), { from: 10, to: 20 }).bars([[0, true], [10.2, false]].map(([from, chosen]) =>
            ({ from, to: from + 0.1, label: "1", chosen, look: () => ({}) })))"""
        self.gives(page, {f"{bars}.map((bar) => bar.querySelectorAll('text').length)": [1]})

    def check_table(self, page, conflicts):
        # Previous and Next where there is no other conflict; what a sorted title says.
        order = page.run("sortedConflicts(tableColumns()).map((c) => c.id)")
        for at, disabled in ((0, [True, False, False]), (1, [False, False, False]), (-1, [False, True, False])):
            page.run(f"selectConflict(conflictList().find((c) => c.id === {order[at]}))")
            self.gives(page, {"[...document.querySelectorAll('#conflict-details button')].map((b) => b.disabled)":
                              disabled})
        page.run("sortBy('Points')")
        sorts = page.run("[...document.querySelectorAll('#conflicts-table th')].map((h) => h.getAttribute('aria-sort'))")
        self.assertEqual([sorts.count("descending"), sorts.count("none")], [1, len(sorts) - 1])
        self.gives(page, {f"{ROWS}.length": min(100, conflicts["count"])})
        page.run("sortBy('No.')")
        ids = page.run(f"[...{ROWS}].map((r) => +r.dataset.id)")
        self.assertEqual(ids, sorted(ids))
        page.run(f"{ROWS}[2].click()")
        self.gives(page, {"page.conflict.id": ids[2]})
        self.says(page, {"conflict-details": f"Conflict {ids[2]}"})
        side = conflicts["list"][0]["side"]
        page.run(f"""{{ const s = document.querySelector('#conflicts-tools select');
            s.value = '{side}'; s.dispatchEvent(new Event('change')); }}""")
        self.gives(page, {f"{ROWS}.length": min(100, sum(c["side"] == side for c in conflicts["list"]))})

    def check_keys_and_camera(self, page):
        """From a row of the table to the next, and into it, without a mouse; the button brings the camera
        to the conflict, wherever it and the vehicle were before."""
        page.run(f"{ROWS}[0].focus()")
        last = page.run("String(sortedConflicts(tableColumns()).pop().id)")
        page.key("End")
        self.gives(page, {"document.activeElement.dataset.id": last})
        page.key("Home")
        page.key("ArrowDown")
        self.gives(page,
                   {f"[...{ROWS}].filter((r) => r.tabIndex === 0).map((r) => r === document.activeElement)": [True],
                          "getComputedStyle(document.activeElement).outlineStyle": "solid"})
        chosen = page.run("document.activeElement.dataset.id")
        page.key("Enter")
        self.gives(page, {"String(page.conflict.id)": chosen})
        page.run("document.querySelector('#profile-chart svg').focus()")
        before = page.run("page.pose")
        page.key("ArrowRight")
        self.gives(page, {"page.pose": before + 1})
        camera = """JSON.stringify([page.pose, ...view.target, view.distance, view.yaw, view.pitch]
            .map((v) => +v.toFixed(6)))"""
        show = """[...byId('conflict-details').querySelectorAll('button')]
            .find((b) => b.textContent === 'Show in 3-D').click()"""
        seen = []
        for action in (show, "selectPose(0), flyToOverview()", show):
            page.run(action)
            page.frames()
            seen.append(page.run(camera))
        self.assertEqual([seen[0] == seen[1], seen[0] == seen[2]], [False, True])

    def check_paper(self, page, count):
        page.call("Emulation.setEmulatedMedia", media="print")
        page.run("preparePrint()")
        size = "(({ width, height, x, y }) => [width, height, x, y])(byId('%s').getBoundingClientRect())"
        rows = min(200, count)  # the filter is still on
        self.gives(page, {"byId('print-feet').sheet.cssRules.length": 1,
                          "document.querySelectorAll('#conflicts #print-table tbody tr').length": rows,
                          size % "view-canvas": page.run(size % "view-numbers"),
                          "/Show it|Drag|Tab to/.test(document.body.innerText)": False})
        page.run("page.facts.conflicts.count += 4800")
        self.says(page, {"make('div', {}, ...printedTable()).textContent": f"{4800 + count - rows:,} more conflicts"})
        page.run("page.facts.conflicts.count -= 4800; endPrint()")
        self.gives(page, {"byId('print-table').childElementCount + document.querySelectorAll('.on-paper').length": 0})
        page.call("Emulation.setEmulatedMedia", media="")

    def test_stations(self):
        rows = [line.split() for line in (self.hall / "trajectory.txt").read_text().splitlines()]
        turns = [4 * row + k for row in range(3) for k in range(3)]
        self.hall.put("line.csv", "station [m],x,y,z,r00,r01,r02,r10,r11,r12,r20,r21,r22\n" + "".join(
            ",".join([str(2500 - i), m[3], m[7], m[11], *(m[k] for k in turns)]) + "\n" for i, m in enumerate(rows)))
        self.hall.ask("stations out.h5 --trajectory line.csv --every 3 -o stations.json --force")
        expected = json.loads((self.hall / "stations.json").read_text())["stations"]
        facts = self.other_hall(trajectory="line.csv").report("stations", "--every 3", result="out")
        listed = facts["stations"]["list"]
        self.assertEqual(facts["stations"]["every"], 3)
        self.same_values(listed, expected, "chainage_from chainage_to station_from station_to least least_source left "
                         "left_source right above verdict reasons searched")
        for a, b in zip(listed, expected):
            self.assertAlmostEqual(a["overthrow"][0]["end"] or 0, b["overthrow_end"] or 0, 6)
        for conflict in facts["conflicts"]["list"]:
            self.assertEqual(conflict["station_from"], 2500 - conflict["first_pose"])
        without = self.hall.report("plain", result="out")
        self.assertEqual(["station_from" in without["conflicts"]["list"][0], without["stations"]["every"]], [False, 5])
        page = self.shown(self.hall, "stations", facts)
        page.run("document.querySelector('#stations details').open = true")
        shown = page.run("[...document.querySelectorAll('#stations tbody tr')].map((r) => r.innerText)")
        for text, row in zip(shown, listed, strict=True):
            self.assertIn(row["verdict"], text)
            self.assertIn(f"{row['station_from']:.2f} \u2013 {row['station_to']:.2f}", text)
        worst = next(c for c in facts["conflicts"]["list"] if c["id"] == facts["conflicts"]["worst"])
        self.says(page, {"verdict": "(station 2", "conflict-details": f"{worst['station_from']:.2f}",
                         "byId('profile').textContent": "station (m)", "poseLabel(3)": "station 2"})
        # A station lies between those of the poses.
        between = page.run("stationAt((page.poses.chainage[4] + page.poses.chainage[5]) / 2)")
        self.assertAlmostEqual(between, 2495.5, 2)
        page.run("document.querySelectorAll('#stations tbody tr')[1].click()")
        page.run("document.querySelector('#stations details').open = false")
        for action, is_open in (("preparePrint()", True), ("endPrint()", False)):
            page.run(action)
            self.gives(page, {"document.querySelector('#stations details').open": is_open})

    def test_shifts(self):
        lane = make_lane(Scene(self.place / "lane"))
        lane.ask(f"run {lane.inputs()} --model-as solid --radius 0.001 --first-pose --clearance 0.3 -o out.h5")
        told = lane.json(f"shift out.h5 {lane.inputs()} --lateral -0.6,0.8 -o shifts.json")
        facts = lane.report("shifts", "--shifts shifts.json", result="out")
        for rows in (facts["shifts"]["list"], told["conflicts"]):
            self.assertEqual([row["shift"] for row in rows], [-0.11, 0.21, None, None])
        lane.report("bad", "--min-points 500 --shifts shifts.json", 3, "table of shifts", result="out")
        self.assertNotIn("shifts", lane.report("plain", result="out"))
        page = self.shown(lane, "shifts", facts)
        self.assertEqual(self.column(page, "Frees it"), ["0.11 right", "0.21 left", "\u2013", "\u2013"])
        no_shift = "o shift of up to 0.8 m to the left and 0.6 m to the right frees"
        for words, conflict in zip(("0.11 m to the right between 2.0 and 5.0 m, which leaves 0.010 m",
                                    "0.21 m to the left between 7.0 and 10.0 m, which leaves 0.010 m",
                                    f"n{no_shift} it", f"n{no_shift} it"), facts["conflicts"]["list"]):
            page.run(f"selectConflict(conflictList().find((c) => c.id === {conflict['id']}))")
            self.says(page, {"conflict-details": words})
        page.run("preparePrint()")
        self.says(page, {"byId('conflicts-note').textContent": [f"N{no_shift} the whole path.",
                                                                "2 of 4 conflicts can be freed"],
                         "byId('print-cards').textContent": "Frees it"})
        self.gives(page, {"(sortBy('Frees it'), sortedConflicts(tableColumns()).map((c) => c.id))": [1, 2, 3, 4]})

    def test_a_ledger(self):
        """Four panels beside a lane: one stays accepted, one comes nearer, one goes, one is out of reach."""
        odd = '<b>"a, b"</b></script><!-- \u2028 =1+1'
        folder = self.place / "epochs"
        lane = make_epoch(Scene(folder), "before", ((3, 0.4), (8, 0.4), (13, 0.4), (17, 0.4)), 401)
        later = make_epoch(Scene(folder), "after", ((3, 0.4), (8, 0.35), (10.5, -0.4)), 301)
        for one, name in ((lane, "first"), (later, "second")):
            one.ask(f"run {one.inputs()} --radius 0.05 --first-pose --clearance 0.3 -o {name}.h5")
        lane.ask(f"conflicts first.h5 {lane.inputs()} --update --ledger odd.csv --date 2026-01-01")
        with open(folder / "odd.csv", newline="", encoding="utf-8") as file:
            rows = list(csv.reader(file))
        for row, edit in zip(rows[1:], (("accepted", odd, odd, "2026-12-31"), ("accepted", "Ann", "", ""),
                                        ("accepted", "Ann", "", ""), ("open", "", "behind the gate", ""))):
            row[1:5] = edit
        with open(folder / "odd.csv", "w", newline="", encoding="utf-8") as file:
            csv.writer(file).writerows(rows)
        before = later.bytes("odd.csv")
        facts = later.report("ledger", "--ledger odd.csv", result="second")
        self.assertEqual(later.bytes("odd.csv"), before)
        keys = ("name", "date", "accepted", "worse", "new", "gone", "not-searched")
        self.assertEqual([facts["ledger"][key] for key in keys], ["odd.csv", "2026-01-02", 1, 1, 1, 1, 1])
        wide = later.report("wide", "--ledger odd.csv --worse-by 0.1", result="second")
        self.assertEqual([wide["ledger"]["worse"], "ledger" in later.report("plain", result="second")], [0, False])
        page = self.shown(later, "ledger", facts)
        self.says(page, {
            "byId('ledger-sentence').textContent":
                "The verdict stays conflict. The ledger accepts 1 of the 3 conflicts. Of the others 1 is worse and "
                "1 is new. 1 row of the ledger is gone. 1 row of the ledger was not searched",
            "ledger-rows": ["not-searched (was open)", "This question would not find it", "behind the gate",
                            "gone (was accepted)", "Nothing collides there any more"],
            "byId('profile-chart').textContent": "Conflict 1, accepted"})
        cells = """Object.fromEntries([...document.querySelectorAll('#conflicts-table tbody tr')].map((r) => [r.dataset.id,
            r.cells[tableColumns().findIndex((c) => c.title === '%s')].textContent]))"""
        self.assertEqual(page.run(cells % "Decided")["1"], f"{odd}, until 2026-12-31: {odd}")
        for conflict, words in (("1", "accepted"), ("2", "worseIts least distance was"), ("3", "new")):
            self.assertTrue(page.run(cells % "Ledger")[conflict].startswith(words), words)
        self.gives(page, {"conflictMarks().filter((mark) => mark.quiet).map((mark) => mark.text)": ["1"],
                          "page.conflict.id === 1": False})
        page.run("selectConflict(conflictList()[0]); table.status = kNotAccepted; drawTable()")
        self.gives(page, {"tableRows().map((row) => row.dataset.id).sort()": ["2", "3"]})
        page.run("preparePrint()")
        self.says(page, {"byId('conflict-details').textContent": odd,
                         "byId('print-table').textContent": [odd, "Its least distance was", "accepted"]})

    def test_a_run_without_first_poses_names_the_options_that_a_page_needs(self):
        self.hall.search("bare", "")
        facts = self.hall.report("bare")
        self.assertIsNone(facts["conflicts"])
        page = self.shown(self.hall, "bare", facts)
        self.says(page, {"document.body.innerText": ["--first-pose", "--clearance", "--profile"]})

    def test_depths_of_a_solid(self):
        solid = self.other_hall(model="box:4.2,2.4,1.4")
        solid.search("solid", "--first-pose --model-as solid --clearance 0.3 --profile 0.5")
        facts, info = solid.report("solid"), self.hall.json("info solid.h5")
        inside, depth = facts["inside"]["points"], facts["inside"]["depth"]
        listed = facts["conflicts"]["list"]
        self.assertEqual([info["model_solids"], inside, depth, facts["least_distance"]["distance"]],
                         [1, info["points_inside"], info["greatest_depth"], -depth])
        self.assertTrue(inside > 10 and 0.05 < depth <= 0.7, (inside, depth))
        self.assertEqual(max(c["depth"] for c in listed), depth)
        self.assertLessEqual(sum(c["points_inside"] for c in listed), inside)
        page = self.shown(self.hall, "solid", facts)
        deep = f"{depth:.3f} m deep inside the vehicle"
        self.says(page, {"verdict": [f"{inside:,} points are inside it.", deep, "The deepest point is",
                                     "1 closed part has an inside", "deepest inside the vehicle"],
                         "conflict-details": "deep inside the vehicle",
                         "byId('profile-chart').textContent": "inside the vehicle",
                         "(goToNearest(), byId('profile-readout').textContent)": deep})
        self.assertEqual(self.column(page, "Depth"), [f"{c['depth']:.3f}" if c["depth"] else "" for c in listed])
        self.assertLess(page.run("profile.low"), -depth)
        solid.search("bare_solid", "--first-pose --model-as solid")
        facts = solid.report("bare_solid")
        self.assertIsNone(facts["inside"])
        self.shown(self.hall, "bare_solid", facts)

    def test_a_floor(self):
        with_errors = "0.3 m of the vehicle (0.1621 m with the errors)"
        given = []
        for name, more, words in (("floor", "", "0.3 m of the vehicle"),
                                  ("floor_errors", "--error-pose 0.01", with_errors)):
            self.hall.search(name, f"--first-pose --clearance 0.3 --floor 0.3 {more}")
            given.append((self.hall.report(name), words))
        page = self.shown(self.hall, "floor_errors", given[1][0])
        for facts, words in given:
            text, below = self.verdict_of(page, facts), facts["floor"]["colliding"]
            self.assertGreater(below, 10)
            judged = text.index(f"{below:,} points within the radius below {words} not judged.")
            self.assertLess(judged, text.index("points are closer than"))
            self.assertIn(f"Only what lies at {words} or above", text)

    def test_an_empty_answer(self):
        self.empty.search("out", "--first-pose --clearance 2")
        facts = self.empty.report("out")
        self.assertEqual([facts["verdict"], facts["least_distance"]["distance"], facts["least_distance"]["pose"]],
                         ["clear", 1, 30])
        page = self.shown(self.empty, "out", facts, width=2560, height=1440)
        at = page.run("page.facts.least_distance.point.map((v) => v.toFixed(3)).join(' ')")
        self.says(page, {
            "verdict": ["1.000 m", "No environment point is closer than 0.1 m to the model on its way.",
                        "The least distance is 1 m at pose 30 (3.0", f" along the path), point {at}.",
                        "That point is below it, 0.50 m right of the path and 1.00 m below it"]})
        page.run("""selectPose(90); [...document.querySelectorAll('#profile-tools button')]
                 .find((b) => b.textContent === 'Nearest pose').click()""")
        tile = "conflictsTile({ count: %d, small_groups: %d }).textContent"
        self.gives(page, {"page.poses.index[page.pose]": 30, tile % (1, 0): "1conflict", tile % (2, 3): "2conflicts",
                          tile % (0, 0): "0conflicts", tile % (0, 1): "1place, too small for the list"})
        page.frames()
        self.assertGreater(page.run(f"({BLANK})('#view-canvas')"), 5)

    def test_a_profile_has_gaps(self):
        for far, pieces in ((1.05, 1), (0.5, 0)):
            self.empty.search("gap", f"--first-pose --profile {far}")
            page = self.shown(self.empty, "gap", self.empty.report("gap"))
            self.gives(page, {"profileLine().length": pieces,
                              "byId('profile-tools').textContent.includes('Nearest pose')": pieces > 0})
            self.says(page, {"byId('profile-chart').textContent": f"nothing is closer than {far} m"})

    def test_what_was_not_scanned(self):
        self.road.search("unseen", "--first-pose --profile 0.5 --seen")
        facts, info = self.road.report("unseen"), self.road.json("info unseen.h5")
        seen, front = facts["seen"], facts["seen"]["front"]
        self.same_values([seen], [info["seen"]], "cube swept seen unseen groups listed_groups not_scanned_length")
        [group] = seen["list"]
        self.assertEqual([facts["verdict"], facts["reasons"], seen["origins"], group["cubes"], group["shown"]],
                         ["undecided", ["not-scanned"], [{"what": "a file of origins", "points": 9801}],
                          seen["unseen"], seen["unseen"]])
        for kind in ("swept", "unseen"):
            self.assertEqual(len(front[kind]), front["columns"] * front["rows"])
            self.assertAlmostEqual(sum(front[kind]) * front["cell"] ** 2, seen[kind] * seen["cube"] ** 3, 6)
        self.assertEqual(sum(length for i, length in enumerate(front["unseen"])  # the board stands on the left
                             if front["left"] + (i % front["columns"] + 1) * front["cell"] <= -0.2), 0)
        page = self.shown(self.road, "unseen", facts)
        length = f"{seen['not_scanned_length']:.1f} of 7.0 m"
        self.says(page, {
            "verdict": [f"Not scanned on {length}: no beam", "in 1 place", "see U1 below", f"{length}\n", "from a file of origins",
                        "wires, glass, mirrors", "What would decide it", "Places were not scanned: see U1 below",
                        "Undecided: parts of the way were not scanned."],
            "byId('profile-unsearched').textContent": "Not scanned: at chainage"})
        self.check_shaded(page, "not-scanned", seen["stretches"])
        # The numbers of the picture are those of the facts: each is drawn in its cell.
        drawn = page.run("[...document.querySelectorAll('#front-picture text')].map((text) => text.textContent)")
        shares = [unseen / swept for swept, unseen in zip(front["swept"], front["unseen"])
                  if swept >= 0.1 * max(front["swept"]) and unseen > 0]
        self.assertGreater(len(shares), 3)
        self.assertLessEqual(set(page.run(f"{json.dumps(shares)}.map((v) => percentWords(v))")), set(drawn))
        self.assertGreater(page.run("document.querySelector('#front-picture image').href.baseVal.length"), 500)
        page.run("document.querySelector('#unseen-table tbody tr').click()")
        self.gives(page, {"[0, 0.001, 0.5, 0.999, 1].map((v) => percentWords(v))": ["0", "<1", "50", ">99", "100"],
                          "[page.unseen.count, page.group.id, page.poses.index[page.pose]]":
                          [seen["unseen"], group["id"], group["first_pose"]]})
        self.says(page, {"unseen-chosen": "U1: "})
        page.run("selectPose(0)")
        page.frames()
        page.run("""{ const c = byId('plan-canvas'), s = c.width / c.clientWidth;
            const p = plan.places.find((p) => p.mark.text === 'U1');
            page.group = null;
            pickNumber(plan.places, c, p.x / s, p.y / s); }""")
        self.gives(page, {"plan.places.find((p) => p.mark.text === 'U1').mark.shape": "square",
                          "page.group.id": group["id"],
                          "(preparePrint(), document.querySelectorAll('#unseen-print tbody tr').length)": 1})
        self.assertTrue(page.call("Page.printToPDF", preferCSSPageSize=True)["data"])

    def test_all_that_is_swept_was_seen(self):
        self.road.search("small", "--seen --seen-min 100000")
        facts = self.road.report("small")
        self.assertEqual([facts["verdict"], facts["seen"]["list"]], ["clear", []])
        page = self.shown(self.road, "small", facts)
        self.says(page, {"byId('scanned').textContent": ["A beam passed through all but",
                                                         "1 group of fewer than 100,000 cubes"]})
        self.check_shaded(page, "not-scanned", [])

    def test_certain_and_possible_conflicts(self):
        self.hall.search("budget", "--first-pose --clearance 0.5 --profile 0.6 --error-scan 0.003 --error-pose 0.01 "
                         "--error-model 0.01")
        classes = [c["class"] for c in self.hall.conflicts("budget")["conflicts"]]
        facts = self.hall.report("budget")
        self.assertEqual([c["class"] for c in facts["conflicts"]["list"]], classes)
        self.assertEqual(set(classes), {"certain", "possible"})
        page = self.shown(self.hall, "budget", facts)
        self.assertEqual([cell[2:] for cell in self.column(page, "Certainty")], classes)
        radius = facts["query"]["radius"]
        clear, conflict = radius + facts["margins"]["clear"], radius - facts["margins"]["conflict"]
        self.gives(page, {"conflictMarks().map((m) => m.hollow)": [c == "possible" for c in classes],
                          "byId('decides')": None})  # a conflict is decided
        self.says(page, {
            "verdict": [f"{classes.count('possible')}\nof them possible, {classes.count('certain')} certain", "0.13 %",
                        "The risk is per place", "--seen looks for them"],
            "byId('profile-chart').textContent": "clear above " + page.run(f"shortLength(+({clear}).toPrecision(4))")})
        top, height = page.run("""(() => { const r = document.querySelector('rect.margins');
            return [+r.getAttribute('y'), +r.getAttribute('height')]; })()""")
        self.assertAlmostEqual(top, page.run(f"profileY({clear})"), 6)
        self.assertAlmostEqual(top + height, page.run(f"profileY({conflict})"), 6)

    def test_an_undecided_page_says_what_would_decide_it(self):
        self.hall.ask(f"run {self.hall.inputs()} --radius 0.02 --first-pose --between-poses --error-scan 0.002 "
                      "--error-registration 0.03 -o exceed.h5")
        facts = self.hall.report("exceed")
        self.assertEqual([facts["verdict"], facts["reasons"]], ["undecided", ["near", "errors-exceed-margin"]])
        self.says(self.shown(self.hall, "exceed", facts), {
            "decides": ["possible conflicts in the table below",
                        "the error of the registration is the largest, with 0.09 m",
                        "search a closed mesh with --model-as solid"],
            "conflicts": "No conflict is certain, because the errors exceed the margin"})

    @unittest.skipUnless(os.environ.get("CLEARWAY_TEST_DATA"), "CLEARWAY_TEST_DATA is not set")
    def test_the_street(self):
        street, data = Scene(self.place / "street"), os.environ["CLEARWAY_TEST_DATA"] + "/street"
        street.model = "warthog_ugv.obj"
        for name in (street.model, street.trajectory):
            shutil.copy(f"{data}/{name}", street / name)
        street.ask(f"convert {data}/street.las -o site.h5")
        street.search("out", "--first-pose --clearance 0.3")
        facts = street.report("out", "--max-points 200000")
        self.assertLessEqual(facts["page"]["environment_points"], 200000)
        self.says(self.shown(street, "out", facts), {"verdict": "as the ground is under wheels"})


if __name__ == "__main__":
    unittest.main(verbosity=2)
