"""Made-up files of figures, one of every experiment, as `clearway-bench` writes them."""

import itertools
import json
import random

ENGINES = {"kdtree cpu": 20.0, "sweep cpu": 0.9, "grid cuda": 0.4, "sweep cuda": 0.05}
FLOAT = "grid float cuda"
REFUSED = {"exit_code": 4,
           "log": "[2026-01-01 10:00:00.000] [error] clearway run: /w/x/hall.h5: this run needs 123.4 MiB (--memory 129394278)"}
chance = random.Random(1)


def report(engine, seconds, points=1_110_000, cells=400):
    name, device = engine.split()[0], engine.split()[-1]
    search = seconds * chance.uniform(1, 1.1)
    steps = {"inputs": 0.02, "context": 0.2 * (device == "cuda"), "plan": 0.05, "field": 0.04,
             "engine": 0.02, "search": search, "read": search * 0.3, "upload": search * 0.2,
             "compute": search * 0.8, "collect": search * 0.05, "write": 0.03}
    return {"engine": name, "device": device, "searches": 10**9, "environment_points": points,
            "model_points": 20_000, "poses": 1_700, "colliding_points": 104_711,
            "grid_cell": 0.14 if name == "grid" else 0, "cells_total": cells,
            "cells_read": cells // 2, "peak_host_bytes": 10**8, "peak_device_bytes": 10**8,
            "seconds": {"total": sum(steps.values()), **steps}, "wall_seconds": search + 0.5,
            "peak_resident_bytes": 4 * 10**8}


def case(parameters, seconds, findings=None, failed=None, runs=3, **more):
    one = {"key": "/".join(str(value) for value in parameters.values()), "parameters": parameters,
           "runs": [] if failed else [report(parameters.get("engine", "grid cuda"), seconds, **more)
                                      for _ in range(runs)]}
    if findings is not None and not failed:
        one["findings"] = findings
    if failed:
        one["failed"] = failed
    return one


def compared(differing=0):
    return {"common": 104_711, "only_here": differing, "only_in_reference": 0,
            "equal": not differing}


def judged(wrong, distance, beyond=0):
    return {"false_hits": wrong, "misses": 0, "share": wrong / 1_110_000, "beyond": beyond,
            "largest_distance": distance, "histogram": [0] * 18}


def table():
    for scene, engine in itertools.product(("mine", "hall", "plant", "tunnel"), [*ENGINES, FLOAT]):
        slow = scene == "plant" and engine == "kdtree cpu"
        yield case({"scene": scene, "engine": engine, "exact": engine != FLOAT}, ENGINES.get(engine, 1),
                   compared(7 if engine == FLOAT else 0), points=806_183_400,
                   failed={"after_seconds": 120.0, "limit": 120.0} if slow else None)


def threads():
    for engine, n in itertools.product(("kdtree cpu", "sweep cpu"), [1, *range(2, 33, 2)]):
        yield case({"scene": "hall", "engine": engine, "threads": n},
                   ENGINES[engine] / (min(n, 16) + 0.17 * max(n - 16, 0)))


def grid():
    yield case({"vary": "grid cell", "value": "chosen"}, 0.41)
    for i, size in enumerate(("0.04", "0.05", "0.07", "0.1", "0.14", "0.2", "0.28", "0.4")):
        yield case({"vary": "grid cell", "value": size}, 0.4 + 0.05 * abs(i - 4))
    for i, points in enumerate(("1024", "4096", "16384", "65536", "262144")):
        yield case({"vary": "adaptive layout", "value": points}, 0.4 + 0.1 * abs(i - 3),
                   cells=55_000_000 // int(points))
    for i, size in enumerate(("0.7", "1", "1.5", "2", "3", "5", "8", "12", "20")):
        yield case({"vary": "regular layout", "value": size, "chunk_points": 4096}, 0.5 + 0.1 * i,
                   failed=REFUSED if i == 0 else None, cells=90_000 // (i + 1) ** 2)


def points():
    for i, engine in itertools.product(range(1, 112), ENGINES):
        yield case({"scene": "hall", "engine": engine, "points": 500_000 * i},
                   ENGINES[engine] * (0.2 + i / 111))


def accuracy():
    for engine, seconds in ENGINES.items():
        yield case({"method": "exact", "engine": engine, "value": ""}, seconds, judged(0, 0))
    yield case({"method": "float", "engine": FLOAT, "value": ""}, 0.3, judged(3, 2e-9))
    for far, distance in (("UTM", 0.02), ("10,000 km", 0.1)):
        for engine in ("kdtree cpu", "sweep cuda", "grid cuda"):
            yield case({"method": "exact, far origin", "engine": engine, "value": far},
                       ENGINES[engine], judged(0, 0))
        yield case({"method": "float, far origin", "engine": FLOAT, "value": far}, 0.31,
                   judged(9000, distance))
    for far, failed in (("a", {"after_seconds": 64.4}), ("b", {"after_seconds": 61, "limit": 60})):
        yield case({"method": "float, far origin", "engine": FLOAT, "value": far}, 0, failed=failed)
    for i, tolerance in enumerate(("1e-6", "1e-5", "1e-4", "1e-3", "0.01", "0.05")):
        yield case({"method": "tolerance", "engine": "sweep cuda", "value": tolerance},
                   0.049 - 0.005 * i, judged(4 * 6**i, float(tolerance) * 0.9))
    for i, voxel in enumerate((0.005, 0.01, 0.02, 0.05)):
        yield case({"method": "model thinned", "engine": "sweep cuda", "value": voxel},
                   0.04 - 0.004 * i, judged(50 * 5**i, voxel * 0.8))
    for n in (2, 5, 10):
        yield case({"method": "every nth pose", "engine": "sweep cuda", "value": n}, 0.05 / n**0.5,
                   judged(200 * n, 0.01 * n, beyond=n == 10))
    for i, scale in enumerate(("1e-6", "1e-5", "1e-4", "1e-3", "1e-2")):
        yield case({"method": "environment quantised", "engine": "sweep cuda", "value": scale},
                   0.05 - 0.001 * i, judged(7**i, float(scale) * 0.8))


def stability():
    yield {"key": "near the boundary", "parameters": {"vary": "boundary"},
           "findings": {"environment_points": 1_110_000,
                        "within_ulps": [int(2**i / 1e7) for i in range(41)]}}
    engines = ("kdtree cpu", "sweep cuda", "grid cuda")
    for engine in (*engines, FLOAT):
        wrong = [64 * (engine == FLOAT and i < 29) for i in range(31)]
        yield case({"vary": "ulps", "value": 0.1, "engine": engine}, 1,
                   {"false_hits": 0, "misses": sum(wrong), "points": [128] * 31, "wrong": wrong})
    for far in (0.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7):
        for engine in (*engines, FLOAT):
            wrong = int(far / 100) if engine == FLOAT else 0
            yield case({"vary": "origin", "value": far, "engine": engine}, 1,
                       judged(wrong, far * 1e-8 if wrong else 0), runs=1)
    for factor in (1.0, 3.0, 10.0, 30.0, 100.0, 300.0, 1000.0):
        for i, layout in enumerate(("adaptive", "regular, 50 cells along", "regular, 2 m")):
            whole = {"vary": "sparseness", "value": factor, "layout": layout}
            if i:
                whole["chunk_points"] = 256
            failed = REFUSED if layout == "regular, 2 m" and factor >= 100 else None
            yield {"key": f"sparseness/{layout}/{factor}", "parameters": whole,
                   "findings": {"failed": failed} if failed else
                   {"convert_seconds": 1 + i, "convert_peak_bytes": 10**8 * (i + 1) * factor**0.2,
                    "store_bytes": 10**7}}
            for engine in engines[1:] if not failed else ():
                yield case({**whole, "engine": engine}, ENGINES[engine] * factor ** (0.3 * i),
                           runs=1)
    for radius in (0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0, 3.0, 10.0):
        for engine in engines:
            yield case({"vary": "radius", "value": radius, "engine": engine},
                       ENGINES[engine] * (1 + 30 * radius), runs=1,
                       failed={"after_seconds": 120.0} if radius == 10 else None)
    for option, engine in (("--memory", "sweep cpu"), ("--device-memory", "sweep cuda"),
                           ("--device-memory", "grid cuda")):
        refused = {**REFUSED, "log": REFUSED["log"].replace("--memory", option)}
        yield case({"vary": "least" + option, "value": 1, "engine": engine}, 1, failed=refused)
        for share in (0.99, 1.0, 1.05, 1.2, 1.5, 2.0, 4.0, 8.0):
            yield case({"vary": option, "value": int(share * 129394278), "engine": engine},
                       ENGINES[engine] * (1 + 1 / share), judged(0, 0),
                       failed=refused if share < 1 else None)
    for vary, values in (("noise of the poses", (0.0, 1e-6, 1e-5, 1e-4, 1e-3, 1e-2, 0.1)),
                         ("stretch of the poses", (0.0, 1e-6, 1e-5, 9e-5, 1e-3, 1e-2, 0.1))):
        for at, engine in itertools.product(values, engines):
            yield case({"vary": vary, "value": at, "engine": engine}, ENGINES[engine],
                       {} if engine == "kdtree cpu" else compared(), runs=1)
    refused = {"exit_code": 3, "log": "error: /w/stretched.txt: line 1: the rotation has singular "
               "values from 0.9999999999047962 to 1.0009999996438987 and determinant "
               "1.000999999884437; expected a rigid motion: singular values within 1e-04 of 1 "
               "and a positive determinant (--allow-non-rigid accepts any invertible matrix)"}
    for at in (0.0, 1e-6, 1e-5, 9e-5, 1e-3, 1e-2, 0.1):
        yield case({"vary": "stretch without --allow-non-rigid", "value": at,
                    "engine": "sweep cuda"}, 0.05, runs=1, failed=refused if at > 1e-4 else None)


def scaling():
    for vary, values in (("poses", (100, 300, 1_000, 3_000, 10_000, 30_000)),
                         ("model points", (1_000, 3_000, 10_000, 30_000, 100_000, 300_000, 10**6)),
                         ("radius", (0.001, 0.003, 0.01, 0.03, 0.1, 0.3, 1.0)),
                         ("cell points", (256, 1024, 4096, 16384, 65536, 262144))):
        for (i, at), engine in itertools.product(enumerate(values), ENGINES):
            slow = engine == "kdtree cpu" and at == 1.0
            yield case({"engine": engine, "vary": vary, "value": at},
                       ENGINES[engine] * 1.5**i / 3,
                       failed={"after_seconds": 120.0} if slow else None)


def surfaces():
    yield case({"scene": "hall", "method": "surface", "engine": "sweep cpu", "value": ""}, 0.4,
               judged(0, 0))
    for parts, wrong in ((4, 90), (8, 30), (12, 9), (16, 1), (64, 0)):
        yield case({"scene": "hall", "method": "sampled", "engine": "sweep cpu",
                    "value": f"r / {parts}"}, 0.02 * parts, judged(wrong, 0.01 / parts**2))


def seen():
    questions = ("set", "first poses", "least distances", "profile", "error budget", "seen, 0.2 m",
                 "seen, 0.1 m", "seen, 0.2 m, and budget")
    varied = {"question": questions, "beams": (17_000, 69_000, 277_000, 1_110_000),
              "cube": ("0.8", "0.4", "0.2", "0.1", "0.05"), "path": (0.015625, 0.0625, 0.25, 1.0),
              "threads": (1, 2, 4, 8, 16)}
    for scene, (vary, values) in itertools.product(("mine", "hall"), varied.items()):
        for i, at in enumerate(values):
            one = case({"scene": scene, "engine": "sweep cpu", "vary": vary, "value": at}, 0.2,
                       failed=REFUSED if at == "0.05" and scene == "mine" else None)
            for run in one["runs"]:
                asked = vary != "question" or at.startswith("seen")
                run["seen"] = {"swept": 100_000, "unseen": 321} if asked else None
                if asked:
                    run["seconds"].update(swept=0.02 * (i + 1), beams=0.1 * 2**i)
            yield one


def section():
    varied = {"bin": (80.0, 20.0, 5.0, 1.25), "cell": (0.08, 0.04, 0.02, 0.01),
              "length": (1.0, 4.5, 12.0, 25.0), "threads": (1, 2, 4, 8, 16),
              "method": ("section, 1 thread", "section, all threads", "section, GPU")}
    for scene in ("mine", "hall"):
        for vary, values in varied.items():
            for at in values:
                refused = at == 0.01 and scene == "mine"
                yield case({"scene": scene, "vary": vary, "value": at}, 0.3,
                           failed=REFUSED if refused else None)
        for width in (1.0, 2.0):
            yield case({"scene": scene, "vary": "width", "value": width, "widths": 200}, 0.9)
        yield case({"scene": scene, "vary": "method", "value": "brute force"}, 0,
                   {"pairs": 3.2e9, "seconds": 48.0, "poses_searched": 50}, runs=0)


def certainty():
    shapes = ("wall and plane", "edge and edge", "point and corner")
    for shape, errors, margin, k in itertools.product(shapes, ("position", "all"), (0, 0.1),
                                                      (2, 3, 4)):
        clear = 10**6 // 50 ** (k - 1)
        here = {"shape": shape, "errors": errors, "margin": margin, "sigmas": k}
        yield {"key": f"place/{shape}/{errors}/{margin}/{k}", "parameters": {"vary": "place", **here},
               "findings": {"trials": 10**6, "clear": clear, "conflict": clear if margin else 0,
                            "groups": {"1": clear, "10": clear // 2, "100": clear // 9}}}
        yield {"key": f"program/{shape}/{errors}/{margin}/{k}",
               "parameters": {"vary": "program", **here},
               "findings": {"places": 10**4, "clear": clear // 100, "conflict": 0, "differ": 1}}
    for side, sigma in itertools.product((0.1, 0.2, 0.4), (0.005, 0.02, 0.05)):
        count = int(10**5 * max(0, sigma / side - 0.06))
        yield {"key": f"noise/normal/{sigma}/{side}",
               "parameters": {"vary": "noise", "noise": "normal", "size": sigma, "side": side},
               "findings": {"inside": 10**6, "seen": count, "skin": 10**5, "skin_seen": count}}


def check():
    steps = {"convert": 0.2, "path": 0, "run": 0.5, "conflicts": 0.1, "stations": 0.05, "report": 0.15}
    for points, (way, share) in itertools.product((10**6, 10**7, 10**8),
                                                  (("2 cores", 8), ("16 cores", 1), ("GPU", 0.5))):
        seconds = {step: part * share * points / 10**6 for step, part in steps.items()}
        yield {"key": f"hall/{points}/{way}",
               "parameters": {"scene": "hall", "points": points, "way": way},
               "runs": [{"seconds": {**seconds, "total": sum(seconds.values())}}] * 3,
               "findings": {"colliding_points": points // 20}}


def peers():
    kinds = [("nanoflann", None), ("cgal", None), ("pcl", None), ("open3d", None),
             ("cubql", None), *(("octomap", cell) for cell in (0.1, 0.05, 0.02, 0.01))]
    for scene, (i, (peer, cell)) in itertools.product(("hall", "tunnel", "plant", "mine"),
                                                      enumerate(kinds)):
        parameters = {"scene": scene, "peer": peer, "threads": 16}
        if cell:
            parameters["cell"] = cell
        one = {"key": f"{scene}/{peer} {cell}", "parameters": parameters}
        if peer == "cgal" and scene == "mine":
            yield {**one, "failed": {"exit_code": 1, "log": "error: std::bad_alloc"}}
            continue
        every = 40 * i if i > 2 else 1
        yield {**one, "findings": {
            "all_poses_seconds": 20.0 * 3**i, "search_seconds": [20.0 * 3**i / every],
            "every_pose": every, "prepare_seconds": 12.3, "peak_bytes_of_peer": 3e9,
            "environment_points": 10**8, "colliding_points": 10**6,
            "false_hits": int(10**6 * cell) if cell else 0, "misses": 7 if peer == "pcl" else 0,
            "peer": {"name": peer, "version": "1.2.3",
                     **({"gpu": {"device_peak_bytes": 5e9}} if peer == "cubql" else {})}}}


def share():
    found = {"points": 806_183_400, "points_tested": 90_000_000, "poses": 17_795, "cells": 12_552,
             "cells_read": 6_418, "bytes": 7 * 10**9, "bytes_read": 2 * 10**9,
             "point_tests": 4 * 10**8, "exact_tests": 21_133, "bricks": 998, "bricks_made": 924}
    for scene in ("mine", "hall", "plant", "tunnel"):
        for way, seconds in (("as it is", 0.9), ("all cells", 1.8), ("whole field", 1.1)):
            yield {"key": f"{scene}/{way}", "parameters": {"scene": scene, "way": way},
                   "findings": {**found, "seconds": seconds}}
        yield {"key": f"{scene}/poses one by one",
               "parameters": {"scene": scene, "way": "poses one by one"},
               "findings": {"seconds": 40.0, "searched_poses": 64}}
        yield case({"scene": scene, "way": "GPU"}, 0.1)


EXPERIMENTS = (table, threads, grid, points, accuracy, stability, scaling, surfaces, seen,
               section, certainty, check, peers, share)


def write_records(folder):
    for experiment in EXPERIMENTS:
        record = {"experiment": experiment.__name__, "size": "full",
                  "machine": {"processor": "Some(R) Processor(TM) of a Long Name CPU @ 2.40GHz",
                              "cores": 16, "memory_bytes": 2**37, "gpus": ["NVIDIA H200"],
                              "system": "Debian GNU/Linux 12 (bookworm)"},
                  "clearway": {"version": "0.1.0", "commit": "0123456789ab", "build": "Release"},
                  "parameters": {"repetitions": 3, "limit": 120.0}, "cases": list(experiment())}
        (folder / f"{experiment.__name__}.json").write_text(json.dumps(record))
