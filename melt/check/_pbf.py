"""Fields and parameters of the position based fluid for the check scene, with lattice sums of its own."""

import itertools

import numpy as np

from melt.check._cloud import INACTIVE, LIQUID, SOLID, SPACING, SUPPORT, WALL

POINTS, START = 65, 1.5
D0 = 0.37 / (1000 * SPACING**5)  # about that of a particle inside


def _sums(ratio):
    r = np.array([np.sqrt(a * a + b * b + c * c) for a, b, c in itertools.product(range(-3, 4), repeat=3)])
    q = np.maximum(1 - r / ratio, 0)
    S = 315 / (64 * np.pi * ratio**3) * (np.maximum(1 - (r / ratio) ** 2, 0) ** 3).sum()
    return S, 45 / (np.pi * ratio**4) * (r * q**2).sum() / 3


def constants():
    """Return the values of the tuple `Pbf`; the histogram's bins are a power of two so that ties stay ties."""
    ratio = SUPPORT / SPACING
    S, G = _sums(ratio)
    return dict(
        spacing=SPACING,
        support=SUPPORT,
        uniform=0,
        same_iterations=0,
        value_scale=315 / (64 * np.pi * S * SUPPORT**3),
        gradient_scale=45 / (np.pi * G * SUPPORT**4),
        table_start=START,
        table_step=(POINTS - 1) / (ratio - START),
        table_last=POINTS - 1,
        omega=0.9,
        softening=0.8 * D0,
        minimum_error=-1.0,
        push=0.1 / D0,
        push_scale=1 / 0.96,
        blend=60.0,
        vorticity=3.0,
        iterations=4,
        minimum_iterations=2,
        minimum_support=1.6 * SPACING,
        height_share=0.5,
        minimum_precision=0.25,
        precision_time=0.01,
        floor=0.0,
        inverse_bin=16.0,
    )


def fields(arrays, rng):
    """Return fields of a step in the making: radii whose means and squares are exact, a list of iteration 1."""
    phase = arrays["phase"]
    n, liquid = len(phase), phase == LIQUID
    radius = np.where(liquid, rng.integers(80, 121, n) / 256, 0.0)  # 1.67 to 2.5 spacings
    radius[liquid & (rng.random(n) < 0.2)] = SUPPORT
    steps = np.where(liquid, rng.integers(1, 5, n), 0)
    key = steps.copy()
    for i in np.flatnonzero(liquid):
        row = arrays["neighbour_index"][i, : arrays["neighbour_count"][i]]
        key[i] = max(steps[i], steps[row].max(initial=0))
    on = np.flatnonzero(key > 2)
    index = np.full(n, -987654321)
    index[: len(on)] = on
    solids = np.full(n, -987654321)
    solids[: (phase == SOLID).sum()] = np.flatnonzero(phase == SOLID)
    mass = np.where(liquid, arrays["mass"], 1.0)
    return dict(
        position_predicted=arrays["position"] + 0.01 * SPACING * rng.normal(size=(3, n)),
        mobility=np.where(liquid, 1 / np.where(mass > 0, mass, 1.0), 0.0),
        constraint=np.where(liquid, rng.normal(size=n) * 0.1, 0.0),
        multiplier=np.where(liquid, rng.normal(size=n) * 0.05 / D0, 0.0),
        correction=rng.normal(size=(3, n)) * np.where(np.arange(n) % 5 == 0, 0.5, 0.02) * SPACING,  # some are cut
        vorticity=np.where(liquid, rng.normal(size=(3, n)) * 5.0, 0.0),
        effect_precision=np.where(liquid, rng.uniform(0.3, 1.0, n), 0.0),
        support_radius=radius,
        iterations=steps,
        iteration_key=np.where(phase == INACTIVE, 0, np.where(phase == WALL, 0, key * liquid)),
        active_index=index,
        active_count=np.array([len(on)]),
        solid_index=solids,
        solid_count=np.array([(phase == SOLID).sum()]),
        kernel_scale=np.array(
            [[c / s for c, s in zip((315 / (64 * np.pi), 45 / np.pi), _sums(q))]
             for q in np.linspace(START, SUPPORT / SPACING, POINTS)]
        ).T,
        height_bins=np.zeros(40, int),
    )
