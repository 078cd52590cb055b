#!/usr/bin/python3
"""The module beside h5py in one process, and what it leaves behind."""

import contextlib
import importlib.util
import resource
import subprocess
import sys
import unittest

import clearway
import numpy as np
from scene import SceneTest

READ_WITH_BOTH = """
import {first}, {second}
import gc, sys
import numpy as np
with h5py.File(sys.argv[1]) as file:
    result = clearway.Result(sys.argv[1])  # while h5py has it open
    assert np.array_equal(file["collisions/source"][:], result.source())
    other = h5py.File(sys.argv[1])  # and the other way round
    assert np.array_equal(other["collisions/xyz"][:], result.xyz())
del result
gc.collect()
assert np.array_equal(other["collisions/source"][:], clearway.Result(sys.argv[1]).source())
for opened, kind in ((h5py.File, OSError), (clearway.Result, clearway.InputError)):
    try:
        opened(sys.argv[2])
    except kind:
        print("bad")
"""


@unittest.skipUnless(importlib.util.find_spec("h5py"), "h5py is not installed")
class BesideH5py(SceneTest):
    def test_both_orders_of_import(self):
        self.search(query=self.query(first_pose=True))
        result, bad = self.folder / "out.h5", self.folder / "bad.h5"
        bad.write_bytes(result.read_bytes()[:-100])
        for first, second in (("h5py", "clearway"), ("clearway", "h5py")):
            done = subprocess.run([sys.executable, "-c", READ_WITH_BOTH.format(first=first, second=second), result, bad],
                                  capture_output=True, text=True, check=False)
            self.assertEqual((done.stdout, done.stderr), ("bad\nbad\n", ""))


class LeavesNothingBehind(SceneTest):
    def test_many_small_reads(self):
        self.search(query=self.query(first_pose=True, clearance=1.0, profile=1.0))
        query, poses = self.query(), np.tile(self.poses, (20, 1, 1)).astype("float32")

        def grown_over(repeats):
            before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
            for _ in range(repeats):
                result = clearway.Result(self.folder / "out.h5")
                result.source(), result.xyz(), result.first_pose(), result.clearance().xyz
                result.profile().xyz, result.model_box()
                clearway.Store(self.folder / "site.h5").box()
                query.poses = poses
                with contextlib.suppress(clearway.ResourceError):
                    clearway.Store("there/is/none")
            return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before

        grown_over(100)
        # KiB; leaking the smallest column of each call would be more.
        self.assertLess(grown_over(1500), 1000)


if __name__ == "__main__":
    unittest.main()
