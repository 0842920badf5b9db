"""Freezing on the step page: where, when and with what lists; new bodies; the rigid baseline."""

import numpy as np
import pytest
from extreme_scenes import DX, WEIGHTLESS, all_finite, box, scene
from scene_runs import stepped
from scipy.spatial.transform import Rotation

from melt.errors import SceneError
from melt.simulation import Simulation

#: A cold body of 3^3 in free flight and a drop of its own liquid, no heat exchange.
FLIGHT = {
    "time": {"end": 1.0},
    "domain": {"upper": [4.0, 4.0, 4.0], **WEIGHTLESS},
    "fluid": {"temperature": 50.0, "density": 917.0, "fill": [box((1, 1, 1), (1, 1, 1))]},
    "solid": [box((5, 5, 5), (3, 3, 3), name="ice", conductivity=0)],
    "heat": {"conductivity": 0, "refreeze": True},
    "solver": {"precision": "double", "guard": False},
}
OMEGA, DRIFT = np.array([4.0, -3.0, 9.0]), np.array([5.0, 3.0, 2.0])


def in_flight(changes=None, backend="cpu"):
    """Return a simulation whose body turns and flies, after a third of a turn or so."""
    sim = Simulation(scene(**{**FLIGHT, **(changes or {})}), backend)
    x, solid = sim.state.read("position"), sim.state.read("phase") == 1
    centre = x[:, solid].mean(axis=1)
    sim.state.set("velocity", np.where(solid, np.cross(OMEGA, (x.T - centre)).T + DRIFT[:, None], 0.0))
    for _ in range(40):
        sim.step()
    return sim


def pose(sim):
    """Return (R, X0, x0, bend) of the body: x = R (X - X0) + x0 within the bend, X the positions at the start."""
    ids = sim.state.read("id")
    solid = sim.state.read("phase") == 1
    X, x = sim.initial["position"][:, ids[solid]], sim.state.read("position")[:, solid]
    X[:, ids[solid] == 0] = [[8.5 * DX], [6.5 * DX], [6.5 * DX]]  # where the drop (id 0) froze
    X0, x0 = X.mean(axis=1), x.mean(axis=1)
    R = Rotation.align_vectors((x.T - x0), (X.T - X0))[0].as_matrix()
    return R, X0, x0, np.abs(R @ (X - X0[:, None]) + x0[:, None] - x).max()


def bring_drop(sim, offset):
    """Put the drop beside the middle of the face x+, ``offset`` spacings from the vacant site there, cold.

    Returns the place of the site and how much the body is bent.
    """
    R, X0, x0, bend = pose(sim)
    place = R @ ([8.5 * DX, 6.5 * DX, 6.5 * DX] - X0) + x0
    x, v = sim.state.read("position"), sim.state.read("velocity")
    drop = np.flatnonzero(sim.state.read("phase") == 0)[0]
    x[:, drop] = place + np.array(offset) * DX
    v[:, drop] = DRIFT
    sim.state.set("position", x)
    sim.state.set("velocity", v)
    sim.state.set("temperature", np.full(28, -10.0))
    return place, bend


@pytest.mark.parametrize("baseline", ["none", "rigid"])
@pytest.mark.parametrize("backend", ["cpu", "reference", "cuda-emulated"])
def test_what_froze_is_where_its_body_is_now(backend, baseline):
    """The new site lies where the body's best pose at this very time puts it.

    The pose of the sub-step before is off by the way of one sub-step, about 0.1 dx.
    """
    sim = in_flight({"solver": {**FLIGHT["solver"], "baseline": baseline, "damping": 0.0}}, backend)
    site, bend = bring_drop(sim, (0.3, -0.2, 0.25))
    assert bend < 0.01 * DX
    do, seen = sim.do, {}
    run = do.run

    def watched(name, scalars):
        if name == "freeze_choice":
            seen["before"] = {n: do.read(n) for n in ("id", "position", "velocity", "mass", "phase")}
        if name in ("fluid_force", "heat_pairs_coloured") and name not in seen:
            seen[name] = {n: do.read(n) for n in ("id", "position", "phase", "neighbour_count", "neighbour_index")}
            seen[name]["p"] = (do.read("velocity") * do.read("mass")).sum(axis=1)
        run(name, scalars)

    do.run = watched
    sim.step()
    assert do.clock.frozen == 1 and sim.series()["frozen"] == 1 and sim.series()["solid_particles"] == 28
    b, a = seen["before"], seen["fluid_force"]
    old, new = np.argsort(b["id"]), np.argsort(a["id"])
    solid = b["phase"][old] == 1
    was, now = b["position"][:, old], a["position"][:, new]
    assert np.array_equal(was[:, solid], now[:, solid])  # nothing else moved
    assert np.abs(now[:, ~solid][:, 0] - site).max() <= 2 * bend + 1e-12
    assert np.linalg.norm(now - was) == pytest.approx(np.linalg.norm([0.3, -0.2, 0.25]) * DX, rel=0.1)
    # momentum and mass are those of before, to the bit of a sum in another order
    p = (b["velocity"] * b["mass"]).sum(axis=1)
    assert a["p"] == pytest.approx(p, rel=1e-13)
    assert sim.series()["mass_created"] == pytest.approx(0, abs=1e-11)
    for name in ("fluid_force", "heat_pairs_coloured"):
        lists_are_true(seen[name])
    for _ in range(20):  # and it stays there
        sim.step()
    assert all_finite(sim) and sim.series()["solid_particles"] == 28
    assert pose(sim)[3] < 0.05 * DX


def lists_are_true(a):
    """The lists are those of the positions that stages see now."""
    d = np.sqrt(((a["position"][:, :, None] - a["position"][:, None, :]) ** 2).sum(axis=0))
    near = (d < 2.5 * DX) & ~np.eye(len(d), dtype=bool)
    for i in range(len(d)):
        assert a["neighbour_index"][i, : a["neighbour_count"][i]].tolist() == np.flatnonzero(near[i]).tolist()


@pytest.mark.parametrize("motion", [True, False])
@pytest.mark.parametrize("nuclei", [0, 1, 30])
def test_cold_liquid_far_from_solids_starts_bodies(motion, nuclei):
    """A supercooled pool whose only solid floats elsewhere: bodies start, grow on their sites, and no site has two."""
    pool = scene(
        time={"end": 1.0},
        domain={"upper": [2.4, 1.2, 1.2], "gravity": [0, 0, 0]},
        fluid={"temperature": -5.0, "fill": [box((0, 0, 0), (6, 6, 6))]},
        solid=[box((10, 2, 2), (1, 1, 1), name="seed")],
        heat={"refreeze": True, "nuclei": nuclei, "freeze_layers": 1, "conductivity": 0},
        solver={"motion": motion, "melt_to": "own", "density_form": "volume", "precision": "double"},
    )
    pool = pool.model_copy(update={"fluid": pool.fluid.model_copy(update={"freezes_to": "seed"})})
    sim = Simulation(pool, "cpu")
    mass = sim.series()["mass"]
    sim.step()
    first = sim.series()["frozen"]
    x, solid = sim.read("position"), sim.read("phase") == 1
    d = np.linalg.norm(x[solid][:, None] - x[solid][None], axis=2) + 9 * np.eye(solid.sum())
    assert (first <= nuclei and d.min() >= 2.4 * DX) and (first > 0) == (nuclei > 0)
    for _ in range(4):
        sim.step()
    s = sim.series()
    assert s["solid_particles"] == 1 + s["frozen"] and all_finite(sim)
    assert s["mass"] == pytest.approx(mass, rel=1e-13)
    if nuclei:
        assert s["frozen"] > 3 * first
    sites = sim.state.read("site")[sim.state.read("phase") == 1]
    assert np.unique(sites).size == sites.size
    body, live = sim.state.read("site_body"), sim.state.read("site_link_count") > 0
    assert live.sum() == sites.size and 1 + first <= np.unique(body[live]).size <= 1 + nuclei


def test_refusals():
    with pytest.raises(SceneError, match="set refreeze = true, or nuclei = 0"):
        scene(heat={"nuclei": 3})
    with pytest.raises(SceneError, match="add a .*solid.* that melts"):
        scene(heat={"nuclei": 3, "refreeze": True}, solid=[])
    with pytest.raises(SceneError, match="'stone' never melts, so no liquid freezes to it: give it a melting_point"):
        scene(
            heat={"refreeze": True},
            fluid={"freezes_to": "stone"},
            solid=[box((1, 1, 3), (2, 2, 2), name="stone", melting_point="never")],
        )


def test_water_freezes_to_the_first_solid_that_melts():
    """A stone before the ice: with its melting point of inf all water near it would be cold enough."""
    sim = stepped(
        scene(
            fluid={"temperature": -5.0},
            heat={"refreeze": True},
            solid=[
                box((0, 0, 2), (2, 2, 2), name="stone", melting_point="never"),
                box((2, 2, 3), (2, 2, 2), name="ice"),
            ],
        ),
        1,
    )
    assert sim.initial["material_freezes_to"].tolist() == [2, -1, -1]
    assert set(sim.read("material")[sim.read("phase") == 1]) == {1, 2}
    assert (sim.read("material") == 1).sum() == 8
