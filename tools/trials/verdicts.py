"""How often a verdict with an error budget is wrong, for a place whose true distance is the margin:
by Monte Carlo, and by running Clearway itself on thousands of such places."""

import tempfile
from pathlib import Path

import h5py
import numpy as np

from trials.scans import write_las

QUANTUM = 0.0001   # metres; the step of the stores, small beside all errors
APART = 3.0        # metres between two places, so that none touches another's model
SIDE = 0.5         # metres; sides of the model's faces
CERTAIN = 10       # points that make a conflict


class Errors:
    """Standard deviations: metres on each axis, and radians."""

    def __init__(self, scan=0.0, registration=0.0, pose=0.0, angle=0.0):
        self.scan, self.registration, self.pose, self.angle = scan, registration, pose, angle

    def options(self):
        return {"error_scan": self.scan, "error_registration": self.registration,
                "error_pose": self.pose, "error_angle": self.angle}

    def margins(self, shape, sigmas):
        """U_clear and U_conflict as docs/design/findings.md defines them, of points whose step is
        QUANTUM and a model that stands still."""
        hard = np.sqrt(3) * QUANTUM / 2
        lever = np.linalg.norm(shape.vertices(), axis=1).max()
        others = self.registration**2 + self.pose**2 + (self.angle * lever) ** 2
        return {"clear": hard + sigmas * np.sqrt(others + self.scan**2),
                "conflict": hard + sigmas * np.sqrt(others) + 6 * self.scan}


ERRORS = {"position": Errors(registration=0.01, pose=0.02),
          "all": Errors(scan=0.005, registration=0.01, pose=0.02, angle=np.radians(0.05))}


class Wall:
    """A scanned wall beside a flat side of the vehicle, which is the plane y = 0."""
    name = "wall and plane"
    # The sides of the vehicle, each of four corners, as multiples of SIDE.
    sides = [[[-1, 0, -1], [1, 0, -1], [1, 0, 1], [-1, 0, 1]]]

    def vertices(self):
        return SIDE * np.concatenate(self.sides)

    def mesh(self):
        """Vertices, and two triangles of each side."""
        return self.vertices(), np.array([[4 * i, 4 * i + k, 4 * i + k + 1]
                                          for i in range(len(self.sides)) for k in (1, 2)], np.uint32)

    def points(self, margin):
        """True points whose least distance is the margin."""
        at = np.arange(-0.15, 0.151, 0.05)
        x, z = np.meshgrid(at, at)
        return np.stack([x.ravel(), np.full(x.size, margin), z.ravel()], 1)

    def distance(self, points):
        return np.abs(points[..., 1])


class Edge(Wall):
    """A scanned upright edge beside an upright edge of the vehicle, which fills x < 0, y < 0."""
    name = "edge and edge"
    axes = 2  # on which the vehicle ends
    sides = [[[0, 0, -1], [0, -1, -1], [0, -1, 1], [0, 0, 1]],
             [[0, 0, -1], [-1, 0, -1], [-1, 0, 1], [0, 0, 1]]]

    def points(self, margin):
        z = np.arange(-0.15, 0.151, 0.02)
        return np.stack([np.full(z.size, margin / np.sqrt(2))] * 2 + [z], 1)

    def distance(self, points):
        """To the surface of all that is below 0 on every axis."""
        points = points[..., :self.axes]
        outside = np.linalg.norm(np.maximum(points, 0), axis=-1)
        return np.where(outside > 0, outside, -points.max(-1))


class Corner(Edge):
    """A single scanned point beside a corner of the vehicle, which fills x < 0, y < 0, z < 0."""
    name = "point and corner"
    axes = 3
    sides = [np.roll([[0, 0, 0], [-1, 0, 0], [-1, -1, 0], [0, -1, 0]], k, 1) for k in range(3)]

    def points(self, margin):
        return np.full((1, 3), margin / np.sqrt(3))


SHAPES = {shape.name: shape for shape in (Wall(), Edge(), Corner())}


def rotations(vectors):
    """Rotation matrices of rotation vectors (Rodrigues)."""
    angle = np.linalg.norm(vectors, axis=1)
    x, y, z = (vectors / np.where(angle > 0, angle, 1)[:, None]).T
    zero = np.zeros_like(x)
    cross = np.stack([zero, -z, y, z, zero, -x, -y, x, zero], 1).reshape(-1, 3, 3)
    return (np.eye(3) + np.sin(angle)[:, None, None] * cross
            + (1 - np.cos(angle))[:, None, None] * (cross @ cross))


class Places:
    """Places whose true distance is the margin, as scan and path have them."""

    def __init__(self, shape, errors, margin, count, random):
        true = shape.points(margin)
        self.shape, self.margin = shape, margin
        points = true + random.normal(size=(count, 1, 3)) * errors.registration
        points += random.normal(size=(count, *true.shape)) * errors.scan
        self.points = np.rint(points / QUANTUM) * QUANTUM  # as the store keeps them
        self.shifts = random.normal(size=(count, 3)) * errors.pose
        self.turns = rotations(random.normal(size=(count, 3)) * errors.angle)

    def distances(self):
        """Distances of the recorded points from the model at the recorded pose, a row a place."""
        return self.shape.distance((self.points - self.shifts[:, None]) @ self.turns)


def wrong(distances, margin, margins):
    """Which places are called clear, and which a conflict, though they stand at the margin."""
    clear = distances.min(1) >= margin + margins["clear"]
    conflict = (distances < margin - margins["conflict"]).sum(1) >= CERTAIN
    return clear, conflict


def monte_carlo(shape, errors, margin, sigmas, trials, seed):
    """How many of so many places are called clear, and how many a conflict, by number of
    deviations; also of groups of 1, 10 and 100 places those in which any is called clear."""
    random = np.random.default_rng(seed)
    at_once = 20_000
    found = {k: {"clear": 0, "conflict": 0, "groups": {n: 0 for n in (1, 10, 100)}} for k in sigmas}
    for _ in range(trials // at_once):
        distances = Places(shape, errors, margin, at_once, random).distances()
        for k, sums in found.items():
            clear, conflict = wrong(distances, margin, errors.margins(shape, k))
            sums["clear"] += int(clear.sum())
            sums["conflict"] += int(conflict.sum())
            for n in sums["groups"]:
                sums["groups"][n] += int(clear.reshape(-1, n).any(1).sum())
    return {k: {"trials": trials, "margins": errors.margins(shape, k), **sums}
            for k, sums in found.items()}


def ask(clearway, places, errors, sigmas):
    """Asks the Python module `clearway` about many places at once: each is a pose of one of two bodies
    that take turns, so that none moves and no place is near another. Returns which places are called
    clear, which a conflict, and its margins."""
    count, each = places.points.shape[:2]
    columns = int(np.ceil(np.sqrt(count)))
    at = APART * np.stack([np.arange(count) % columns, np.arange(count) // columns, np.zeros(count)], 1)
    poses = np.zeros((count, 3, 4))
    poses[:, :, :3], poses[:, :, 3] = places.turns, places.shifts + at
    model = clearway.Model(*places.shape.mesh())
    bodies = [clearway.Body(f"turn {i}", model, poses[i::2], np.arange(i, count, 2, dtype=np.uint32))
              for i in range(2)]
    with tempfile.TemporaryDirectory() as name:
        scan, store, out = (Path(name) / end for end in ("scan.las", "site.h5", "out.h5"))
        write_las(scan, (places.points + at[:, None]).reshape(-1, 3), QUANTUM)
        clearway.convert(scan, store)
        query = clearway.Query(bodies=bodies, poses=poses, radius=max(places.margin, 1e-9),
                               sigmas=sigmas, **errors.options())
        report = clearway.search(clearway.Store(store), query, out)
        result = clearway.Result(out)
        colliding = result.collisions().source.astype(np.int64)
        near = result.near().source.astype(np.int64)
        with h5py.File(out) as file:
            certain = colliding[file["collisions/certain"][:].astype(bool)]
    clear = np.ones(count, bool)
    clear[np.concatenate([near, colliding]) // each] = False
    conflict = np.bincount(certain // each, minlength=count) >= CERTAIN
    return clear, conflict, report.margins
