#!/usr/bin/python3
"""Two checks with different options in one folder, and the second one in a fresh folder: equal.

    check_pairs.py CLEARWAY [--pairs N] [--seed S] [--first N]

Tries pairs that somebody may well make, and then draws pairs of option sets; in between an input may
change. The second check has to end as it does in a folder where nothing was before: with the same
exit code, verdict, facts, warnings, path, tables and page. Where it asks for --force, it is given.
"""

import argparse
import json
import math
import random
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parents[2]))
from place import EAST, NORTH, PROGRAM, Place, write_las, zone  # noqa: E402

FOOT = 1200 / 3937


def lane():
    """A road between two fences, with a post beside the car's way and a beam above it."""
    points = [(x / 2, y / 2, 0.0, 2, False) for x in range(60) for y in range(-7, 8)]
    points += [(x / 4, side * 3.5, z / 4, 1, False)
               for x in range(120) for side in (-1, 1) for z in range(4)]
    points += [(15 + x / 100, 1.13, z / 20, 18 if z % 2 else 1, False)
               for x in range(-5, 6) for z in range(40)]
    return points + [(22.0, y / 10, 2.45, 1, y > 0) for y in range(-20, 20)]


def poses(count, wave=0.0, unit=1.0, origin=(0, 0)):
    """Along the lane, looking where they go, in other units and from another origin."""
    for i in range(count):
        x = 3 + 24 * i / (count - 1)
        yield ((origin[0] + x) / unit, (origin[1] + wave * math.sin(x / 4)) / unit, 0,
               math.atan(wave / 4 * math.cos(x / 4)))


def put_car(place, name, length=4.0, unit=1.0):
    place.put_box(name, (-length / 2 / unit, -1 / unit, 0.3 / unit), (length / 2 / unit, 1 / unit, 2 / unit))


def put_pose_folder(place, count, shift=0.0):
    for i, (x, y, *_) in enumerate(poses(count)):
        place.put(f"poses/scan{i:03}.pose", f"{-100 * (y + shift):.4f} 0 {100 * x:.4f}\n0 0 0\n")


def make_inputs(place):
    points = lane()
    place.put("scan.xyz", "".join(f"{x:.3f} {y:.3f} {z:.3f} {x + 0.5:.3f} {y - 0.06:.3f} {z:.3f}\n"
                                  for x, y, z, _, _ in points))
    (place / "scans").mkdir()
    write_las(place / "scans/a.las", points[:900])
    write_las(place / "scans/b.las", points[900:])
    write_las(place / "utm.las", points, zone("metre", 1))
    write_las(place / "feet.las", points, zone("US survey foot", FOOT), FOOT)
    place.put("origins.csv", "first,x,y,z\n0,5,2,2\n1000,20,-2,2\n")
    put_car(place, "car.off")
    put_car(place, "car_cm.off", unit=0.01)
    put_car(place, "short.off", 2.5)
    cloud = [(x / 5, y / 5, z / 5) for x in range(-10, 11) for y in (-5, 5) for z in range(2, 11)]
    place.put("car.ply", f"ply\nformat ascii 1.0\nelement vertex {len(cloud)}\nproperty float x\n"
              "property float y\nproperty float z\nend_header\n" + "".join("%g %g %g\n" % p for p in cloud))
    for name, path in (("path", poses(30)), ("wave", poses(12, 0.3)), ("path_feet", poses(30, 0, FOOT)),
                       ("path_utm", poses(30, 0.1, 1, (EAST, NORTH))),
                       ("path_utm_feet", poses(30, 0.1, FOOT, (EAST, NORTH)))):
        place.put_path(f"{name}.txt", path)
    put_pose_folder(place, 30)
    place.put("train.json", {"bodies": [
        {"name": "front", "model": "short.off"},
        {"name": "rear", "model": "short.off", "pivots": [-2.2, -3.6]}]})
    place.put("truck.json", {"bodies": [
        {"name": "tractor", "model": "short.off", "floor": 0.5},
        {"name": "trailer", "model": "short.off", "towed": {"at": -1.0, "pivots": [1.5, -1]}}]})
    convert(place)


def convert(place, words=""):
    place.ask(f"convert scan.xyz {words} -o site.h5 --force")


# Inputs that change: what becomes of each.
CHANGES = {
    "scan": lambda rng, place: place.put("scan.xyz", (place / "scan.xyz").read_text() + "9 0 1 9 0 1\n"),
    "las": lambda rng, place: write_las(place / "scans/b.las", lane()[800:]),
    "store": lambda rng, place: convert(place, rng.choice(
        ["--unit us-ft", "--unit ft", "--columns 4,5,6", "--scale 0.5", ""])),
    "unit": lambda rng, place: convert(place, "--unit us-ft"),
    "path": lambda rng, place: place.put_path("path.txt", poses(25, 0.02)),
    "poses": lambda rng, place: put_pose_folder(place, 30, 0.1),
    "pose": lambda rng, place: put_pose_folder(place, 31),
    "car": lambda rng, place: put_car(place, "car.off", 3.0),
    "short": lambda rng, place: put_car(place, "short.off", 3.0),
    "origins": lambda rng, place: place.put("origins.csv", "first,x,y,z\n0,6,2,2\n")}

# What somebody may well do: a check, a change of an input, and another check.
CAR = "--model car.off --radius 0.15"
TEXT = f"scan.xyz --trajectory path.txt {CAR}"
LIKELY = [(f"{TEXT} --columns 4,5,6", "", TEXT),
          (TEXT, "", f"{TEXT} --columns 4,5,6"),
          (f"{TEXT} --scale 0.5", "", TEXT),
          (f"{TEXT} --unit ft", "", TEXT),
          (f"{TEXT} --origins origins.csv --seen", "origins", f"{TEXT} --origins origins.csv --seen"),
          (f"scan.xyz --trajectory poses {CAR}", "poses", f"scan.xyz --trajectory poses {CAR}"),
          (f"scans --trajectory wave.txt {CAR} --near", "", f"scans --trajectory path.txt {CAR}"),
          (f"site.h5 --trajectory path.txt {CAR}", "unit", f"site.h5 --trajectory path.txt {CAR}")]


def draw(rng, choices, chance=1.0):
    """The words of one of the choices, or sometimes none."""
    return rng.choice(choices).split() if rng.random() < chance else []


def vehicle(rng):
    return draw(rng, ["--model car.off"] * 4 + [
        "--model car.ply", "--model car_cm.off --model-unit cm", "--model box:4,2,1.7",
        "--model car.off --model-as points", "--model car.off --model-as solid",
        "--model car.off --model-spacing 0.2", "--model car.off --forward +y",
        "--vehicle train.json", "--vehicle truck.json"])


def question(rng):
    words = draw(rng, ["--radius 0.1", "--radius 0.15", "--radius 0.3", "--radius 20cm",
                       "--radius 1ft"])
    words += draw(rng, ["--clearance 0.4", "--profile 1", "--floor 0.35", "--floor 20cm",
                        "--ignore-class 18", "--ignore-class 2,18", "--between-poses",
                        "--ignore-box 10,0,-1,18,3,3", "--depth", "--error-scan 5mm",
                        "--error-pose 2cm --sigmas 2 --gap 0.5", "--error-angle 0.1deg"], 0.6)
    words += draw(rng, ["--engine sweep", "--device cpu", "--threads 1", "--memory 1G"], 0.3)
    words += draw(rng, ["--min-points 3", "--split 5", "--chainage-start 100", "--every 2",
                        "--title A", "--client B", "--date 2026-01-02", "--classes 0.2,0.5"], 0.4)
    return words


def scans(rng):
    """Scans with their path, and how this is read."""
    return draw(rng, ["scan.xyz --trajectory path.txt"] * 4 + [
        "scans --trajectory path.txt", "scans --trajectory wave.txt", "scan.xyz --trajectory poses",
        "scans --trajectory poses", "scan.xyz --trajectory wave.txt",
        "site.h5 --trajectory path.txt --trajectory-unit m", "site.h5 --trajectory wave.txt",
        "scan.xyz --trajectory path_feet.txt --trajectory-unit us-ft",
        "scan.xyz --trajectory path.txt --trajectory-unit m", "scans --trajectory path_feet.txt",
        "utm.las --trajectory path_utm.txt", "utm.las --trajectory path_utm_feet.txt --trajectory-unit us-ft",
        "feet.las --trajectory path_utm_feet.txt", "feet.las --trajectory path_utm.txt --trajectory-unit m"])


def conversion(rng):
    words = draw(rng, ["--columns 4,5,6", "--columns 1,5,3"], 0.2)
    words += draw(rng, ["--scale 0.5", "--scale 0.01", "--scale 0.001", "--cell-points 64",
                        "--layout regular:5", "--unit m", "--unit ft", "--unit us-ft", "--unit-z ft",
                        "--ignore-crs", "--keep-withheld", "--skip-unreadable",
                        "--origins origins.csv", "--origins origins.csv --seen"], 0.6)
    return words + draw(rng, ["--near", "--near", "--near", "--strict"], 0.25)


PARTS = (scans, conversion, vehicle, question)


def fitting(words):
    """Without most of what would be refused, which would show little."""
    text = " ".join(words)
    if "scan.xyz" in text:
        text = re.sub(r"--ignore-class \S+|--keep-withheld", "", text)
    else:
        text = re.sub(r"--columns \S+|--unit \S+", "", text)
    if "car.ply" not in text and "--model-as points" not in text and "spacing" not in text:
        text = re.sub("--between-poses", "", text)
    if "--near" in text:
        text = re.sub(r"--seen|--depth", "", text)
    if "site.h5" in text:
        text = re.sub(r"--(near|seen|strict|ignore-crs|skip-unreadable|keep-withheld)\b|"
                      r"--(columns|unit|unit-z|scale|cell-points|layout|origins|ignore-class) \S+", "", text)
    return text


def drawn_pair(rng):
    """Mostly only one part changes, as when somebody tries another option."""
    parts = [part(rng) for part in PARTS]
    first = fitting(word for part in parts for word in part)
    parts = [other(rng) if rng.random() < 0.35 else part for part, other in zip(parts, PARTS)]
    return first, rng.choice(["", "", "", "store", *CHANGES]), fitting(word for part in parts for word in part)


def check(words, place):
    return subprocess.run([PROGRAM, "check", *words.split(), "-o", "out", "--json"], cwd=place.folder,
                          capture_output=True, text=True, check=False, timeout=300)


# What only a search, this machine or this moment knows.
OF_THE_MOMENT = {
    "seconds", "commands", "reused", "nothing_done", "was_finished", "engine", "device",
    "device_name", "estimate", "searches", "cells_read", "bytes_read", "resumed_cells",
    "pages", "page_bytes", "slots", "needed_host_bytes", "peak_host_bytes", "peak_device_bytes"}


def of_the_answer(value):
    if isinstance(value, dict):
        return {key: of_the_answer(v) for key, v in value.items() if key not in OF_THE_MOMENT}
    return [of_the_answer(v) for v in value] if isinstance(value, list) else value


def outcome(ran, place):
    """What a check says and leaves, but for times."""
    if ran.returncode not in (0, 1, 6):
        return {"exit code": ran.returncode, "error": ran.stderr.strip().splitlines()[-1:]}
    found = {"exit code": ran.returncode, "facts": of_the_answer(json.loads(ran.stdout))}
    files = found["facts"]["run"]["files"]
    # A path may be one that an earlier question left.
    for name in ("conflicts.csv", "stations.csv", "report.html", files["trajectory"].removeprefix("out/")):
        file = place / "out" / name
        found[name] = re.sub(r"20\d\d-\d\d-\d\d[ T]\d\d:\d\d(:\d\d)?( UTC|Z)?", "",
                             file.read_text(errors="replace")) if file.is_file() else None
    for name in ("result.h5", "site.h5") if files["env"] == "out/site.h5" else ("result.h5",):
        found[name] = (place / "out" / name).read_bytes()
    return found


def differences(a, b, at=""):
    if isinstance(a, dict) and isinstance(b, dict):
        return [d for key in sorted(a.keys() | b.keys())
                for d in differences(a.get(key), b.get(key), f"{at}/{key}")]
    if a == b:
        return []
    if isinstance(a, bytes) and isinstance(b, bytes):
        return [f"{at}: other bytes, {len(a)} and {len(b)}"]
    a, b = str(a), str(b)
    i = next((i for i, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))
    a, b = a[max(0, i - 80):i + 120], b[max(0, i - 80):i + 120]
    return [f"{at}: {a!r} in the used folder, {b!r} in a fresh one"]


def try_pair(rng, inputs, scratch, first, change, second):
    """How the second check differs in a used and in a fresh folder, and its exit code."""
    used, fresh = Place(scratch / "used"), Place(scratch / "fresh")
    shutil.copytree(inputs.folder, used.folder, dirs_exist_ok=True)
    check(first, used)
    if change:
        CHANGES[change](rng, used)
    force = rng.random() < 0.5
    shutil.copytree(used.folder, fresh.folder, ignore=shutil.ignore_patterns("out"), dirs_exist_ok=True)
    ran = check(second + (" --force" if force else ""), used)
    if not force and ran.returncode == 2 and "--force" in ran.stderr:
        ran = check(f"{second} --force", used)
    expected = outcome(check(second, fresh), fresh)
    return differences(outcome(ran, used), expected), expected["exit code"]


def main():
    parser = argparse.ArgumentParser()
    for name, default in (("--pairs", 8), ("--seed", 1), ("--first", 0)):
        parser.add_argument(name, type=int, default=default)
    arguments = parser.parse_args()
    wrong, codes = 0, []
    with tempfile.TemporaryDirectory(prefix="clearway-pairs-") as scratch:
        inputs = Place(Path(scratch) / "inputs")
        make_inputs(inputs)
        pairs = [(f"likely {i}", random.Random(i), pair) for i, pair in enumerate(LIKELY)]
        for number in range(arguments.first, arguments.first + arguments.pairs):
            rng = random.Random(f"{arguments.seed} {number}")
            pairs.append((f"{number} of seed {arguments.seed}", rng, drawn_pair(rng)))
        for number, rng, (first, change, second) in pairs:
            folder = Path(scratch) / "pair"
            found, code = try_pair(rng, inputs, folder, first, change, second)
            codes.append(code)
            if found or number.startswith("likely") and code not in (0, 6):
                wrong += 1
                print(f"pair {number}, exit code {code}: {first}\n  then {second}; changed: {change}")
                print("".join(f"    {one}\n" for one in found[:6]), flush=True)
            shutil.rmtree(folder)
    print(f"{len(codes)} pairs, {wrong} differ; exit codes {sorted(codes)}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
