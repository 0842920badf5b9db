"""``melt bench --render``: time per stage of the screen-space renderer, for a block of liquid that fills the picture."""

import statistics

import numpy as np

from melt.output import camera as cameras
from melt.output.colours import TEMPERATURE
from melt.output.screen import SMOOTH, ScreenRenderer

PARTICLES, SIZE = 60_000, (960, 540)


def block(particles):
    """Return positions (3, n) [spacings] of a jittered cubic block of about ``particles``, and its edge."""
    edge = max(2, round(particles ** (1 / 3)))
    lattice = np.stack(np.meshgrid(*[np.arange(edge) + 0.5] * 3, indexing="ij")).reshape(3, -1)
    return lattice + np.random.default_rng(0).uniform(-0.2, 0.2, lattice.shape), edge


def run(particles=PARTICLES, backend="cpu", size=SIZE, frames=20, say=print):
    """Print medians [ms] over frames, after two that compile, of every stage and smoothing; return {smoothing: {stage: ms}}."""
    position, edge = block(particles)
    camera = cameras.fit([0, 0, 0], [edge] * 3, "iso", *size)
    n, found = position.shape[1], {}
    for smooth in SMOOTH:
        renderer = ScreenRenderer(camera, backend, smooth, stops=TEMPERATURE)
        shapes = position, np.full(n, 0.62), position[2] / edge
        for _ in range(2):
            renderer.draw(*shapes)
        renderer.seconds = {}
        for _ in range(frames if smooth != "bilateral" else min(frames, 3)):
            renderer.draw(*shapes)
        calls = min(len(s) for s in renderer.seconds.values())
        found[smooth] = {k: 1e3 * statistics.median(s) * len(s) / calls for k, s in renderer.seconds.items()}
        covered = np.isfinite(renderer.backend.download(renderer.arrays["screen_depth"])).mean()
        say(f"{n:,} particles, {size[0]}x{size[1]}, {covered:.0%} liquid, {renderer.backend.name}, {smooth}: "
            f"{sum(found[smooth].values()):.1f} ms")
        say("".join(f"  {stage:<18}{ms:8.2f} ms\n" for stage, ms in found[smooth].items()))
    return found
