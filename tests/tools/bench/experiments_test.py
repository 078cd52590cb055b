"""Every experiment of tools/experiments.py runs on scenes of some thousand points, finds what it has to,
and goes on where it was stopped.

    experiments_test.py CLEARWAY CLEARWAY_BENCH
"""

import importlib.util
import json
import shutil
import struct
import subprocess
import sys
import tempfile
import unittest
from collections import defaultdict
from pathlib import Path

import numpy as np

TOOLS = Path(__file__).resolve().parents[3] / "tools"
sys.path.insert(0, str(TOOLS))

from bench import variants

MODULE = importlib.util.find_spec("clearway")


class Experiments(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = Path(tempfile.mkdtemp(prefix="clearway-experiments-"))
        cls.addClassCleanup(shutil.rmtree, cls.folder)
        cls.programs = cls.folder / "programs"
        cls.programs.mkdir()
        for name, path in zip(("clearway", "clearway-bench"), PROGRAMS):
            (cls.programs / name).symlink_to(path)

    def run_it(self, experiment, *options, code=0, says=""):
        self.file = self.folder / f"{experiment}.json"
        done = subprocess.run(
            [TOOLS / "experiments.py", self.programs, experiment, "--size", "smoke", "--device", "cpu",
             "--repetitions", "1", "-o", self.file, "--work", self.folder / "work", *options],
            capture_output=True, text=True)
        self.assertEqual(done.returncode, code, done.stderr)
        self.assertIn(says, done.stderr)
        return json.loads(self.file.read_text()) if self.file.exists() else None

    def cases(self, experiment, *options):
        """{what is varied: cases}, all of which were measured."""
        found = defaultdict(list)
        for case in self.run_it(experiment, "--force", *options)["cases"]:
            self.assertNotIn("failed", case)
            parameters = case["parameters"]
            found[parameters.get("vary") or parameters.get("method") or parameters.get("way")].append(case)
        return found

    @staticmethod
    def of_runs(cases, *path):
        values = [case["runs"][0] for case in cases]
        for name in path:
            values = [value[name] for value in values]
        return values

    def test_table_and_how_a_file_is_gone_on_with(self):
        record = self.run_it("table", "--scenes", "hall", "--force")
        cases = record["cases"]
        self.assertEqual([case["key"] for case in cases],
                         [f"hall/{name} cpu/{exact}" for name, exact in (
                             ("kdtree", True), ("sweep", True), ("grid", True), ("grid float", False))])
        for case in cases:
            self.assertEqual(case["runs"][0]["environment_points"], 20_000)
            self.assertGreater(case["runs"][0]["peak_resident_bytes"], 1 << 20)
            self.assertTrue(case["findings"]["equal"] or not case["parameters"]["exact"])
        self.run_it("table", "--scenes", "hall", code=1, says="--resume goes on")
        self.run_it("table", "--resume", "--memory", "5G", code=1, says="differs in parameters")
        # A case that a smaller limit stopped is measured anew, in its place; others stay.
        cases[1] = {**cases[1], "runs": [], "failed": {"after_seconds": 6.5, "limit": 6}}
        cases[2] = {**cases[2], "runs": [], "failed": {"after_seconds": 61, "limit": 60}}
        self.file.write_text(json.dumps(record))
        resumed = self.run_it("table", "--scenes", "tunnel,hall", "--resume")
        self.assertEqual(resumed["parameters"]["scenes"], ["hall", "tunnel"])
        self.assertEqual([resumed["cases"][i] for i in (0, 2, 3)], [cases[i] for i in (0, 2, 3)])
        self.assertEqual((resumed["cases"][1]["key"], len(resumed["cases"][1]["runs"])), (cases[1]["key"], 1))
        self.assertEqual(len(resumed["cases"]), 8)
        resumed["cases"][0]["findings"]["equal"] = False
        self.file.write_text(json.dumps(resumed))
        self.run_it("table", "--resume", "--scenes", "hall,tunnel", code=1,
                    says="what decides exactly is wrong: hall/kdtree cpu/True")
        self.run_it("table", "--force", "--scenes", "hall", "--memory", "1K", code=1, says="is enough")
        self.run_it("grid", "--scenes", "hall", code=2, says="has scenes of its own")

    def test_a_run_that_exceeds_the_limit_has_failed(self):
        case = self.run_it("threads", "--force", "--limit", "0.001")["cases"][0]
        self.assertEqual((case["runs"], case["failed"]["limit"]), ([], 0.001))

    def test_accuracy(self):
        cases = self.cases("accuracy")
        for case in cases["exact"] + cases["exact, far origin"]:
            self.assertEqual(case["findings"]["largest_distance"], 0)
        for method in ("model thinned", "every nth pose", "environment quantised"):
            self.assertGreater(cases[method][-1]["findings"]["misses"], 0)
        self.assertEqual(len(cases), 6)

    def test_stability(self):
        cases = self.run_it("stability", "--force")["cases"]
        vary = {case["parameters"]["vary"] for case in cases}
        self.assertEqual(len(vary), 10)
        for case in cases:
            at = case["parameters"]
            refused = (at["vary"].startswith("least") or at["vary"] == "--memory" and
                       case["key"] == next(c["key"] for c in cases if c["parameters"]["vary"] == "--memory")
                       or at["vary"] == "stretch without --allow-non-rigid" and at["value"] > 1e-4)
            self.assertEqual("failed" in case, refused, case["key"])
            if at["vary"] == "ulps":
                self.assertEqual(sum(case["findings"]["points"]), 1 + 31 * 128)
        self.assertTrue(any(sum(case["findings"]["wrong"]) for case in cases
                            if case["parameters"]["vary"] == "ulps"))  # in float

    def test_share(self):
        found = {way: case["findings"] for way, (case,) in self.cases("share", "--scenes", "hall").items()}
        usual = found["as it is"]
        self.assertTrue(0 < usual["colliding_points"] and usual["points_tested"] < usual["points"])
        for way, touched, whole in (("all cells", "cells_read", "cells"),
                                    ("whole field", "bricks_made", "bricks")):
            self.assertEqual((found[way]["colliding_points"], found[way][touched]),
                             (usual["colliding_points"], usual[whole]))
        self.assertGreater(found["poses one by one"]["seconds"], 0)

    def test_ablation(self):
        path = self.programs / "peer_inverse"
        path.write_text("#!/bin/sh\ncase $* in *tree*|*voxels*) misses=1;; *) misses=0;; esac\n"
                        "echo '{\"false_hits\": 0, \"misses\": '$misses'}'\n")
        path.chmod(0o755)
        record = self.run_it("ablation", "--force", "--scenes", "hall", code=1, says="is wrong: hall/tree\n")
        self.assertEqual([case["key"] for case in record["cases"]], [f"hall/{method}" for method in (
            "kdtree cpu", "sweep cpu", "poses", "tree", "field", "voxels")])

    def test_peers(self):
        for name, text in (("nanoflann", "echo '{\"false_hits\": 0}'"), ("cgal", "echo no room >&2; exit 1"),
                           ("octomap", "exec sleep 60")):
            path = self.programs / f"peer_{name}"
            path.write_text(f"#!/bin/sh\n{text}\n")
            path.chmod(0o755)
        record = self.run_it("peers", "--force", "--scenes", "hall", "--limit", "0.05", says="peer_pcl: not built")
        found = {case["parameters"].get("cell", case["parameters"]["peer"]): case["findings"]
                 for case in record["cases"]}
        self.assertEqual(found["nanoflann"], {"false_hits": 0})
        self.assertEqual(found["cgal"], {"failed": {"exit_code": 1, "log": "no room\n"}})
        self.assertEqual([found[cell]["failed"]["limit"] for cell in (0.1, 0.05, 0.02, 0.01)], [0.5] * 4)

    def test_check_and_certainty(self):
        for case in self.run_it("check", "--force")["cases"]:
            seconds = case["runs"][0]["seconds"]
            self.assertAlmostEqual(seconds["total"], sum(seconds.values()) - seconds["total"])
        for case in self.run_it("certainty", "--force")["cases"] if MODULE else ():
            self.assertFalse(case["findings"].get("differ"))

    def test_outofcore(self):
        found = defaultdict(set)
        for case in self.run_it("outofcore", "--force")["cases"]:
            at = case["parameters"]
            if at.get("question") == "conversion":
                self.assertGreater(case["findings"]["store_bytes"], 8 * at["points"])
            elif "skipped" not in case.get("findings", {}):
                run = case["runs"][0]
                found[at["points"]].add((run["environment_points"], run["colliding_points"]))
        self.assertEqual([[points for points, _ in each] for each in found.values()], [[20_000], [40_000]])
        self.assertFalse((self.folder / "work" / "outofcore-smoke").exists())

    def test_seen(self):
        cases = self.cases("seen", "--scenes", "hall")
        swept = {vary: self.of_runs(cases[vary], "seen", "swept") for vary in ("beams", "cube", "path")}
        self.assertEqual(len(set(swept["beams"])), 1)
        self.assertEqual(sorted(swept["path"]), swept["path"])
        self.assertLess(swept["cube"][0], swept["cube"][3])
        unseen = self.of_runs(cases["beams"], "seen", "unseen")
        self.assertLess(unseen[3], unseen[0])
        self.assertEqual(len(cases["question"]), 8)

    def test_section(self):
        cases = self.cases("section", "--scenes", "hall")
        blocked = {vary: self.of_runs(of, "blocked") for vary, of in cases.items() if vary != "width"}
        self.assertEqual(set(blocked["bin"]), set(blocked["method"]) | set(blocked["threads"]))
        self.assertLess(blocked["cell"][0], blocked["cell"][3])
        self.assertLess(blocked["length"][0], blocked["length"][3])
        self.assertEqual(set(self.of_runs(cases["width"], "model_solids")), {1})

    def test_surfaces_of_a_query_of_ones_own_and_of_the_hall(self):
        for case in self.cases("surfaces")["sampled"]:
            self.assertEqual(case["findings"]["false_hits"], 0)
        hall = self.folder / "work" / "hall-smoke"
        own = ["--env", hall.with_suffix(".h5"), "--model", hall / "model.ply"]
        self.run_it("surfaces", *own, code=2, says="belong together")
        found = self.cases("table", *own, "--trajectory", hall / "trajectory.txt")
        self.assertEqual(found[None][0]["parameters"]["scene"], "hall-smoke")

    def test_grid_and_points(self):
        grid = self.cases("grid")
        self.assertEqual({vary: len(cases) for vary, cases in grid.items()},
                         {"grid cell": 4, "adaptive layout": 3, "regular layout": 3})
        self.assertGreater(*self.of_runs(grid["adaptive layout"], "cells_total")[:2])
        points = self.run_it("points", "--force")["cases"]
        self.assertEqual(sorted({case["parameters"]["points"] for case in points}),
                         [20_000 // 3 * i for i in range(1, 4)])
        for case in points:
            self.assertEqual(case["runs"][0]["environment_points"], case["parameters"]["points"])


class Variants(unittest.TestCase):
    def test_paths(self):
        poses = np.tile(np.eye(3, 4), (7, 1, 1))
        poses[:, 0, 3] = range(7)
        self.assertEqual(variants.every_nth(poses, 3)[:, 0, 3].tolist(), [0, 3, 6])
        self.assertEqual(variants.every_nth(poses, 4)[:, 0, 3].tolist(), [0, 4, 6])
        noisy = variants.noisy(poses, 0.1)
        np.testing.assert_allclose(noisy[:, :, :3] @ noisy[:, :, :3].transpose(0, 2, 1),
                                   np.tile(np.eye(3), (7, 1, 1)), atol=1e-12)
        self.assertTrue(0 < np.abs(noisy - poses).max() < 0.5)
        np.testing.assert_array_equal(variants.noisy(poses, 0), poses)
        self.assertEqual(variants.stretched(poses, 0.5)[0, 0, 0], 1.5)

    def test_environments_keep_their_points(self):
        with tempfile.TemporaryDirectory() as name:
            las, out = Path(name) / "a.las", Path(name) / "b.las"
            quanta = np.random.default_rng(3).integers(-1000, 1000, (500, 3))
            head, records = bytearray(227), np.zeros((500, 20), np.uint8)
            struct.pack_into("<HIIBH", head, 94, 227, 227, 0, 0, 20)
            struct.pack_into("<6d", head, variants.SCALE, 0.5, 0.5, 0.5, 1, 2, 3)
            records[:, :12] = quanta.astype("<i4").view(np.uint8)
            variants.write_las(las, head, records)
            variants.shift_environment(las, out, (7, 0, -1))
            moved, same = variants.read_las(out)
            self.assertEqual(struct.unpack_from("<3d", moved, variants.OFFSET), (8, 2, 2))
            np.testing.assert_array_equal(same, records)
            variants.sample_environment(las, out, 40, 1)
            _, sample = variants.read_las(out)
            self.assertEqual(len(sample), 40)
            self.assertLess(set(map(bytes, sample)), set(map(bytes, records)))
            variants.stretch_environment(las, out, 3)
            _, longer = variants.read_las(out)
            np.testing.assert_array_equal(longer[:-8, :12], records[:, :12])
            corners = longer[-8:, :12].copy().view("<i4")
            extent = quanta.max(0) - quanta.min(0)
            np.testing.assert_allclose(corners.max(0) - corners.min(0), 3 * extent, atol=1)


if __name__ == "__main__":
    PROGRAMS = [Path(sys.argv.pop(1)).resolve() for _ in range(2)]
    unittest.main()
