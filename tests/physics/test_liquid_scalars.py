"""Scalar formulas of the liquid, its coupling and of contacts: hand values, and float32 stays float32."""

import numpy as np
import pytest
from numba import types

from melt import params as P
from melt.physics import contact, coupling, eos, surface, viscosity
from melt.physics.phases import LIQUID, SOLID, WALL


def fluid(real, **over):
    values = dict.fromkeys(P.Fluid._fields, 0)
    values.update(sound_speed=10, alpha=0.2, mu=0.5, solid_friction=0.2, mirror=1, clamp=1, density_factor=1)
    return P.make(P.Fluid, real, **{**values, **over})


def smoothing(real):
    return P.make(P.Smoothing, real, support=0.5, kernel=P.CUBIC, laplacian=P.L_VISC)


CONTACT = dict(distance=0.2, stiffness=0.25, damping=0.1, friction=0.2, connect=26)


def calls(real):
    """Return {scalar: arguments} of every scalar that yields a real number."""
    f, s, c = fluid(real), smoothing(real), P.make(P.Contact, real, **CONTACT)
    one = real(1)
    return {
        eos.tait: (real(1010), real(1000), f),
        coupling.pair_factor: (
            real(0.04),
            real(-0.1),
            real(0.5),
            np.int32(SOLID),
            real(0.008),
            real(8),
            real(1000),
            real(1000),
            real(900),
            real(0.008),
            real(8),
            real(1000),
            real(0),
            s,
            f,
        ),
        viscosity.laminar_factor: (
            real(0.2),
            np.int32(LIQUID),
            real(0.008),
            real(8),
            real(1000),
            real(0.008),
            real(8),
            real(1000),
            s,
            f,
        ),
        contact.reduced_mass: (one, one, False),
        contact.contact_normal: (real(0.1), -one, one, c, real(1e-3)),
        contact.contact_friction: (one, one, one, c, real(1e-3)),
    }


@pytest.mark.parametrize("real", (np.float32, np.float64))
@pytest.mark.parametrize("index", range(6))
def test_precision_is_kept(real, index):
    scalar, arguments = list(calls(real).items())[index]
    scalar(*arguments)
    kind = types.float32 if real is np.float32 else types.float64
    found = [sig for sig in scalar.nopython_signatures if sig.args[0] == kind]
    assert found and all(sig.return_type == kind for sig in found)


def test_tait():
    f = fluid(np.float64)
    assert eos.tait(1000.0, 1000.0, f) == 0
    assert eos.tait(1010.0, 1000.0, f) == pytest.approx(1000 * 100 / 7 * (1.01**7 - 1), rel=1e-13)
    assert eos.tait(990.0, 1000.0, f) == 0
    assert eos.tait(990.0, 1000.0, fluid(np.float64, clamp=0)) == pytest.approx(
        1e5 / 7 * (0.99**7 - 1), rel=1e-13
    )
    assert np.isnan(eos.tait(np.nan, 1000.0, f))


@pytest.mark.parametrize("mirror, force", ((0, 5.006581608), (1, 10.013163216)))
def test_printed_coupling_force(mirror, force):
    f = fluid(np.float64, mirror=mirror)
    factor = coupling.pair_factor(
        0.04, 0.0, 0.0, np.int32(SOLID),
        0.008, 8.0, 1000.0, 1000.0, 1000.0, 0.008, 1.0, 9.0, 0.0, smoothing(np.float64), f,
    )
    assert factor * 0.2 == pytest.approx(force, rel=1e-9)


def test_a_boundary_of_volume_zero_does_nothing():
    s, f = smoothing(np.float64), fluid(np.float64)
    for phase in (SOLID, WALL):
        assert (
            coupling.pair_factor(
                0.04, -1.0, 0.3, np.int32(phase), 0.008, 8.0, 1010.0, 5.0, 5.0, 0.0, 8.0, 9.0, 0.0, s, f
            )
            == 0
        )


def test_friction_is_coulomb_but_never_reverses_sliding():
    c = P.make(P.Contact, np.float64, **CONTACT)
    assert contact.contact_friction(10.0, 5.0, 2.0, c, 1e-3) * 5.0 == pytest.approx(0.2 * 10)
    assert contact.contact_friction(10.0, 1e-9, 2.0, c, 1e-3) == pytest.approx(0.25 * 2 / 1e-3)
    assert contact.contact_friction(0.0, 0.0, 2.0, c, 1e-3) == pytest.approx(500.0)  # times v_t = 0


def test_contact_normal():
    c = P.make(P.Contact, np.float64, **CONTACT)
    assert contact.contact_normal(0.15, 1.0, 2.0, c, 1e-2) == pytest.approx(0.25 * 2 / 1e-4 * 0.05)
    assert contact.contact_normal(0.15, -1.0, 2.0, c, 1e-2) == pytest.approx(
        0.25 * 2 / 1e-4 * 0.05 + 0.1 * 2 / 1e-2
    )


def test_surface_thresholds():
    s = smoothing(np.float64)
    assert surface.on_surface(0.0, 0.0, 0.0, 80, 80.0, s) == 0
    assert surface.on_surface(0.0, 0.0, 0.0, 60, 80.0, s) == 0  # 0.75 of 80 is not fewer
    assert surface.on_surface(0.0, 0.0, 0.0, 59, 80.0, s) == 1
    assert surface.on_surface(1.01, 0.0, 0.0, 80, 80.0, s) == 1
    assert surface.on_surface(0.0, 0.99, 0.0, 80, 80.0, s) == 0
    assert surface.on_surface(np.nan, 0.0, 0.0, 0, 80.0, s) == 1
