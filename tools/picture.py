#!/usr/bin/python3
"""Makes a picture of a result: a perspective view of the place with most collisions, and the plan.

Needs h5py, matplotlib and numpy (Debian: python3-h5py python3-matplotlib).
Example: tools/picture.py --environment environment.las --result out.h5 --model model.ply \
             --trajectory trajectory.txt -o result.png
"""

import argparse
import io
import sys

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from matplotlib.lines import Line2D  # noqa: E402
from PIL import Image  # noqa: E402
from picturing.canvas import Camera, Canvas, shade  # noqa: E402
from picturing.files import read_las, read_ply, read_trajectory  # noqa: E402

# Okabe and Ito's palette: distinguishable with every kind of colour vision.
COLLIDING = "#d55e00"
MODEL = "#0072b2"
MODEL_ELSEWHERE = "#56b4e9"
PATH = "#000000"


def thinned(points, most):
    """Every k-th point, at most `most`."""
    return points[:: max(1, -(-len(points) // most))]


def moved(model, pose):
    return model @ pose[:, :3].T + pose[:, 3]


def busiest_pose(poses, model, colliding):
    """The pose whose surroundings hold most colliding points; the middle one where there are none."""
    if len(colliding) == 0:
        return len(poses) // 2
    reach = np.ptp(model, axis=0).max()
    some = thinned(colliding, 20_000)
    centre = model.mean(axis=0)
    tried = np.unique(np.linspace(0, len(poses) - 1, 400).astype(int))
    counts = [np.count_nonzero(((some - moved(centre, poses[i])) ** 2).sum(axis=1) < reach**2)
              for i in tried]
    return tried[int(np.argmax(counts))]


def heading(poses, index):
    """Horizontal unit vector along the path at a pose; x where it stands still."""
    for reach in (5, 50, len(poses)):
        ahead = poses[min(index + reach, len(poses) - 1), :, 3]
        way = (ahead - poses[max(index - reach, 0), :, 3])[:2]
        if np.hypot(*way) > 1e-6:
            return way / np.hypot(*way)
    return np.array([1.0, 0.0])


def other_poses(poses, model, index, most=3):
    """Poses ahead of and behind `index`, some model lengths apart."""
    steps = np.linalg.norm(np.diff(poses[:, :, 3], axis=0), axis=1)
    way = np.concatenate([[0], np.cumsum(steps)])
    wanted = way[index] + 2.5 * np.ptp(model, axis=0).max() * np.arange(-most, most + 1)
    wanted = wanted[(wanted >= 0) & (wanted <= way[-1]) & (wanted != way[index])]
    return np.clip(np.searchsorted(way, wanted), 0, len(poses) - 1)


def greys(heights, lo, hi):
    level = 0.55 + 0.37 * np.clip((heights - lo) / max(hi - lo, 1e-6), 0, 1)
    return np.stack([level, level, level * 1.03], axis=1).clip(0, 1)


def rgb(name):
    return np.array(matplotlib.colors.to_rgb(name))


def perspective(ax, scene, index, cut):
    """The model at the busiest pose, and what it touches, seen from behind and above."""
    environment, colliding, model, poses = scene
    length = np.ptp(model, axis=0).max()
    way = heading(poses, index)
    centre = moved(model.mean(axis=0), poses[index])
    side = np.array([-way[1], way[0]])
    eye = centre + np.append(-2.1 * length * way + 0.9 * length * side, 1.5 * length)
    target = centre + np.append(0.7 * length * way, -0.1 * length)
    camera = Camera(eye, target, (1800, 1000))
    dot = length / 90
    near = ((environment[:, :2] - centre[:2]) ** 2).sum(axis=1) < (40 * length) ** 2
    near &= environment[:, 2] < cut
    shown = environment[near]
    canvas = Canvas(camera)
    if len(shown):
        canvas.draw(shown, greys(shown[:, 2], *np.percentile(shown[:, 2], [2, 98])), dot)
    canvas.draw(moved(model, poses[index]), rgb(MODEL), dot)
    for other in other_poses(poses, model, index):
        if heading(poses, index) @ (poses[other] - poses[index])[:2, 3] > 0:
            canvas.draw(moved(model, poses[other]), rgb(MODEL_ELSEWHERE), dot)
    canvas.draw(colliding, rgb(COLLIDING), dot, before=3 * dot)
    shade(canvas)
    ax.imshow(canvas.image.clip(0, 1), interpolation="antialiased")
    ax.set_xticks([])
    ax.set_yticks([])
    for spine in ax.spines.values():
        spine.set_color("0.7")


def turned(points, axes):
    return points[:, :2] @ axes.T


def plan_frame(model, poses):
    """Plan axes along and across the path from the first pose, and the limits of what to show."""
    track = poses[:, :2, 3] - poses[0, :2, 3]
    _, _, axes = np.linalg.svd(track - track.mean(axis=0), full_matrices=False)
    if len(poses) < 2:
        axes = np.eye(2)
    if axes[0] @ track[-1] < 0:
        axes[0] = -axes[0]
    axes[1] = [-axes[0][1], axes[0][0]]
    path = track @ axes.T
    margin = max(2.0 * np.ptp(model, axis=0).max(), 0.12 * np.ptp(path[:, 0]))
    return axes, path.min(axis=0) - margin, path.max(axis=0) + margin


def plan(ax, scene, index, cut, frame):
    """Everything from above, axes in metres from the first pose."""
    environment, colliding, model, poses = scene
    axes, lo, hi = frame
    origin = poses[0, :, 3]
    path = turned(poses[:, :, 3] - origin, axes)
    seen = environment[environment[:, 2] < cut] - origin
    density(ax, turned(seen, axes), lo, hi)
    ax.plot(*path.T, color=PATH, linewidth=0.8)
    hits = turned(thinned(colliding, 1_000_000) - origin, axes)
    ax.scatter(*hits.T, s=1.5, c=COLLIDING, linewidths=0, rasterized=True)
    for other in [*other_poses(poses, model, index), index]:
        shown = turned(moved(model, poses[other]) - origin, axes)
        ax.scatter(*thinned(shown, 10_000).T, s=0.6, linewidths=0, rasterized=True,
                   c=MODEL if other == index else MODEL_ELSEWHERE)
    ax.set(xlim=(lo[0], hi[0]), ylim=(lo[1], hi[1]), aspect="equal",
           xlabel="along the path's main direction from the first pose (m)", ylabel="across (m)")


def density(ax, points, lo, hi):
    shape = np.maximum(1, (1600 * (hi - lo) / (hi - lo).max()).astype(int))
    counts, _, _ = np.histogram2d(*points.T, bins=shape, range=list(zip(lo, hi)))
    top = np.percentile(counts[counts > 0], 97) if counts.any() else 1
    grey = 1 - 0.5 * np.clip(np.log1p(counts) / np.log1p(top), 0, 1)
    ax.imshow(grey.T, origin="lower", extent=(lo[0], hi[0], lo[1], hi[1]), cmap="gray", vmin=0,
              vmax=1, interpolation="antialiased")


def legend(figure):
    def dot(colour):
        return Line2D([], [], marker="s", linestyle="", color=colour, markersize=9)

    entries = [(dot("0.65"), "environment"), (dot(MODEL), "model"),
               (dot(MODEL_ELSEWHERE), "model at other poses"),
               (dot(COLLIDING), "colliding points of all poses"),
               (Line2D([], [], color=PATH, linewidth=2), "trajectory")]
    figure.legend(*zip(*entries), loc="lower center", ncol=5, frameon=False, fontsize=11)


def save(figure, path):
    """As a PNG of 256 colours, a third of the size of all."""
    with io.BytesIO() as buffer:
        figure.savefig(buffer, dpi=100)
        image = Image.open(buffer).convert("RGB")
    image.quantize(256, method=Image.Quantize.MEDIANCUT).save(path, optimize=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--environment", required=True, help="LAS file")
    parser.add_argument("--result", required=True, help="result of clearway run")
    parser.add_argument("--model", required=True, help="PLY file")
    parser.add_argument("--trajectory", required=True, help="12 or 16 numbers a line")
    parser.add_argument("--pose", type=int, help="show the model here (default: most collisions)")
    parser.add_argument("--cut", type=float, metavar="Z",
                        help="leave out what is above this height in metres (default: a model's "
                             "height above the model), so that roofs hide nothing")
    parser.add_argument("--points", type=int, default=8_000_000, metavar="N",
                        help="draw at most N environment points (default: %(default)s)")
    parser.add_argument("-o", "--output", required=True, help="PNG file")
    options = parser.parse_args()

    environment = read_las(options.environment, options.points)
    model = read_ply(options.model)
    poses = read_trajectory(options.trajectory)
    if len(model) == 0 or len(poses) == 0:
        sys.exit("nothing to show: the model or the trajectory is empty")
    with h5py.File(options.result, "r") as result:
        colliding = result["collisions/xyz"][:]
        radius = float(np.ravel(result.attrs["radius"])[0])
        total = int(np.ravel(result.attrs["environment_points"])[0])
    index = options.pose if options.pose is not None else busiest_pose(poses, model, colliding)
    if not 0 <= index < len(poses):
        sys.exit(f"--pose {index}: expected 0 to {len(poses) - 1}")
    shown = moved(model, poses[index])
    cut = shown[:, 2].max() + np.ptp(shown[:, 2]) if options.cut is None else options.cut
    scene = (environment, colliding, model, poses)

    frame = plan_frame(model, poses)
    sides = frame[2] - frame[1]
    plan_inches = np.clip(11.2 * sides[1] / sides[0], 1.6, 5.0)
    figure, (top, bottom) = plt.subplots(2, 1, figsize=(12, 8.1 + plan_inches),
                                         height_ratios=(6.4, plan_inches))
    perspective(top, scene, index, cut)
    plan(bottom, scene, index, cut, frame)
    top.set_title(f"{len(colliding):,} of {total:,} points come closer than {radius:g} m "
                  f"to the model on its way ({len(poses):,} poses)", fontsize=13)
    legend(figure)
    figure.tight_layout(rect=(0, 0.035, 1, 1))
    save(figure, options.output)


if __name__ == "__main__":
    main()
