"""Kernels in two dimensions: unit integral, derivatives, and the forms in which the stages use them (flood 0, E8)."""

import numpy as np
import pytest
from scipy.integrate import quad

from melt import params as P
from melt.physics import flood as F
from melt.reference import _flood

KERNELS = pytest.mark.parametrize("kernel", (P.CUBIC, P.WENDLAND2))
H = 0.7


def make(real=np.float64, **changes):
    values = {**dict.fromkeys(P.Flood._fields, 0), "sigma": 1.0, "ratio": 2.66, "smallest": 0.5, "largest": 4.0, "growth": 1.1}
    return P.make(P.Flood, real, **{**values, **changes})


def integral(f):
    return sum(quad(f, a, b, epsabs=1e-13)[0] for a, b in ((0, H / 2), (H / 2, H)))


@KERNELS
def test_integral_over_the_plane_is_one(kernel):
    f = make(kernel=kernel)
    assert integral(lambda r: 2 * np.pi * r * F.W2(r, H, f)) == pytest.approx(1, abs=1e-11)
    # by parts: -r/2 W' belongs to the same function
    assert integral(lambda r: -np.pi * r * r * F.dW2(r, H, f)) == pytest.approx(1, abs=1e-11)
    assert integral(lambda r: 2 * np.pi * r * F.W2(r, H, make(kernel=kernel, sigma=0.9))) == pytest.approx(0.9, abs=1e-11)


@KERNELS
@pytest.mark.parametrize("r", [0.01, 0.2, 0.34, 0.36, 0.5, 0.69])
def test_derivative_is_that_of_the_kernel(kernel, r):
    f, e = make(kernel=kernel), 1e-6
    assert F.dW2(r, H, f) == pytest.approx((F.W2(r + e, H, f) - F.W2(r - e, H, f)) / (2 * e), rel=1e-6)
    w, t = F.weights2(r / H, f)
    c, slope = F.scales2(f)
    assert c * w / H**2 == pytest.approx(F.W2(r, H, f), rel=1e-11)
    assert slope * t / H**2 == pytest.approx(-r * F.dW2(r, H, f), rel=1e-11)
    assert F.W2(r, H, f) == pytest.approx(float(_flood.W2(r, H, f)), rel=1e-12)
    assert F.dW2(r, H, f) == pytest.approx(float(_flood.dW2(r, H, f)), rel=1e-12)


@KERNELS
def test_kernel_ends_at_its_support_and_has_no_gradient_in_the_middle(kernel):
    f = make(kernel=kernel)
    for r in (H, 2 * H, 1e9):
        assert F.W2(r, H, f) == 0 and F.dW2(r, H, f) == 0 and F.weights2(r / H, f)[0] == 0
    assert F.dW2(0.0, H, f) == 0


def test_printed_values():
    """l = 0.5: W(0) = 10/(7 pi l^2), 7/(4 pi l^2); at r = l 1/4 and 3/16 of them."""
    cubic, wendland = make(kernel=P.CUBIC), make(kernel=P.WENDLAND2)
    assert F.W2(0.0, 1.0, cubic) == pytest.approx(1.8189136, rel=1e-7)
    assert F.W2(0.5, 1.0, cubic) == pytest.approx(1.8189136 / 4, rel=1e-7)
    assert F.W2(0.0, 1.0, wendland) == pytest.approx(2.2281692, rel=1e-7)
    assert F.W2(0.5, 1.0, wendland) == pytest.approx(2.2281692 * 3 / 16, rel=1e-7)


def test_support_is_clamped_whatever_the_depth():
    f = make()
    assert F.support_of(1.0, 1.0, f) == 2.66 and F.support_of(0.25, 1.0, f) == 1.33
    assert F.support_of(1.0, 1e9, f) == 0.5
    assert [F.support_of(1.0, d, f) for d in (1e-9, 0.0, -1.0, np.nan)] == [4.0] * 4
    assert [F.support_limit(h, f) for h in (0.1, 2.0, 3.9, np.nan)] == [0.5, pytest.approx(2.2), 4.0, 4.0]


def test_outermost_ring_is_the_last_that_can_be_reached():
    for h, rings in ((0.0, 0), (np.nan, 0), (0.1, 1), (1.0, 1), (1.001, 2), (2.0, 2), (7.5, 8), (8.0, 8), (50.0, 9), (np.inf, 9)):
        assert F.outermost_ring(h, 1.0, 1.0, np.int32(9)) == rings
