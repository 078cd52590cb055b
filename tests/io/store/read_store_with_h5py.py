"""Reads a store with h5py alone and compares every integer with the LAS file it was made from.

Usage: read_store_with_h5py.py CLEARWAY_PROGRAM
"""

import json
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile

import h5py
import numpy

SCALE, OFFSET = (0.001, 0.002, 0.0005), (500000.0, -20.0, 3.5)


def las_bytes(points):
    """LAS 1.2, point format 0."""
    header = bytearray(227)
    header[0:4] = b"LASF"
    header[24:26] = bytes((1, 2))
    struct.pack_into("<HII", header, 94, 227, 227, 0)
    struct.pack_into("<BHI", header, 104, 0, 20, len(points))
    struct.pack_into("<6d", header, 131, *SCALE, *OFFSET)
    return bytes(header) + b"".join(struct.pack("<3i8x", *point) for point in points)


def clouds(folder):
    random = numpy.random.default_rng(1)
    yield "narrow", random.integers(-5000, 5000, (20000, 3))
    yield "constant", numpy.full((1000, 3), -7)
    yield "empty", numpy.zeros((0, 3), int)
    # HDF5 1.14.5 does not read what it packs itself where values need all their bits.
    values = numpy.array([-(2**31), 2**31 - 1, 5], numpy.int32)
    with h5py.File(folder / "own.h5", "w") as file:
        file.create_dataset("own", data=values, chunks=(3,), scaleoffset=0)
    try:
        with h5py.File(folder / "own.h5", "r") as file:
            assert (file["own"][:] == values).all()
    except (OSError, AssertionError):
        return
    yield "whole range", random.integers(-(2**31), 2**31, (3000, 3))


def stored_points(store):
    """Coordinates in the order of the source indices."""
    facts = json.loads(bytes(store["header"][:]))
    count, size = store["cells/count"][:], facts["cell_points"]
    assert count.sum() == facts["point_count"]
    assert all(store["points/" + name].shape == (len(count), size) for name in "xyz")
    if len(count) == 0:
        return numpy.zeros((0, 3), int)
    used = numpy.arange(size)[None, :] < count[:, None]
    source = store["points/source"][:][used]
    assert (numpy.sort(source) == numpy.arange(len(source))).all()
    places = numpy.stack([store["points/" + name][:][used] for name in "xyz"], axis=1)
    return places[numpy.argsort(source)]


def h5dump_value(path, dataset):
    """The first value of a dataset, by h5dump."""
    text = subprocess.run(
        ["h5dump", "-d", dataset, "-s", "0,0", "-c", "1,1", "-y", "-m", "%.17g", str(path)],
        check=True, capture_output=True, text=True).stdout
    return int(text.split("DATA {")[1].split("}")[0])


def main():
    with tempfile.TemporaryDirectory() as folder:
        path = pathlib.Path(folder) / "a.h5"
        for name, points in clouds(pathlib.Path(folder)):
            path.with_suffix(".las").write_bytes(las_bytes(points))
            subprocess.run([sys.argv[1], "convert", path.with_suffix(".las"), "-o", path,
                            "--cell-points", "1000", "--force"], check=True, capture_output=True)
            with h5py.File(path, "r") as store:
                assert store.attrs["format"] in (b"clearway store", "clearway store")
                assert (store.attrs["scale"] == SCALE).all()
                assert (store.attrs["offset"] == OFFSET).all()
                assert (stored_points(store) == points).all(), name
                for dataset in ("/points/x", "/points/source"):
                    if len(points) and shutil.which("h5dump"):
                        assert h5dump_value(path, dataset) == store[dataset][0, 0]
            print(f"{name}: {len(points)} points equal")


if __name__ == "__main__":
    main()
