"""Bodies that cold liquid starts away from solids: who starts one, and which spare body it takes."""

import numpy as np
import pytest
from lattice_bodies import DX, Drive, change
from test_freezing import BACKENDS, DT, check_lattice, neighbours

from melt.geometry.lattice import lattice_fields
from melt.systems.topology import build_lattice, freeze

pytestmark = pytest.mark.usefixtures("emulated")

BLOCK = np.indices((3, 3, 3)).reshape(3, -1) - 1  # voxels of a spare body with one layer around its middle


def world(backend, water, spare=2, temperature=-0.5, precision="double", **params):
    """Return a Drive with one solid particle at the origin, spare bodies, and water (positions in spacings)."""
    do = Drive(np.zeros((3, 1), int), backend=backend, precision=precision, **params)
    water = np.asarray(water, float).reshape(3, -1)
    w, sites = water.shape[1], 1 + 27 * spare
    do.sizes.update(particle=1 + w, site=sites, nucleus=spare)
    do.need.nucleation = True
    cell = np.hstack([np.zeros((3, 1), int), np.tile(BLOCK, spare)])
    body = np.concatenate([[0], 1 + np.repeat(np.arange(spare), 27)])
    particle = np.full(sites, -1)
    particle[0] = 0
    first = 1 + 27 * np.arange(spare)
    do.set(
        id=np.arange(1 + w)[::-1],
        phase=[1] + [0] * w,
        material=[0] + [1] * w,
        site=[0] + [-1] * w,
        position=np.hstack([np.zeros((3, 1)), water]) * DX,
        velocity=np.ones((3, 1 + w)),
        mass=[7.2] + [8.0] * w,
        rest_volume=np.full(1 + w, DX**3),
        density=np.full(1 + w, 1000.0),
        temperature=[-10] + [temperature] * w,
        site_particle=particle,
        site_cell=cell,
        site_rest=cell * DX,
        site_body=body,
        nucleus_sites=[first, first + 27],
        **lattice_fields(cell, body, particle),
    )
    build_lattice(do)
    neighbours(do)
    return do


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_the_smallest_id_of_cold_neighbours_away_from_solids_starts_a_body(backend, precision):
    """Ids fall with the index. Particle 1 is beside the solid; of 2, 3, 4 (a chain) 4 is the smallest, 5 is alone."""
    do = world(backend, [[1, 10, 12, 14, 30], [0] * 5, [0] * 5], precision=precision)
    x, v = do["position"].copy(), do["velocity"].copy()
    assert freeze(do, DT)
    assert do["nucleation"].tolist() == [0, 0, 1, 1, 3, 3]
    assert do["phase"].tolist() == [1, 0, 0, 0, 1, 1] and do.clock.frozen == 2
    assert do["site"].tolist() == [0, -1, -1, -1, 1 + 13, 28 + 13]
    assert np.array_equal(do["position"], x) and np.array_equal(do["velocity"], v)  # it freezes where it is
    assert do["site_component"][[14, 41]].tolist() == [14, 41] and (do["site_link_count"] > 0).sum() == 3
    assert do["region_rotation"][:, 14].tolist() == [1, 0, 0, 0]
    if precision == "double":
        check_lattice(do)


@pytest.mark.parametrize("backend", BACKENDS)
def test_other_particles_freeze_to_the_new_body(backend):
    """Neighbours about a spacing away take the sites beside it in the next step; no further body starts near it."""
    do = world(backend, [[10, 9, 9], [0, 1.2, 0.1], [0] * 3])
    freeze(do, DT)
    assert do["phase"].tolist() == [1, 0, 0, 1]
    assert freeze(do, DT)
    assert do["phase"].tolist() == [1, 1, 1, 1] and (do["nucleation"] == 0).all()
    assert do["position"][:, 1] == pytest.approx([10 * DX, 0.1 * DX, 0])
    assert do["position"][:, 2] == pytest.approx([9 * DX, 1.1 * DX, 0])
    assert do["site_component"][do["site"][1:]].max() == do["site_component"][do["site"][1:]].min()
    check_lattice(do)
    assert not freeze(do, DT) and do.clock.frozen == 3


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("case", ["warm", "cold enough", "latent left", "all given off", "no spare body",
                                  "no latent heat, warm", "no latent heat, cold"])
def test_conditions(backend, case):
    latent = "latent" in case or case == "all given off"
    spare = 0 if case == "no spare body" else 1
    warm = np.nextafter(-0.5, 0)
    t = {"warm": warm, "latent left": 0.0, "all given off": 0.0, "no latent heat, warm": warm}.get(case, -0.5)
    do = world(backend, [[10], [0], [0]], spare, t, change_params=change(latent=int(latent)))
    do.set(latent_energy=[0, 1.0 if case == "latent left" else 0.0])
    do.set(latent_capacity=[0, 0.0 if "no latent" in case else 2.0])
    freeze(do, DT)
    assert do.clock.frozen == (case in ("cold enough", "all given off", "no latent heat, cold"))


@pytest.mark.parametrize("backend", BACKENDS)
def test_taken_bodies_are_passed_over_and_melted_ones_free_again(backend):
    """Three would start a body; of four spare ones, 0 has a live site at its rim and 2 in its middle."""
    do = world(backend, [[10, 20, 30], [0] * 3, [0] * 3], 4)
    count = do["site_link_count"].copy()
    count[[1, 1 + 2 * 27 + 13]] = 1
    do.set(site_link_count=count)
    do.run("freeze_choice", dt=DT)
    do.run("freeze_claim")
    do.run("nucleus_choice")
    do.run("nucleus_claim")
    middle = 1 + 27 * np.arange(4) + 13
    assert do["freeze_site"].tolist() == [-1, middle[1], middle[3], -1]
    assert do["claim"][middle].tolist() == [-1, 1, -1, 2] and do["nucleated"].sum() == 2


def test_random_nuclei_are_the_same_on_every_backend():
    """Cold particles in 64 pieces and more bodies wanted than there are: reference, CPU and CUDA agree."""
    rng = np.random.default_rng(2)
    water = 10 + rng.uniform(0, 14, (3, 300))
    runs = []
    for backend in BACKENDS:
        do = world(backend, water, 20)
        freeze(do, DT)
        runs.append(do)
        assert do.clock.frozen == 20 and (do["nucleation"] == 3).sum() > 20
        check_lattice(do)
    for name in ("nucleation", "freeze_site", "claim", "nucleated", "phase", "site", "region_rotation"):
        assert all(np.array_equal(do[name], runs[0][name]) for do in runs), name
