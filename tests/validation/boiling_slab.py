"""A slab of liquid at rest, endless to both sides, on which the heat stages of boiling run alone (V9-V11).

z goes through the slab, whose two faces are free (insulated). Sideways it repeats: copies of its particles stand
beside it, and get the values of their originals after every stage.
"""

import itertools

import numpy as np
from scipy.spatial import cKDTree

from melt import params as P
from melt.check.compare import stage_function
from melt.stages import STAGES
from melt.state import POSITION, REAL

D, DENSITY, CAPACITY = 0.02, 1000.0, 4186.0
BOILING = dict(
    diffusivity=2.4e-3, corrected=1, specific_heat=CAPACITY, boiling_point=100.0, latent_heat=4.5e4,
    start_temperature=20.0, threshold=0, seed_low=1, seed_high=0, mass_model=0, subcooling=0.0, heater_lower_x=-1e30,
    heater_upper_x=1e30, heater_lower_y=-1e30, heater_upper_y=1e30, contact=D, boost=0, boost_rate=0.5,
    boost_speed=0.5, expansion=5e-4,
)
PBF = dict.fromkeys(P.Pbf._fields, 0)
BUBBLES = dict.fromkeys(P.Bubbles._fields, 0)


class Slab:
    """``layers`` spacings of liquid, ``width`` to a side, every particle moved by up to ``jitter`` spacings.

    ``radii`` (smallest, largest) in spacings gives each particle a support radius of its own.
    """

    def __init__(self, layers, width=6, ratio=2.2, jitter=0.0, radii=None, precision="double", seed=3, **boiling):
        self.real = real = REAL[precision]
        cells = np.indices((layers, width, width)).reshape(3, -1)[::-1].T
        rng = np.random.default_rng(seed)
        x = (cells + 0.5 + rng.uniform(-jitter, jitter, cells.shape)) * D
        R = np.full(len(x), ratio * D) if radii is None else rng.uniform(*radii, len(x)) * D
        self.core = len(x)
        self._place(x, R, width * D, POSITION[precision])
        n = len(self.source)
        self.pbf = P.make(P.Pbf, real, **{**PBF, "spacing": D, "support": R.max(), "uniform": int(radii is None)})
        self.boiling = P.make(P.Boiling, real, **{**BOILING, **boiling})
        self.bubbles = P.make(P.Bubbles, real, **BUBBLES)
        self.phase = np.zeros(n, np.int32)
        self.mass, self.rest_volume = np.full(n, DENSITY * D**3, real), np.full(n, D**3, real)
        self.temperature, self.temperature_next, self.heat_sum = (np.zeros(n, real) for _ in range(3))
        self.latent_store, self.constraint = np.zeros(n, real), np.zeros(n, real)
        self.heat_rate = np.zeros(64, real)
        self.boil_content, self.heater_heat = np.zeros(64), np.zeros(64)

    def _place(self, x, R, period, wide):
        """Add the copies, and the neighbours of the originals."""
        reach = R.max()
        at, source = [x], [np.arange(len(x))]
        for shift in itertools.product((-period, 0.0, period), repeat=2):
            if shift != (0.0, 0.0):
                moved = x + (*shift, 0.0)
                near = ((moved[:, :2] > -reach) & (moved[:, :2] < period + reach)).all(axis=1)
                at.append(moved[near])
                source.append(np.flatnonzero(near))
        at, self.source = np.concatenate(at), np.concatenate(source)
        R = R[self.source]
        rows = cKDTree(at).query_ball_point(x, reach)
        rows = [
            [j for j in sorted(row) if j != i and np.linalg.norm(at[i] - at[j]) < 0.5 * (R[i] + R[j]) * (1 - 1e-12)]
            for i, row in enumerate(rows)
        ]
        self.neighbour_count = np.zeros(len(at), np.int32)
        self.neighbour_count[: len(x)] = [len(row) for row in rows]
        self.neighbour_index = np.full((len(at), self.neighbour_count.max()), -987654321, np.int32)
        for i, row in enumerate(rows):
            self.neighbour_index[i, : len(row)] = row
        self.position = np.ascontiguousarray(at.T, dtype=wide)
        self.support_radius = R.astype(self.real)

    @property
    def z(self):
        """Heights of the particles [m]."""
        return self.position[2, : self.core].astype(np.float64)

    @property
    def T(self):
        """Temperatures of the particles [degC]."""
        return self.temperature[: self.core]

    @T.setter
    def T(self, values):
        self.temperature[:] = np.asarray(values)[self.source]

    def run(self, name, **scalars):
        """Run a stage on the CPU; copies follow their originals."""
        given = {k: self.real(v) for k, v in scalars.items()}
        stage_function(name, "cpu")(*(given[a] if a in given else getattr(self, a) for a in STAGES[name].arguments))
        for field in ("temperature_next", "heat_sum", "temperature"):
            if field in STAGES[name].writes:
                values = getattr(self, field)
                values[self.core :] = values[self.source[self.core :]]

    def conduct(self, dt, steps, hot=None):
        """Take steps of conduction; with ``hot`` [degC] the floor holds what it touches at that temperature."""
        self.run("boil_sums")
        for _ in range(steps):
            if hot is not None:
                self.run("boil_heater", target=hot, share=1.0)
            self.run("boil_exchange", dt=dt)
            self.temperature, self.temperature_next = self.temperature_next, self.temperature
