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
        updates, messages, threads = [], [], set()

        def progress(update):
            threads.add(threading.get_ident())
            updates.append((update.stage, update.done, update.total, update.finished))

        query = self.query()
        query.poses = query.poses[::5]
        report = self.search(query=query, progress=progress, message=messages.append)
        self.assertEqual(threads, {threading.get_ident()})
        self.assertTrue(updates)
        self.assertTrue(any(finished and done == total for _, done, total, finished in updates))
        self.assertEqual([m.code for m in messages if m.severity == "warning"],
                         [w.code for w in report.warnings])
        steps = [w for w in report.warnings if w.code == "large-steps"]
        self.assertEqual(len(steps), 1)
        self.assertIn(steps[0].text, [m.text for m in messages])
        self.assertTrue(all(isinstance(x, float) for x in steps[0].numbers.values()))
        self.assertTrue(steps[0].numbers)

    def test_stop_and_resume(self):
        with self.assertRaises(TypeError):
            self.search(progress=3)
        expected = self.search("whole.h5")
        self.assertGreater(expected.colliding_points, 0)
        stop = threading.Event()
        stop.set()
        with self.assertRaises(clearway.Interrupted):
            self.search("part.h5", stop=stop)
        self.assertFalse((self.folder / "part.h5").exists())
        store = clearway.Store(self.folder / "site.h5")
        clearway.search(store, self.query(), self.folder / "part.h5", resume=True)
        self.assertEqual((self.folder / "part.h5").read_bytes(),
                         (self.folder / "whole.h5").read_bytes())
        with self.assertRaises(clearway.Interrupted):
            clearway.convert(self.folder / "scan.xyz", self.folder / "part.h5", stop=stop,
                             overwrite=True)

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

    def test_a_forked_process_searches_too(self):
        self.search("parent.h5")
        child = os.fork()
        if child == 0:
            try:
                self.search("child.h5")
                os._exit(0)
            finally:
                os._exit(1)
        self.assertEqual(os.waitpid(child, 0)[1], 0)
        self.assertEqual((self.folder / "child.h5").read_bytes(),
                         (self.folder / "parent.h5").read_bytes())


if __name__ == "__main__":
    unittest.main()
