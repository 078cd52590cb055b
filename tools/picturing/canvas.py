"""A camera, and an image of the points that it sees."""

import numpy as np

BACKGROUND = (1.0, 1.0, 1.0)


class Camera:
    """Perspective from `eye` to `target`, z up."""

    def __init__(self, eye, target, size, field_degrees=55):
        self.eye = eye
        self.size = size
        forward = (target - eye) / np.linalg.norm(target - eye)
        right = np.cross(forward, [0, 0, 1.0])
        right /= np.linalg.norm(right)
        self.axes = np.stack([right, np.cross(right, forward), forward])
        self.focal = 0.5 * size[0] / np.tan(np.radians(field_degrees) / 2)

    def project(self, points):
        """Pixel columns, rows and depths of the points in front."""
        x, y, depth = self.axes @ (points - self.eye).T
        keep = depth > 0.3
        with np.errstate(divide="ignore", invalid="ignore"):
            column = self.size[0] / 2 + self.focal * x / depth
            row = self.size[1] / 2 - self.focal * y / depth
        keep &= (column > -20) & (column < self.size[0] + 20)
        keep &= (row > -20) & (row < self.size[1] + 20)
        return column[keep], row[keep], depth[keep], keep


class Canvas:
    """An image to which the nearest point of each pixel belongs."""

    def __init__(self, camera):
        self.camera = camera
        self.image = np.full((camera.size[1], camera.size[0], 3), BACKGROUND)
        self.depth = np.full((camera.size[1], camera.size[0]), np.inf)

    def draw(self, points, colours, metres, before=0.0, most=6):
        """Squares of about `metres` a side; colours: n x 3 or one colour. They win against what is
        up to `before` metres nearer, so that points in a surface show."""
        column, row, depth, keep = self.camera.project(points)
        colours = np.broadcast_to(colours, (len(points), 3))[keep]
        sides = np.clip(np.rint(self.camera.focal * metres / depth), 1, most).astype(int)
        depth = np.maximum(depth - before, 0.01)
        order = np.argsort(-depth)
        column, row, depth = column[order].astype(int), row[order].astype(int), depth[order]
        colours, sides = colours[order], sides[order]
        for dy in range(most):
            for dx in range(most):
                self.put(column + dx - sides // 2, row + dy - sides // 2, depth, colours,
                         (dx < sides) & (dy < sides))

    def put(self, column, row, depth, colours, keep):
        keep = keep & (column >= 0) & (column < self.camera.size[0])
        keep &= (row >= 0) & (row < self.camera.size[1])
        at = (row[keep], column[keep])
        nearer = depth[keep] < self.depth[at]
        at = (at[0][nearer], at[1][nearer])
        self.depth[at] = depth[keep][nearer]  # far to near: the last written is the nearest
        self.image[at] = colours[keep][nearer]


def shade(canvas):
    """Darkens pixels behind nearer neighbours (eye-dome lighting), which shows edges."""
    depth = np.where(np.isfinite(canvas.depth), np.log2(canvas.depth), np.nan)
    sum_ = np.zeros_like(depth)
    for dy, dx in ((0, 2), (2, 0), (0, -2), (-2, 0), (1, 1), (-1, 1), (1, -1), (-1, -1)):
        neighbour = np.roll(depth, (dy, dx), (0, 1))
        sum_ += np.nan_to_num(np.clip(depth - neighbour, 0, 0.15))
    canvas.image *= np.exp(-1.3 * sum_)[:, :, None]
