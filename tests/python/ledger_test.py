#!/usr/bin/python3
"""Ledgers in Python. ledger_test.py, with the module on the path."""

import json
import re
import unittest

import clearway
import numpy as np
from scene import SceneTest, poses_along_x


def panel(x, left):
    return [(x + 0.1 * i, left, 0.1 + 0.1 * k) for i in range(11) for k in range(9)]


class LedgerTest(SceneTest):
    """A box of 2 x 1 x 1 m in a lane, where two panels stand; the second one is taken away."""

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        along = np.arange(-2, 16, 0.25)
        lane = [(x, y, z) for x in along for y in (-1.1, 1.1) for z in np.arange(0, 1.1, 0.25)]
        lane += [(x, y, -0.5) for x in along for y in np.arange(-1, 1.1, 0.25)]
        cls.model = clearway.box_model(2, 1, 1)
        cls.poses = poses_along_x(241, 0.05)
        for name, panels in (("before", panel(3, 0.4) + panel(8, 0.4)), ("after", panel(3, 0.4))):
            np.savetxt(cls.folder / f"{name}.xyz", lane + panels, "%.3f")
            clearway.convert(cls.folder / f"{name}.xyz", cls.folder / f"{name}.h5", overwrite=True)

    def found(self, name, **options):
        store = clearway.Store(self.folder / f"{name}.h5")
        output = self.folder / f"{name}_out.h5"
        if not output.exists():
            query = clearway.Query(self.model, self.poses, 0.05, first_pose=True, clearance=0.3)
            clearway.search(store, query, output)
        self.result, self.store = clearway.Result(output), store
        options = {"model": self.model, "store": store, "ledger": self.folder / "L.csv", **options}
        return clearway.find_conflicts(self.result, self.poses, **options)

    def test_two_epochs(self):
        with self.assertRaisesRegex(clearway.UsageError, "does not exist"):
            self.found("before")
        first = self.found("before", update=True, date="2026-03-01").ledger
        self.assertEqual((len(first), first.is_updated, first.date, first.counts()["new"]), (2, True, "2026-03-01", 2))
        self.assertEqual([entry.key for entry in first.conflicts], ["1", "2"])
        text = (self.folder / "L.csv").read_text()
        for key, owner in (("1", "Ann"), ("2", "Ben")):
            text = re.sub(rf"(?m)^{key},[^,]*,[^,]*,[^,]*,[^,]*,", f"{key},accepted,{owner},known,,", text)
        (self.folder / "L.csv").write_text(text)

        ledger = self.found("after", date="2026-06-01").ledger
        self.assertEqual({status: n for status, n in ledger.counts().items() if n}, {"accepted": 1, "gone": 1})
        self.assertEqual([(row.shown, row.status, row.owner, row.conflicts) for row in ledger.rows],
                         [("accepted", "accepted", "Ann", [1]), ("gone", "accepted", "Ben", [])])
        self.assertEqual([(e.conflict, e.status, e.key, e.comment) for e in ledger.conflicts],
                         [(1, "accepted", "1", "known")])
        self.assertEqual((ledger.accepted_conflicts, ledger.outside.verdict, ledger.outside.colliding_points),
                         (1, "clear", 0))
        columns = ledger.columns()
        self.assertEqual((columns["shown"], {*map(len, columns.values())}), (["accepted", "gone"], {2}))
        np.testing.assert_allclose(columns["x"], [3.5, 8.5])
        np.testing.assert_allclose(columns["size_z"], [0.8, 0.8])
        np.testing.assert_allclose(ledger.rows[0].box.lo, [3, 0.4, 0.1])
        summary = clearway.write_report(self.result, self.store, self.model, self.poses, self.folder / "page.html",
                                        overwrite=True, ledger=ledger, ledger_name="L.csv")
        facts = json.loads(summary.facts)["ledger"]
        self.assertEqual((facts["name"], facts["gone"], facts["accepted_conflicts"]), ("L.csv", 1, 1))

        without_store = self.found("after", store=None).ledger
        self.assertEqual([row.shown for row in without_store.rows], ["accepted", "not-searched"])
        self.assertEqual(self.found("after", worse_by=0).ledger.counts()["accepted"], 1)
        self.assertIsNone(self.found("after", ledger=None, store=None).ledger)

    def test_refuses(self):
        no_ledger = {"ledger": None, "store": None}
        for words, options in (("^ledger: ", {**no_ledger, "update": True}), ("^ledger: ", {**no_ledger, "worse_by": 0.1}),
                               ("soon", {"update": True, "date": "soon"})):
            with self.assertRaisesRegex(clearway.UsageError, words):
                self.found("after", **options)
        other = self.found("before", ledger=self.folder / "other.csv", update=True).ledger
        self.found("after", **no_ledger)
        with self.assertRaisesRegex(clearway.UsageError, "^ledger: it judges 2 conflicts, and the result has 1"):
            clearway.write_report(self.result, self.store, self.model, self.poses, "page.html", ledger=other)


if __name__ == "__main__":
    unittest.main()
