"""Colours of a height field: tint by height, light of sun and sky, haze. Flood spec 5, R0."""

import numpy as np

from melt.output.shade import LIGHT

#: Low meadows, dry slopes, rock.
TINTS = np.array([(0.42, 0.50, 0.30), (0.58, 0.58, 0.38), (0.66, 0.60, 0.47), (0.74, 0.71, 0.66)])

CUT = np.array((0.46, 0.40, 0.34))  # of the faces of the block


def base(terrain):
    """Return the height [m] down to which the ground is drawn."""
    known = np.asarray(terrain.elevation)[np.isfinite(terrain.elevation)]
    wide = max(n * c for n, c in zip(np.shape(terrain.elevation)[::-1], terrain.cell))
    return float(known.min() - max(0.1 * np.ptp(known), 0.04 * wide)) if known.size else 0.0


def _nodes(values, x, y):
    """Return values (ny, nx, ...) at fractional nodes, bilinear; holes keep clear of their neighbours."""
    i, j = np.clip(x, 0, values.shape[1] - 1.001).astype(int), np.clip(y, 0, values.shape[0] - 1.001).astype(int)
    u, v = (np.clip(f, 0, 1)[..., None] for f in (x - i, y - j))
    rows = [(1 - u) * values[j + k, i] + u * values[j + k, i + 1] for k in (0, 1)]
    return (1 - v) * rows[0] + v * rows[1]


def colours(terrain, camera, depth, sky):
    """Return the colour (h, w, 3) of a terrain seen at ``depth`` (h, w) [m], of the ``sky`` (h, w, 3) elsewhere."""
    height = np.asarray(terrain.elevation, float)
    known = np.isfinite(height)
    filled = np.where(known, height, np.nanmean(height) if known.any() else 0.0)
    low, high = filled.min(), filled.max()
    slope_y, slope_x = np.gradient(filled, terrain.cell[1], terrain.cell[0])
    normal = np.stack([-slope_x, -slope_y, np.ones_like(filled)], axis=-1)
    normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
    tint = (filled - low) / max(high - low, 1e-9) * (len(TINTS) - 1)
    colour = np.stack([np.interp(tint, range(len(TINTS)), channel) for channel in TINTS.T], axis=-1)
    colour = colour + (0.12 * np.clip(1.6 * (1 - normal[..., 2:]), 0, 1)) * (TINTS[3] - colour)  # steep is bare
    hit = np.isfinite(depth)
    point = camera.eye + camera.rays()[hit] * depth[hit][:, None].astype(float)
    x, y = ((point[:, k] - terrain.lower[k]) / terrain.cell[k] for k in (0, 1))
    seen = _nodes(np.concatenate([colour, normal], axis=-1), x, y)
    n = seen[:, 3:] / np.linalg.norm(seen[:, 3:], axis=1, keepdims=True)
    light = 0.42 + 0.18 * n[:, 2] + 0.52 * np.clip(n @ LIGHT, 0, 1)
    nearest = depth[hit].min() if hit.any() else 1.0
    last = np.array(height.shape[::-1]) - 1
    sides = [[np.abs(f) < 1e-2, np.abs(f - m) < 1e-2] for f, m in zip((x, y), last)]
    surface = _nodes(filled[..., None], x, y)[:, 0]
    cut = np.any([*sides[0], *sides[1]], axis=0) & (point[:, 2] < surface - 1e-3 * (high - low + 1e-9))
    lit = seen[:, :3] * light[:, None]
    lit[cut] = CUT * np.where(np.any(sides[0], axis=0)[cut], 0.72, 0.9)[:, None]
    haze = (1 - np.exp(-0.25 * (depth[hit] / nearest - 1)))[:, None]
    out = np.array(sky, np.float32)
    out[hit] = np.clip(lit, 0, 1) * (1 - haze) + out[hit] * haze
    return out
