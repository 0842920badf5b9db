"""What an entry of the registry is, and the tolerances of the cross-check."""

from typing import NamedTuple


class Tolerance(NamedTuple):
    """``|a - b| <= rtol * |ref| + atol * field.scale``, per precision, with its reason."""

    single: float
    double: float
    reason: str
    atol_single: float | None = None  # None: as rtol
    atol_double: float | None = None

    def of(self, precision):
        """Return (rtol, atol) for ``single`` (also pair work of ``mixed``) or ``double``."""
        if precision == "double":
            return self.double, self.double if self.atol_double is None else self.atol_double
        return self.single, self.single if self.atol_single is None else self.atol_single


class Stage(NamedTuple):
    name: str
    file: str
    equation: str
    reads: tuple
    params: tuple
    writes: tuple
    tolerance: Tolerance
    partial: bool  # writes a subset of the elements: the others keep their value
    scratch: tuple  # fields among ``writes`` whose contents mean nothing afterwards

    @property
    def arguments(self):
        """Names of the arguments in order."""
        return tuple(r for r in self.reads if r not in self.writes) + self.params + self.writes


EXACT = Tolerance(0.0, 0.0, "integers, compared exactly")
COPY = Tolerance(0.0, 0.0, "copies values")
SUM = Tolerance(2e-5, 1e-12, "sum of about 80 products; float32 positions are rounded")
STIFF = Tolerance(2e-4, 1e-11, "seventh power and differences of nearly equal terms")
FEW = Tolerance(2e-6, 1e-14, "a few operations per element")
SHARE = Tolerance(1e-3, 1e-12, "divided by a sum of weights, of which few digits are left if all neighbours are near the support")
REGION = Tolerance(5e-5, 1e-11, "sum over up to 125 members and a rotation")
SWEEP = Tolerance(5e-5, 1e-11, "a chain of pair updates")
EIGEN = Tolerance(2e-4, 1e-8, "closed-form eigenvalue: a double root has half the digits")
MOMENT = Tolerance(1e-3, 1e-8, "inverse of a second moment with a condition of up to 100, shown by its small elements")
SOLVER = Tolerance(1e-4, 1e-7, "iterated to its own residual tolerance")


def stage(name, file, equation, reads, params, writes, tolerance, partial=False, scratch=""):
    """Return a `Stage` whose lists of names are given as text."""
    return Stage(
        name, file, equation, tuple(reads.split()), tuple(params.split()), tuple(writes.split()),
        tolerance, partial, tuple(scratch.split()),
    )


NEAR = "neighbour_count neighbour_index"
