"""How many cubes inside opaque things `clearway run --seen` calls seen, where ranges are noisy."""

import json
import subprocess

import h5py
import numpy as np

from trials.scans import QUANTUM, keys, write_las, write_origins

SPACING = 0.5  # metres between the points of a model that fills a box
REACH = 0.45   # radius with which it sweeps all of the box


class Ground:
    """A scene with a model that sweeps all of its cubes."""

    def __init__(self, program, folder, scene):
        self.program, self.folder, self.scene = program, folder, scene
        low = np.min([thing.bounds()[0] for thing in scene.things], axis=0)
        high = np.max([thing.bounds()[1] for thing in scene.things], axis=0)
        axes = [np.arange(a, b + SPACING, SPACING) for a, b in zip(low, high)]
        grid = np.stack(np.meshgrid(*axes, indexing="ij"), -1).reshape(-1, 3)
        np.savetxt(folder / "model.xyz", grid, "%.6f")
        (folder / "path.txt").write_text("1 0 0 0 0 1 0 0 0 0 1 0\n")

    def run(self, *arguments):
        done = subprocess.run([self.program, *map(str, arguments)], capture_output=True, text=True,
                              check=False)
        if done.returncode:
            raise RuntimeError(f"{self.program} {arguments[0]} failed: {done.stderr}")
        return done.stdout

    def convert(self, points, of):
        las, origins = self.folder / "scan.las", self.folder / "origins.csv"
        write_las(las, points)
        write_origins(origins, self.scene.scanners, of)
        self.run("convert", las, "--origins", origins, "-o", self.folder / "site.h5", "--force")

    def unseen(self, side):
        """The cubes that were not seen, as keys(), and how many were swept."""
        result = self.folder / "out.h5"
        report = json.loads(self.run(
            "run", "--env", self.folder / "site.h5", "--model", self.folder / "model.xyz",
            "--trajectory", self.folder / "path.txt", "--radius", REACH, "--seen", "--seen-cube",
            side, "--json", "--force", "-o", result))
        with h5py.File(result) as file:
            return keys(file["unseen/cube"][:]), report["seen"]["swept"]


def look(ground, random, rays, noise, sides):
    """Scans the scene with this noise. Returns for each side of cubes how many lie inside things,
    how many of these are called seen, the same of the skin, and how many would be called seen at
    least if a beam had to touch the whole cube alone: those that a recorded point lies in."""
    points, of = ground.scene.scan(random, rays, noise)
    ground.convert(points, of)
    found = {}
    for side in sides:
        inside, skin = ground.scene.cubes_inside(side)
        unseen, swept = ground.unseen(side)
        ends = np.floor(np.rint(points / QUANTUM) / round(side / QUANTUM)).astype(int)
        found[side] = {"swept": swept, "inside": len(inside),
                       "seen": len(np.setdiff1d(inside, unseen, True)), "skin": len(skin),
                       "skin_seen": len(np.setdiff1d(skin, unseen, True)),
                       "whole": len(np.intersect1d(inside, keys(ends))), "beams": len(points)}
    return found
