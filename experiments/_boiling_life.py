"""Runs that boil: ledgers (V21), repeatability (V22), superheat (V25), the paper's literal rule (V26)."""

import hashlib

import numba

from melt.scene import load_scene, scene_from_dict
from melt.simulation import Simulation

D = 0.02
#: Heater temperatures [degC] of V25.
HEATERS = (90.0, 100.0, 102.0, 104.0, 106.0, 110.0, 115.0, 120.0, 130.0)
#: V26: name -> (half size of the heater over the side of the floor, sub-steps, one-sided constraint)
LITERAL = {
    "heater of 0.2 of the side": (0.2, "auto", False),
    "whole floor": (0.5, "auto", False),
    "whole floor, one-sided": (0.5, "auto", True),
    "heater of 0.2 of the side, sub-step 1/240 s": (0.2, 1, False),
    "whole floor, sub-step 1/240 s": (0.5, 1, False),
    "whole floor, sub-step 1/240 s, one-sided": (0.5, 1, True),
}
STATE = "id phase position velocity temperature latent_store bubble_radius bubble_volume age cargo".split()


def stepped(scene, steps):
    """Return a simulation after some steps."""
    sim = Simulation(scene, "cpu")
    for _ in range(steps):
        sim.step()
    return sim


def digest(sim):
    """Return the SHA-256 of the state."""
    total = hashlib.sha256()
    for name in STATE:
        total.update(sim.state.read(name).tobytes())
    return total.hexdigest()


def small(*overrides):
    """Return the small kettle in double precision."""
    return load_scene("kettle_small", ["solver.precision=double", *overrides])


def ledger(steps):
    """V21: return what the ledgers miss; heat over that of the start."""
    sim = stepped(small(), steps)
    s = sim.series()
    return {
        "quarters": s["quarters_missing"], "heat": abs(s["heat_missing"]) / abs(sim.do.clock.ledger["start_heat"]),
        "boiled": s["boiled"], "merged": s["merged"], "burst": s["burst"], "steps": steps, "n_sub": int(sim.do.notes["n_sub"]),
        "liquid": sim.initial.counts["liquid"], "neighbours": s["neighbours_mean"], "density": s["density_error_max"],
    }


def repeats(steps, *overrides):
    """V22: return digests of the same run by 1 and 2 threads, again, and with another seed."""
    before, most = numba.get_num_threads(), numba.config.NUMBA_NUM_THREADS
    hashes, boiled = {}, 0
    try:
        for name, threads, seed in (("1 thread", 1, 1), ("1 thread, again", 1, 1), ("2 threads", 2, 1), ("seed 2", 1, 2)):
            if threads <= most:
                numba.set_num_threads(threads)
                sim = stepped(small(f"boiling.seed={seed}", *overrides), steps)
                hashes[name] = digest(sim)
                boiled = max(boiled, sim.series()["boiled"])
    finally:
        numba.set_num_threads(before)
    return hashes, boiled


def superheat(temperature, steps):
    """V25: return particles boiled by a heater of some temperature in water of 99 degC, and the bubbles there are."""
    s = stepped(small("fluid.temperature=99", f"boiling.heater.temperature={temperature}"), steps).series()
    return {"heater": temperature, "boiled": s["boiled"], "bubbles": s["bubbles"], "merged": s["merged"], "steps": steps}


def literal(half, n_sub, one_sided, cells, seconds, seed=1):
    """V26: boil water of 20 degC by the paper's rules; return the share gone and the mean temperature of the rest."""
    size = [c * D for c in cells]
    scene = scene_from_dict({
        "time": {"end": 10.0, "dt": 1 / 240, "n_sub": n_sub},
        "domain": {"upper": [size[0], size[1], 1.5 * size[2]], "spacing": D},
        "fluid": {"temperature": 20.0, "fill": [{"lower": [0, 0, 0], "upper": size}]},
        "solver": {"pressure": "pbf", "pbf": {"one_sided": one_sided}},
        "boiling": {"seed": seed, "heater": {"half_size": [half * size[0], half * size[1]]},
                    "bubbles": {"capacity": 4 * cells[0] * cells[1] * cells[2]}},
    }, preset="paper")
    sim = stepped(scene, round(240 * seconds))
    s, n = sim.series(), sim.initial.counts["liquid"]
    return {"gone": s["boiled"] / n, "temperature": s.get("temperature_mean", 0.0), "liquid": n, "bubbles": s["bubbles"],
            "n_sub": int(sim.do.notes["n_sub"]), "largest": s["bubble_radius_max"] / D, "precision": sim.prepared.precision}
