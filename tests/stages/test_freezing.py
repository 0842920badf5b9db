"""Freezing to vacant sites: who takes which site, links and regions afterwards, no flicker."""

import numpy as np
import pytest
from lattice_bodies import DX, Drive, box, change, lattice
from scipy.spatial.transform import Rotation

from melt.geometry.lattice import lattice_fields
from melt.systems.topology import build_lattice, freeze, melt_and_relink

BACKENDS = ["reference", "cpu", "cuda"]
DT = 1e-3  # slow is below 100 m/s
WATER = -1  # marks in `world`: a liquid particle without a site


pytestmark = pytest.mark.usefixtures("emulated")


def neighbours(do, support=2.5 * DX):
    """Fill the neighbour lists by all pairs."""
    x = do["position"].astype(np.float64)
    d = np.linalg.norm(x[:, :, None] - x[:, None, :], axis=0)
    near = (d < support) & ~np.eye(len(d), dtype=bool)
    do.sizes["neighbour"] = max(1, int(near.sum(axis=1).max(initial=0)))
    table = np.zeros((len(d), do.sizes["neighbour"]), np.int32)
    for i, row in enumerate(near):
        table[i, : row.sum()] = np.flatnonzero(row)
    do.set(neighbour_count=near.sum(axis=1), neighbour_index=table)


def world(backend, solid, vacant, water, precision="double", body=None, **params):
    """Return a Drive with solid cells, vacant sites (cells) and water particles (positions in cells)."""
    solid, vacant, water = (np.asarray(a, float).reshape(3, -1) for a in (solid, vacant, water))
    do = Drive(solid.astype(int), backend=backend, precision=precision, **params)
    n, v, w = solid.shape[1], vacant.shape[1], water.shape[1]
    do.sizes.update(particle=n + w, site=n + v)
    cell = np.hstack([solid, vacant]).astype(np.int32)
    body = np.zeros(n + v, np.int32) if body is None else np.asarray(body, np.int32)
    sites = np.concatenate([np.arange(n), np.full(v, -1)]).astype(np.int32)
    do.set(
        id=np.arange(n + w)[::-1],
        phase=np.repeat([1, 0], [n, w]),
        material=np.repeat([0, 1], [n, w]),
        site=np.concatenate([np.arange(n), np.full(w, WATER)]),
        position=(np.hstack([solid, water]) + 0.5) * DX,
        velocity=np.zeros((3, n + w)),
        mass=np.repeat([7.2, 8.0], [n, w]),
        rest_volume=np.full(n + w, DX**3),
        density=np.full(n + w, 1000.0),
        temperature=np.repeat([-10.0, -0.5], [n, w]),
        site_particle=sites,
        site_cell=cell,
        site_rest=cell * DX,
        site_body=body,
        **lattice_fields(cell, body, sites, int(do.lattice.connect)),
    )
    build_lattice(do)
    do.region_match()
    neighbours(do)
    return do


def check_lattice(do):
    """Links, regions and sums are those of a lattice built anew."""
    fresh = Drive(do["site_cell"], do["site_body"], backend="cpu", lattice_params=do.lattice)
    fresh.sizes["particle"] = do.sizes["particle"]
    live = np.where(do["site_link_count"] > 0, do["site_particle"], -1)
    fresh.set(
        mass=do["mass"],
        site_particle=live,
        **lattice_fields(do["site_cell"], do["site_body"], live, int(do.lattice.connect)),
    )
    build_lattice(fresh)
    for name in ("site_links", "site_link_count", "site_region", "site_region_count", "site_component"):
        assert np.array_equal(do[name], fresh[name]), name
    for name in ("region_share", "region_mass", "region_rest"):
        assert do[name] == pytest.approx(fresh[name], rel=1e-12, abs=1e-13), name


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_the_nearest_particle_takes_the_site(backend, precision):
    """Site (2,0,0) beside a pair: water at 0.3 dx loses against 0.2 dx, the one at 0.7 dx is too far."""
    do = world(backend, box(2, 1, 1), [[2], [0], [0]], [[2.3, 2.2, 2.7], [0, 0, 0], [0, 0, 0]], precision)
    freeze(do, DT)
    assert do.clock.frozen == 1
    assert do["phase"].tolist() == [1, 1, 0, 1, 0]
    assert do["site"].tolist() == [0, 1, -1, 2, -1]
    assert do["site_particle"].tolist() == [0, 1, 3] and do["site_component"].tolist() == [0, 0, 0]
    assert do["material"][3] == 0 and do["mass"][3] == 8.0
    assert do["rest_volume"][3] == pytest.approx(8.0 / 900, rel=1e-6)
    # it is put on the site, so that no goal fetches it in one sub-step; its velocity stays
    assert do["position"][:, 3] == pytest.approx([2.5 * DX, 0.5 * DX, 0.5 * DX], rel=1e-6)
    assert (do["velocity"] == 0).all()
    do.region_match()
    do.goal()
    assert np.abs(do["goal"]).max() <= 1e-6 * DX
    check_lattice(do) if precision == "double" else None


@pytest.mark.parametrize("backend", BACKENDS)
def test_equal_distances_go_to_the_smaller_id_and_site(backend):
    """Two particles as far from one site: id decides. One between two sites: the smaller site."""
    do = world(backend, box(2, 1, 1), [[2], [0], [0]], [[2, 2], [0.25, -0.25], [0, 0]])
    do.run("freeze_choice", dt=DT)
    do.run("freeze_claim")
    assert do["freeze_site"].tolist() == [-1, -1, 2, 2] and do["claim"].tolist() == [-1, -1, 3]
    do = world(backend, box(1, 2, 1), [[1, 1], [0, 1], [0, 0]], [[1], [0.5], [0]])
    do.run("freeze_choice", dt=DT)
    assert do["freeze_site"][2] == 2


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize(
    "case", ["warm", "exactly cold enough", "fast", "just slow enough", "never freezes", "latent left", "all given off",
             "no latent heat, warm", "no latent heat, cold"]
)
def test_conditions(backend, case):
    latent = "latent" in case or case == "all given off"
    do = world(
        backend,
        box(2, 1, 1),
        [[2], [0], [0]],
        [[2.1], [0], [0]],
        change_params=change(latent=int(latent)),
    )
    warm = np.nextafter(-0.5, 0)
    t = {"warm": warm, "latent left": 0.0, "all given off": 0.0, "no latent heat, warm": warm}.get(case, -0.5)
    do.set(temperature=[-10, -10, t], latent_energy=[0, 0, 1.0 if case == "latent left" else 0.0])
    do.set(latent_capacity=[0, 0, 0.0 if "no latent" in case else 2.0])
    limit = 0.5 * DX / DT  # half a spacing in the sub-step
    speed = {"fast": limit, "just slow enough": np.nextafter(limit, 0)}.get(case, 0.0)
    do.set(velocity=np.array([[0, 0, speed], [0, 0, 0], [0, 0, 0]]))
    if case == "never freezes":
        do.set(material_freezes_to=[-1, -1])
    freeze(do, DT)
    frozen = ("exactly cold enough", "just slow enough", "all given off", "no latent heat, cold")
    assert do.clock.frozen == (case in frozen)


@pytest.mark.parametrize("backend", BACKENDS)
def test_ambient_liquid_gets_the_mass_of_the_solid(backend):
    do = world(backend, box(2, 1, 1), [[2], [0], [0]], [[2.1], [0], [0]], change_params=change(own_liquid=0))
    freeze(do, DT)
    assert do["mass"][2] == pytest.approx(900 * DX**3, rel=1e-14) and do["rest_volume"][2] == pytest.approx(
        DX**3
    )


@pytest.mark.parametrize("backend", BACKENDS)
def test_sites_are_predicted_with_the_body_turned(backend):
    """The body stands rotated in the world: its vacant site is where its frame says."""
    do = world(backend, box(3, 2, 2), [[3], [0], [0]], [[3.0], [0.0], [0.0]])
    Q = Rotation.from_rotvec([0.4, -1.0, 2.0]).as_matrix()
    do.set(position=Q @ do["position"] + [[3.0], [1.0], [-2.0]])
    do.region_match()
    neighbours(do)
    do.run("freeze_choice", dt=DT)
    assert do["freeze_site"][12] == 12 and do["freeze_distance"][12] == 0
    freeze(do, DT)
    do.region_match()
    do.goal()
    assert np.abs(do["goal"]).max() <= 1e-12
    check_lattice(do)


@pytest.mark.parametrize("backend", BACKENDS)
def test_another_body_is_not_relinked(backend):
    """A site of body 0 in a voxel next to body 1: frozen, it bonds with body 0 only."""
    solid = [[0, 1, 3, 4], [0] * 4, [0] * 4]
    do = world(backend, solid, [[2], [0], [0]], [[2.0], [0], [0]], body=[0, 0, 1, 1, 0])
    freeze(do, DT)
    assert do["site_component"].tolist() == [0, 0, 2, 2, 0]
    check_lattice(do)


def test_melt_and_freeze_again_restores_the_lattice():
    """Melted particles that cool down return to their own sites: same lattice, own or other particle."""
    do = Drive(box(4, 4, 4))
    build_lattice(do)
    do.region_match()
    before = {
        n: do[n].copy() for n in ("site_links", "site_region", "region_rest", "mass", "material", "phase")
    }
    rng = np.random.default_rng(3)
    gone = np.flatnonzero(rng.random(64) < 0.3)
    do.heat(gone)
    do.set(material_freezes_to=[-1, 0])
    melt_and_relink(do)
    assert do.clock.melted > 5
    do.region_match()
    neighbours(do)
    freeze(do, DT)  # still hot: nothing happens
    assert do.clock.frozen == 0
    do.set(temperature=np.full(64, -0.4))
    freeze(do, DT)  # within the hysteresis: nothing happens
    assert do.clock.frozen == 0
    melted = do.clock.melted
    melt_and_relink(do)
    assert do.clock.melted == melted
    do.set(temperature=np.full(64, -0.5))
    freeze(do, DT)
    for name, value in before.items():
        assert (
            np.array_equal(do[name], value) if value.dtype.kind == "i" else do[name] == pytest.approx(value)
        ), name
    check_lattice(do)


@pytest.mark.parametrize("backend", BACKENDS)
def test_a_stranger_takes_a_melted_site(backend):
    """The particle that melted from a site and drifted off forgets it when another freezes there."""
    do = world(backend, box(3, 1, 1), np.zeros((3, 0)), [[7.0], [0], [0]])
    do.heat([2])
    melt_and_relink(do)
    x = do["position"].copy()
    x[:, [2, 3]] = x[:, [3, 2]]
    do.set(position=x, temperature=[-10, -10, 50, -5])
    do.region_match()
    neighbours(do)
    freeze(do, DT)
    assert do["phase"].tolist() == [1, 1, 0, 1] and do["site"].tolist() == [0, 1, -1, 2]
    assert do["site_particle"].tolist() == [0, 1, 3]


@pytest.mark.parametrize("connect", [6, 18, 26])
@pytest.mark.parametrize("refill", [0, 2])
def test_random_freezing_on_every_backend(connect, refill):
    rng = np.random.default_rng(connect)
    cells = box(6, 5, 5)
    kind = rng.choice(3, cells.shape[1], p=[0.4, 0.3, 0.3])
    water = cells[:, kind == 1] + rng.normal(size=(3, (kind == 1).sum())) * 0.2
    runs = []
    for backend in BACKENDS:
        for w in (1, 2):
            do = world(
                backend,
                cells[:, kind == 0],
                cells[:, kind > 0],
                water,
                lattice_params=lattice(connect=connect, refill=refill, width=w),
            )
            freeze(do, DT)
            runs.append(do)
            assert do.clock.frozen > 5
            check_lattice(do)
    for do in runs[2:]:
        for name in ("phase", "site", "claim", "freeze_site", "freeze_distance", "site_particle", "mass"):
            assert np.array_equal(do[name], runs[0][name]), (do.backend, name)
        first = runs[1] if int(do.lattice.width) == 2 else runs[0]
        assert np.array_equal(do["site_dirty"], first["site_dirty"])
        assert do["region_rotation"] == pytest.approx(first["region_rotation"], abs=1e-13)
