"""Reads a store with h5py alone and compares every integer with the LAS file it was made from.

Usage: read_store_with_h5py.py CLEARWAY_PROGRAM
"""

import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile

import h5py
import numpy

RECORD = numpy.dtype([("xyz", "<i4", 3), ("rest", "V8")])
SCALE, OFFSET = (0.001, 0.002, 0.0005), (500000.0, -20.0, 3.5)


def write_las(path, points):
    """LAS 1.2, point format 0."""
    header = bytearray(227)
    header[0:4] = b"LASF"
    header[24:26] = bytes((1, 2))
    struct.pack_into("<HII", header, 94, 227, 227, 0)
    struct.pack_into("<BHI", header, 104, 0, RECORD.itemsize, len(points))
    struct.pack_into("<6d", header, 131, *SCALE, *OFFSET)
    records = numpy.zeros(len(points), RECORD)
    records["xyz"] = points
    path.write_bytes(bytes(header) + records.tobytes())


def read_las(path):
    data = path.read_bytes()
    first = struct.unpack_from("<I", data, 96)[0]
    count = struct.unpack_from("<I", data, 107)[0]
    return numpy.frombuffer(data, RECORD, count, first)["xyz"]


def clouds():
    random = numpy.random.default_rng(1)
    yield "narrow", random.integers(-5000, 5000, (20000, 3))
    yield "constant", numpy.full((1000, 3), -7)
    yield "whole range", random.integers(-(2**31), 2**31, (3000, 3))
    yield "one point", numpy.array([[-1, 2, -3]])
    yield "empty", numpy.zeros((0, 3), int)


def stored_points(store):
    """Coordinates in the order of the source indices."""
    count = store["cells/count"][:]
    assert count.sum() == store.attrs["point_count"]
    columns = {name: store["points/" + name] for name in ("x", "y", "z", "source")}
    assert all(column.shape == (len(count), store.attrs["cell_points"])
               for column in columns.values())
    if len(count) == 0:
        return numpy.zeros((0, 3), int)
    used = numpy.array([numpy.arange(store.attrs["cell_points"]) < n for n in count])
    values = {name: column[:][used] for name, column in columns.items()}
    assert (numpy.sort(values["source"]) == numpy.arange(len(values["source"]))).all()
    order = numpy.argsort(values["source"])
    return numpy.stack([values[name][order] for name in "xyz"], axis=1)


def h5dump_value(path, dataset):
    """The first value of a dataset, by h5dump."""
    text = subprocess.run(
        ["h5dump", "-d", dataset, "-s", "0,0", "-c", "1,1", "-y", "-m", "%.17g", str(path)],
        check=True, capture_output=True, text=True).stdout
    return int(text.split("DATA {")[1].split("}")[0])


def reads_full_width(folder):
    """Whether this HDF5 reads what it packs itself where values need all their bits; 1.14.5 does not."""
    path = folder / "own.h5"
    values = numpy.array([-(2**31), 2**31 - 1, 5], numpy.int32)
    with h5py.File(path, "w") as file:
        file.create_dataset("own", data=values, chunks=(3,), scaleoffset=0)
    try:
        with h5py.File(path, "r") as file:
            return bool((file["own"][:] == values).all())
    except OSError:
        return False


def check(program, folder, name, points):
    las, path = folder / "a.las", folder / "a.h5"
    write_las(las, points)
    expected = read_las(las)
    assert (expected == points).all()
    subprocess.run([program, "convert", str(las), "-o", str(path), "--cell-points", "1000",
                    "--force"], check=True, capture_output=True)
    with h5py.File(path, "r") as store:
        assert store.attrs["format"] in (b"clearway store", "clearway store")
        assert (store.attrs["scale"] == SCALE).all() and (store.attrs["offset"] == OFFSET).all()
        assert store["points/x"].dtype == "<i4" and store["points/source"].dtype == "<u8"
        found = stored_points(store)
        assert (found == expected).all(), name
        if len(points) and shutil.which("h5dump"):
            for dataset in ("/points/x", "/points/source"):
                assert h5dump_value(path, dataset) == store[dataset][0, 0]
    print(f"{name}: {len(points)} points equal")


def main():
    with tempfile.TemporaryDirectory() as folder:
        full_width = reads_full_width(pathlib.Path(folder))
        for name, points in clouds():
            if name == "whole range" and not full_width:
                print(f"{name}: HDF5 {h5py.version.hdf5_version} does not read what it packs itself")
                continue
            check(sys.argv[1], pathlib.Path(folder), name, points)


if __name__ == "__main__":
    main()
