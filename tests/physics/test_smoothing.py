"""Smoothing functions against quadrature, lattice sums and the values printed in the method's text."""

import itertools

import numpy as np
import pytest
from numba import types
from scipy.integrate import quad

from melt import params as P
from melt.physics import smoothing as S
from melt.reference import _pairs

KERNELS = (P.CUBIC, P.WENDLAND2, P.MUELLER)


def make(real=np.float64, support=0.5, kernel=P.CUBIC, laplacian=P.L_VISC, dimension=3):
    return P.make(P.Smoothing, real, support=support, kernel=kernel, laplacian=laplacian, dimension=dimension)


def integral(f, h):
    """Volume integral of f(r) over the support; split where the cubic spline changes its polynomial."""
    return sum(
        quad(lambda r: 4 * np.pi * r * r * f(r), a, b, epsabs=1e-13)[0] for a, b in ((0, h / 2), (h / 2, h))
    )


@pytest.mark.parametrize("kernel", KERNELS)
def test_integral_is_one(kernel):
    s = make(kernel=kernel)
    assert integral(lambda r: S.W(r, s), 0.5) == pytest.approx(1, abs=1e-9)
    # by parts: the integral of -r/3 W' is the one of the function that W' belongs to
    assert integral(lambda r: -r / 3 * S.dW(r, s), 0.5) == pytest.approx(1, abs=1e-9)


@pytest.mark.parametrize("kernel", (P.CUBIC, P.WENDLAND2))
def test_integral_over_the_plane_is_one(kernel):
    s = make(kernel=kernel, dimension=2)

    def plane(f):
        return sum(quad(lambda r: 2 * np.pi * r * f(r), a, b, epsabs=1e-13)[0] for a, b in ((0, 0.25), (0.25, 0.5)))

    assert plane(lambda r: S.W(r, s)) == pytest.approx(1, abs=1e-9)
    assert plane(lambda r: -r / 2 * S.dW(r, s)) == pytest.approx(1, abs=1e-9)
    for r in (0.0, 0.1, 0.3, 0.6):
        assert _pairs.W(r, s) == pytest.approx(S.W(r, s), abs=1e-12)
        assert _pairs.dW(r, s) == pytest.approx(S.dW(r, s), abs=1e-11)


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("laplacian", (P.L_VISC, P.L_BROOK))
def test_second_moment_of_laplacian_weight_is_six(kernel, laplacian):
    s = make(kernel=kernel, laplacian=laplacian)
    assert integral(lambda r: r * r * S.laplacian_weight(r, s), 0.5) == pytest.approx(6, abs=1e-8)


def test_regularised_weight_is_finite_at_zero_and_smaller():
    rough, smooth = make(laplacian=P.L_BROOK), make(laplacian=P.L_BROOK_REGULAR)
    for r in (0.01, 0.1, 0.3):
        assert 0 < S.laplacian_weight(r, smooth) < S.laplacian_weight(r, rough)
    assert np.isfinite(S.laplacian_weight(0.0, smooth))
    assert S.laplacian_weight(0.0, make()) == pytest.approx(45 / (np.pi * 0.5**5), rel=1e-14)


def test_printed_values():
    s = make()
    assert S.W(0.0, s) == pytest.approx(20.3718327, rel=1e-8)
    assert S.W(0.2, s) == pytest.approx(8.63765707, rel=1e-8)
    assert S.dW(0.2, s) == pytest.approx(-78.2278376, rel=1e-8)
    assert S.laplacian_weight(0.2, s) == pytest.approx(275.0197417, rel=1e-9)
    assert S.laplacian_weight(0.2, make(laplacian=P.L_BROOK)) == pytest.approx(782.278376, rel=1e-9)


def lattice_radii(h, dx):
    k = int(np.ceil(h / dx))
    r = np.array(
        [dx * np.sqrt(a * a + b * b + c * c) for a, b, c in itertools.product(range(-k, k + 1), repeat=3)]
    )
    return r[(r > 0) & (r < h * (1 - 1e-12))]


def test_lattice_sums():
    r, V = lattice_radii(0.5, 0.2), 0.2**3
    assert len(r) == 80
    for kernel, total in zip(KERNELS, (0.9985, 1.0134, 0.9954)):
        s = make(kernel=kernel)
        assert V * (S.W(0.0, s) + sum(S.W(x, s) for x in r)) == pytest.approx(total, abs=1e-4)
    s = make()
    assert V * sum(S.laplacian_weight(x, s) for x in r) * 0.25 == pytest.approx(14.20, abs=5e-3)


@pytest.mark.parametrize(
    "laplacian, ratio, factor",
    [
        (P.L_VISC, 2.5, 1.021),
        (P.L_BROOK, 2.5, 0.982),
        (P.L_VISC, 2, 0.988),
        (P.L_VISC, 3, 0.956),
        (P.L_VISC, 4, 1.008),
    ],
)
def test_lattice_second_moment(laplacian, ratio, factor):
    s = make(support=0.2 * ratio, laplacian=laplacian)
    r = lattice_radii(0.2 * ratio, 0.2)
    assert 0.008 / 6 * sum(x * x * S.laplacian_weight(x, s) for x in r) == pytest.approx(factor, abs=6e-4)


@pytest.mark.parametrize("kernel", KERNELS)
def test_derivative_against_finite_difference(kernel):
    s = make(kernel=kernel)

    def value(r):  # the function whose derivative dW is: spiky beside poly6
        return 15 / (np.pi * 0.5**6) * (0.5 - r) ** 3 if kernel == P.MUELLER else S.W(r, s)

    step = 1e-5
    for r in np.linspace(0.01, 0.49, 49):
        assert S.dW(r, s) == pytest.approx(
            (value(r + step) - value(r - step)) / (2 * step), rel=1e-6, abs=1e-6
        )


@pytest.mark.parametrize("kernel", KERNELS)
def test_zero_at_the_support_and_beyond(kernel):
    for r in (0.5, np.nextafter(0.5, 1), 0.7, 1e9):
        s = make(kernel=kernel)
        assert S.W(r, s) == 0 and S.dW(r, s) == 0 and S.dW_over_r(r * r, s) == 0
        assert S.laplacian_weight(r, s) == 0


@pytest.mark.parametrize("kernel", KERNELS)
def test_gradient_vanishes_at_zero_and_has_no_hole_beside_it(kernel):
    s = make(kernel=kernel)
    assert S.dW_over_r(0.0, s) == 0
    assert S.dW_over_r((0.9e-9 * 0.5) ** 2, s) == 0
    near = 1e-6
    assert S.dW_over_r(near**2, s) * near == pytest.approx(_pairs.dW(near, s), rel=1e-9)
    single = make(np.float32, kernel=kernel)
    for r in (1e-7, 1e-4, 1e-2, 0.2, 0.45):  # the cubic spline's difference of squares would cancel
        assert S.dW(np.float32(r), single) == pytest.approx(
            float(_pairs.dW(np.float64(np.float32(r)), s)), rel=3e-6
        )


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("laplacian", (P.L_VISC, P.L_BROOK, P.L_BROOK_REGULAR))
def test_same_as_the_reference(kernel, laplacian):
    s = make(kernel=kernel, laplacian=laplacian)
    r = np.linspace(0, 0.55, 111)
    for mine, theirs in ((S.W, _pairs.W), (S.dW, _pairs.dW), (S.laplacian_weight, _pairs.L)):
        expected = theirs(r, s)
        assert np.allclose([mine(x, s) for x in r], expected, rtol=1e-12, atol=1e-13 * np.abs(expected).max())


@pytest.mark.parametrize("kernel", KERNELS)
@pytest.mark.parametrize("laplacian", (P.L_VISC, P.L_BROOK, P.L_BROOK_REGULAR))
def test_float32_stays_float32(kernel, laplacian):
    s = make(np.float32, kernel=kernel, laplacian=laplacian)
    for f in (S.W, S.dW, S.dW_over_r, S.laplacian_weight):
        f(np.float32(0.1), s)
        found = [sig for sig in f.nopython_signatures if sig.args[0] == types.float32]
        assert found and all(sig.return_type == types.float32 for sig in found), f
