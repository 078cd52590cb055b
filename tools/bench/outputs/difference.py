"""How two outputs differ: what may differ, and where the first difference is."""

import io
import re
import shutil
import sqlite3
import subprocess
import tempfile
import zipfile
from pathlib import Path

try:
    import h5py
    import numpy
except ImportError:
    h5py = numpy = None

# What depends on the clock or on the folder: what stands for it, and why it may differ.
CLOCK = [(re.compile(pattern), word) for pattern, word, _ in (
    (rb"\b\d[\d,]*(\.\d+)? (ms|s|min|h)\b", b"TIME", "seconds that a step took"),
    (rb"\b(count|distribute|partition|confirm) \d+\.\d+", rb"\1 TIME", "seconds of a conversion"),
    (rb'"(\w*seconds)": ?\{[^{}]*\}', rb'"\1": TIME', "seconds of the steps of a command"),
    (rb'"(\w*seconds)": ?[\d.e+-]+', rb'"\1": TIME', "seconds that a task took"),
    (rb'"time": ?"[^"]*"', b'"time": TIME', "when a task of a campaign ended"),
    (rb'"date": ?"\d{4}-[^"]* UTC"', b'"date": TIME', "when a page was made that got no date"),
    (rb'"peak_host_bytes": ?\d+', b'"peak_host_bytes": BYTES', "memory at its greatest"),
    (rb'"bytes_moved": ?\{[^{}]*\}', b'"bytes_moved": BYTES', "as the system counts them"),
    (rb'"outputs_id": ?"\w+"', b'"outputs_id": HASH', "hash of commands that name the folder"),
    (rb'"modified": ?-?\d+', b'"modified": TIME', "time of an input file"),
)]
# What depends on which thread finds a point first; of commands with a profile and several threads.
THREADS = [(re.compile(rb"tests: [^\n]*"), b"tests: COUNTS")]
# Outputs that depend on the clock: what a command prints, and these files. All others have to be equal.
TELLS_TIME = re.compile(
    r"(^|/)(stdout|stderr|log\.txt|plan\.json|run\.json|state\.json)$|/runs/.*/report\.html$")


def missing_tools():
    """What a reader has to know about how results are compared, or None."""
    if h5py:
        return None
    if shutil.which("h5dump"):
        return "h5py is missing: where results and stores differ, h5dump says how (try /usr/bin/python3)"
    return "h5py and h5dump are missing: where results and stores differ, only the first byte is named"


class Naming:
    """What of an output names the program or its folder: paths, and its version."""

    def __init__(self, folder, programs, version):
        self.words = [(str(folder).encode(), b"FOLDER")]
        self.words += [(str(program).encode(), b"PROGRAM") for program in programs]
        self.version = version
        self.patterns = [(re.compile(
            rb"(?<![\d.])" + re.escape(version.encode()) + rb"(?![\d.])"), b"VERSION")]

    def neutral(self, data, with_version):
        for word, stands_for in self.words:
            data = data.replace(word, stands_for)
        for pattern, stands_for in self.patterns if with_version else []:
            data = pattern.sub(stands_for, data)
        return data


class Comparison:
    """Compares outputs of an old and a new program."""

    def __init__(self, old, new):
        self.old, self.new = old, new
        self.other_version = old.version != new.version

    def difference(self, name, old, new, several_threads=False):
        """Where the bytes of an output first differ, in words; None where they say the same."""
        if name == "stderr" and several_threads:
            for pattern, word in THREADS:
                old, new = pattern.sub(word, old), pattern.sub(word, new)
        if old == new:
            return None
        old, new = self._neutral(name, old, self.old), self._neutral(name, new, self.new)
        if old == new:
            return None
        kind = name.rpartition(".")[2]
        if kind in PARTS:
            try:
                return self._by_parts(kind, old, new)
            except Exception as error:  # a damaged output is a difference like any other
                return f"{_first_difference(old, new)} (not read as {kind}: {error})"
        return _first_difference(old, new)

    def _neutral(self, name, data, naming):
        data = naming.neutral(data, self.other_version)
        if TELLS_TIME.search(name):
            for pattern, word in CLOCK:
                data = pattern.sub(word, data)
        return data

    def _by_parts(self, kind, old, new):
        parts = PARTS[kind](old), PARTS[kind](new)
        if parts[0] is None:
            return _first_difference(old, new)
        for part in dict.fromkeys([*parts[0], *parts[1]]):
            if part not in parts[1]:
                return f"{part} is missing"
            if part not in parts[0]:
                return f"{part} is new"
            where = self._part_difference(part, parts[0][part], parts[1][part])
            if where:
                return f"{part}: {where}"
        # The version stands in a compressed member, so the bytes of the archive differ.
        if kind in ZIPS and self.other_version:
            return None
        return f"the contents are equal, but not the bytes: {_first_difference(old, new)}"

    def _part_difference(self, part, old, new):
        if isinstance(old, bytes) and isinstance(new, bytes):
            old, new = self._neutral(part, old, self.old), self._neutral(part, new, self.new)
            return None if old == new else _first_difference(old, new)
        return _array_difference(old, new)


def _first_difference(old, new):
    """The first line, or the first byte of binary data, that differs."""
    try:
        lines = old.decode().splitlines(), new.decode().splitlines()
    except UnicodeDecodeError:
        lines = None
    if lines is None or b"\0" in old:
        at = next((i for i, (a, b) in enumerate(zip(old, new)) if a != b), min(len(old), len(new)))
        return f"byte {at}: {_byte(old, at)}, now {_byte(new, at)} (sizes {len(old)} and {len(new)})"
    for number in range(max(map(len, lines))):
        line = [side[number] if number < len(side) else None for side in lines]
        if line[0] != line[1]:
            shown = _around(*line)
            return f"line {number + 1}: {shown[0]}, now {shown[1]}"
    return "the line breaks differ"


def _byte(data, at):
    return f"{data[at]:#04x}" if at < len(data) else "the end"


def _around(old, new, most=90):
    """The part of both lines that has their first difference; a line that is not there has its word."""
    at = 0
    if old is not None and new is not None:
        at = next((i for i, (a, b) in enumerate(zip(old, new)) if a != b), min(len(old), len(new)))
    start = max(0, at - most // 3)
    return ["no line" if line is None else
            repr(("..." if start else "") + line[start:start + most] + ("..." if line[start + most:] else ""))
            for line in (old, new)]


def _array_difference(old, new):
    """The first value of two arrays that differs, by its bits, so that a NaN is equal to itself."""
    if type(old) is not type(new):
        return f"{old!r}, now {new!r}"
    if old.dtype != new.dtype:
        return f"type {old.dtype}, now {new.dtype}"
    if old.shape != new.shape:
        return f"shape {old.shape}, now {new.shape}"
    if old.tobytes() == new.tobytes():
        return None
    pairs = zip(old.reshape(-1), new.reshape(-1))
    at, (a, b) = next((i, pair) for i, pair in enumerate(pairs) if pair[0].tobytes() != pair[1].tobytes())
    return f"[{', '.join(map(str, numpy.unravel_index(at, old.shape)))}] is {a}, now {b}"


# --- the parts of a file -------------------------------------------------------------------------


def _hdf5(data):
    """Attributes and datasets by their paths; None where nothing here can read them."""
    if not h5py:
        return _hdf5_dump(data)
    parts = {}
    with h5py.File(io.BytesIO(data), "r") as file:
        def add(name, item):
            path = "/" + name.strip("/")
            for attribute in sorted(item.attrs):
                parts[f"{path}@{attribute}"] = numpy.asarray(item.attrs[attribute])
            if isinstance(item, h5py.Dataset):
                parts[path] = _values(item)
        add("", file)
        file.visititems(add)
    return {name: value.astype(bytes) if value.dtype == object else value for name, value in parts.items()}


def _values(dataset):
    """The values; of a dataset that only Clearway unpacks, the bytes as they are stored."""
    try:
        return numpy.asarray(dataset[()])
    except OSError:
        chunks = [dataset.id.get_chunk_info(i).chunk_offset for i in range(dataset.id.get_num_chunks())]
        stored = b"".join(dataset.id.read_direct_chunk(offset)[1] for offset in chunks)
        return numpy.frombuffer(stored, dtype="u1")


def _hdf5_dump(data):
    if not shutil.which("h5dump"):
        return None
    with tempfile.TemporaryDirectory() as folder:  # h5dump reads no pipe
        (Path(folder) / "file.h5").write_bytes(data)
        done = subprocess.run(["h5dump", "-w", "0", "-m", "%.17g", "file.h5"], cwd=folder,
                              capture_output=True)
    return {"h5dump": done.stdout} if done.returncode == 0 else None


def _zip(data):
    with zipfile.ZipFile(io.BytesIO(data)) as archive:
        return {f"{info.filename} ({info.date_time})": archive.read(info) for info in archive.infolist()}


def _sqlite(data):
    with sqlite3.connect(":memory:") as database:
        database.deserialize(data)
        database.text_factory = bytes
        tables = [name.decode() for (name,) in database.execute(
            "select name from sqlite_master where type = 'table' order by name")]
        return {f"table {table}": "\n".join(
            map(repr, database.execute(f'select * from "{table}"'))).encode() for table in tables}  # noqa: S608


ZIPS = ("bcf", "bcfzip")
PARTS = {"h5": _hdf5, "gpkg": _sqlite, **dict.fromkeys(ZIPS, _zip)}
