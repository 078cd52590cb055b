#!/usr/bin/python3
"""Two checks with different options in one folder, and the second one in a fresh folder: equal.

    check_pairs.py CLEARWAY [PAIRS [SEED [FIRST]]]

Draws pairs of option sets, and sometimes changes an input in between. The second check has to end
as it does in a folder where nothing was before: with the same exit code, verdict, facts, warnings,
path, tables and page. Where it asks for --force, it is given. Prints every pair that differs.
"""

import json
import math
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

PROGRAM = os.path.abspath(sys.argv[1])
PAIRS = int(sys.argv[2]) if len(sys.argv) > 2 else 12
SEED = int(sys.argv[3]) if len(sys.argv) > 3 else 1
FIRST = int(sys.argv[4]) if len(sys.argv) > 4 else 0
EAST, NORTH = 500000, 5316000
FOOT = 1200 / 3937


def zone(unit, metres):
    return (f'PROJCS["ETRS89 / UTM zone 32N",GEOGCS["ETRS89",'
            f'DATUM["European_Terrestrial_Reference_System_1989",'
            f'SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],'
            f'UNIT["degree",0.0174532925199433]],PROJECTION["Transverse_Mercator"],'
            f'PARAMETER["latitude_of_origin",0],PARAMETER["central_meridian",9],'
            f'PARAMETER["scale_factor",0.9996],PARAMETER["false_easting",{500000 / metres:.12g}],'
            f'PARAMETER["false_northing",0],UNIT["{unit}",{metres:.16g}]]').encode() + b"\0"


def write_las(path, points, wkt=None, metres=1.0):
    """LAS 1.4 with steps of 1 mm or a thousandth of a foot. points: x, y, z, class, withheld."""
    start = (EAST / metres, NORTH / metres, 0) if wkt else (0, 0, 0)
    steps = [[round(p[k] / metres * 1000) for k in range(3)] for p in points]
    header = bytearray(375)
    header[0:4] = b"LASF"
    struct.pack_into("<H", header, 6, 16)
    header[24:26] = bytes((1, 4))
    records = 54 + len(wkt) if wkt else 0
    struct.pack_into("<HII", header, 94, 375, 375 + records, 1 if wkt else 0)
    struct.pack_into("<BH", header, 104, 6, 30)
    struct.pack_into("<6d", header, 131, 1e-3, 1e-3, 1e-3, *start)
    for k in range(3):
        axis = [start[k] + step[k] / 1000 for step in steps]
        struct.pack_into("<2d", header, 179 + 16 * k, max(axis), min(axis))
    struct.pack_into("<Q", header, 247, len(points))
    record = b""
    if wkt:
        record = bytearray(54)
        record[2:17] = b"LASF_Projection"
        struct.pack_into("<HH", record, 18, 2112, len(wkt))
        record = bytes(record) + wkt
    bodies = b"".join(struct.pack("<3i2xBBB13x", *step, 0x11, 4 if p[4] else 0, p[3])
                      for step, p in zip(steps, points))
    path.write_bytes(bytes(header) + record + bodies)


def lane():
    """A road between two fences, with a post beside the car's way and a beam above it."""
    points = [(x / 2, y / 2, 0.0, 2, False) for x in range(60) for y in range(-7, 8)]
    points += [(x / 4, side * 3.5, z / 4, 1, False)
               for x in range(120) for side in (-1, 1) for z in range(4)]
    points += [(15 + x / 100, 1.13, z / 20, 18 if z % 2 else 1, False)
               for x in range(-5, 6) for z in range(40)]
    points += [(22.0, y / 10, 2.45, 1, y > 0) for y in range(-20, 20)]
    return points


def poses(count, wave=0.0):
    """Places along the lane, and the direction of travel there."""
    for i in range(count):
        x = 3 + 24 * i / (count - 1)
        yield x, wave * math.sin(x / 4), math.atan(wave / 4 * math.cos(x / 4))


def write_path(path, count, wave=0.0, unit=1.0, origin=(0, 0)):
    path.write_text("".join(
        f"{math.cos(a):.12f} {-math.sin(a):.12f} 0 {origin[0] / unit + x / unit:.9f} "
        f"{math.sin(a):.12f} {math.cos(a):.12f} 0 {origin[1] / unit + y / unit:.9f} 0 0 1 0\n"
        for x, y, a in poses(count, wave)))


def write_car(path, unit=1.0, length=4.0):
    corners = [(x * length / 2, y, z) for x in (-1, 1) for y in (-1, 1) for z in (0.3, 2.0)]
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
             (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    path.write_text("OFF\n8 12 0\n" +
                    "".join("%g %g %g\n" % tuple(c / unit for c in p) for p in corners) +
                    "".join("3 %d %d %d\n" % f for f in faces))


def write_pose_folder(folder, count, shift=0.0):
    folder.mkdir(exist_ok=True)
    for i, (x, y, _) in enumerate(poses(count)):
        (folder / f"scan{i:03}.pose").write_text(f"{-100 * (y + shift):.4f} 0 {100 * x:.4f}\n0 0 0\n")


def write_inputs(folder):
    points = lane()
    rows = [f"{x:.3f} {y:.3f} {z:.3f} {x + 0.5:.3f} {y - 0.06:.3f} {z:.3f}" for x, y, z, _, _ in points]
    (folder / "scan.xyz").write_text("\n".join(rows) + "\n")
    (folder / "scans").mkdir()
    write_las(folder / "scans/a.las", points[:900])
    write_las(folder / "scans/b.las", points[900:])
    write_las(folder / "utm.las", points, zone("metre", 1))
    write_las(folder / "feet.las", points, zone("US survey foot", FOOT), FOOT)
    (folder / "origins.csv").write_text("first,x,y,z\n0,5,2,2\n1000,20,-2,2\n")
    write_car(folder / "car.off")
    write_car(folder / "car_cm.off", 0.01)
    cloud = [(x / 5, y / 5, z / 5) for x in range(-10, 11) for y in (-5, 5) for z in range(2, 11)]
    (folder / "car.ply").write_text(
        f"ply\nformat ascii 1.0\nelement vertex {len(cloud)}\nproperty float x\nproperty float y\n"
        "property float z\nend_header\n" + "".join("%g %g %g\n" % p for p in cloud))
    write_path(folder / "path.txt", 30)
    write_path(folder / "wave.txt", 12, 0.3)
    write_path(folder / "path_feet.txt", 30, 0, FOOT)
    write_path(folder / "path_utm.txt", 30, 0.1, 1, (EAST, NORTH))
    write_path(folder / "path_utm_feet.txt", 30, 0.1, FOOT, (EAST, NORTH))
    write_pose_folder(folder / "poses", 30)
    write_car(folder / "short.off", 1, 2.5)
    (folder / "train.json").write_text(json.dumps({"bodies": [
        {"name": "front", "model": "short.off"},
        {"name": "rear", "model": "short.off", "pivots": [-2.2, -3.6]}]}))
    (folder / "truck.json").write_text(json.dumps({"bodies": [
        {"name": "tractor", "model": "short.off", "floor": 0.5},
        {"name": "trailer", "model": "short.off", "towed": {"at": -1.0, "pivots": [1.5, -1]}}]}))


def convert(folder, words=""):
    subprocess.run([PROGRAM, "convert", "scan.xyz", *words.split(), "-o", "site.h5", "--force"],
                   cwd=folder, check=True, capture_output=True)


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
    words += draw(rng, ["--engine sweep", "--device cpu",
                        "--threads 1", "--memory 1G"], 0.3)
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


def change(rng, folder):
    """Changes an input, or none."""
    kind = rng.choice(["", "", "", "scan", "las", "store", "store", "path", "poses", "pose", "car", "short", "origins"])
    if kind == "scan":
        with open(folder / "scan.xyz", "a", encoding="ascii") as file:
            file.write("9 0 1 9 0 1\n")
    elif kind == "las":
        write_las(folder / "scans/b.las", lane()[800:])
    elif kind == "store":
        convert(folder, rng.choice(["--unit us-ft", "--unit ft", "--columns 4,5,6", "--scale 0.5", ""]))
    elif kind == "path":
        write_path(folder / "path.txt", 25, 0.02)
    elif kind == "poses":
        write_pose_folder(folder / "poses", 30, 0.1)
    elif kind == "pose":
        write_pose_folder(folder / "poses", 31)
    elif kind in ("car", "short"):
        write_car(folder / f"{kind}.off", 1, 3.0)
    elif kind == "origins":
        (folder / "origins.csv").write_text("first,x,y,z\n0,6,2,2\n")
    return kind


def check(words, folder):
    return subprocess.run([PROGRAM, "check", *words, "-o", "out", "--json"], cwd=folder,
                          capture_output=True, text=True, check=False, timeout=300)


# What only a search, this machine or this moment knows.
OF_THE_MOMENT = {
    "seconds", "commands", "reused", "nothing_done", "was_finished", "engine", "device",
    "device_estimate", "searches", "cells_read", "bytes_read", "resumed_cells",
    "pages", "page_bytes", "slots", "needed_host_bytes", "peak_host_bytes", "peak_device_bytes",
    "looked_at"}


def of_the_answer(value):
    if isinstance(value, dict):
        return {key: of_the_answer(v) for key, v in value.items() if key not in OF_THE_MOMENT}
    return [of_the_answer(v) for v in value] if isinstance(value, list) else value


def outcome(ran, folder):
    """What a check says and leaves, but for times."""
    if ran.returncode not in (0, 1, 6):
        return {"exit code": ran.returncode, "error": ran.stderr.strip().splitlines()[-1:]}
    found = {"exit code": ran.returncode, "facts": of_the_answer(json.loads(ran.stdout))}
    for name in ("path.txt", "conflicts.csv", "stations.csv", "report.html"):
        file = folder / "out" / name
        text = file.read_text(errors="replace") if file.exists() else None
        if text and name == "report.html":
            text = re.sub(r"20\d\d-\d\d-\d\d[ T]\d\d:\d\d(:\d\d)?( UTC|Z)?", "", text)
        found[name] = text
    files = found["facts"]["run"]["files"]
    if files["trajectory"] != "out/path.txt":
        found["path.txt"] = None  # one that an earlier question left
    for name in ("result.h5", "site.h5") if files["env"] == "out/site.h5" else ("result.h5",):
        found[name] = (folder / "out" / name).read_bytes()
    return found


def differences(a, b, at=""):
    if isinstance(a, dict) and isinstance(b, dict):
        return [d for key in sorted(a.keys() | b.keys())
                for d in differences(a.get(key), b.get(key), f"{at}/{key}")]
    if a == b:
        return []
    if isinstance(a, bytes) and isinstance(b, bytes):
        return [f"{at}: other bytes, {len(a)} and {len(b)}"]
    if isinstance(a, str) and isinstance(b, str) and len(a) > 200:
        i = next((i for i, (x, y) in enumerate(zip(a, b)) if x != y), min(len(a), len(b)))
        a, b = a[max(0, i - 80):i + 120], b[max(0, i - 80):i + 120]
    return [f"{at}: {str(a)[:300]!r} in the used folder, {str(b)[:300]!r} in a fresh one"]


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
    return text.split()


def try_pair(rng, inputs, scratch):
    used, fresh = scratch / "used", scratch / "fresh"
    shutil.copytree(inputs, used)
    common = [part(rng) for part in PARTS]
    first = fitting(word for part in common for word in part)
    # Mostly only one part changes, as when somebody tries another option.
    for part, other in enumerate(PARTS):
        if rng.random() < 0.35:
            common[part] = other(rng)
    second = fitting(word for part in common for word in part)
    check(first, used)
    changed = change(rng, used)
    force = rng.random() < 0.5
    shutil.copytree(used, fresh, ignore=shutil.ignore_patterns("out"))
    ran = check(second + (["--force"] if force else []), used)
    if not force and ran.returncode == 2 and "--force answers this question" in ran.stderr:
        ran = check(second + ["--force"], used)
    expected = outcome(check(second, fresh), fresh)
    found = differences(outcome(ran, used), expected)
    return first, second, changed, force, found, expected["exit code"]


def main():
    wrong, codes = 0, {}
    with tempfile.TemporaryDirectory(prefix="clearway-pairs-") as scratch:
        inputs = Path(scratch) / "inputs"
        inputs.mkdir()
        write_inputs(inputs)
        convert(inputs)
        for number in range(FIRST, FIRST + PAIRS):
            pair = Path(scratch) / str(number)
            first, second, changed, force, found, code = try_pair(
                random.Random(f"{SEED} {number}"), inputs, pair)
            codes[code] = codes.get(code, 0) + 1
            if found:
                wrong += 1
                print(f"pair {number} of seed {SEED}: {' '.join(first)}\n  then "
                      f"{'--force ' if force else ''}{' '.join(second)}"
                      f"{'; changed: ' + changed if changed else ''}")
                print("".join(f"    {one}\n" for one in found[:6]), flush=True)
            shutil.rmtree(pair)
            if (number + 1 - FIRST) % 50 == 0:
                print(f"{number + 1 - FIRST} pairs, {wrong} differ", flush=True)
    print(f"{PAIRS} pairs, {wrong} differ; exit codes {codes}")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
