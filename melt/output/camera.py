"""Perspective camera."""

from typing import NamedTuple

import numpy as np

#: Directions from the target to the eye, z up.
VIEWS = {
    "iso": (0.62, -1.0, 0.52),
    "side": (0.0, -1.0, 0.10),
    "top": (0.0, -0.02, 1.0),
    "front": (1.0, 0.0, 0.10),
}
FIELD_OF_VIEW = 28.0  # degrees, vertical


class Camera(NamedTuple):
    """Eye [m], rows right, down, forward of the camera frame, focal length and centre [pixels]."""

    eye: np.ndarray
    axes: np.ndarray
    focal: float
    width: int
    height: int
    shift: float = 0.0  # of the centre to the left [pixels], to leave room for the colour bar

    def view(self, points):
        """Return points (n, 3) in the camera frame (right, down, forward) [m]."""
        return (np.asarray(points, np.float64) - self.eye) @ self.axes.T

    def pixels(self, points):
        """Return (n, 2) pixel coordinates of points (n, 3)."""
        v = self.view(points)
        return v[:, :2] / v[:, 2:] * self.focal + self.centre

    @property
    def centre(self):
        return np.array([self.width / 2 - self.shift, self.height / 2])

    def rays(self):
        """Return unit-depth rays (height, width, 3) in the world frame."""
        x = (np.arange(self.width) + 0.5 - self.centre[0]) / self.focal
        y = (np.arange(self.height) + 0.5 - self.centre[1]) / self.focal
        right, down, forward = self.axes.astype(np.float32)
        return (
            x.astype(np.float32)[None, :, None] * right + y.astype(np.float32)[:, None, None] * down + forward
        )


def look(direction):
    """Return the axes (right, down, forward) of a camera looking from ``direction``, z up."""
    forward = -np.asarray(direction, float)
    forward /= np.linalg.norm(forward)
    up = np.array([0.0, 0.0, 1.0]) if abs(forward[2]) < 0.9999 else np.array([0.0, 1.0, 0.0])
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    return np.stack([right, np.cross(forward, right), forward])


def fit(low, high, view, width, height, margin=0.10, right=0.0):
    """Return the camera that shows the box low .. high; ``right`` is the share kept free at the right."""
    low, high = np.asarray(low, float), np.asarray(high, float)
    axes = look(VIEWS[view])
    corners = np.array([[(low, high)[b][k] for k, b in enumerate(bits)] for bits in np.ndindex(2, 2, 2)])
    middle = (low + high) / 2
    focal = height / 2 / np.tan(np.radians(FIELD_OF_VIEW / 2))
    shift = right * width / 2
    v = (corners - middle) @ axes.T
    half = np.array([(1 - right) * width, height]) / 2 * (1 - margin) / focal
    # |v_xy| <= half * (v_z + d) for every corner, also after centring the picture of the box
    distance = np.max(np.abs(v[:, :2]) / half - v[:, 2:])
    for _ in range(3):
        picture = v[:, :2] / (v[:, 2:] + distance)
        offset = (picture.min(axis=0) + picture.max(axis=0)) / 2 * distance
        v[:, :2] -= offset
        middle = middle + offset @ axes[:2]
        distance = np.max(np.abs(v[:, :2]) / half - v[:, 2:])
    distance = max(distance, 1e-6)
    return Camera(middle - axes[2] * distance, axes, focal, width, height, shift)
