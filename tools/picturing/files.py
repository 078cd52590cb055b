"""Points of LAS and PLY files and poses of trajectories, as arrays."""

import struct
import sys
from pathlib import Path

import numpy as np

PLY_TYPES = {
    "char": "i1", "int8": "i1", "uchar": "u1", "uint8": "u1", "short": "i2", "int16": "i2",
    "ushort": "u2", "uint16": "u2", "int": "i4", "int32": "i4", "uint": "u4", "uint32": "u4",
    "float": "f4", "float32": "f4", "double": "f8", "float64": "f8",
}


def read_las(path, most):
    """Every k-th point, at most `most`, metres; n x 3."""
    with open(path, "rb") as file:
        head = file.read(375)
    if head[:4] != b"LASF":
        sys.exit(f"{path}: byte 0: expected LASF")
    if head[104] & 0x80:
        sys.exit(f"{path}: byte 104: compressed points (LAZ); expected LAS")
    offset = struct.unpack_from("<I", head, 96)[0]
    record_bytes = struct.unpack_from("<H", head, 105)[0]
    count = struct.unpack_from("<I", head, 107)[0]
    if head[25] >= 4:
        count = max(count, struct.unpack_from("<Q", head, 247)[0])
    if count == 0:
        return np.empty((0, 3))
    record = np.dtype({"names": ["q"], "formats": ["3<i4"], "offsets": [0],
                       "itemsize": record_bytes})
    points = np.memmap(path, record, "r", offset, (count,))
    quanta = points[:: -(-count // most)]["q"]
    return quanta * np.frombuffer(head, "<f8", 3, 131) + np.frombuffer(head, "<f8", 3, 155)


def read_ply(path):
    """The vertices of a PLY file, n x 3."""
    data = Path(path).read_bytes()
    end = data.find(b"end_header\n")
    if not data.startswith(b"ply") or end < 0:
        sys.exit(f"{path}: expected a PLY header")
    lines = [line.split() for line in data[:end].decode("latin-1").splitlines()]
    form = next(line[1] for line in lines if line[:1] == ["format"])
    start = next(i for i, line in enumerate(lines) if line[:2] == ["element", "vertex"])
    names = []
    for line in lines[start + 1:]:
        if line[0] == "element":
            break
        if line[0] == "property":
            names.append((line[2], line[1]))
    count = int(lines[start][2])
    body = data[end + len(b"end_header\n"):]
    if form == "ascii":
        table = np.loadtxt(body.decode("latin-1").splitlines()[:count], ndmin=2)
        return table[:, [[name for name, _ in names].index(axis) for axis in "xyz"]]
    order = ">" if form == "binary_big_endian" else "<"
    record = np.dtype([(name, order + PLY_TYPES[kind]) for name, kind in names])
    table = np.frombuffer(body, record, count)
    return np.stack([table[axis].astype(float) for axis in "xyz"], axis=1)


def read_trajectory(path):
    """Poses as n x 3 x 4 from 12 or 16 numbers a line."""
    table = np.loadtxt(path, ndmin=2)
    if table.shape[1] not in (12, 16):
        sys.exit(f"{path}: line 1: expected 12 or 16 numbers")
    return table[:, :12].reshape(-1, 3, 4)
