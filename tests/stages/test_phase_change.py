"""Melting of particles: thresholds, one layer per step, mass and volume ledgers."""

import numpy as np
import pytest
from lattice_bodies import DX, box, built, change

from melt.systems.topology import melt_and_relink

BACKENDS = ["reference", "cpu", "cuda"]


pytestmark = pytest.mark.usefixtures("emulated")


@pytest.mark.parametrize("precision", ["single", "double"])
@pytest.mark.parametrize("backend", BACKENDS)
def test_surface_melts_from_the_melting_point_on(backend, precision):
    do = built(backend, box(3, 3, 3), precision=precision)
    real = do["temperature"].dtype.type
    t = np.full(27, np.nextafter(real(0), real(-1)))
    t[[0, 13]] = 0.0, 80.0  # a corner exactly at the melting point, the interior hot
    t[5] = np.nan
    do.set(temperature=t)
    do.melt_test()
    assert np.flatnonzero(do["site_melting"]).tolist() == [0]
    assert do["melted"].sum() == 1


@pytest.mark.parametrize("backend", BACKENDS)
def test_infinite_melting_point_never_melts(backend):
    do = built(backend, box(2, 2, 2))
    do.set(temperature=np.full(8, 1e30), material_melting_point=[np.inf, np.inf])
    do.melt_test()
    assert do["site_melting"].sum() == 0


@pytest.mark.parametrize("backend", BACKENDS)
def test_latent_heat_must_be_absorbed(backend):
    do = built(backend, box(3, 1, 1), change_params=change(latent=1))
    do.set(temperature=np.zeros(3), latent_energy=[2.0, 3.0, 3.1], latent_capacity=[3.0, 3.0, 3.0])
    do.melt_test()
    assert do["site_melting"].tolist() == [0, 1, 1]


@pytest.mark.parametrize("connect, full", [(26, 27), (18, 19), (6, 7)])
@pytest.mark.parametrize("backend", BACKENDS)
def test_interior_is_the_same_for_every_connectivity(backend, connect, full):
    from lattice_bodies import lattice

    do = built(backend, box(3, 3, 3), lattice_params=lattice(connect=connect))
    assert do["site_link_count"][13] == full
    do.heat(np.arange(27))
    do.melt_test()
    assert np.flatnonzero(do["site_melting"] == 0).tolist() == [13]


@pytest.mark.parametrize("backend", BACKENDS)
def test_hot_cube_loses_one_layer_per_step(backend):
    do = built(backend, box(7, 7, 7))
    do.heat(np.arange(343))
    live = [343]
    while live[-1]:
        melt_and_relink(do)
        live.append(int((do["phase"] == 1).sum()))
        assert live[-1] == (do["site_link_count"] > 0).sum() == (do["site_component"] >= 0).sum()
        assert do.clock.melted == 343 - live[-1]
    assert live == [343, 125, 27, 1, 0]
    assert (do["site_region"] == -1).all() and (do["region_mass"] == 0).all()
    do.region_match()
    do.goal()
    assert (do["goal"] == 0).all()


@pytest.mark.parametrize("backend", BACKENDS)
@pytest.mark.parametrize("own", [0, 1])
def test_mass_ledger(backend, own):
    """V20: own liquid keeps the mass, ambient liquid adds n (rho V0 - m)."""
    do = built(backend, box(4, 4, 4), change_params=change(own_liquid=own))
    before = do["mass"].sum()
    do.heat(np.arange(64))
    melt_and_relink(do)
    n = int((do["phase"] == 0).sum())
    assert n == 56
    gained = 0.0 if own else n * (1000 * DX**3 - 7.2)
    assert do["mass"].sum() - before == pytest.approx(gained, abs=1e-12 * before)
    liquid = do["phase"] == 0
    assert (do["material"][liquid] == 1).all() and (do["material"][~liquid] == 0).all()
    volume = 7.2 / 1000 if own else DX**3
    assert do["rest_volume"][liquid] == pytest.approx(volume, rel=1e-14)
    assert (do["site"] == np.arange(64)).all()


@pytest.mark.parametrize("backend", BACKENDS)
def test_crumbs_melt_with_the_rest(backend):
    """A neck melts: the piece of two that it held goes too, the piece of 27 stays."""
    cell = np.hstack([box(3, 3, 3), [[3, 4, 5], [1, 1, 1], [1, 1, 1]]])
    do = built(backend, cell)
    do.settings.crumb = 4
    do.heat([27])
    melt_and_relink(do)
    assert do.clock.melted == 3
    assert np.flatnonzero(do["phase"] == 0).tolist() == [27, 28, 29]
    assert (do["site_component"][:27] == 0).all() and (do["site_component"][27:] == -1).all()
    assert do.members(28) == []


@pytest.mark.parametrize("backend", BACKENDS)
def test_no_sites_is_legal(backend):
    do = built(backend, np.zeros((3, 0), int))
    melt_and_relink(do)
    assert do.clock.melted == 0
