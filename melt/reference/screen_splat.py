r"""Particles as spheres in the picture: projection, depth, thickness, values. Flood spec 5, R1, R2, R5.

The ray of a pixel is :math:`d = (u, v, 1)` in the camera frame (right, down, forward), a sphere has centre c and
radius r. Depth is that of the nearer root of :math:`|t d - c|^2 = r^2`; thickness is the sum of chords
:math:`2 \sqrt{r^2 - |d \times c|^2 / |d|^2}`, which is 2 r n_z.
"""

import numpy as np

from melt.reference._screen import halved, pierce, rays, spheres


def screen_project(position, screen_radius, view, screen_sphere, screen_box, screen_skipped):
    """Write the spheres in the camera frame and what they cover at most; unseen ones get an empty box.

    Reads: position (3, n), screen_radius (n,) [m].
    Writes: screen_sphere (4, n) [m], screen_box (4, n) [px], screen_skipped (64,).
    """
    n, pieces = position.shape[1], screen_skipped.shape[0]
    X, R = position.astype(np.float64), screen_radius.astype(np.float64)
    finite = np.isfinite(X).all(axis=0) & np.isfinite(R)
    piece = [np.count_nonzero(~finite[p * n // pieces : (p + 1) * n // pieces]) for p in range(pieces)]
    screen_skipped[:] = piece
    screen_sphere[:], screen_box[:] = 0, np.array([[0], [-1], [0], [-1]])
    axes = np.array([[getattr(view, f"{a}_{k}") for k in "xyz"] for a in ("right", "down", "forward")], np.float64)
    eye = np.array([view.eye_x, view.eye_y, view.eye_z], np.float64)
    f, cx, cy = (float(v) for v in (view.focal, view.centre_x, view.centre_y))
    for i in np.flatnonzero(finite & (R > 0)):
        below = np.array([0, 0, R[i] if view.below else 0.0])  # spec 5: centre (x, y, surface - r)
        x, y, z = axes @ (X[:, i] - below - eye)
        r = max(R[i], float(view.smallest) * z / f)
        if z <= 1.01 * r or z + r >= view.far:  # reaches the eye, or beyond what is drawn
            continue
        screen_sphere[:, i] = x, y, z, r
        # tangents to the circle (x, z; r) from the eye: u = (x z +- r sqrt(x^2 + z^2 - r^2)) / (z^2 - r^2)
        for k, (a, c) in enumerate(((x, cx), (y, cy))):
            s = r * np.sqrt(a * a + z * z - r * r)
            screen_box[2 * k : 2 * k + 2, i] = c + f * (a * z + np.array([-s, s])) / (z * z - r * r)


def screen_depth(screen_sphere, screen_box, behind_depth, view, screen_depth):
    """Write the depth of the nearest sphere in front of what is behind, infinity for none (R2)."""
    u, v = rays(screen_depth.shape, view)
    nearest = np.full(screen_depth.shape, np.inf)
    for _, *sphere in spheres(screen_sphere, screen_box):
        z, _, hit = pierce(u, v, *sphere)
        nearest = np.minimum(nearest, np.where(hit, z, np.inf))
    screen_depth[:] = np.where(nearest < behind_depth, nearest, np.inf)


def screen_length(screen_sphere, screen_box, behind_depth, view, splat, screen_length, screen_length_sum):
    """Write the thickness [m] at half resolution: chords, cut off at what is behind (R5)."""
    u, v = rays(screen_length.shape, view, 2)
    behind = halved(behind_depth, screen_length.shape)
    total = np.zeros(screen_length.shape)
    for _, *sphere in spheres(screen_sphere, screen_box):
        z, chord, hit = pierce(u, v, *sphere)
        room = (behind - z) * np.sqrt(u * u + v * v + 1)  # along the ray
        total += np.where(hit, np.clip(room, 0, chord), 0)
    screen_length[:] = total
    screen_length_sum[:] = 0


def screen_column(screen_depth, behind_depth, view, longest, screen_length):
    """Write the thickness [m] as the way along the ray from the surface to what is behind, at most ``longest``.

    In shallow water it stands for d / cos(theta) of the refracted ray: it goes to 0 at the shore, where spheres do not.
    """
    shape = screen_length.shape
    u, v = (halved(a, shape) for a in rays(screen_depth.shape, view))
    D, behind = halved(screen_depth, shape), halved(behind_depth, shape)
    some = np.isfinite(D)
    way = (behind - np.where(some, D, 0)) * np.sqrt(u * u + v * v + 1)
    screen_length[:] = np.where(some, np.clip(way, 0, float(longest)), 0)


def screen_value(
    screen_sphere, screen_box, particle_value, screen_depth, view, splat, screen_value, screen_value_sum
):
    r"""Write sums of w value and of w over the spheres near the surface, at half resolution.

    w = (0.1 + 0.9 n_z^2) clamp(1 - (z - D)/reach, 0, 1): smooth, and independent of the order, where the value of
    the one nearest sphere would show the spheres.
    """
    u, v = rays(screen_value.shape[1:], view, 2)
    D = halved(screen_depth, screen_value.shape[1:])
    sums = np.zeros(screen_value.shape)
    for i, *sphere in spheres(screen_sphere, screen_box):
        z, chord, hit = pierce(u, v, *sphere)
        share = (chord / (2 * sphere[3])) ** 2
        w = np.where(hit, (0.1 + 0.9 * share) * np.clip(1 - (z - D) / float(splat.reach), 0, 1), 0)
        sums += w * np.array([float(particle_value[i]), 1.0])[:, None, None]
    screen_value[:] = sums
    screen_value_sum[:] = 0
