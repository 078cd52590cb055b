#!/usr/bin/python3
"""Sessions of the Python module: the same answers as search(), arrays without a copy, threads."""

import gc
import os
import shutil
import signal
import struct
import threading
import unittest

import clearway
import numpy as np
from scene import RADIUS, SceneTest, first_poses, poses_along_x

# The two triangles of a square with four corners.
SQUARE = [[0, 1, 2], [0, 2, 3]]


class Sessions(SceneTest):
    def setUp(self):
        self.session = clearway.Session(self.folder / "site.h5", threads=2, device="cpu")
        self.addCleanup(self.session.close)

    def at(self, x, model=None, **parameters):
        """The query of one pose."""
        pose = np.eye(4)[None].copy()
        pose[0, 0, 3] = x
        model = self.model if model is None else model
        return clearway.Query(model, pose, RADIUS, **parameters)


class SameAsSearch(Sessions):
    """What a session answers is what search() writes."""

    def assert_columns(self, found, expected, names):
        self.assertEqual(found is None, expected is None)
        if found is None:
            return
        self.assertEqual(len(found), len(expected))
        for name in names:
            one, other = getattr(found, name), getattr(expected, name)
            self.assertEqual(one is None, other is None, name)
            if one is not None:
                self.assertEqual((one.dtype, one.shape), (other.dtype, other.shape), name)
                np.testing.assert_array_equal(one, other, name)

    def check(self, query, store="site.h5", **options):
        """Returns the answer of the session, whose every part was compared."""
        output, saved = self.folder / "out.h5", self.folder / "saved.h5"
        report = clearway.search(clearway.Store(self.folder / store), query, output, device="cpu",
                                 threads=2, overwrite=True, **options)
        session = self.session
        if store != "site.h5":
            session = clearway.Session(self.folder / store, threads=2, device="cpu")
            self.addCleanup(session.close)
        answer = session.search(query, **options)
        self.assertIsInstance(answer, clearway.Answer)
        self.assertIsInstance(answer, clearway.SearchReport)
        for name in ("verdict", "reasons", "doubts", "warned_of", "colliding_points",
                     "near_points", "certain_points", "clearance_points", "inside_points",
                     "profile_poses", "model_points", "model_triangles", "model_solids", "poses",
                     "ignored_colliding", "ignored_colliding_high", "margins", "device"):
            self.assertEqual(getattr(answer, name), getattr(report, name), name)
        self.assertEqual([(w.code, w.text) for w in answer.warnings],
                         [(w.code, w.text) for w in report.warnings])
        result = clearway.Result(output)
        common = ("source", "xyz")
        self.assert_columns(answer.collisions, result.collisions(),
                            (*common, "first_pose", "last_pose", "body", "certain"))
        self.assert_columns(answer.near, result.near(), (*common, "first_pose", "body"))
        self.assert_columns(answer.clearances, result.clearance(),
                            (*common, "distance", "pose", "body"))
        self.assert_columns(answer.profile, result.profile(), (*common, "distance", "chainage"))
        self.assert_columns(answer.unseen, result.unseen(), ("cube", "first_pose", "group"))
        answer.save(saved, overwrite=True)
        self.assertEqual(saved.read_bytes(), output.read_bytes())
        return answer

    def test_points(self):
        expected = first_poses(self.points, self.model, self.poses, RADIUS)
        for engine in ("sweep", "kdtree", "grid"):
            with self.subTest(engine):
                answer = self.check(self.query(), engine=engine)
                np.testing.assert_array_equal(answer.collisions.source,
                                              np.flatnonzero(expected >= 0))
                self.assertIsNone(answer.collisions.first_pose)
                self.assertIsNone(answer.first)
                self.assertIsNone(answer.least)
        answer = self.check(self.query(first_pose=True))
        first = answer.collisions.first_pose
        np.testing.assert_array_equal(first, expected[expected >= 0])
        self.assertEqual(answer.first.pose, first.min())
        self.assertEqual(answer.first.source, answer.collisions.source[first.argmin()])

    def test_clearances_and_profile(self):
        answer = self.check(self.query(first_pose=True, clearance=0.5, profile=0.4))
        self.assertEqual(answer.least.distance, answer.profile.distance.min())
        self.assertEqual(answer.least.distance, answer.clearances.distance.min())
        answer = self.check(self.at(3, clearance=0.5))
        place = answer.clearances.distance.argmin()
        self.assertEqual(answer.least.source, answer.clearances.source[place])

    def test_between_poses(self):
        self.check(self.query(first_pose=True, between_poses=True))

    def test_a_surface_and_a_solid(self):
        square = clearway.Model([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], SQUARE)
        self.check(clearway.Query(square, self.poses, RADIUS, first_pose=True, clearance=0.5))
        box = clearway.box_model(1, 0.8, 0.6)
        answer = self.check(clearway.Query(box, self.poses, RADIUS, first_pose=True,
                                           clearance=0.3, profile=0.3))
        self.assertGreater(answer.inside_points, 0)
        self.assertLess(answer.least.distance, 0)

    def test_bodies(self):
        front = clearway.follow("front", self.model, self.poses, at=0.5)
        rear = clearway.follow("rear", clearway.box_model(0.5, 0.5, 0.5), self.poses,
                               pivots=(0.4, -0.4))
        answer = self.check(clearway.Query(poses=self.poses, radius=RADIUS, first_pose=True,
                                           bodies=[front, rear], clearance=0.4, profile=0.3))
        self.assertEqual(set(np.unique(answer.collisions.body)), {0, 1})
        self.assertEqual(len(answer.clearances.body), len(answer.clearances))

    def test_an_error_budget(self):
        answer = self.check(self.query(first_pose=True, error_scan=0, error_model=0.02))
        self.assertGreater(len(answer.near), 0)
        self.assertEqual(answer.collisions.certain.dtype, bool)
        self.assertIsNone(answer.near.certain)
        self.assertEqual(answer.collisions.certain.sum(), answer.certain_points)

    def test_ignored_points(self):
        answer = self.check(self.query(ignore_boxes=[clearway.Box((0, -1, -1), (3, 1, 1))]))
        self.assertGreater(answer.ignored_colliding, 0)
        head = bytearray(227)
        struct.pack_into("<4s2xH16xBB", head, 0, b"LASF", 0, 1, 2)
        struct.pack_into("<HIIBHI", head, 94, 227, 227, 0, 0, 20, len(self.points))
        bounds = np.stack([self.points.max(0), self.points.min(0)], 1)
        struct.pack_into("<12d", head, 131, *[0.001] * 3, *[0] * 3, *bounds.ravel())
        (self.folder / "classes.las").write_bytes(head + b"".join(
            struct.pack("<3i3xB4x", *q, 2 + i % 3)
            for i, q in enumerate(np.rint(1000 * self.points).astype(int))))
        clearway.convert(self.folder / "classes.las", self.folder / "classes.h5", unit="m")
        answer = self.check(self.query(ignore_classes=[2]), "classes.h5")
        self.assertTrue((answer.collisions.source % 3 != 0).all())

    def test_seen_space(self):
        (self.folder / "origins.csv").write_text("first,x,y,z\n0,3,0,0\n")
        clearway.convert(self.folder / "scan.xyz", self.folder / "seen.h5",
                         origins=self.folder / "origins.csv")
        answer = self.check(self.query(seen=True, seen_cube=0.3), "seen.h5")
        self.assertGreater(len(answer.unseen), 0)
        self.assertEqual(answer.unseen.cube.shape, (answer.seen.unseen, 3))

    def test_nothing_found(self):
        answer = self.check(self.at(500, first_pose=True, clearance=0.3, profile=0.3))
        self.assertEqual(answer.verdict, "undecided")
        self.assertEqual(answer.collisions.xyz.shape, (0, 3))
        self.assertEqual(len(answer.clearances), 0)
        self.assertEqual(answer.profile.distance[0], np.inf)

    def test_one_after_the_other(self):
        """What a question left behind does not change the next one."""
        box = clearway.Model(clearway.box_model(1, 1, 1).vertices)
        model = clearway.Model(self.model)
        for x in np.linspace(-1, 7, 9):
            for one in (box, model, self.model):
                self.check(self.at(x, one, first_pose=True, clearance=0.4))
            self.check(self.at(x, model, profile=0.3 + x / 100))


class Arrays(Sessions):
    def answer(self):
        return self.session.search(
            self.query(first_pose=True, clearance=0.5, profile=0.4, error_scan=0.01))

    def columns(self, answer):
        for name in ("collisions", "near", "clearances", "profile"):
            table = getattr(answer, name)
            for column in dir(table):
                value = getattr(table, column)
                if not column.startswith("_") and isinstance(value, np.ndarray):
                    yield f"{name}.{column}", value

    def test_they_are_made_without_a_copy(self):
        answer = self.answer()
        one, other = dict(self.columns(answer)), dict(self.columns(answer))
        self.assertEqual(len(one), 21)
        for name, array in one.items():
            if array.size == 0:  # body, where there are no bodies
                continue
            self.assertFalse(array.flags.owndata, name)
            self.assertEqual(array.ctypes.data, other[name].ctypes.data, name)
            base = array.base
            while isinstance(base, np.ndarray):
                base = base.base
            self.assertIs(base, answer, name)

    def test_they_cannot_be_written_to(self):
        for name, array in self.columns(self.answer()):
            self.assertFalse(array.flags.writeable, name)
            with self.assertRaises(ValueError):
                array[...] = 0
            if array.size > 0:
                with self.assertRaises(ValueError):
                    array.flags.writeable = True

    def test_they_outlive_answer_and_session(self):
        answer = self.answer()
        arrays = dict(self.columns(answer))
        expected = {name: array.copy() for name, array in arrays.items()}
        del answer
        self.session.close()
        gc.collect()
        other = [np.full(100_000, 7.0) for _ in range(20)]
        for name, array in arrays.items():
            np.testing.assert_array_equal(array, expected[name], name)
        self.assertEqual(len(other), 20)

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
        self.session.search(self.at(3, model), engine="sweep")
        kept = self.session.kept_bytes()
        self.assertGreater(kept, 2 * model.vertices.nbytes)  # with a tree and a field
        for x in (2, 4, 3):
            self.session.search(self.at(x, model), engine="sweep")
        self.assertEqual(self.session.kept_bytes(), kept)
        self.session.forget_models()
        self.assertEqual(self.session.kept_bytes(), 0)
        self.session.search(self.at(3, model), engine="sweep")
        self.assertEqual(self.session.kept_bytes(), kept)

    def test_many_questions_take_no_more_memory(self):
        def resident_bytes():
            with open("/proc/self/statm", encoding="ascii") as file:
                return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")

        model = clearway.Model(np.random.default_rng(3).uniform(-0.4, 0.4, (20_000, 3)))
        for i in range(2000):
            answer = self.session.search(self.at(i % 50 / 10, model, clearance=0.3))
            self.assertEqual(len(answer.clearances), answer.clearance_points)
            if i == 300:
                before = resident_bytes()
        self.assertLess(resident_bytes() - before, 4 << 20)


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
        report = clearway.search(store, self.query(), self.folder / "out.h5", overwrite=True)
        self.assertEqual(report.colliding_points, answer.colliding_points)

    def test_an_error_closes_it(self):
        with self.assertRaises(LookupError), clearway.Session(self.folder / "site.h5") as session:
            raise LookupError
        self.assertTrue(session.closed)

    def test_what_cannot_be_opened(self):
        with self.assertRaises(clearway.Error):
            clearway.Session(self.folder / "none.h5")
        with self.assertRaises(clearway.InputError):
            clearway.Session(self.folder / "scan.xyz")
        with self.assertRaisesRegex(clearway.UsageError, "^device 'tpu'"):
            clearway.Session(self.folder / "site.h5", device="tpu")
        with self.assertRaisesRegex(clearway.UsageError, "^threads: expected 0"):
            clearway.Session(self.folder / "site.h5", threads=-1)
        with self.assertRaisesRegex(TypeError, "did you mean 'memory_bytes'"):
            clearway.Session(self.folder / "site.h5", memory=1)

    def test_questions_that_are_refused_leave_it_as_it_was(self):
        good = self.session.search(self.query())
        query = self.query()
        for name, value, said in (("poses", np.full((1, 4, 4), 2.0), "pose 0"),):
            with self.assertRaisesRegex(clearway.UsageError, said):
                setattr(query, name, value)
        query.poses = np.diag((2.0, 2, 2, 1))[None]
        with self.assertRaisesRegex(clearway.InputError, "not a rotation"):
            self.session.search(query)
        with self.assertRaisesRegex(clearway.UsageError, "^radius: the query has none"):
            self.session.search(clearway.Query(self.model, self.poses))
        with self.assertRaisesRegex(clearway.UsageError, "^engine 'best'"):
            self.session.search(self.query(), engine="best")
        with self.assertRaisesRegex(TypeError, "^query: expected a clearway.Query"):
            self.session.search(self.model)
        with self.assertRaises(clearway.InputError):
            self.session.search(self.at(500), strict=True)
        with self.assertRaisesRegex(clearway.UsageError, "have no classes"):
            self.session.search(self.query(ignore_classes=[2]))
        again = self.session.search(self.query())
        np.testing.assert_array_equal(again.collisions.source, good.collisions.source)

    def test_save_refuses_existing_files_and_the_store(self):
        answer = self.session.search(self.query())
        output = self.folder / "once.h5"
        answer.save(output)
        with self.assertRaises(clearway.UsageError) as raised:
            answer.save(output)
        self.assertEqual(raised.exception.remedy, "overwrite")
        before = (self.folder / "site.h5").read_bytes()
        with self.assertRaisesRegex(clearway.UsageError, "is an input too"):
            answer.save(self.folder / "site.h5", overwrite=True)
        self.assertEqual((self.folder / "site.h5").read_bytes(), before)
        with self.assertRaises(clearway.ResourceError):
            answer.save(self.folder / "none" / "out.h5")

    def test_a_replaced_store_is_noticed(self):
        path = self.folder / "replaced.h5"
        shutil.copy(self.folder / "site.h5", path)
        session = clearway.Session(path)
        self.addCleanup(session.close)
        answer = session.search(self.query())
        np.savetxt(self.folder / "other.xyz", self.points + 1, "%.3f")
        clearway.convert(self.folder / "other.xyz", path, overwrite=True)
        with self.assertRaisesRegex(clearway.InputError, "replaced.h5"):
            session.search(self.query())
        with clearway.Session(path) as renewed:
            self.assertNotEqual(renewed.search(self.query()).colliding_points,
                                answer.colliding_points)


class Threads(Sessions):
    def test_eight_threads_at_once(self):
        shared = clearway.Model(self.model)
        queries = [self.at(x, shared if i % 2 else clearway.box_model(0.5, 0.4, 0.3 + i / 100),
                           first_pose=True, clearance=0.4)
                   for i, x in enumerate(np.linspace(-1, 7, 24))]
        expected = [self.session.search(query) for query in queries]
        self.assertTrue(any(len(answer.collisions) for answer in expected))
        wrong = []

        def ask(begin):
            for i in range(len(queries)):
                i = (i + begin) % len(queries)
                answer = self.session.search(queries[i])
                same = np.array_equal(answer.collisions.source, expected[i].collisions.source)
                near, other = answer.clearances, expected[i].clearances
                if not (same and np.array_equal(near.distance, other.distance)):
                    wrong.append(i)

        threads = [threading.Thread(target=ask, args=(3 * begin,)) for begin in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(wrong, [])

    def test_other_threads_run_during_a_question(self):
        counted = 0

        def count():
            nonlocal counted
            while counted < 1_000_000:
                counted += 1

        class Counted:
            @staticmethod
            def is_set():
                return counted == 1_000_000

        counter = threading.Thread(target=count)
        counter.start()
        # The question ends only because the other thread comes to its end.
        with self.assertRaises(clearway.Interrupted):
            self.session.search(self.slow_query(), engine="grid", stop=Counted)
        counter.join()

    def test_keyboard_interrupt_leaves_it_usable(self):
        expected = self.session.search(self.query())
        sent = []

        def interrupt(update):
            if update.stage == "search" and not sent:
                threading.Timer(0.1, os.kill, (os.getpid(), signal.SIGINT)).start()
                sent.append(1)

        with self.assertRaises(KeyboardInterrupt):
            self.session.search(self.slow_query(), engine="grid", progress=interrupt)
        answer = self.session.search(self.query())
        np.testing.assert_array_equal(answer.collisions.source, expected.collisions.source)

    def test_closing_lets_questions_end(self):
        begun = threading.Event()
        stop = threading.Event()
        raised = []

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

    def test_what_a_callback_raises_comes_out(self):
        def progress(update):
            raise LookupError("mine")

        with self.assertRaisesRegex(LookupError, "mine"):
            self.session.search(self.slow_query(), engine="grid", progress=progress)
        told = []
        answer = self.session.search(self.at(500), message=told.append)
        self.assertEqual([m.code for m in told if m.severity == "warning"],
                         [w.code for w in answer.warnings])

    def test_a_forked_process_asks_too(self):
        expected = self.session.search(self.query()).colliding_points
        child = os.fork()
        if child == 0:
            found = -1
            try:
                found = self.session.search(self.query()).colliding_points
            finally:
                os._exit(0 if found == expected else 1)
        self.assertEqual(os.waitpid(child, 0)[1], 0)


if __name__ == "__main__":
    unittest.main()
