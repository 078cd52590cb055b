"""Variants of a scene's files for the experiments: the same bytes for the same arguments.

Environments are LAS as `clearway scene` writes it, models its PLY in float, paths its twelve numbers a
pose.
"""

import os
import struct

import h5py
import numpy as np

from trials.verdicts import rotations

# Bytes of the LAS header: ASPRS LAS 1.4 R15, section 2.4.
POINTS_AT, RECORD_BYTES, COUNT, SCALE, OFFSET, BOUNDS, LONG_COUNT = 96, 105, 107, 131, 155, 179, 247
OCTAVES = 31


def read_las(path):
    """The bytes before the points, as they may be changed, and the records."""
    data = np.memmap(path, np.uint8, "r")
    start, = struct.unpack_from("<I", data, POINTS_AT)
    size, = struct.unpack_from("<H", data, RECORD_BYTES)
    return bytearray(data[:start]), data[start:].reshape(-1, size)


def write_las(path, head, records):
    if struct.unpack_from("<I", head, COUNT)[0]:
        struct.pack_into("<6I", head, COUNT, len(records), len(records), 0, 0, 0, 0)
    if head[25] >= 4:
        struct.pack_into("<16Q", head, LONG_COUNT, len(records), len(records), *[0] * 14)
    with open(path, "wb") as file:
        file.write(head)
        for first in range(0, len(records), 1 << 22):
            np.ascontiguousarray(records[first:first + (1 << 22)]).tofile(file)


def shift_environment(las, out, shift):
    """Every byte of the points is kept. shift: whole metres."""
    head, records = read_las(las)
    for axis, metres in enumerate(shift):
        for at in (OFFSET + 8 * axis, BOUNDS + 16 * axis, BOUNDS + 16 * axis + 8):
            struct.pack_into("<d", head, at, struct.unpack_from("<d", head, at)[0] + metres)
    write_las(out, head, records)


def sample_environment(las, out, wanted, seed):
    """A random sample without replacement, in the order of the file."""
    head, records = read_las(las)
    chosen = np.random.default_rng(seed).choice(len(records), wanted, replace=False, shuffle=False)
    write_las(out, head, records[np.sort(chosen)])


def stretch_environment(las, out, factor):
    """All points and, after them, eight at the corners of their box, which is made `factor` times as
    long about its centre. The integers are divided by the least power of ten with which a box of
    1000 times the length fits 32 bits."""
    head, records = read_las(las)
    quanta = np.ascontiguousarray(records[:, :12]).view("<i4").astype(float)
    low, high = quanta.min(0), quanta.max(0)
    centre, half = (low + high) / 2, (high - low) / 2
    multiple = 1
    while (np.abs(centre) + 1000 * half).max() / multiple > 2**31 - 2:
        multiple *= 10
    ends = np.rint((centre + factor * np.array([-half, half])) / multiple)
    corners = [[ends[i >> axis & 1][axis] for axis in range(3)] for i in range(8)]
    all_records = np.zeros((len(records) + 8, records.shape[1]), np.uint8)
    all_records[:-8] = records
    all_records[:, :12] = np.concatenate([np.rint(quanta / multiple), corners]).astype("<i4").view(np.uint8)
    for axis in range(3):
        scale, = struct.unpack_from("<d", head, SCALE + 8 * axis)
        offset, = struct.unpack_from("<d", head, OFFSET + 8 * axis)
        struct.pack_into("<d", head, SCALE + 8 * axis, scale * multiple)
        struct.pack_into("<2d", head, BOUNDS + 16 * axis,
                         *(end[axis] * scale * multiple + offset for end in ends[::-1]))
    write_las(out, head, all_records)


def read_model(path):
    data = path.read_bytes()
    start = data.index(b"end_header\n") + len(b"end_header\n")
    return np.frombuffer(data[start:], "<f4").reshape(-1, 3).astype(float)


def write_model(path, points):
    head = (f"ply\nformat binary_little_endian 1.0\nelement vertex {len(points)}\n"
            "property double x\nproperty double y\nproperty double z\nend_header\n")
    path.write_bytes(head.encode() + np.asarray(points, "<f8").tobytes())


def write_thinned_model(model, out, voxel):
    """One point of every occupied voxel of a grid through the model's origin: the one nearest to the
    voxel's centre, the first of several, in the model's order."""
    points = read_model(model)
    cells = np.floor(points / voxel)
    away = ((points - (cells + 0.5) * voxel) ** 2).sum(1)
    nearest = np.lexsort((away, *cells.T))
    _, first = np.unique(cells[nearest], axis=0, return_index=True)
    write_model(out, points[np.sort(nearest[first])])


def write_body(model, out, triangles):
    """A closed body like a car's that fills the box of a model, |x/a|^4 + |y/b|^4 + |z/c|^4 = 1.
    triangles: 2 n^2, or rounded down to such a number."""
    points, n = read_model(model), int((triangles / 2) ** 0.5)

    def root(x):
        return np.copysign(np.sqrt(np.abs(x)), x)

    polar = np.pi * np.arange(1, n + 1)[:, None] / (n + 1)
    turn = 2 * np.pi * np.arange(n)[None] / n
    rows = np.stack([root(np.sin(polar)) * root(np.cos(turn)), root(np.sin(polar)) * root(np.sin(turn)),
                     root(np.cos(polar)) + 0 * turn], -1).reshape(-1, 3)
    unit = np.concatenate([rows, [[0, 0, 1], [0, 0, -1]]])
    low, high = points.min(0), points.max(0)
    i, top = np.arange(n), n * n
    faces = [np.stack([0 * i + top, i, (i + 1) % n], 1)]
    for upper in range(0, top - n, n):
        a, b, next_a, next_b = upper + i, upper + n + i, upper + (i + 1) % n, upper + n + (i + 1) % n
        faces += [np.stack([a, b, next_b], 1), np.stack([a, next_b, next_a], 1)]
    faces.append(np.stack([0 * i + top + 1, top - n + (i + 1) % n, top - n + i], 1))
    write_off(out, low + (high - low) / 2 * (1 + unit), np.concatenate(faces))


def write_off(out, corners, faces):
    with open(out, "w", encoding="ascii") as file:
        file.write(f"OFF\n{len(corners)} {len(faces)} 0\n")
        np.savetxt(file, corners, "%.17g")
        for face in faces:
            print(len(face), *face, file=file)


def write_box(out, rear, front, width):
    """A closed box of the width, as high as a load."""
    corners = [(x, y * width / 2, z) for z in (0.5, 3.0)
               for x, y in ((rear, -1), (front, -1), (front, 1), (rear, 1))]
    write_off(out, corners, [(0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7)])


def read_poses(path):
    return np.loadtxt(path, ndmin=2).reshape(-1, 3, 4)


def write_poses(path, poses):
    np.savetxt(path, poses.reshape(-1, 12), "%.17g")


def every_nth(poses, n):
    """Poses 0, n, 2 n, ... and the last one."""
    return poses[sorted({*range(0, len(poses), n), len(poses) - 1})]


def shifted(poses, shift):
    poses = poses.copy()
    poses[:, :, 3] += shift
    return poses


def noisy(poses, sigma):
    """Every pose moved by normal noise of sigma metres an axis, and turned about its own origin by a
    vector of sigma radians an axis."""
    noise = np.random.default_rng(1).normal(0, 1, (len(poses), 6)) * sigma
    poses = shifted(poses, noise[:, :3])
    poses[:, :, :3] = rotations(noise[:, 3:]) @ poses[:, :, :3]
    return poses


def stretched(poses, stretch):
    """Poses that are not rigid: the x axis is longer."""
    poses = poses.copy()
    poses[:, :, 0] *= 1 + stretch
    return poses


def write_boundary_scene(files, radius):
    """A model of one point at the origin, a pose that leaves it there, and points on the x axis whose
    distance is exactly the radius plus as many ulps as are returned: none, and of every octave."""
    random = np.random.default_rng(1)
    steps = [0]
    for octave in range(OCTAVES):
        for step in (2.0**octave * (1 + random.random(64))).astype(int):
            steps += [int(step), -int(step)]
    head, ulp = bytearray(227), np.spacing(radius)
    struct.pack_into("<4s20x2B", head, 0, b"LASF", 1, 2)
    struct.pack_into("<HIIBHI", head, 94, 227, 227, 0, 0, 20, len(steps))
    struct.pack_into("<12d", head, SCALE, ulp, ulp, ulp, radius, 0, 0, radius + max(steps) * ulp,
                     radius + min(steps) * ulp, 0, 0, 0, 0)
    records = np.zeros((len(steps), 20), np.uint8)
    records[:, :4] = np.array(steps, "<i4")[:, None].view(np.uint8)
    write_las(files.environment, head, records)
    write_model(files.model, [(0, 0, 0)])
    write_poses(files.trajectory, np.eye(3, 4)[None])
    return np.array(steps)


def decided_at_boundary(result, steps):
    """False hits and misses and, by octave of the ulps, how many points there are and are wrong."""
    found = np.zeros(len(steps), bool)
    with h5py.File(result) as file:
        found[file["collisions/source"][:]] = True
    octave = np.log2(np.maximum(np.abs(steps), 1)).astype(int)
    return {"false_hits": int((found & (steps >= 0)).sum()), "misses": int((~found & (steps < 0)).sum()),
            "points": np.bincount(octave, minlength=OCTAVES).tolist(),
            "wrong": np.bincount(octave[found != (steps < 0)], minlength=OCTAVES).tolist()}


def drop_from_page_cache(path):
    with open(path, "rb") as file:
        os.fsync(file.fileno())  # unwritten pages would stay
        os.posix_fadvise(file.fileno(), 0, 0, os.POSIX_FADV_DONTNEED)
