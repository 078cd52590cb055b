#!/usr/bin/python3
"""Prints what is in an HDF5 file of Clearway: a line for each fact, such as "warnings[0].code", and
one for each column with its path, type, rows and the SHA-256 of its values.

Files of the layout of docs/design/table-file.md and of the one before give the same lines where they
say the same. What only guards or describes the file itself, such as its version and the hashes of its
tables, is left out. So are facts that are no finite number, which the new layout does not write.
"""

import hashlib
import io
import json
import sys
from pathlib import Path

import h5py
import numpy

# What the files of before call otherwise, by kind: the old name of a fact or the path of a column, and
# the new one. None: it says nothing that another does not say.
NAMES = {
    "clearway result": {
        "ignored_points": "ignored.points", "runs_without_bodies": None, "first_date": "scanned.first",
        "last_date": "scanned.last", "shard[0]": "part.shard.number", "shard[1]": "part.shard.count",
        "division": "part.division", "store": "part.store", "path_length": "searched.path",
        "searched_length": "searched.whole", "partly_searched_length": "searched.part",
        "certain_points": "certain.points", "certain_group": "certain.has_group",
        "unseen_cube_side": "seen_space.cube_side", "swept_cubes": "seen_space.swept_cubes",
        "unseen_cubes": "seen_space.unseen_cubes", "unseen_groups": "seen_space.unseen_groups",
        "unseen_listed_groups": "seen_space.listed_groups",
        "unseen_listed_cubes": "seen_space.listed_cubes",
        "not_scanned_length": "seen_space.not_scanned_length",
    },
    "clearway section": {
        "ignored.blocked_cells": "ignored_cells.blocked",
        "ignored.high_cells": "ignored_cells.high",
    },
}
# The names of what stood in a list of a section, in its order. True where there are pivots.
NUMBERS = ("rear front window.y_from window.y_to window.z_from window.z_to cell bin margin pivots.front "
           "pivots.rear rounding motion[0] motion[1]").split()
COUNTS = ("environment_points ignored_points poses load_poses environment_hash trajectory_hash "
          "between_poses pivots").split()
FLAGS = ("first_pose", "between_poses", "seen", "depth", "certain_group")
# Hashes of tables, by which the files of before notice damage.
GUARDS = ("hash collisions_hash clearance_hash profile_hash near_hash unseen_hash swept_hash ignored_hash "
          "section_hash index_hash classes_index_hash origins_index_hash withheld_hash").split()
OF_THE_FILE = ("format", "version", "complete", "header_hash")


def read(data):
    """Facts by name, and columns by path: arrays, or bytes that only Clearway unpacks."""
    with h5py.File(io.BytesIO(data), "r") as file:
        kind = text_of(file.attrs["format"])
        is_new = "header" in file
        columns = {}

        def add(path, item):
            if isinstance(item, h5py.Dataset) and not (is_new and path in ("header", "chunk_hashes")):
                columns[path] = values(item)
        file.visititems(add)
        if is_new:
            facts = flat(new_facts(file, columns))
        else:
            renamed = NAMES.get(kind.replace("part", "result"), {})
            facts = old_facts(file, kind, columns)
            facts = {renamed.get(name, name): value for name, value in flat(facts).items()}
            facts.pop(None, None)
            columns = {renamed.get(path, path): column for path, column in columns.items()}
    return {"format": kind, **facts}, columns


def flat(value, name=""):
    """The facts of a JSON value by their names. Whole numbers are ints, whatever held them."""
    if isinstance(value, dict):
        members = ((f"{name}.{member}" if name else member, of) for member, of in value.items())
        return {key: fact for member, of in members if usable(of) is not None
                for key, fact in flat(of, member).items()}
    if isinstance(value, list):
        return {key: fact for i, of in enumerate(value) for key, fact in flat(of, f"{name}[{i}]").items()}
    return {name: usable(value)}


def usable(value):
    if not isinstance(value, float):
        return value
    if not numpy.isfinite(value):
        return None
    return int(value) if value.is_integer() and (value or str(value) == "0.0") else value


def plain(value):
    """An attribute or dataset as a JSON value; arrays of one are a number."""
    if isinstance(value, (str, bytes)):
        return text_of(value)
    return value.item() if value.size == 1 else value.tolist()


def text_of(value):
    return value if isinstance(value, str) else value.decode(errors="surrogateescape")


def boxes(rows):
    return [{"lo": row[:3].tolist(), "hi": row[3:].tolist()} for row in numpy.reshape(rows, (-1, 6))]


def new_facts(file, columns):
    """The header; and attributes, where they do not say what it says."""
    header = file["header"][:].tobytes()
    facts = json.loads(header, parse_int=lambda digits: -0.0 if digits == "-0" else int(digits))
    rows = {path.lstrip("/"): number for path, (number, _) in facts.pop("columns").items()}
    if rows != {path: len(column) for path, column in columns.items()}:
        facts["columns"] = rows
    del facts["chunk_hashes"]
    for name, value in file.attrs.items():
        said, of = flat(plain(value)), flat(facts.get(name))
        if name not in OF_THE_FILE and {key: fact == 1 if name in FLAGS else fact
                                        for key, fact in said.items()} != of:
            facts["@" + name] = plain(value)
    return facts


def old_facts(file, kind, columns):
    facts = {name: plain(value) for name, value in file.attrs.items() if name not in (*OF_THE_FILE, *GUARDS)}
    if "warnings" in file:
        facts["warnings"] = [warning(file["warnings"][str(i)].attrs)
                             for i in range(file["warnings"].attrs["count"].item())]
    if kind in ("clearway result", "clearway part"):
        of_result(facts, columns, file.attrs)
    if kind == "clearway section":
        of_section(facts, columns, file)
    return facts


def warning(attributes):
    said = {name: plain(attributes[name]) for name in ("code", "message")}
    if "names" in attributes:
        names = plain(attributes["names"]).splitlines()
        said["numbers"] = dict(zip(names, attributes["numbers"].tolist(), strict=True))
    if "stretches" in attributes:
        said["stretches"] = attributes["stretches"].tolist()
    return said


def of_result(facts, columns, attributes):
    facts.update({name: facts[name] == 1 for name in FLAGS if name in facts})
    facts["model_box"] = boxes(facts["model_box"])[0]
    for name in ("ignored_colliding", "ignored_colliding_high"):
        facts.setdefault(name, 0)
    if "bodies" in facts:
        facts["bodies"] = facts["bodies"].split("\n")
    if "body_floors" in facts:
        facts["body_floors"] = attributes["body_floors"].tolist()
    if "ignored/classes" in columns:
        facts["ignored"] = {name: columns.pop("ignored/" + name).tolist()
                            for name in ("classes", "class_points", "box_points")}
        facts["ignored"]["boxes"] = boxes(columns.pop("ignored/boxes"))


def of_section(facts, columns, file):
    numbers = dict(zip(NUMBERS, facts.pop("numbers"), strict=True))
    counts = dict(zip(COUNTS, facts.pop("counts"), strict=True))
    counts["between_poses"] = counts["between_poses"] == 1
    left_out = [] if counts["between_poses"] else ["motion"]
    if counts.pop("pivots") == 0:
        left_out.append("pivots")
    facts.update(counts, **{name: number for name, number in numbers.items()
                            if not name.startswith(tuple(left_out))})
    facts["seen"] = "seen_cube" in facts
    facts.setdefault("seen_cube", 0)
    facts["ignored"] = {name: plain(value) for name, value in file["ignored"].attrs.items()}
    facts["ignore_classes"] = columns.pop("ignored/classes").tolist()
    facts["ignore_boxes"] = boxes(columns.pop("ignored/boxes"))


def values(dataset):
    """The values; of a dataset that only Clearway unpacks, the bytes as they are stored."""
    try:
        return dataset[()]
    except OSError:
        chunks = [dataset.id.get_chunk_info(i).chunk_offset for i in range(dataset.id.get_num_chunks())]
        return b"".join(dataset.id.read_direct_chunk(offset)[1] for offset in chunks)


def main():
    facts, columns = read(Path(sys.argv[1]).read_bytes())
    for name in sorted(facts):
        print(f"{name} = {facts[name]!r}")
    for path, column in sorted(columns.items()):
        sha = hashlib.sha256(column).hexdigest()[:16]
        print(path, *(("packed", len(column)) if isinstance(column, bytes)
                      else (column.dtype, column.shape)), sha)


if __name__ == "__main__":
    main()
