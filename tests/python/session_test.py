#!/usr/bin/python3
"""Sessions of the Python module: the same answers as search(), arrays without a copy, threads."""

import gc
import os
import shutil
import threading
import unittest

import clearway
import numpy as np
from scene import RADIUS, SceneTest, run_together


class Sessions(SceneTest):
    def setUp(self):
        self.session = clearway.Session(self.folder / "site.h5", threads=2, device="cpu")
        self.addCleanup(self.session.close)

    def at(self, x, model=None, **parameters):
        """The query of one pose."""
        pose = np.eye(4)[None].copy()
        pose[0, 0, 3] = x
        return clearway.Query(self.model if model is None else model, pose, RADIUS, **parameters)


class SameAsSearch(Sessions):
    """What a session answers is what search() writes."""

    def check(self, query, store="site.h5", **options):
        """Returns the answer of the session, whose every part was compared."""
        output, saved = self.folder / "out.h5", self.folder / "saved.h5"
        report = clearway.search(clearway.Store(self.folder / store), query, output, device="cpu",
                                 threads=2, overwrite=True, **options)
        with clearway.Session(self.folder / store, threads=2, device="cpu") as session:
            answer = session.search(query, **options)
        self.assertIsInstance(answer, clearway.SearchReport)
        for name in ("verdict", "reasons", "doubts", "warned_of", "colliding_points", "near_points",
                     "certain_points", "clearance_points", "inside_points", "margins", "device"):
            self.assertEqual(getattr(answer, name), getattr(report, name), name)
        self.assertEqual([(w.code, w.text) for w in answer.warnings],
                         [(w.code, w.text) for w in report.warnings])
        result = clearway.Result(output)
        for name, table in (("collisions", result.collisions()), ("near", result.near()),
                            ("clearances", result.clearance()), ("profile", result.profile()),
                            ("unseen", result.unseen())):
            found = getattr(answer, name)
            self.assertEqual(found is None, table is None, name)
            for column in (c for c in dir(table) if table is not None and c[0] != "_" and c != "NO_POINT"):
                one, other = getattr(found, column), getattr(table, column)
                np.testing.assert_array_equal(one, other, column)
                self.assertEqual((type(one), getattr(one, "dtype", 0)), (type(other), getattr(other, "dtype", 0)))
        answer.save(saved, overwrite=True)
        self.assertEqual(saved.read_bytes(), output.read_bytes())
        return answer

    def test_a_set_has_no_other_columns(self):
        for engine in ("sweep", "kdtree", "grid"):
            answer = self.check(self.query(), engine=engine)
            self.assertEqual((answer.collisions.first_pose, answer.first, answer.least), (None,) * 3)

    def test_first_poses_clearances_and_a_profile(self):
        answer = self.check(self.query(first_pose=True, clearance=0.5, profile=0.4))
        first = answer.collisions.first_pose
        self.assertEqual((answer.first.pose, answer.first.source),
                         (first.min(), answer.collisions.source[first.argmin()]))
        self.assertEqual({answer.least.distance}, {answer.profile.distance.min(),
                                                   answer.clearances.distance.min()})
        self.check(self.query(first_pose=True, between_poses=True,
                              ignore_boxes=[clearway.Box((0, -1, -1), (3, 1, 1))]))

    def test_a_solid_and_bodies(self):
        box = clearway.box_model(1, 0.8, 0.6)
        answer = self.check(clearway.Query(box, self.poses, RADIUS, first_pose=True,
                                           clearance=0.3, profile=0.3))
        self.assertGreater(answer.inside_points, 0)
        self.assertLess(answer.least.distance, 0)
        bodies = [clearway.follow("front", self.model, self.poses, at=0.5),
                  clearway.follow("rear", clearway.box_model(0.5, 0.5, 0.5), self.poses,
                                  pivots=(0.4, -0.4))]
        answer = self.check(clearway.Query(poses=self.poses, radius=RADIUS, first_pose=True,
                                           bodies=bodies, clearance=0.4, profile=0.3))
        self.assertEqual(set(np.unique(answer.collisions.body)), {0, 1})

    def test_errors_and_seen_space(self):
        answer = self.check(self.query(first_pose=True, error_scan=0, error_model=0.02))
        self.assertGreater(len(answer.near), 0)
        self.assertEqual(answer.collisions.certain.sum(), answer.certain_points)
        (self.folder / "origins.csv").write_text("first,x,y,z\n0,3,0,0\n")
        clearway.convert(self.folder / "scan.xyz", self.folder / "seen.h5",
                         origins=self.folder / "origins.csv")
        answer = self.check(self.query(seen=True, seen_cube=0.3), "seen.h5")
        self.assertGreater(len(answer.unseen), 0)
        self.assertEqual(answer.unseen.cube.shape, (answer.seen.unseen, 3))

    def test_nothing_found(self):
        answer = self.check(self.at(500, first_pose=True, clearance=0.3, profile=0.3))
        self.assertEqual((answer.verdict, answer.collisions.xyz.shape, answer.profile.distance[0]),
                         ("undecided", (0, 3), np.inf))


class Arrays(Sessions):
    def answer(self):
        return self.session.search(
            self.query(first_pose=True, clearance=0.5, profile=0.4, error_scan=0.01))

    def columns(self, answer):
        return {f"{name}.{column}": value
                for name in ("collisions", "near", "clearances", "profile")
                for column in dir(getattr(answer, name)) if not column.startswith("_")
                if isinstance(value := getattr(getattr(answer, name), column), np.ndarray)}

    def test_they_are_parts_of_the_answer_that_nobody_may_write_to(self):
        answer = self.answer()
        one, other = self.columns(answer), self.columns(answer)
        self.assertEqual(len(one), 21)
        for name, array in one.items():
            self.assertFalse(array.flags.writeable, name)
            with self.assertRaises(ValueError):
                array[...] = 0
            if array.size == 0:  # body, where there are no bodies
                continue
            with self.assertRaises(ValueError):
                array.flags.writeable = True
            self.assertFalse(array.flags.owndata, name)
            self.assertEqual(array.ctypes.data, other[name].ctypes.data, name)
            base = array.base
            while isinstance(base, np.ndarray):
                base = base.base
            self.assertIs(base, answer, name)

    def test_they_outlive_answer_and_session(self):
        answer = self.answer()
        arrays = self.columns(answer)
        expected = {name: array.copy() for name, array in arrays.items()}
        del answer
        self.session.close()
        gc.collect()
        self.assertEqual(len([np.full(100_000, 7.0) for _ in range(20)]), 20)  # would take freed memory
        for name, array in arrays.items():
            np.testing.assert_array_equal(array, expected[name], name)

    def test_the_model_may_change_between_questions(self):
        model = self.model.copy()
        query = self.at(3, model)
        self.assertGreater(self.session.search(query).colliding_points, 0)
        model += 100
        self.assertEqual(self.session.search(query).colliding_points, 0)
        query.model = self.model
        self.assertGreater(self.session.search(query).colliding_points, 0)

    def test_a_model_is_kept_once(self):
        model = clearway.Model(np.random.default_rng(2).uniform(-0.4, 0.4, (50_000, 3)))
        self.session.search(self.at(3, model))
        kept = self.session.kept_bytes()
        self.assertGreater(kept, 2 * model.vertices.nbytes)  # with a tree and a field
        self.session.search(self.at(2, model))
        self.assertEqual(self.session.kept_bytes(), kept)
        self.session.forget_models()
        self.assertEqual(self.session.kept_bytes(), 0)

    def test_many_questions_take_no_more_memory(self):
        def resident_bytes():
            with open("/proc/self/statm", encoding="ascii") as file:
                return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")

        model = clearway.Model(np.random.default_rng(3).uniform(-0.4, 0.4, (20_000, 3)))
        for i in range(1200):
            answer = self.session.search(self.at(i % 50 / 10, model, clearance=0.3))
            self.assertEqual(len(answer.clearances), answer.clearance_points)
            if i == 300:
                before = resident_bytes()
        self.assertLess(resident_bytes() - before, 3 << 20)


class Lifetime(Sessions):
    def test_a_closed_session_says_so(self):
        with clearway.Session(self.folder / "site.h5") as session:
            self.assertFalse(session.closed)
            self.assertIn("2000 points", repr(session))
            answer, store = session.search(self.query()), session.store
        self.assertTrue(session.closed)
        self.assertIn("closed", repr(session))
        for ask in (lambda: session.search(self.query()), lambda: session.store,
                    session.forget_models, session.kept_bytes, session.__enter__):
            with self.assertRaisesRegex(clearway.UsageError, "session of .*site.h5 is closed"):
                ask()
        session.close()
        self.assertGreater(len(answer.collisions), 0)
        self.assertEqual(store.point_count(), 2000)
        with self.assertRaises(LookupError), clearway.Session(self.folder / "site.h5") as session:
            raise LookupError
        self.assertTrue(session.closed)

    def test_refusals_leave_it_as_it_was(self):
        stretched, site, once = self.query(), self.folder / "site.h5", self.folder / "once.h5"
        stretched.poses = np.diag((2.0, 2, 2, 1))[None]
        before, answer = site.read_bytes(), self.session.search(self.query())
        answer.save(once)
        for kind, words, call, *args, named in (
                (clearway.Error, "none.h5", clearway.Session, self.folder / "none.h5", {}),
                (clearway.InputError, "scan.xyz", clearway.Session, self.folder / "scan.xyz", {}),
                (clearway.UsageError, "^device 'tpu'", clearway.Session, site, {"device": "tpu"}),
                (clearway.UsageError, "^threads: expected 0", clearway.Session, site, {"threads": -1}),
                (TypeError, "did you mean 'memory_bytes'", clearway.Session, site, {"memory": 1}),
                (clearway.InputError, "not a rotation", self.session.search, stretched, {}),
                (clearway.UsageError, "^engine 'best'", self.session.search, self.query(), {"engine": "best"}),
                (TypeError, "^query: expected a clearway.Query", self.session.search, self.model, {}),
                (clearway.InputError, "", self.session.search, self.at(500), {"strict": True}),
                (clearway.UsageError, "is an input too", answer.save, site, {"overwrite": True}),
                (clearway.ResourceError, "none", answer.save, self.folder / "none" / "out.h5", {}),
                (clearway.UsageError, "once.h5", answer.save, once, {})):
            with self.subTest(words), self.assertRaisesRegex(kind, words) as caught:
                call(*args, **named)
        self.assertEqual((caught.exception.remedy, site.read_bytes()), ("overwrite", before))
        np.testing.assert_array_equal(self.session.search(self.query()).collisions.source, answer.collisions.source)

    def test_a_replaced_store_is_noticed(self):
        path = self.folder / "replaced.h5"
        shutil.copy(self.folder / "site.h5", path)
        with clearway.Session(path) as session:
            np.savetxt(self.folder / "other.xyz", self.points + 1, "%.3f")
            clearway.convert(self.folder / "other.xyz", path, overwrite=True)
            with self.assertRaisesRegex(clearway.InputError, "replaced.h5"):
                session.search(self.query())


class Threads(Sessions):
    def test_eight_threads_at_once(self):
        shared = clearway.Model(self.model)
        queries = [self.at(x, shared if i % 2 else clearway.box_model(0.5, 0.4, 0.3 + i / 100),
                           first_pose=True, clearance=0.4)
                   for i, x in enumerate(np.linspace(-1, 7, 24))]

        def ask(query):
            answer = self.session.search(query)
            return answer.collisions.source.tolist(), answer.clearances.distance.tolist()

        expected = [ask(query) for query in queries]
        self.assertTrue(any(sources for sources, _ in expected))
        wrong = []

        def ask_all(begin):
            order = [*range(begin, 24), *range(begin)]
            wrong.extend(i for i in order if ask(queries[i]) != expected[i])

        run_together([lambda begin=begin: ask_all(3 * begin) for begin in range(8)])
        self.assertEqual(wrong, [])

    def test_closing_lets_a_question_end_that_another_thread_stops(self):
        begun, stop, raised = threading.Event(), threading.Event(), []

        def ask():
            try:
                self.session.search(self.slow_query(), engine="grid", stop=stop,
                                    progress=lambda update: begun.set())
            except clearway.Interrupted as error:
                raised.append(error)

        thread = threading.Thread(target=ask)
        thread.start()
        begun.wait()
        self.session.close()
        with self.assertRaises(clearway.UsageError):
            self.session.search(self.query())
        self.assertTrue(thread.is_alive())
        stop.set()
        thread.join()
        self.assertEqual(len(raised), 1)

    def test_what_a_callback_raises_comes_out_and_a_forked_process_asks_too(self):
        def raising(update):
            raise LookupError("mine")

        with self.assertRaises(LookupError):
            self.session.search(self.slow_query(), engine="grid", progress=raising)
        told = []
        answer = self.session.search(self.at(500), message=told.append)
        self.assertEqual([m.code for m in told if m.severity == "warning"], [w.code for w in answer.warnings])
        expected = self.session.search(self.query()).colliding_points
        child = os.fork()
        if child == 0:
            try:
                os._exit(0 if self.session.search(self.query()).colliding_points == expected else 1)
            finally:
                os._exit(2)
        self.assertEqual(os.waitpid(child, 0)[1], 0)


if __name__ == "__main__":
    unittest.main()
