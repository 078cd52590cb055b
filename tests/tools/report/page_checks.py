"""What a page is used for and looked at: parts of tests, for a unittest.TestCase."""

import json


class PageChecks:
    def check_quiet(self, page):
        self.assertEqual(page.complaints(), [])

    def check_words(self, page, facts):
        self.assertEqual(page.run("document.body.dataset.ready"), "true")
        word = page.run("byId('verdict-word').textContent").lower()
        warned = facts["verdict"] == "clear" and facts["warnings"]
        self.assertEqual(word, "clear with warnings" if warned else facts["verdict"])
        text = page.run("document.body.innerText")
        for slip in ("false", "undefined", "null", "NaN"):
            self.assertNotIn(slip, text.split())
        self.assertIn(f"{facts['colliding_points']:,}", text)
        for kind in ("environment", "model", "trajectory"):
            self.assertIn(facts["inputs"][kind]["hash"], text)
        self.assertEqual(json.loads(page.run("document.getElementById('facts').textContent")),
                         facts)

    def verdict_of(self, page, facts, part="verdict"):
        """What an open page says of a run, which may be another one of the same kind: opening a page
        takes a second, and most of it draws pictures."""
        return page.run(f"""(() => {{ const mine = page.facts, body = byId('verdict-body');
            const fill = (facts) => {{
              page.facts = facts; body.replaceChildren(); buildVerdict(); }};
            fill({json.dumps(facts)});
            const text = byId('{part}').innerText;
            fill(mine);
            return text; }})()""")

    def check_slider(self, page):
        page.run("""{ const s = byId('pose-slider'); s.value = 7;
            s.dispatchEvent(new Event('input')); }""")
        page.frames()
        index = page.run("page.poses.index[7]")
        self.assertIn(f"pose {index:,},", page.run("byId('pose-text').textContent"))
        self.assertIn(f"Pose {index:,},", page.run("byId('profile-readout').textContent"))

    def check_table(self, page, facts):
        rows = "document.querySelectorAll('#conflicts-table tbody tr')"
        self.assertEqual(page.run(f"{rows}.length"), min(100, facts["conflicts"]["count"]))
        page.run("sortBy('No.')")
        ids = page.run(f"[...{rows}].map((r) => +r.dataset.id)")
        self.assertEqual(ids, sorted(ids))
        page.run(f"{rows}[2].click()")
        self.assertEqual(page.run("page.conflict.id"), ids[2])
        self.assertIn(f"Conflict {ids[2]}", page.run("byId('conflict-details').innerText"))
        side = facts["conflicts"]["list"][0]["side"]
        page.run(f"""{{ const s = document.querySelector('#conflicts-tools select');
            s.value = '{side}'; s.dispatchEvent(new Event('change')); }}""")
        count = sum(c["side"] == side for c in facts["conflicts"]["list"])
        self.assertEqual(page.run(f"{rows}.length"), min(100, count))

    def check_offsets(self, page, facts):
        titles = page.run("tableColumns().map((c) => c.title)")
        for title, key in (("Lateral", "lateral"), ("Height", "height")):
            cells = page.run(f"conflictList().map((c) => tableColumns()[{titles.index(title)}]"
                             ".cell(c))")
            for cell, conflict in zip(cells, facts["conflicts"]["list"]):
                self.assertAlmostEqual(float(cell.replace("\u2212", "-")), conflict[key], 2)
        classes = set(page.run("conflictList().map((c) => classOf(c.least_distance).name)"))
        self.assertEqual("Class" in titles, len(classes) > 1)
        self.assertEqual(page.run("metres(0)"), "0.000 m")
        self.assertEqual(page.run("metres(0.0004)"), "0.0004 m")
        self.assertEqual(page.run("metres(0.00002)"), "< 0.0001 m")
        self.assertEqual(page.run("[-0.001, -1.5, 2].map(signed)"), ["0.00", "\u22121.50", "+2.00"])

    def check_ends(self, page):
        """Previous and Next where there is no other conflict; what a sorted title says."""
        state = "[...document.querySelectorAll('#conflict-details button')].map((b) => b.disabled)"
        order = page.run("sortedConflicts(tableColumns()).map((c) => c.id)")
        for at, expected in ((0, [True, False, False]), (1, [False, False, False]),
                             (-1, [False, True, False])):
            page.run(f"selectConflict(conflictList().find((c) => c.id === {order[at]}))")
            self.assertEqual(page.run(state), expected)
        page.run("sortBy('Points')")
        sorts = page.run("[...document.querySelectorAll('#conflicts-table th')]"
                         ".map((h) => h.getAttribute('aria-sort'))")
        self.assertEqual(sorts.count("descending"), 1)
        self.assertEqual(sorts.count("none"), len(sorts) - 1)

    def check_paper(self, page, facts):
        page.call("Emulation.setEmulatedMedia", media="print")
        page.run("preparePrint()")
        self.assertEqual(page.run("byId('print-feet').sheet.cssRules.length"), 1)
        rows = page.run("document.querySelectorAll('#conflicts #print-table tbody tr').length")
        self.assertEqual(rows, min(200, facts["conflicts"]["count"]))  # the filter is still on
        size = "(({ width, height, x, y }) => [width, height, x, y])(byId('%s').getBoundingClientRect())"
        self.assertEqual(page.run(size % "view-canvas"), page.run(size % "view-numbers"))
        text = page.run("document.body.innerText")
        for hint in ("Show it", "Drag", "Tab to"):
            self.assertNotIn(hint, text)
        page.run("page.facts.conflicts.count += 4800")
        self.assertIn(f"{4800 + facts['conflicts']['count'] - rows:,} more conflicts",
                      page.run("make('div', {}, ...printedTable()).textContent"))
        page.run("page.facts.conflicts.count -= 4800; endPrint()")
        self.assertEqual(page.run("byId('print-table').childElementCount + "
                                  "document.querySelectorAll('.on-paper').length"), 0)
        page.call("Emulation.setEmulatedMedia", media="")

    def check_show(self, page):
        """The button brings the camera to the conflict, wherever it and the vehicle were before."""
        camera = "JSON.stringify([page.pose, ...view.target, view.distance, view.yaw, view.pitch].map((v) => +v.toFixed(6)))"
        button = "[...byId('conflict-details').querySelectorAll('button')].find((b) => b.textContent === 'Show in 3-D')"
        page.run(f"{button}.click()")
        page.frames()
        there = page.run(camera)
        page.run("selectPose(0), flyToOverview()")
        page.frames()
        self.assertNotEqual(page.run(camera), there)
        page.run(f"{button}.click()")
        page.frames()
        self.assertEqual(page.run(camera), there)

    def check_keys(self, page):
        """From a row of the table to the next, and into it, without a mouse."""
        page.run("document.querySelector('#conflicts-table tbody tr').focus()")
        stops = "document.querySelectorAll('#conflicts-table tbody tr[tabindex=\"0\"]')"
        last = page.run("String(sortedConflicts(tableColumns()).pop().id)")
        page.key("End")
        self.assertEqual(page.run("document.activeElement.dataset.id"), last)
        page.key("Home")
        page.key("ArrowDown")
        self.assertEqual(page.run(f"{stops}.length"), 1)
        self.assertTrue(page.run(f"{stops}[0] === document.activeElement"))
        self.assertEqual(page.run("getComputedStyle(document.activeElement).outlineStyle"), "solid")
        chosen = page.run("document.activeElement.dataset.id")
        page.key("Enter", "\r")
        self.assertEqual(page.run("String(page.conflict.id)"), chosen)
        page.run("document.querySelector('#profile-chart svg').focus()")
        before = page.run("page.pose")
        page.key("ArrowRight")
        self.assertEqual(page.run("page.pose"), before + 1)
