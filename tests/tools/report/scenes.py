"""Small scenes with their results and pages, made by the program. Standard library only."""

import json
import math
import subprocess

PROGRAM = None
DATE = "2026-01-02 03:04 UTC"


def clearway(*arguments, code=0):
    done = subprocess.run([PROGRAM, *map(str, arguments)], capture_output=True, text=True)
    if done.returncode != code:
        raise AssertionError(f"{arguments}: exit code {done.returncode}\n{done.stderr}")
    return done.stdout if code == 0 else done.stderr


class Scene:
    """Store, model, trajectory and result in a folder of their own."""

    def __init__(self, folder, *query):
        self.folder, self.model = folder, f"{folder}/model.ply"
        self.trajectory, self.store = f"{folder}/trajectory.txt", f"{folder}/site.h5"
        self.query = query

    def search(self, name, *options):
        result = f"{self.folder}/{name}.h5"
        clearway("run", "--env", self.store, "--model", self.model, "--trajectory",
                 self.trajectory, *options, "-o", result, "--force")
        return result

    def report(self, result, name, *options, code=0):
        page = f"{self.folder}/{name}.html"
        text = clearway("report", result, "--env", self.store, "--model", self.model,
                        "--trajectory", self.trajectory, "-o", page, "--force", "--json",
                        "--date", DATE, *options, code=code)
        return page, json.loads(text) if code == 0 else text


def make_hall(folder):
    clearway("scene", "hall", "--points", 30000, "--poses", 400, "--model-points", 2500, "-o",
             folder, "--force")
    hall = Scene(folder)
    clearway("convert", f"{folder}/environment.las", "-o", hall.store, "--force")
    return hall


def make_car(path, rings=24):
    """A closed body about as large as a car, as a mesh; its ends are single vertices."""
    def power(x, e):
        return math.copysign(abs(x) ** e, x)

    corners, faces = [(2.1, 0, 0.75), (-2.1, 0, 0.75)], []
    for i in range(1, rings):
        t = math.pi * i / rings
        for j in range(2 * rings):
            p = math.pi * j / rings
            across = power(math.sin(t), 0.4)
            corners.append((2.1 * power(math.cos(t), 0.4), 1.2 * across * power(math.cos(p), 0.4),
                            0.75 + 0.7 * across * power(math.sin(p), 0.4)))

    def at(i, j):
        return i // rings if i in (0, rings) else 2 + (i - 1) * 2 * rings + j % (2 * rings)

    for i in range(rings):
        for j in range(2 * rings):
            a, b, c, d = at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)
            if i > 0:
                faces.append((a, b, c))
            if i < rings - 1:
                faces.append((b, d, c))
    with open(path, "w") as file:
        file.write(f"OFF\n{len(corners)} {len(faces)} 0\n")
        file.writelines(f"{x:.6f} {y:.6f} {z:.6f}\n" for x, y, z in corners)
        file.writelines(f"3 {a} {b} {c}\n" for a, b, c in faces)


def make_empty(folder):
    """A box that is carried one metre above a floor."""
    scene = Scene(folder)
    scene.model = f"{folder}/model.xyz"
    with open(f"{folder}/floor.xyz", "w") as file:
        for x in range(0, 200):
            for y in range(-20, 21):
                file.write(f"{x / 10} {y / 10} 0\n")
    with open(scene.model, "w") as file:
        for x in (-0.5, 0.5):
            for y in (-0.5, 0.5):
                for z in (0, 1):
                    file.write(f"{x} {y} {z}\n")
    with open(scene.trajectory, "w") as file:
        for i in range(100):
            file.write(f"1 0 0 {5 + i / 10} 0 1 0 0 0 0 1 {1 + abs(i - 30) / 100}\n")
    clearway("convert", f"{folder}/floor.xyz", "-o", scene.store, "--force")
    return scene


def make_lane(folder):
    """A box of 2 x 1 x 1 m that meets a wall on its left, one on its right, and a gate of 0.8 m."""
    lane = Scene(folder)
    lane.model = f"{folder}/box.off"
    clearway("model", "box", "2,1,1", "-o", lane.model, "--force")
    with open(lane.trajectory, "w") as file:
        file.writelines(f"1 0 0 {0.5 * i} 0 1 0 0 0 0 1 0\n" for i in range(41))
    with open(f"{folder}/scan.xyz", "w") as file:
        for x, y in ((3, 0.4), (8, -0.3), (14, 0.4), (14, -0.4)):
            file.writelines(f"{x + 0.1 * i:.1f} {y} {0.1 + 0.2 * k:.1f}\n"
                            for i in range(11) for k in range(5))
    clearway("convert", f"{folder}/scan.xyz", "-o", lane.store, "--force")
    return lane


def make_epoch(folder, name, panels):
    """A box of 2 x 1 x 1 m in a lane with walls, where panels of 1 m stand: (chainage, left) of each."""
    lane = Scene(folder)
    lane.model, lane.store = "box:2,1,1", f"{folder}/{name}.h5"
    lane.trajectory = f"{folder}/{name}.txt"
    with open(lane.trajectory, "w") as file:
        file.writelines(f"1 0 0 {0.05 * i} 0 1 0 0 0 0 1 0\n" for i in range(401))
    with open(f"{folder}/{name}.xyz", "w") as file:
        for x, y in panels:
            file.writelines(f"{x + 0.1 * i:.1f} {y} {0.1 + 0.1 * k:.1f}\n" for i in range(11) for k in range(9))
        file.writelines(f"{-2 + 0.25 * i} {y} {0.25 * k}\n" for i in range(105) for y in (-1.1, 1.1) for k in range(5))
        file.writelines(f"{-2 + 0.25 * i} {-1 + 0.25 * k} -0.5\n" for i in range(105) for k in range(9))
    clearway("convert", f"{folder}/{name}.xyz", "-o", lane.store, "--force")
    return lane


def make_road(folder):
    """A car that drives towards a wall, which a scanner saw but for a wedge behind a board."""
    scene = Scene(folder)
    scene.model = f"{folder}/model.xyz"
    with open(scene.model, "w") as file:
        for x in (-0.6, -0.3, 0, 0.3, 0.6):
            for i in range(11):
                file.writelines(f"{x} {-0.5 + 0.1 * i:.1f} {-0.3 + 0.1 * j:.1f}\n"
                                for j in range(7))
    with open(scene.trajectory, "w") as file:
        file.writelines(f"1 0 0 {8 + 0.1 * i:.1f} 0 1 0 0 0 0 1 0\n" for i in range(71))
    with open(f"{folder}/scan.xyz", "w") as file:
        for i in range(-60, 61):
            for j in range(-40, 41):
                y, z = 0.05 * i + 0.013, 0.05 * j + 0.011
                part = 0.25 if 0 <= y / 4 < 0.3 else 1
                file.write(f"{20 * part} {y * part:.5f} {z * part:.5f}\n")
    with open(f"{folder}/origins.csv", "w") as file:
        file.write("first,x,y,z\n0,0,0,0\n")
    clearway("convert", f"{folder}/scan.xyz", "--origins", f"{folder}/origins.csv", "-o",
             scene.store, "--force")
    return scene
