"""Fields and parameters of the screen-space renderer for the check scene: a small picture of the cloud.

Depths are multiples of 1/1024 m, so that comparisons of them are exact in float32. No ray passes so close to the rim
of a sphere that rounding decides whether it meets it.
"""

import numpy as np

from melt.check._cloud import SPACING

HEIGHT, WIDTH = 45, 70  # odd, and no multiple of a band or a group of lanes
SIZES = dict(
    pixel_row=HEIGHT, pixel_column=WIDTH, half_row=(HEIGHT + 1) // 2, half_column=(WIDTH + 1) // 2, stop=4, relief_row=7, relief_column=9,
)
EYE, TARGET, FOCAL = np.array([0.4, -3.3, 2.3]), np.array([0.75, 0.8, 0.4]), 75.0
CENTRE = np.array([0.48 * WIDTH, 0.52 * HEIGHT])


def _axes():
    forward = (TARGET - EYE) / np.linalg.norm(TARGET - EYE)
    right = np.cross(forward, [0.05, 0.02, 1.0])
    right /= np.linalg.norm(right)
    return right, np.cross(forward, right), forward


VIEW = dict(
    **dict(zip(("eye_x", "eye_y", "eye_z"), EYE)),
    **{f"{name}_{k}": v for name, axis in zip(("right", "down", "forward"), _axes()) for k, v in zip("xyz", axis)},
    focal=FOCAL, centre_x=CENTRE[0], centre_y=CENTRE[1], far=64.0, smallest=0.75, below=0,
)
SPLAT = dict(length_steps=2.0**22, value_steps=2.0**21, reach=0.25)
FILTER = dict(size=0.1, smallest=0.7, largest=2.6, range=0.11, narrow=0.0625, clamp=0.03125)
OPTICS = dict(
    fresnel=0.0201, refraction=0.25, absorb_red=1.9, absorb_green=0.7, absorb_blue=0.4, body_red=0.1, body_green=0.3, body_blue=0.4,
    mapped=0, ambient=0.4, shine=0.6, doublings=5, sun_x=-0.48, sun_y=-0.6, sun_z=-0.64, up_x=0.1, up_y=-0.9, up_z=-0.42,
    zenith_red=0.3, zenith_green=0.5, zenith_blue=0.9, horizon_red=0.8, horizon_green=0.85, horizon_blue=0.9,
    nadir_red=0.3, nadir_green=0.25, nadir_blue=0.2,
)
RELIEF = dict(lower_x=-0.4, lower_y=-0.1, cell_x=0.3, cell_y=0.35, base=-0.45)


def _share(x, y, z, r, step):
    """Return 1 - (distance from the centre / radius)^2 of the rays of all pixels, ``step`` wide."""
    u = ((np.arange(-(-WIDTH // step)) + 0.5) * step - CENTRE[0]) / FOCAL
    v = (((np.arange(-(-HEIGHT // step)) + 0.5) * step - CENTRE[1]) / FOCAL)[:, None]
    return 1 - ((u * y - v * x) ** 2 + (u * z - x) ** 2 + (v * z - y) ** 2) / (u * u + v * v + 1) / r**2


def _sphere(rng):
    """Return a random sphere (x, y, z, radius), at times outside of the picture, near the eye or large."""
    while True:
        z = rng.uniform(2.5, 5.5)
        r = SPACING * rng.choice([0.25, 0.5, 0.7, 2.0], p=[0.2, 0.5, 0.28, 0.02]) * rng.uniform(0.9, 1.1)
        x, y = (rng.uniform(-0.1, 1.1, 2) * (WIDTH, HEIGHT) - CENTRE) / FOCAL * z
        if min(np.abs(_share(x, y, z, r, step)).min() for step in (1, 2)) > 2e-3:
            return x, y, z, r


def _spheres(n, rng):
    """Return spheres and their boxes; every seventh is not seen."""
    sphere = np.array([_sphere(rng) for _ in range(n)]).reshape(n, 4).T.copy()
    x, y, z, r = sphere
    box = np.empty((4, n))
    for k, a in enumerate((x, y)):
        s = r * np.sqrt(a * a + z * z - r * r)
        box[2 * k], box[2 * k + 1] = (CENTRE[k] + FOCAL * (a * z + sign * s) / (z * z - r * r) for sign in (-1, 1))
    sphere[:, ::7], box[:, ::7] = 0, np.array([[0], [-1], [0], [-1]])
    return sphere, box


def _exact(x):
    return np.round(np.asarray(x) * 1024) / 1024


def fields(arrays, rng):
    """Return the fields of a picture; only particle fields depend on the cloud."""
    n, shape, half = len(arrays["phase"]), (HEIGHT, WIDTH), (SIZES["half_row"], SIZES["half_column"])
    sphere, box = _spheres(n, rng)
    row, column = np.mgrid[:HEIGHT, :WIDTH]
    depth = _exact(4 + 0.3 * np.sin(row / 7) + 0.25 * np.cos(column / 5) + rng.uniform(-0.05, 0.05, shape) + 0.75 * (column > 40))
    depth[rng.random(shape) < 0.08] = np.inf
    depth[:9, :20] = depth[30:, 50:] = np.inf
    depth[3, 3] = 4.0  # alone
    behind = _exact(3.6 + 0.04 * row + rng.uniform(0, 0.2, shape))
    behind[rng.random(shape) < 0.2] = np.inf
    normal = rng.normal(size=(3, *shape)) * 0.5 - np.array([0, 0, 1.2])[:, None, None]
    radius = SPACING * rng.uniform(0.02, 0.8, n)
    radius[3::11], radius[5::13], radius[6::13] = 0.0, np.nan, np.inf
    weight = rng.uniform(0.2, 3, half) * (rng.random(half) < 0.9)
    height = 0.4 * np.sin(np.arange(9) * 1.3)[None, :] + 0.3 * np.cos(np.arange(7) * 0.9)[:, None]
    height[4, 6] = np.nan
    return dict(
        screen_radius=radius, particle_value=rng.random(n), screen_sphere=sphere, screen_box=box,
        screen_depth=depth, screen_normal=normal / np.sqrt((normal**2).sum(axis=0)),
        screen_length=rng.uniform(0, 1.5, half), screen_value=np.stack([weight * rng.random(half), weight]),
        screen_map=rng.random((3, 4)), behind_depth=behind, behind_colour=rng.random((3, *shape)), relief_height=height,
    )
