#!/usr/bin/python3
"""Arrays and errors of the Python module."""

import inspect
import os
import unittest
from pathlib import Path

import clearway
import numpy as np
from scene import SceneTest


class Arrays(SceneTest):
    def sources(self, **changed):
        query = self.query()
        for name, value in changed.items():
            setattr(query, name, value)
        self.search(query=query)
        return clearway.Result(self.folder / "out.h5").source()

    def test_any_layout_and_type_of_real_numbers_gives_the_same(self):
        expected = self.sources()
        wide, frozen = np.zeros((40, 6)), self.model.copy()
        wide[::2, ::2] = self.model
        frozen.flags.writeable = False
        for model in (np.asfortranarray(self.model), wide[::2, ::2], frozen, self.model.tolist(),
                      self.model[::-1][::-1], self.model.astype(">f8"), self.model.astype("longdouble")):
            np.testing.assert_array_equal(self.sources(model=model), expected)
        for poses in (self.poses[:, :3], np.asfortranarray(self.poses), list(self.poses),
                      self.poses.astype(">f8"), self.poses.astype("longdouble")):
            np.testing.assert_array_equal(self.sources(poses=poses), expected)
        for kind in ("float16", "float32", ">f4", "int8", ">i2", "int64", "uint64", "longdouble"):
            query = clearway.Query(np.arange(6).reshape(2, 3).astype(kind), self.poses, 0.1)
            self.assertEqual(query.model.dtype, np.float64)
            np.testing.assert_array_equal(query.model, [[0, 1, 2], [3, 4, 5]])
        for kind in (np.longdouble, np.float32, np.float16, np.array):
            self.assertEqual(clearway.Query(self.model, self.poses, kind(0.25)).radius, 0.25)
        box = clearway.Box(np.zeros(3, "longdouble"), np.ones(3, "float16"))
        np.testing.assert_array_equal(box.hi, [1, 1, 1])
        with self.assertRaisesRegex(clearway.InputError, "model: point 0: expected finite"):
            with np.errstate(over="ignore"):
                self.sources(model=np.full((1, 3), np.longdouble("1e4000")))

    def test_an_array_is_shared_until_the_search(self):
        model = self.model.copy()
        query = clearway.Query(model, self.poses, 0.25)
        model += 100
        np.testing.assert_array_equal(query.model, model)
        self.search(query=query)
        self.assertEqual(clearway.Result(self.folder / "out.h5").size(), 0)

    def test_values_that_are_refused_leave_what_was_there(self):
        query, nan_row = self.query(), np.stack([np.eye(4), np.full((4, 4), 1.0)])
        for name, kind, words, values in (
                ("model", clearway.UsageError, "model: expected an array of n x 3",
                 (np.zeros(3), np.zeros((3, 4)), np.zeros((2, 2, 3)), 5.0)),
                ("model", TypeError, "model: expected real numbers",
                 (np.zeros((2, 3), complex), np.zeros((2, 3), bool), [["1", "2", "3"]],
                  np.full((2, 3), None))),
                ("model", clearway.UsageError, "model: is no array of numbers", ([[1, 2, 3], [4, 5]],)),
                ("model", clearway.UsageError, "masked", (np.ma.masked_less(self.model, 0),)),
                ("poses", clearway.UsageError, "poses: expected an array of n x 4 x 4",
                 (np.eye(4), np.zeros((2, 12)), np.zeros((2, 4, 3)))),
                ("poses", clearway.UsageError, "pose 1: expected 0 0 0 1", (nan_row,)),
                ("poses", clearway.UsageError, "last row", (self.poses.transpose(0, 2, 1),))):
            for value in values:
                with self.subTest(name, words=words), self.assertRaisesRegex(kind, words):
                    setattr(query, name, value)
        np.testing.assert_array_equal(query.model, self.model)
        query.model = np.ma.masked_array(self.model)  # nothing is masked

    def test_arrays_that_no_search_can_use(self):
        def broken(of, place, value):
            changed = getattr(self, of).copy()
            changed[place] = value
            return {of: changed}

        scaled = self.poses * np.array([2, 2, 2, 1])
        for words, changed in (("model: point 7: expected finite", broken("model", (7, 1), np.inf)),
                               ("poses: pose 3: expected finite", broken("poses", (3, 0, 0), np.nan)),
                               ("pose 3: expected finite .* leave such", broken("poses", 3, np.nan)),
                               ("no points", {"model": []}), ("pose 0: .*stretches", {"poses": scaled})):
            with self.assertRaisesRegex(clearway.InputError, words) as caught:
                self.sources(**changed)
        self.assertEqual(caught.exception.remedy, "allow_non_rigid")
        self.sources(poses=scaled, allow_non_rigid=True)
        self.assertEqual(len(self.sources(poses=[])), 0)


class Arguments(SceneTest):
    """What is wrong with an argument is said by its name, and never as a list of C++ types."""

    def refused(self, rows):
        """rows: the kind of error, words of it, the call and its arguments."""
        for kind, words, call, args, named in rows:
            with self.subTest(call=call, named=named):
                with self.assertRaisesRegex(kind, words) as caught:
                    call(*args, **named)
                self.assertNotIn("incompatible", str(caught.exception))

    def of(self, kind, call, args, values):
        """A row for each value that an argument may not have; the message names the argument."""
        self.refused((kind, name, call, args, {name: value})
                     for name, each in values.items() for value in each)

    def test_numbers_of_a_query_out_of_range(self):
        nan, inf = np.nan, np.inf
        radii = (-1, 0, nan, inf, -inf)
        self.of(clearway.UsageError, clearway.Query, (self.model, self.poses), {
            "radius": radii, "clearance": (-0.1, nan, inf), "profile": (-0.1, nan, inf),
            "floor": (nan,), "error_pose": (-0.1,), "ignore_classes": ([256],)})
        self.refused([
            *((clearway.UsageError, "radius: expected", setattr, (self.query(), "radius", radius), {})
              for radius in radii),
            (clearway.UsageError, "^radius: the query has none", self.search, (),
             {"query": clearway.Query(self.model, self.poses)}),
            (clearway.UsageError, "have no classes", self.search, (),
             {"query": self.query(ignore_classes=[2])}),
            (clearway.InputError, "hi: point 0", clearway.Box, ((0, 0, 0), (1, 1, inf)), {})])

    def test_wrong_types(self):
        store, query = clearway.Store(self.folder / "site.h5"), self.query()
        self.of(TypeError, clearway.search, (store, query, "a.h5"), {
            "threads": ("two", 2.5), "gpus": (0,), "stop": (True,), "input_warnings": (["mind the step"],)})
        self.of(TypeError, clearway.Query, (self.model, self.poses), {
            "radius": ("0.25", [0.25], 1j, True), "first_pose": ("no",), "clearance": (None,),
            "ignore_boxes": ([(0, 1)],), "ignore_classes": ("2",), "bodies": ([self.model],)})
        self.refused([
            (TypeError, "expected a path", clearway.Store, (3,), {}),
            (TypeError, r"inputs\[1\]: expected a path", clearway.convert, (["a", 1], "b.h5"), {}),
            (TypeError, "columns: expected a list", clearway.convert, ("a", "b.h5"), {"columns": "xyz"}),
            (TypeError, "missing a required argument: 'output'", clearway.search, (store, query), {}),
            (TypeError, "too many", clearway.search, (store, query, "a.h5", "sweep"), {}),
            (TypeError, "too many", store.point_count, (1,), {}),
            (TypeError, "no argument 'force'; did you mean 'overwrite'", self.search, (), {"force": True}),
            (AttributeError, "raduis", setattr, (query, "raduis", 1), {})])
        self.search(threads=np.int64(2), memory_bytes=4e9, strict=np.bool_(False))  # whole numbers of any type


def shown(thing):
    """What a call returned, as a text that differs where a user sees another value."""
    if isinstance(thing, (list, tuple)):
        return str([*map(shown, thing)])
    if isinstance(thing, np.ndarray):
        return str(thing.tolist())
    rows = next((value for name in ("listed", "rows", "conflicts")
                 if isinstance(value := getattr(thing, name, None), list)), [])
    members = [getattr(thing, name) for name in ("vertices", "poses", "model") if hasattr(thing, name)]
    numbers = [[value for name in dir(row) if not name.startswith("_")
                and isinstance(value := getattr(row, name), (int, float, str))] for row in rows]
    return f"{thing!r} {numbers} {shown(members) if members else ''}"


class Defaults(SceneTest):
    """What a call does without an argument it does with the argument's default too."""

    def setUp(self):
        self.addCleanup(os.chdir, os.getcwd())
        os.chdir(self.folder)

    def calls(self):
        """{name of a function: the arguments that it needs}; outputs have the name "new"."""
        scan, site, path, model = "scan.xyz", clearway.Store("site.h5"), self.poses, self.model
        names = ("line.csv", "track.xml", "path.txt", "outline.csv", "car.json")
        texts = ("x,y,z\n0,0,0\n9,0,0\n",
                 '<LandXML><Units><Metric linearUnit="meter"/></Units><Alignments>'
                 '<Alignment name="a" staStart="0"><CoordGeom><Line><Start>0 0</Start><End>0 9</End>'
                 '</Line></CoordGeom><Profile><ProfAlign name="p"><PVI>0 1</PVI><PVI>9 1</PVI>'
                 "</ProfAlign></Profile></Alignment></Alignments></LandXML>",
                 "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n",
                 "y,z\n-1,0\n1,0\n0,2\n",
                 '{"bodies": [{"name": "a", "model": "scan.xyz", "pivots": [1, -1]}]}')
        for name, text in zip(names, texts):
            (self.folder / name).write_text(text)
        if not (self.folder / "out.h5").exists():
            self.search(query=self.query(first_pose=True, clearance=0.5, profile=1))
            clearway.find_section(site, path, "section.h5", -1, 1)
            for i in (1, 2):
                clearway.search(site, self.query(), f"part{i}.h5", shard=(i, 2))
        result, section = clearway.Result("out.h5"), clearway.Section("section.h5")
        return {"convert": (scan, "new"), "search": (site, self.query(), "new"),
                "read_trajectory": ("path.txt",), "read_alignment": ("track.xml",),
                "read_line": ("line.csv",), "read_model": (scan,), "read_model_points": (scan,),
                "read_outline": ("outline.csv",), "read_vehicle": ("car.json", path),
                "box_model": (3, 2, 1), "outline_model": ([[-1, 0], [1, 0], [0, 2]], -1, 1),
                "follow": ("a", model, path), "unsearched_stretches": (path, []),
                "smooth_trajectory": (path, 0.1), "find_conflicts": (result, path),
                "find_shifts": (result, site, model, path), "station_table": (result, path),
                "find_section": (site, path, "new", -1, 1), "merge": (["part1.h5", "part2.h5"], "new"),
                "export_section": (section, "cells", "new"),
                "export_section_outline": (section, "new"),
                "write_report": (result, site, model, path, "new")}

    def outcome(self, call, given, **named):
        """What a call returns or raises, with its rows, and what it writes."""
        self.new = self.folder / f"new{len(list(self.folder.iterdir()))}.h5"
        try:
            found = call(*(self.new if isinstance(each, str) and each == "new" else each
                           for each in given), **named)
        except Exception as error:
            found = error
        written = self.new.read_bytes() if self.new.exists() else b""
        return shown(found).replace(self.new.name, ""), written.replace(self.new.name.encode(), b"")

    def test_every_default_may_be_given(self):
        calls = self.calls()
        functions = {name for name in clearway.__all__ if inspect.isfunction(getattr(clearway, name))}
        self.assertEqual(set(calls), functions)
        for name, given in calls.items():
            call = getattr(clearway, name)
            expected = self.outcome(call, given)
            self.assertNotIn("Error(", expected[0])
            for parameter in inspect.signature(call).parameters.values():
                if parameter.default is parameter.empty:
                    continue
                with self.subTest(call=name, argument=parameter.name):
                    self.assertEqual(
                        self.outcome(call, given, **{parameter.name: parameter.default}), expected)

    def test_options_have_their_effect(self):
        """What each of these options changes is what the call returns or writes."""
        box = clearway.Box((0, -1, -1), (3, 1, 1))
        effects = {
            "convert": {"scale": 0.5, "cell_points": 64, "regular_size": 2.0, "unit": "ft",
                        "columns": ["3", "2", "1"], "near": "path.txt", "within": 1.0},
            "search": {"shard": (1, 2)},
            "Query": {"first_pose": True, "clearance": 0.5, "profile": 0.5, "floor": 0.05, "depth": True,
                      "between_poses": True, "error_scan": 0.01, "error_registration": 0.02,
                      "error_pose": 0.03, "error_angle": 1, "error_model": 0.04, "ignore_boxes": [box]},
            "read_trajectory": {"lever_arm": (0, 0, 1)},
            "read_alignment": {"station_from": 3, "station_to": 5, "step": 2, "reverse": True, "order": "en"},
            "read_line": {"step": 2, "reverse": True, "unit": "ft"},
            "read_model": {"unit": "ft", "forward": "-x", "up": "-z"},
            "read_model_points": {"unit": "ft", "forward": "-x", "up": "-z"},
            "read_outline": {"unit": "ft"},
            "read_vehicle": {"unit": "ft", "forward": "-x", "up": "-z"},
            "follow": {"at": 0.3, "pivots": (1, -1)},
            "smooth_trajectory": {"step": 0.5},
            "find_conflicts": {"gap": 0.05, "min_points": 400, "split": 1, "chainage_start": 5, "forward": "-x",
                               "up": "-z", "model": self.model},
            "find_shifts": {"lateral": (-1, 0.5), "min_points": 400, "split": 1, "chainage_start": 5},
            "station_table": {"every": 1, "chainage_start": 5},
            "find_section": {"window": (-1, 1, 0, 1), "pivots": (0.5, -0.5), "cell": 0.1, "bin": 1, "margin": 0.1,
                             "between_poses": True, "ignore_boxes": [box]},
            "export_section": {"band": 0.5, "base": 1},
            "write_report": {"title": "t", "project": "p", "client": "c", "author": "a", "date": "2026-03-01",
                             "result_name": "r", "environment_name": "e", "model_name": "m",
                             "trajectory_name": "y", "max_points": 10, "gap": 0.05, "min_points": 50, "split": 1,
                             "chainage_start": 5, "every": 1}}
        calls = self.calls()
        calls["export_section"] = (calls["export_section"][0], "bands", "new")
        calls["Query"] = (calls["search"][0], "new")
        for name, options in effects.items():
            call, given = getattr(clearway, name), calls[name]
            if name == "Query":
                call = lambda store, output, **named: clearway.search(store, self.query(**named), output)
            usual = self.outcome(call, given)
            for option, value in options.items():
                named = {option: value}
                if option in ("near", "within"):  # one needs the other
                    named = {"near": "path.txt", "within": 1.0, **named}
                with self.subTest(call=name, argument=option):
                    outcome = self.outcome(call, given, **named)
                    self.assertNotIn("Error(", outcome[0])
                    self.assertNotEqual(outcome, usual)

    def test_a_value_out_of_range_is_named(self):
        nan, inf = np.nan, np.inf
        out_of_range = {
            "search": {"threads": (-1, 2**40), "memory_bytes": (-1,), "device_memory_bytes": (-1,),
                       "journal_interval_seconds": (-1, nan, inf), "shard": ((-1, 2), (1, 2, 3)),
                       "gpus": ([-1],), "engine": ("fast",), "device": ("tpu",)},
            "convert": {"scale": (0, nan), "regular_size": (-1,), "threads": (-1,), "cell_points": (-1,),
                        "memory_bytes": (-1,), "unit_z": (-1,)},
            "read_model_points": {"unit": (-1,)}, "follow": {"pivots": ((1, 2, 3),)},
            "read_trajectory": {"environment_unit": (0,), "lever_arm": ((0, nan, 0),), "format": ("tun",)},
            "read_alignment": {"step": (0,), "cant": ("inner",)}, "read_line": {"corner_radius": (0,)},
            "read_vehicle": {"model_as": ("mesh",)},
            "find_conflicts": {"worse_by": (-1,)}, "find_shifts": {"lateral": ((1,), (0, "far")), "step": (0,)},
            "find_section": {"window": ((1, 2, 3),), "cell": (-1,), "bin": (nan,), "pivots": ((1,),),
                             "ignore_classes": ([300],), "threads": (-1,)}}
        calls = self.calls()
        for name, arguments in out_of_range.items():
            for parameter, value in ((p, value) for p, values in arguments.items() for value in values):
                with self.subTest(call=name, argument=parameter, value=value):
                    with self.assertRaisesRegex((clearway.UsageError, TypeError), rf"^{parameter}\b"):
                        getattr(clearway, name)(*calls[name], **{parameter: value})
        self.assertFalse(Path("new").exists())

    def test_an_argument_of_a_wrong_type_is_named(self):
        for name, given in self.calls().items():
            call = getattr(clearway, name)
            signature = inspect.signature(call)
            usual = signature.bind(*given).arguments
            for parameter in signature.parameters:
                with self.subTest(call=name, argument=parameter):
                    with self.assertRaisesRegex((TypeError, clearway.UsageError), rf"^{parameter}\b") as caught:
                        call(**{**usual, parameter: object()})
                    self.assertNotIn("incompatible", str(caught.exception))


class Errors(SceneTest):
    def test_classes(self):
        self.assertTrue(issubclass(clearway.UsageError, ValueError))
        for kind in (clearway.UsageError, clearway.InputError, clearway.ResourceError, clearway.Interrupted):
            self.assertTrue(issubclass(kind, clearway.Error))
        self.assertEqual(clearway.Error.__module__, "clearway")
        self.assertEqual((clearway.Error("x").remedy, clearway.Error("x").amount), (None, 0))

    def test_kinds_and_remedies(self):
        store, bad, far = clearway.Store(self.folder / "site.h5"), self.folder / "bad.h5", self.query()
        bad.write_text("no store")
        far.poses = self.poses + np.array([[0, 0, 0, 0], [0, 0, 0, 1000], [0] * 4, [0] * 4])
        for kind, words, remedy, call in (
                (clearway.UsageError, "radius: expected", None, lambda: setattr(far, "radius", -1)),
                (clearway.UsageError, "bad.h5", "overwrite", lambda: clearway.search(store, far, bad)),
                (clearway.UsageError, "engine 'fast': expected one of sweep, grid", None,
                 lambda: self.search(engine="fast")),
                (clearway.InputError, "bad.h5", None, lambda: clearway.Store(bad)),
                (clearway.InputError, "strict", None, lambda: self.search("strict.h5", far, strict=True)),
                (clearway.ResourceError, "none.h5", None, lambda: clearway.Result(self.folder / "none.h5")),
                (clearway.ResourceError, "", "more_memory", lambda: self.search(memory_bytes=1000))):
            with self.assertRaisesRegex(kind, words) as caught:
                call()
            self.assertEqual(caught.exception.remedy, remedy)
        self.assertFalse((self.folder / "strict.h5").exists())
        self.assertGreater(caught.exception.amount, 1000)
        self.search(memory_bytes=int(caught.exception.amount))


if __name__ == "__main__":
    unittest.main()
