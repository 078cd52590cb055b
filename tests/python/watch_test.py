#!/usr/bin/python3
"""Progress, stopping and threads of the Python module."""

import os
import signal
import subprocess
import sys
import threading
import types
import unittest
from pathlib import Path

import clearway
import numpy as np
from scene import SceneTest, run_together


class Watching(SceneTest):
    def test_progress_and_messages(self):
        updates, messages, threads, query = [], [], set(), self.query()

        def progress(update):
            threads.add(threading.get_ident())
            updates.append((update.done == update.total, update.finished))

        query.poses = query.poses[::5]
        report = self.search(query=query, progress=progress, message=messages.append)
        self.assertEqual(threads, {threading.get_ident()})
        self.assertIn((True, True), updates)
        self.assertEqual([m.code for m in messages if m.severity == "warning"], [w.code for w in report.warnings])
        [steps] = [w for w in report.warnings if w.code == "large-steps"]
        self.assertIn(steps.text, [m.text for m in messages])
        self.assertEqual({type(x) for x in steps.numbers.values()}, {float})

    def test_stop_and_resume(self):
        with self.assertRaises(TypeError):
            self.search(progress=3)
        whole, part, stop = self.folder / "whole.h5", self.folder / "part.h5", threading.Event()
        self.assertGreater(self.search("whole.h5").colliding_points, 0)
        stop.set()
        with self.assertRaises(clearway.Interrupted):
            self.search("part.h5", stop=stop)
        self.assertFalse(part.exists())
        clearway.search(clearway.Store(self.folder / "site.h5"), self.query(), part, resume=True)
        self.assertEqual(part.read_bytes(), whole.read_bytes())
        with self.assertRaises(clearway.Interrupted):
            clearway.convert(self.folder / "scan.xyz", part, stop=stop, overwrite=True)

    def test_other_threads_run_during_a_search(self):
        counted = 0

        def count():
            nonlocal counted
            while counted < 1_000_000:
                counted += 1

        counter = threading.Thread(target=count)
        counter.start()
        # The search ends only because the other thread comes to its end.
        with self.assertRaises(clearway.Interrupted):
            self.search("slow.h5", self.slow_query(), engine="grid", threads=1,
                        stop=types.SimpleNamespace(is_set=lambda: counted == 1_000_000))
        counter.join()

    def test_keyboard_interrupt(self):
        def interrupt(update):
            if update.stage == "search":
                threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
                interrupt.sent = True

        with self.assertRaises(KeyboardInterrupt):
            self.search("slow.h5", self.slow_query(), engine="grid", threads=1,
                        progress=lambda u: None if hasattr(interrupt, "sent") else interrupt(u))
        self.assertFalse((self.folder / "slow.h5").exists())

    def test_python_ends_during_a_search(self):
        script = (
            "import sys, threading; sys.path.insert(0, sys.argv[1])\n"
            "import scene\n"
            "scene.SceneTest.setUpClass()\n"
            "begun, test = threading.Event(), scene.SceneTest()\n"
            "def search():\n"
            "    test.search('out.h5', test.slow_query(), engine='grid', threads=1,\n"
            "                progress=lambda update: begun.set())\n"
            "threading.excepthook = lambda args: print(args.exc_type.__name__)\n"
            "threading.Thread(target=search, daemon=True).start()\n"
            "begun.wait()\n"
            "print('the end')\n"
            "scene.SceneTest.doClassCleanups()\n")
        done = subprocess.run([sys.executable, "-c", script, Path(__file__).parent],
                              capture_output=True, text=True, check=False, timeout=100)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        self.assertEqual(done.stdout.split("\n")[0], "the end")

    def test_threads_that_read_one_result(self):
        self.search(query=self.query(first_pose=True))
        result = clearway.Result(self.folder / "out.h5")
        expected, wrong = result.source(), []

        def read():
            for _ in range(50):
                if not np.array_equal(result.source(), expected) or len(result.xyz()) != len(result):
                    wrong.append(1)

        run_together([read] * 4)
        self.assertFalse(wrong)


if __name__ == "__main__":
    unittest.main()
