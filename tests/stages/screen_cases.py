"""A camera that looks along +y or down, and the stages of the screen-space renderer on plain arrays."""

import numpy as np

from melt import params as P
from melt.check.compare import run_stage
from melt.fields import FIELDS
from melt.stages import STAGES
from melt.state import REAL, dtype_of

LEVEL = dict(right_x=1, right_y=0, right_z=0, down_x=0, down_y=0, down_z=-1, forward_x=0, forward_y=1, forward_z=0)
DOWN = dict(right_x=1, right_y=0, right_z=0, down_x=0, down_y=-1, down_z=0, forward_x=0, forward_y=0, forward_z=-1)
SPLAT = dict(length_steps=2.0**20, value_steps=2.0**20, reach=1.0)
FILTER = dict(size=0.1, smallest=1.0, largest=8.0, range=0.2, narrow=0.2, clamp=0.1)


def view(shape, focal, precision="single", eye=(0, 0, 0), axes=LEVEL, far=64.0, below=0):
    """Return a `View` of a picture of shape (height, width) whose axis goes through its middle."""
    return P.make(
        P.View, REAL[precision], focal=focal, centre_x=shape[1] / 2, centre_y=shape[0] / 2, far=far, smallest=0.75, below=below,
        **dict(zip(("eye_x", "eye_y", "eye_z"), eye)), **axes,
    )


def run(name, backend, arrays, sizes, precision="single", **params):
    """Run a stage; what it writes is allocated by ``sizes`` (extent: size) and kept in ``arrays``."""
    stage = STAGES[name]
    for field in stage.writes:
        if field not in arrays:
            shape = tuple(int(e) if e.isdigit() else sizes[e] for e in FIELDS[field].shape)
            arrays[field] = np.zeros(shape, dtype_of(FIELDS[field], precision))
    given = {f: np.ascontiguousarray(arrays[f], dtype_of(FIELDS[f], precision)) for f in stage.arguments if f not in stage.params}
    found = run_stage(name, backend, given, params)
    arrays.update(found)
    return found


def sizes(shape, n=0):
    """Return the extents of a picture of shape (height, width)."""
    half = [-(-s // 2) for s in shape]
    return dict(pixel_row=shape[0], pixel_column=shape[1], half_row=half[0], half_column=half[1], particle=n, reduction=64)


def splatted(backend, position, radius, shape, view, precision="single", behind=np.inf, value=None):
    """Return all arrays after projection, depth, thickness and values of particles at ``position`` (3, n)."""
    position = np.asarray(position, float).reshape(3, -1)
    n = position.shape[1]
    a = dict(position=position, screen_radius=np.broadcast_to(np.asarray(radius, float), n), behind_depth=np.full(shape, behind))
    a["particle_value"] = np.zeros(n) if value is None else value
    extents, splat = sizes(shape, n), P.make(P.Splat, REAL[precision], **SPLAT)
    run("screen_project", backend, a, extents, precision, view=view)
    run("screen_depth", backend, a, extents, precision, view=view)
    run("screen_length", backend, a, extents, precision, view=view, splat=splat)
    run("screen_value", backend, a, extents, precision, view=view, splat=splat)
    return a


def rays(shape, focal, step=1):
    """Return (u, v) of pixels ``step`` wide, in float64."""
    h, w = shape
    u = ((np.arange(-(-w // step)) + 0.5) * step - w / 2) / focal
    v = ((np.arange(-(-h // step)) + 0.5) * step - h / 2) / focal
    return np.meshgrid(u, v)
