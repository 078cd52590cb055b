"""The questions for both programs: groups of commands, each a line as one types it.

`@` in a line is a name that no other line has. A line may end with `< FILE`, its standard input, and
with `=> N`, the exit code to expect where it is not 0; `=> any` where the real files decide.
Commands run in the order of the table, in a folder with the scenes, with what inputs.py makes, and
with the outputs of the lines before.
"""

ALWAYS = ("scenes", "stores")  # every other group reads what these make

HALL = "--env hall.h5 --model hall/model.ply --trajectory hall/trajectory.txt"
CELLS = "--env cells.h5 --model hall/model.ply --trajectory hall/trajectory.txt"
CLASSES = "--env classes.h5 --model hall/model.ply --trajectory hall/trajectory.txt"
ON_HALL = "--env cells.h5 --trajectory hall/trajectory.txt"
BOX = f"{ON_HALL} --model models"
TUNNEL = "--env tunnel.h5 --trajectory tunnel/trajectory.txt"
ALL_TABLES = "--first-pose --clearance 0.3 --profile 0.5"


def groups(data):
    """The table: the name of each group, and its lines. `data` is the folder of real files, or None."""
    return {
        "scenes": SCENES, "stores": STORES, "convert": CONVERT, "convert refuses": CONVERT_REFUSES,
        **({"formats": formats(data)} if data else {}),
        "engines": engines(), "floor": FLOOR, "models": models(), "paths": paths(), "ignored": IGNORED, "units": UNITS,
        "vehicles": VEHICLES, "options": OPTIONS, "run refuses": RUN_REFUSES, "shards": shards(),
        "export": EXPORT, "conflicts": conflicts(), "compare": COMPARE, "report": REPORT, "info": INFO,
        "trajectory": trajectory(), "lines": LINES, "model": MODEL, "certainty": CERTAINTY,
        "section": section(), "findings": findings(), "check": CHECK, "campaign": campaigns(),
        "info of all": info_of_all(), "help": help_pages(),
        **({"street": STREET} if data and (data / "street").is_dir() else {}),
    }


SCENES = [
    "scene hall --points 40000 --model-points 2500 --poses 100 -o hall",
    "scene tunnel --points 40000 --model-points 2500 --poses 150 -o tunnel",
    "scene mine --points 20000 --model-points 1500 --poses 60 --seed 2 -o mine",
    "scene plant --points 20000 --model-points 1500 --poses 60 --threads 1 -o plant",
    "scene hall --points 400000 --model-points 10000 --poses 1500 -o long",
    "scene hall --points 1000 --poses 5 --model-points 50 -o hall => 2",
    "scene mine --points 1000 --model-points 100 --poses 10 --environment - -o small_mine",
]

FLOOR = [
    f"run {HALL} --radius 0.2 --floor 0.3 {ALL_TABLES} -o floor.h5",
    f"run {CELLS} --radius 0.2 --floor 0.3 --between-poses -o @.h5",
    f"run {CELLS} --radius 0.2 --floor 0.3 --engine kdtree -o @.h5 => 2",
    f"run {CELLS} --radius 0.2 --floor 0.3 --error-scan 0.01 --json -o @.h5",
    "conflicts floor.h5 --model hall/model.ply --trajectory hall/trajectory.txt -o @.csv",
]

STORES = [
    "convert hall/environment.las -o hall.h5",
    "convert hall/environment.las --cell-points 500 -o cells.h5",
    "convert tunnel/environment.las --cell-points 1000 -o tunnel.h5",
    "convert mine/environment.las --cell-points 64 -o mine.h5",
    "convert plant/environment.las -o plant.h5",
    "convert long/environment.las --cell-points 500 -o long.h5",
    "convert scans/classes.las --cell-points 2000 -o classes.h5",
    "convert scans/utm.las --cell-points 1000 -o utm.h5",
    "convert hall/environment.las --unit ft -o feet.h5",
    "convert scans/elsewhere.las -o elsewhere.h5",
    "convert scans/empty.xyz -o empty.h5",
]

CONVERT = [
    *(f"convert scans/{name} -o @.h5" for name in (
        "plain.xyz", "count.pts", "points.txt", "text.ply", "binary.ply", "big_endian.ply", "text.pcd",
        "binary.pcd", "placed.ptx", "scan000.3d", "named.csv", "not_finite.xyz")),
    "convert scans/named.csv --columns 3,2,4 -o @.h5",
    "convert scans/named.csv --columns east,north,height -o @.h5",
    "convert halves/1.las halves/2.las --cell-points 1000 -o halves.h5",
    "convert halves -o @.h5",
    "convert halves/2.las halves/1.las scans/plain.xyz --cell-points 5000 -o @.h5",
    "convert scans/plain.xyz scans/text.ply scans/text.pcd --json -o @.h5",
    "convert mixed --skip-unreadable -o @.h5",
    "convert - -o @.h5 < scans/classes.las",
    "convert hall/environment.las --layout regular:2 --cell-points 4096 -o regular.h5",
    "convert hall/environment.las --layout regular:50cm --cell-points 64 -o @.h5",
    "convert hall/environment.las --scale 0.001 -o @.h5",
    "convert hall/environment.las --scale 0.00025 --cell-points 300 --json -o @.h5",
    "convert scans/plain.xyz --scale 1e-6 -o @.h5",
    "convert hall/environment.las --cell-points 64 --threads 1 --memory 224M -o @.h5",
    "convert hall/environment.las --cell-points 1048576 -o @.h5",
    *(f"convert scans/plain.xyz --unit {unit} -o @.h5" for unit in ("m", "ift", "us-ft")),
    "convert scans/utm.las scans/classes.las --strict -o @.h5 => 3",
    "convert hall/environment.las -o hall.h5 --resume",
    "convert scans/plain.xyz -o again.h5",
    "convert scans/binary.ply -o again.h5 --force --json",
]

CONVERT_REFUSES = [
    "convert scans/decimal_commas.xyz -o @.h5 => 3",
    "convert scans/torn.ply -o @.h5 => 3",
    "convert scans/not_finite.xyz --strict -o @.h5 => 3",
    "convert mixed -o @.h5 => 3",
    "convert models/box.obj -o @.h5 => 3",
    "convert missing.las -o @.h5 => 4",
    "convert scans/plain.xyz -o hall.h5 => 2",
    "convert scans/plain.xyz --cell-points 63 -o @.h5 => 2",
    "convert scans/plain.xyz --memory 1M -o @.h5 => 4",
    "convert scans/plain.xyz --layout round -o @.h5 => 2",
    "convert - -o @.h5 < scans/plain.xyz => 3",
]


def formats(data):
    """Every real file, as a scan and as the file that `info` is asked about; some are refused."""
    names = sorted(path.relative_to(data).as_posix() for folder in ("formats", "malformed")
                   for path in (data / folder).rglob("*") if path.is_file())
    return [
        *(f"convert data/{name} -o @.h5 => any" for name in names),
        *(f"info data/{name} --json => any" for name in names),
        *(f"convert data/{name} --ignore-crs --cell-points 1000 -o @.h5 => any" for name in names
          if name.endswith((".las", ".laz", ".e57"))),
        *(f"model data/{name} => any" for name in names),
        *(f"trajectory info data/trajectories/{name} => any" for name in (
            "kitti00.txt", "tum_freiburg1_xyz.txt", "euroc_v102.csv")),
        "convert data/formats --skip-unreadable --ignore-crs -o @.h5 => any",
    ]


# --- run -----------------------------------------------------------------------------------------


MODES = {
    "sweep": ["", "--first-pose", "--clearance 0.4", "--profile 0.6", ALL_TABLES, "--between-poses",
              "--between-poses --first-pose"],
    "kdtree": [""],
    "grid": [""],
}


def engines():
    """Every mode of every engine, with radii from small to larger than the model; and other scenes."""
    return [
        *(f"run {CELLS} --radius {radius} --engine {engine} {mode} -o @.h5"
          for engine, modes in MODES.items() for mode in modes for radius in ("0.02", "0.25")),
        *(f"run {HALL} --radius 3 --engine {engine} {mode} -o @.h5"
          for engine, mode in (("sweep", ALL_TABLES), ("kdtree", ""), ("grid", ""),
                               ("sweep", "--between-poses"))),
        f"run {CELLS} --radius 0.15 -o set.h5",
        f"run {CELLS} --radius 0.15 {ALL_TABLES} -o tables.h5",
        f"run {CELLS} --radius 0.15 {ALL_TABLES} --threads 1 --memory 256M --json -o @.h5",
        f"run {CELLS} --radius 0.1 {ALL_TABLES} -o smaller.h5",
        f"run {CELLS} --radius 0.15 --first-pose --between-poses -o between.h5",
        "run --env regular.h5 --model hall/model.ply --trajectory hall/trajectory.txt --radius 0.15 "
        f"{ALL_TABLES} -o @.h5",
        *(f"run --env {scene}.h5 --model {scene}/model.ply --trajectory {scene}/trajectory.txt "
          f"--radius {radius} {mode} -o @.h5"
          for scene in ("tunnel", "mine", "plant") for radius, mode in (
              ("0.1", ALL_TABLES), ("50cm", "--engine kdtree"),
              ("0.3", "--engine grid"), ("0.3", "--between-poses --first-pose"))),
    ]


def models():
    """Surfaces, solids and points of meshes."""
    surfaces = ("box.obj", "box.stl", "box_binary.stl", "box.off", "box.ply", "open.obj", "mast.obj",
                "two_parts.obj", "sphere.obj")
    solids = ("box.obj", "two_parts.obj", "sphere.obj")
    return [
        *(f"run {BOX}/{name} --radius 0.2 --first-pose -o @.h5" for name in surfaces),
        *(f"run {BOX}/sphere.obj --radius {radius} {mode} -o @.h5" for radius in ("0.01", "1.5")
          for mode in ("", "--clearance 0.5", "--profile 0.5", ALL_TABLES)),
        *(f"run {BOX}/{name} --model-as solid --radius {radius} {ALL_TABLES} -o @.h5" for name in solids
          for radius in ("0.02", "0.4")),
        f"run {BOX}/sphere.obj --model-as solid --radius 0.2 {ALL_TABLES} -o solid.h5",
        f"run {BOX}/open.obj --model-as solid --radius 0.2 -o @.h5 => 3",
        *(f"run {BOX}/sphere.obj --radius 0.2 {options} -o @.h5" for options in (
            "--model-as points", "--model-as points --first-pose --between-poses",
            "--model-spacing 0.1 --engine kdtree", "--model-spacing 5cm --engine grid",
            "--model-vertices", "--floor 0.5 --clearance 0.4", "--model-as points --floor 50cm",
            "--model-as surface --first-pose --json")),
        f"run {CELLS} --radius 0.2 --floor 0.7 --first-pose -o @.h5",
        f"run {BOX}/few.xyz --radius 1.5 {ALL_TABLES} -o @.h5",
        f"run {BOX}/box_mm.stl --model-unit mm --radius 0.2 {ALL_TABLES} -o mesh.h5",
        f"run {BOX}/box_mm.stl --radius 0.2 -o @.h5",
        f"run {BOX}/no_faces.obj --radius 0.2 -o @.h5",
    ]


def paths():
    """Paths with few digits, without a pose, with poses twice, far from the scan, in other formats."""
    path = "run --env cells.h5 --model hall/model.ply --radius 0.2 --trajectory paths"
    return [
        *(f"{path}/{name} {mode} -o @.h5" for name in (
            "few_digits.txt", "one.txt", "repeated.txt", "back.txt", "jump.txt", "beside.txt", "leaving.txt",
            "empty.txt") for mode in (ALL_TABLES, "--between-poses --first-pose")),
        *(f"{path}/{name} --engine {engine} -o @.h5" for engine in ("kdtree", "grid")
          for name in ("one.txt", "repeated.txt", "empty.txt")),
        f"{path}/fewest_digits.txt -o @.h5 => 3",
        f"{path}/fewest_digits.txt --allow-non-rigid --first-pose -o @.h5",
        f"{path}/mirrored.txt -o @.h5 => 3",
        f"{path}/torn.txt -o @.h5 => 3",
        f"{path}/cm.txt --trajectory-unit cm --first-pose -o @.h5",
        f"{path}/cm.txt --first-pose -o @.h5",
        *(f"{path}/{name} {options} --first-pose -o @.h5" for name, options in (
            ("tum.txt", ""), ("euroc.csv", ""), ("quaternion.csv", ""), ("angles.csv", "--angles deg,enu"),
            ("xyzw.txt", "--trajectory-format pose-xyzw"), ("wxyz.txt", "--trajectory-format pose-wxyz"),
            ("tum.txt", "--lever-arm 0.5,0,1"))),
        f"{path}/xyzw.txt -o @.h5 => 3",
        *(f"run --env utm.h5 --model hall/model.ply --trajectory paths/utm.txt --radius {radius} {mode} -o @.h5"
          for radius, mode in (("0.15", ALL_TABLES), ("0.15", "--engine kdtree"),
                               ("0.15", "--engine grid"), ("2", "--first-pose"),
                               ("0.15", "--between-poses --first-pose"))),
        "run --env utm.h5 --model models/sphere.obj --model-as solid --trajectory paths/utm.txt --radius 0.15 "
        f"{ALL_TABLES} -o utm_out.h5",
        "run --env utm.h5 --model hall/model.ply --trajectory hall/trajectory.txt --radius 0.15 -o @.h5",
        *(f"run --env {store}.h5 --model hall/model.ply --trajectory hall/trajectory.txt --radius 0.15 "
          f"{ALL_TABLES} --json -o {store}_out.h5" for store in ("elsewhere", "empty")),
    ]


IGNORED = [
    *(f"run {CLASSES} --radius 0.2 --ignore-class {classes} {mode} -o @.h5"
      for classes in ("2", "2,3", "0-5 --ignore-class 7") for mode in ("", ALL_TABLES)),
    f"run {CLASSES} --radius 0.2 --ignore-class 2 --engine kdtree -o @.h5",
    f"run {CLASSES} --radius 0.2 --ignore-class 2 --engine grid -o @.h5",
    f"run {CLASSES} --radius 0.2 --between-poses --first-pose --ignore-class 6 --json -o @.h5",
    f"run {CLASSES} --radius 0.2 {ALL_TABLES} --ignore-class 2,3,6 --json -o @.h5",
    f"run {CLASSES} --radius 0.2 {ALL_TABLES} --ignore-class 2 --ignore-box 20,-5,0,40,20,3 -o ignored.h5",
    *(f"run {CELLS} --radius 0.2 {boxes} --first-pose -o @.h5" for boxes in (
        "--ignore-box 0,-5,0,10,5,3", "--ignore-box -100,-100,-100,200,200,200",
        "--ignore-box 0,-5,0,10,5,3 --ignore-box 5,-9,-1,15,9,1")),
    f"run {BOX}/sphere.obj --model-as solid --radius 0.2 --ignore-box 0,-5,-1,50,5,0.4 {ALL_TABLES} -o @.h5",
    f"run {CELLS} --radius 0.2 --ignore-class 2 -o @.h5 => 2",
    f"run {CELLS} --radius 0.2 --ignore-box 1,1,1,0,2,2 -o @.h5 => 2",
]

UNITS = [
    *(f"run --env feet.h5 --model hall/model.ply --trajectory hall/trajectory.txt --radius {radius} "
      f"{options} -o @.h5" for radius, options in (
          ("0.2", "--first-pose"), ("6in", "--clearance 10cm"), ("'10 cm'", ALL_TABLES),
          ("0.2", "--model-unit m"), ("0.2", "--trajectory-unit us-ft"), ("0.2us-ft", "--json"),
          ("0.2ift", "--model-unit in"))),
    *(f"run {CELLS} --radius {radius} -o @.h5" for radius in ("150mm", "4in", "0.5ft", "0.0002km", "0.5us-ft")),
    f"run {CELLS} --radius 0.2 --model-unit ft --trajectory-unit m -o @.h5",
]

VEHICLES = [
    *(f"run {TUNNEL} --vehicle wagon.json --radius {radius} {mode} -o @.h5" for radius in ("0.1", "0.6")
      for mode in ("", "--first-pose", ALL_TABLES)),
    *(f"run {ON_HALL} --vehicle {vehicle}.json --radius 0.2 {mode} -o @.h5"
      for vehicle in ("points", "own", "solid", "same_pose") for mode in ("", ALL_TABLES)),
    f"run {ON_HALL} --vehicle same_pose.json --radius 0.2 "
    "--first-pose --between-poses -o @.h5",
    f"run {ON_HALL} --vehicle points.json --radius 0.2 "
    "--first-pose --between-poses -o @.h5",
    f"run {ON_HALL} --vehicle solid.json --model-as solid --radius 0.2 "
    f"{ALL_TABLES} -o bodies_solid.h5",
    f"run {ON_HALL} --vehicle own.json --model-spacing 0.1 --radius 0.2 "
    f"{ALL_TABLES} --ignore-box 20,-5,0,40,20,3 --json -o @.h5",
    "run --env cells.h5 --trajectory paths/empty.txt --vehicle points.json --radius 0.2 -o @.h5",
    f"run {TUNNEL} --vehicle wagon.json --radius 0.3 {ALL_TABLES} -o wagon.h5",
    f"run {ON_HALL} --vehicle no_name.json --radius 0.2 -o @.h5 => 3",
    f"run {TUNNEL} --vehicle wagon.json --radius 0.3 --engine kdtree -o @.h5 => 2",
]

OPTIONS = [
    *(f"run {CELLS} --radius 0.15 {options} --json -o @.h5" for options in (
        "--threads 1", "--threads 3 --memory 200M", "--first-pose", "--engine sweep --device cpu")),
    f"run {CELLS} --radius 0.15 --fail-on-collision -o @.h5 => 1",
    "run --env elsewhere.h5 --model hall/model.ply --trajectory hall/trajectory.txt --radius 0.1 "
    "--fail-on-collision -o @.h5 => 6",
    f"run {CELLS} --radius 0.15 --strict -o @.h5 => 3",
    f"run {CELLS} --radius 0.15 -o forced.h5",
    f"run {CELLS} --radius 0.2 -o forced.h5 --force",
    f"run {CELLS} --radius 0.2 -o forced.h5 --resume",
]

RUN_REFUSES = [
    f"run {CELLS} --radius 0.2 -o set.h5 => 2",
    f"run {CELLS} --radius -1 -o @.h5 => 2",
    f"run {CELLS} --radius 0.2 --engine kdtree --clearance 0.5 -o @.h5 => 2",
    f"run {CELLS} --radius 0.2 --engine grid --between-poses -o @.h5 => 2",
    f"run {BOX}/box.obj --radius 0.2 --engine kdtree -o @.h5 => 2",
    f"run {BOX}/box.obj --radius 0.2 --between-poses -o @.h5 => 2",
    f"run {CELLS} --radius 0.2 --memory 1M -o @.h5 => 4",
    "run --env missing.h5 --model hall/model.ply --trajectory hall/trajectory.txt --radius 1 -o @.h5 => 4",
    "run --env hall/environment.las --model hall/model.ply --trajectory hall/trajectory.txt --radius 1 "
    "-o @.h5 => 3",
    "run --env set.h5 --model hall/model.ply --trajectory hall/trajectory.txt --radius 1 -o @.h5 => 3",
    "run --radius 1 => 2",
]


def shards():
    """Parts and what merge makes of them, with every table and engine."""
    kinds = {"set": f"{CELLS} --radius 0.2", "all": f"{CELLS} --radius 0.2 {ALL_TABLES}",
             "kdtree": f"{CELLS} --radius 0.2 --engine kdtree",
             "grid": f"{CELLS} --radius 0.2 --engine grid",
             "wagon": f"{TUNNEL} --vehicle wagon.json --radius 0.3 {ALL_TABLES}",
             "ignored": f"{CLASSES} --radius 0.2 --first-pose --ignore-class 2",
             "solid": f"{BOX}/sphere.obj --model-as solid --radius 0.2 {ALL_TABLES}"}
    lines = []
    for name, question in kinds.items():
        parts = [f"part_{name}_{i}.h5" for i in (1, 2, 3)]
        lines += [f"run {question} --shard {i}/3 -o {part}" for i, part in enumerate(parts, 1)]
        lines += [f"merge {' '.join(reversed(parts))} -o merged_{name}.h5",
                  f"merge {' '.join(parts)} --threads 1 --json -o @.h5"]
    return [
        *lines,
        "merge part_set_1.h5 part_set_2.h5 -o @.h5 => 3",
        "merge part_set_1.h5 part_set_1.h5 part_set_2.h5 -o @.h5 => 3",
        "merge part_set_1.h5 part_all_2.h5 part_set_3.h5 -o @.h5 => 3",
        "merge part_set_1.h5 part_set_2.h5 part_set_3.h5 --fail-on-collision -o @.h5 => 1",
        "merge part_set_1.h5 part_set_2.h5 part_set_3.h5 --strict -o @.h5 => 3",
        "merge part_set_1.h5 part_set_2.h5 part_set_3.h5 --resume -o merged_set.h5",
        "info part_all_2.h5 --json",
        "verify part_all_2.h5 --json",
        "compare merged_set.h5 merged_grid.h5",
    ]


# --- what is made of results ---------------------------------------------------------------------


EXPORT = [
    *(f"export tables.h5 --what {what} -o @{ending}" for what in ("collisions", "clearance")
      for ending in (".las", ".ply", ".xyz", ".csv")),
    "export tables.h5 --what profile -o @.csv",
    "export tables.h5 --what profile --trajectory hall/trajectory.txt --chainage-start 1000 --json -o @.csv",
    "export tables.h5 --scans hall/environment.las -o @.las",
    "export ignored.h5 --scans scans/classes.las -o @.las",
    "export ignored.h5 --what clearance --scans scans -o @.las => 2",
    *(f"export wagon.h5 -o @{ending}" for ending in (".las", ".ply", ".xyz", ".csv")),
    *(f"export utm_out.h5 --what clearance -o @{ending}" for ending in (".las", ".ply", ".xyz", ".csv")),
    "export set.h5 -o @.csv",
    "export elsewhere_out.h5 -o @.las",
    "export elsewhere_out.h5 --what profile -o @.csv",
    "export set.h5 --what profile -o @.csv => 2",
    "export set.h5 -o @.stl => 2",
    "export hall.h5 -o @.csv => 3",
]


def conflicts():
    """Every format, of one model and of bodies, seen along several axes."""
    few = "--gap 0.8 --min-points 2"
    outputs = " ".join(f"-o @{ending}" for ending in (".csv", ".json", ".geojson", ".gpkg", ".bcf", ".bcfzip"))
    line = "--trajectory hall/trajectory.txt"
    return [
        f"conflicts tables.h5 {line} {few} {outputs}",
        f"conflicts tables.h5 {line} {few} --model hall/model.ply {outputs} --date 2026-01-02",
        f"conflicts tables.h5 {line} {few} --split 5 --chainage-start 250 --json -o @.csv -o @.geojson",
        f"conflicts tables.h5 {line} {few} --split 0 --forward -x --up +z --show 3 -o @.csv",
        f"conflicts tables.h5 {line} {few} --forward +y --model hall/model.ply --threads 1 -o @.json",
        f"conflicts tables.h5 {line} --show 0 -o @.csv",
        f"conflicts between.h5 {line} {few} {outputs}",
        f"conflicts solid.h5 {line} {few} --model models/sphere.obj {outputs}",
        f"conflicts mesh.h5 {line} {few} --model models/box_mm.stl --model-unit mm {outputs}",
        f"conflicts ignored.h5 {line} {few} -o @.csv -o @.json",
        f"conflicts wagon.h5 --trajectory tunnel/trajectory.txt {few} {outputs}",
        f"conflicts wagon.h5 --trajectory tunnel/trajectory.txt {few} --vehicle wagon.json {outputs}",
        f"conflicts bodies_solid.h5 {line} {few} --vehicle solid.json {outputs}",
        f"conflicts utm_out.h5 --trajectory paths/utm.txt {few} --model models/sphere.obj {outputs}",
        f"conflicts elsewhere_out.h5 {line} {outputs}",
        f"conflicts set.h5 {line} -o @.csv => 2",
        "conflicts tables.h5 --trajectory paths/one.txt -o @.csv => 3",
        f"conflicts tables.h5 {line} -o @.pdf => 2",
    ]


COMPARE = [
    "compare set.h5 tables.h5",
    "compare tables.h5 smaller.h5 => 1",
    "compare tables.h5 smaller.h5 --json --show 3 => 1",
    "compare tables.h5 tables.h5 --json",
    "compare tables.h5 between.h5 --show 0 => 1",
    "compare wagon.h5 tables.h5 => 3",
    *(f"compare smaller.h5 tables.h5 --conflicts --trajectory hall/trajectory.txt --gap 0.8 --min-points 2 "
      f"--allow-other-question {options} => 1" for options in (
          "", "--json", "--worse-by 0.001 --show 2 --split 5 -o @.csv", "-o @.json", "-o @.html")),
    "compare tables.h5 smaller.h5 --conflicts --trajectory hall/trajectory.txt => 1",
    "compare tables.h5 tables.h5 --conflicts --trajectory hall/trajectory.txt --chainage-start 10 -o @.html => 6",
    "compare wagon.h5 wagon.h5 --conflicts --trajectory tunnel/trajectory.txt --vehicle wagon.json -o @.json => 6",
]

REPORT = [
    *(f"report {result}.h5 --env {store}.h5 {options} --date 2026-01-02 --min-points 2 --gap 0.8 -o @.html"
      for result, store, options in (
          ("tables", "cells", "--model hall/model.ply --trajectory hall/trajectory.txt"),
          ("tables", "cells", "--model hall/model.ply --trajectory hall/trajectory.txt --max-points 2000 --json"),
          ("tables", "cells", "--model hall/model.ply --trajectory hall/trajectory.txt --classes 0.05,0.1,0.2 "
           "--title Title --project P --client C --author A --split 5 --chainage-start 100 --forward -x"),
          ("set", "cells", "--model hall/model.ply --trajectory hall/trajectory.txt"),
          ("between", "cells", "--model hall/model.ply --trajectory hall/trajectory.txt"),
          ("solid", "cells", "--model models/sphere.obj --trajectory hall/trajectory.txt"),
          ("mesh", "cells", "--model models/box_mm.stl --model-unit mm --trajectory hall/trajectory.txt"),
          ("ignored", "classes", "--model hall/model.ply --trajectory hall/trajectory.txt"),
          ("wagon", "tunnel", "--vehicle wagon.json --trajectory tunnel/trajectory.txt"),
          ("bodies_solid", "cells", "--vehicle solid.json --trajectory hall/trajectory.txt"),
          ("utm_out", "utm", "--model models/sphere.obj --trajectory paths/utm.txt --threads 1"),
          ("elsewhere_out", "elsewhere", "--model hall/model.ply --trajectory hall/trajectory.txt"),
          ("empty_out", "empty", "--model hall/model.ply --trajectory hall/trajectory.txt"))),
    "report tables.h5 --env hall.h5 --model models/few.xyz --trajectory hall/trajectory.txt -o @.html => 3",
]

INFO = [
    *(f"{command} {file}{json}" for json in ("", " --json") for command in ("info", "verify") for file in (
        "hall.h5", "cells.h5", "classes.h5", "utm.h5", "feet.h5", "mine.h5", "empty.h5", "set.h5", "tables.h5",
        "between.h5", "solid.h5", "ignored.h5", "wagon.h5", "elsewhere_out.h5")),
    *(f"info {file} --json" for file in (
        "hall/environment.las", "scans/classes.las", "scans/plain.xyz", "scans/placed.ptx", "scans/text.pcd",
        "hall/model.ply", "hall/trajectory.txt", "paths/tum.txt",
        "paths/euroc.csv")),
    "info models/box.stl => 3",
    "info wagon.json => 3",
    "info paths/torn.txt",
    "info missing.h5 => 4",
    "verify hall/environment.las => 1",
]


def trajectory():
    """All commands of `clearway trajectory`."""
    files = {"hall/trajectory.txt": "", "paths/few_digits.txt": "", "paths/one.txt": "", "paths/repeated.txt": "",
             "paths/jump.txt": "", "paths/back.txt": "", "paths/empty.txt": "", "paths/tum.txt": "",
             "paths/euroc.csv": "", "paths/quaternion.csv": "", "paths/angles.csv": "--angles deg,ned",
             "paths/xyzw.txt": "--trajectory-format pose-xyzw", "paths/cm.txt": "--trajectory-unit cm",
             "paths/map.csv": "--trajectory-crs EPSG:25832"}
    return [
        *(f"trajectory info {file} {options}{json}" for file, options in files.items() for json in ("", " --json")),
        "trajectory info hall/trajectory.txt --env hall.h5 --model hall/model.ply --radius 0.1 --json",
        "trajectory info hall/trajectory.txt --env feet.h5 --model models/box_mm.stl --model-unit mm --radius 10cm",
        *(f"trajectory resample {file} {options} --model hall/model.ply --max-motion 0.3 -o @.txt"
          for file, options in files.items() if "jump" not in file),
        "trajectory resample paths/utm.txt --max-motion 10cm --model models/box.obj --json -o @.txt",
        *(f"trajectory thin {file} --model hall/model.ply --max-motion {motion} -o @.txt"
          for file in ("hall/trajectory.txt", "paths/repeated.txt", "paths/back.txt")
          for motion in ("0.01", "2", "3m --json")),
        *(f"trajectory smooth {file} --model hall/model.ply --within {within} -o @.txt"
          for file in ("hall/trajectory.txt", "paths/repeated.txt")
          for within in ("0.01", "5cm --step 0.3 --json")),
        *(f"trajectory follow {file} {body} -o @.txt" for file in (
            "hall/trajectory.txt", "tunnel/trajectory.txt", "paths/utm.txt", "paths/few_digits.txt",
            "paths/repeated.txt") for body in ("--at 2.5", "--at -1", "--pivots 3,-3", "--pivots 1,-2.5 --json")),
        "trajectory follow hall/trajectory.txt --pivots 3,-3 --at 1 -o @.txt => 2",
        "trajectory follow paths/one.txt --at 1 -o @.txt => 3",
        "trajectory info paths/xyzw.txt => 3",
        "trajectory info paths/fewest_digits.txt => 3",
        "trajectory info paths/torn.txt => 3",
    ]


MODEL = [
    *(f"model models/{name}{json}" for name in (
        "box.obj", "box.stl", "box_binary.stl", "box.off", "box.ply", "open.obj", "mast.obj", "two_parts.obj",
        "sphere.obj", "few.xyz") for json in ("", " --json")),
    "model hall/model.ply --json",
    *(f"model models/{name} {options} -o @.ply" for name, options in (
        ("box_mm.stl", "--unit mm --spacing 0.1"), ("sphere.obj", "--spacing 0.05"), ("mast.obj", "--spacing 5cm"),
        ("sphere.obj", "--vertices"), ("box.obj", "--spacing 0.2 --above 0.5"), ("few.xyz", "--above 0.6"),
        ("open.obj", "--spacing 0.02 --json"))),
    "model models/sphere.obj -o @.ply => 3",
    "model models/no_faces.obj",
    "model missing.obj => 4",
    "model box 4,1.8,1.4 -o @.off",
    "model box 4,1.8,1.4 -o @.ply",
    "model box:4,1.8,1.4 --json",
    "model outline load.csv --x=-2,2 -o @.off => any",
    "model outline half.csv --mirror --x=-2,2 -o @.ply => any",
]


LINES = [
    *(f"trajectory alignment lines/track.xml {options} -o @.csv" for options in (
        "", "--json", "--step 0.5 --from 20 --to 120 --json", "--reverse --cant none --json",
        "--cant left-rail --rail-distance 1.6 --order en --json", "--env cells.h5 --json")),
    "trajectory alignment lines/track.xml --alignment other -o @.csv => 3",
    "trajectory alignment lines/track.xml --from 300 -o @.csv => any",
    *(f"trajectory line lines/{name} --corner-radius 2 {options} -o @.csv"
      for name in ("route.csv", "route.geojson", "stations.csv") for options in ("--step 0.5", "--json")),
    "trajectory line lines/stations.csv --reverse --cant none --json -o @.csv",
    "trajectory line lines/route.csv -o @.csv => 3",
    "trajectory line lines/route.geojson -o @.csv => 3",
    "trajectory line lines/stations.csv --height 2 -o @.csv => 2",
    "trajectory line lines/stations.csv -o stations_path.csv --step 0.5 --json",
    "trajectory info stations_path.csv --json",
    "trajectory line lines/route.csv --on-ground cells.h5 --track 1.6 --json -o @.csv => any",
    "trajectory follow stations_path.csv --pivots 3,-3 --json -o @.csv",
    "trajectory resample hall/trajectory.txt --model hall/model.ply --max-motion 0.3 --json -o @.csv",
]

SURE = "--error-scan 5mm --error-registration 1cm --error-pose 2cm --error-angle 0.1deg --error-model 1cm"
CERTAINTY = [
    "convert hall/environment.las --origins hall/origins.csv --cell-points 500 --json -o seen.h5",
    "convert scans/plain.xyz scans/placed.ptx --json -o @.h5",
    f"run --env seen.h5 --model hall/model.ply --trajectory hall/trajectory.txt --radius 0.15 {ALL_TABLES} "
    "--seen --json -o seen_out.h5",
    "run --env seen.h5 --model hall/model.ply --trajectory hall/trajectory.txt --radius 0.15 --first-pose "
    "--seen --seen-cube 0.1 --seen-min 2 -o @.h5",
    f"run {CELLS} --radius 0.15 {ALL_TABLES} {SURE} --json -o sure.h5",
    f"run {CELLS} --radius 0.05 --first-pose {SURE} --sigmas 2 --gap 0.5 -o @.h5",
    f"run {TUNNEL} --vehicle wagon.json --radius 0.3 {ALL_TABLES} --error-scan 2cm --json -o wagon_sure.h5",
    f"run --env seen.h5 --model box:4,1.8,1.4 --trajectory hall/trajectory.txt --radius 0.2 --model-as solid "
    f"{ALL_TABLES} --seen {SURE} -o box_seen.h5",
    "run --env cells.h5 --model hall/model.ply --trajectory stations_path.csv --radius 0.1 --first-pose --json "
    "-o @.h5 => any",
    f"run {CELLS} --radius 0.15 --seen -o @.h5 => 2",
    f"run {CELLS} --radius 0.15 --sigmas 2 -o @.h5 => any",
    *(f"run {CELLS} --radius 0.15 {ALL_TABLES} --fail-on-collision --strict {json} -o @.h5 => any"
      for json in ("", "--json")),
    *(f"report {result}.h5 --env {store}.h5 --model {model} --trajectory hall/trajectory.txt --date 2026-01-02 "
      "--json -o @.html" for result, store, model in (
          ("seen_out", "seen", "hall/model.ply"), ("sure", "cells", "hall/model.ply"),
          ("box_seen", "seen", "box:4,1.8,1.4"))),
    *(f"run {CELLS} --radius 0.15 {ALL_TABLES} {SURE} --shard {i}/2 --json -o sure_part_{i}.h5" for i in (1, 2)),
    "merge sure_part_1.h5 sure_part_2.h5 --json -o sure_merged.h5",
]


def section():
    """All commands of `clearway section`."""
    find = "section find --trajectory hall/trajectory.txt --x-range=-2,2"
    known = "--env cells.h5 --trajectory hall/trajectory.txt"
    return [
        f"{find} --env cells.h5 --json -o section.h5",
        f"{find} --env cells.h5 --pivots 1,-1 --margin 0.2 --cell 0.05 --bin 2 --window=-2,2,0,3 -o section_margin.h5",
        f"{find} --env seen.h5 --seen --cell 0.1 --json -o section_seen.h5",
        f"{find} --env cells.h5 --between-poses --cell 0.1 --ignore-box 0,-5,0,10,5,3 --json -o section_ways.h5",
        f"{find} --env classes.h5 --ignore-class 2 --cell 0.1 --json -o section_ignored.h5",
        f"{find} --env elsewhere.h5 --cell 0.1 --json -o section_clear.h5",
        f"{find} --env cells.h5 --strict -o @.h5 => any",
        *(f"section check {name}.h5 --outline {outline} {json} => any" for json in ("", "--json")
          for name in ("section", "section_margin", "section_seen", "section_ways", "section_clear")
          for outline in ("load.csv", "slim.csv", "half.csv --mirror")),
        f"section check section.h5 --outline load.csv {known} --json => any",
        "section check section_margin.h5 --outline load.csv --margin 0.1 --json => any",
        "section check section.h5 --outline missing.csv => 4",
        *(f"section export {name}.h5 --table {table} -o @.csv" for name in ("section", "section_margin", "section_seen")
          for table in ("bands", "stations", "boxes", "cells", "bin-cells")),
        "section export section_margin.h5 --table bands --base 0.5 --band 0.25 -o @.csv",
        "section export section_seen.h5 --table unknown-cells -o @.csv",
        "section export section_margin.h5 --outline --base 0.5 -o @.dxf => any",
        "section export section_clear.h5 --outline -o @.dxf => 2",
        *(f"report {name}.h5 {options} --date 2026-01-02 --json -o @.html -o @.svg => any"
          for name, options in (("section", ""), ("section", "--outline load.csv"), ("section_clear", "--title T"),
                                ("section", f"--outline load.csv {known}"), ("section_seen", "--outline slim.csv"),
                                ("section_margin", "--outline load.csv --margin 0.1 --base 0.5 --band 0.25"))),
        "report section.h5 --gap 0.5 -o @.html => 2",
        "report tables.h5 --env cells.h5 --trajectory hall/trajectory.txt --model hall/model.ply --base 0 -o @.html "
        "=> 2",
    ]


def findings():
    """Stretches of the path, and shifts that free it."""
    line = "--trajectory hall/trajectory.txt"
    results = ("set", "tables", "smaller", "between", "solid", "ignored", "bodies_solid", "seen_out", "sure",
               "elsewhere_out", "empty_out")
    move = f"shift smaller.h5 --env cells.h5 --model hall/model.ply {line} --gap 0.8 --min-points 2"
    return [
        *(f"stations {result}.h5 {line} --json -o @.csv => any" for result in results),
        f"stations tables.h5 {line} --every 2 --chainage-start 100 --show 3 -o @.csv",
        "stations wagon.h5 --trajectory tunnel/trajectory.txt --every 10 --json -o @.csv",
        f"{move} -o @.csv -o shifts.json",
        f"{move} --lateral=-1,1 --step 0.1 --json -o @.csv => any",
        f"shift sure.h5 --env cells.h5 --model hall/model.ply {line} --step 0.2 --json -o @.json => any",
        "shift bodies_solid.h5 --env cells.h5 --vehicle solid.json --trajectory hall/trajectory.txt --step 0.2 "
        "--json -o @.json => any",
        f"report smaller.h5 --env cells.h5 --model hall/model.ply {line} --gap 0.8 --min-points 2 --date 2026-01-02 "
        "--shifts shifts.json --json -o @.html => any",
        *(f"conflicts {result}.h5 {line} --gap 0.8 --min-points 2 --json -o @.csv -o @.json => any"
          for result in ("smaller", "seen_out", "sure", "box_seen")),
        f"compare sure.h5 tables.h5 --conflicts {line} --allow-other-question --json -o @.json => any",
    ]


CHECK = [
    "check hall/environment.las --model hall/model.ply --trajectory hall/trajectory.txt --radius 0.15 "
    "--date 2026-01-02 --threads 1 --json -o checked",
    "check hall/environment.las --model hall/model.ply --trajectory hall/trajectory.txt --radius 0.15 "
    "--date 2026-01-02 --threads 1 --json -o checked",
    "check cells.h5 --vehicle solid.json --trajectory hall/trajectory.txt --radius 0.1 --every 2 "
    "--date 2026-01-02 --threads 1 --fail-on-collision -o @ => any",
    "check elsewhere.h5 --model box:4,1.8,1.4 --trajectory hall/trajectory.txt --radius 0.1 --seen "
    "--date 2026-01-02 --threads 1 --json -o @ => any",
    "check hall/environment.las --trajectory hall/trajectory.txt --radius 0.15 -o @ => 2",
    "check checked/site.h5 --model hall/model.ply --trajectory hall/trajectory.txt --radius 0.2 -o checked => any",
]


def info_of_all():
    """What `info` and `verify` say of every kind of file."""
    ours = ("seen.h5", "part_all_1.h5", "part_wagon_2.h5", "merged_all.h5", "seen_out.h5", "sure.h5", "box_seen.h5",
            "sure_part_1.h5", "sure_merged.h5", "wagon_sure.h5", "bodies_solid.h5", "utm_out.h5", "mesh.h5",
            "section.h5", "section_margin.h5", "section_seen.h5", "section_ways.h5", "section_ignored.h5",
            "checked/site.h5", "checked/result.h5")
    scans = ("plain.xyz", "count.pts", "points.txt", "named.csv", "text.ply", "binary.ply", "big_endian.ply",
             "text.pcd", "binary.pcd", "placed.ptx", "scan000.3d", "classes.las", "utm.las", "not_finite.xyz",
             "torn.ply", "empty.xyz", "decimal_commas.xyz")
    models = ("box.obj", "box.stl", "box_binary.stl", "box.off", "box.ply", "open.obj", "mast.obj", "sphere.obj",
              "few.xyz", "no_faces.obj")
    paths = ("few_digits.txt", "fewest_digits.txt", "xyzw.txt", "quaternion.csv", "angles.csv", "map.csv", "empty.txt",
             "utm.txt")
    others = ("lines/track.xml", "lines/route.csv", "lines/stations.csv", "lines/route.geojson", "stations_path.csv",
              "wagon.json", "campaign_plain.json", "load.csv", "shifts.json", "hall/origins.csv", "hall", "checked",
              "checked/check.json", "checked/conflicts.csv", "checked/report.html")
    files = (*ours, *(f"scans/{name}" for name in scans), *(f"models/{name}" for name in models),
             *(f"paths/{name}" for name in paths), *others)
    return [
        *(f"info {file}{json} => any" for file in files for json in ("", " --json")),
        *(f"verify {file}{json} => any" for file in ours for json in ("", " --json")),
    ]


def campaigns():
    """Plans, runs, pages. One job at a time, so that what is printed has one order."""
    lines = []
    for name in ("plain", "bodies", "shards"):
        lines += [f"campaign plan campaign_{name}.json -o {name}",
                  f"campaign status {name} --missing",
                  f"campaign run {name} --all",
                  f"campaign status {name}",
                  f"campaign status {name} --json",
                  f"campaign status {name} --failed",
                  f"campaign report {name} --date 2026-01-02",
                  f"campaign report {name} --date 2026-01-02 --force --json"]
    return [
        *lines,
        "campaign run plain --task 1 --fail-on-collision => 1",
        "campaign plan campaign_plain.json -o plain",
        "campaign plan campaign_bodies.json -o plain => 2",
        "campaign plan campaign_unknown_key.json -o unknown_key => 3",
        "campaign status missing => 2",
    ]


def help_pages():
    """What every command says of itself."""
    commands = ["", "check", "convert", "run", "merge", "export", "conflicts", "stations", "shift", "compare", "info",
                "verify", "model", "model box", "model outline", "report", "section", "section find", "section check",
                "section export", "scene", "trajectory", "trajectory info", "trajectory resample",
                "trajectory thin", "trajectory follow", "trajectory alignment", "trajectory line", "campaign",
                "campaign plan", "campaign run", "campaign status", "campaign report"]
    return [*(f"{command} --help".strip() for command in commands), "nonsense => 2", "run --nonsense => 2",
            "section nonsense => 2", "run --radius 1 --radus 2 => 2"]


STREET = [
    "convert data/street/street.las -o street.h5",
    "run --env street.h5 --model data/street/beetle.ply --trajectory data/street/trajectory.txt --radius 0.1 "
    "--first-pose -o street_out.h5",
    "run --env street.h5 --model data/street/warthog_ugv.obj --trajectory data/street/trajectory.txt --radius 0.1 "
    "--clearance 0.5 -o @.h5",
    "conflicts street_out.h5 --trajectory data/street/trajectory.txt --model data/street/beetle.ply -o @.csv -o @.bcf",
]


# --- runs that are interrupted -------------------------------------------------------------------


class Interrupted:
    """A command in which one program is stopped, and which the other one then finishes.

    `{name}` in its texts is a folder or file of its own. `output` must have the bytes that it has
    where nobody interrupts the command."""

    def __init__(self, begin, go_on="", prepare="", output="{name}.h5"):
        self.begin, self.go_on = begin, go_on or f"{begin} --resume"
        self.prepare, self.output = prepare, output


def _run(question):
    return Interrupted(f"run {question} -o {{name}}.h5")


LONG_PATH = "--env long.h5 --trajectory long/trajectory.txt --radius 0.1 --threads 1"
LONG = f"{LONG_PATH} --model long/model.ply"

INTERRUPTED = {
    "sweep": _run(f"{LONG} --engine sweep"),
    "tables": _run(f"{LONG} --engine sweep {ALL_TABLES}"),
    "kdtree": _run(f"{LONG} --engine kdtree"),
    "grid": _run(f"{LONG} --engine grid"),
    "between poses": _run(f"{LONG} --engine sweep --between-poses --first-pose"),
    "solid": _run(f"{LONG_PATH} --model models/sphere.obj --model-as solid {ALL_TABLES}"),
    "bodies": _run(f"{LONG_PATH} --vehicle points.json --first-pose"),
    "ignored": _run(f"{LONG} --engine sweep --first-pose --ignore-box 20,-5,0,40,20,3"),
    "shard": _run(f"{LONG} --engine sweep --first-pose --shard 2/3"),
    "campaign": Interrupted(
        prepare="campaign plan campaign_long.json -o {name}", begin="campaign run {name} --all",
        go_on="campaign run {name} --all", output="{name}/runs/car/line/0.1/out.h5"),
}
