"""Every CUDA kernel compiles for every supported device, without one: PTX by NVVM, registers by ptxas."""

import pathlib
import re

import numba
import numpy as np
import pytest

from melt import _compile
from melt.check import ptx
from melt.stages import STAGES

pytestmark = pytest.mark.toolchain
OBSTACLE = ptx.why_not()
GPU_MD = pathlib.Path(__file__).parents[2] / "docs" / "gpu.md"

if OBSTACLE:
    pytest.skip(OBSTACLE, allow_module_level=True)


@pytest.fixture(scope="module")
def single():
    return ptx.compile_all("single", assembled=bool(ptx.ptxas()))


def test_every_kernel_is_launched_by_the_check_inputs():
    """A kernel that no variant of the inputs launches would be neither compiled nor checked."""
    launched = {name for stage in STAGES for name, _ in ptx.launches(stage, "single")}
    assert {
        ptx.name_of(kernel)
        for kernel in _compile.KERNELS
        if kernel.py_func.__module__.startswith("melt.cuda.")
    } == launched


def test_every_kernel_compiles_for_every_capability_in_single_precision(single):
    assert not [(row.kernel, row.error) for row in single if row.error]
    assert {row.capability for row in single} == set(ptx.CAPABILITIES)


#: Kernels of fields of kind "double": ledgers, and the volumes of bubbles, which must add up to the last digits.
LEDGERS = {
    "apic_back._apic_sums",
    "boil_grid._voxel_heater", "boil_heat._boil_content", "boil_heat._boil_cooling", "boil_heat._boil_heater", "boost._liquid_sums",
    "bubble_birth._birth_excess", "bubble_birth._spawn_bubbles", "bubble_growth._bubble_growth", "bubble_merge._merge_members",
    "bubble_merge._merge_removed", "flood_guard._guard_sums", "flood_sources._seepage_sums", "flood_zones._zone_parts",
    "flood_zones._zone_totals",
    # sums of conjugate gradients, and the inverse of a block that may be nearly of rank one
    "_poisson.dot", "poisson._left", "poisson_cg._poisson_step", "poisson_cg._preconditioned", "poisson_cg._poisson_turn",
    "poisson_cg._keep_sums",
    "_viscous.dot", "viscous._pair_shear", "viscous._right_side", "viscous_cg._viscous_step", "viscous_cg._preconditioned",
    "viscous_cg._viscous_turn", "viscous_cg._keep_sums",
}
LEDGERS |= {"dfsph._pressure_error", "dfsph_source._source_mean", "load._pressure_load", "load._shear_load", "bubble_birth._boiled_sums"}


def test_single_precision_kernels_have_no_double_precision_instructions(single):
    assert not {row.kernel: row.doubles for row in single if row.doubles and row.kernel not in LEDGERS}


def test_every_kernel_compiles_in_double_precision():
    rows = ptx.compile_all("double", ((9, 0),), assembled=False)
    assert not [(row.kernel, row.error) for row in rows if row.error]


def test_no_kernel_spills_in_single_precision(single):
    if not ptx.ptxas():
        pytest.skip("ptxas is not installed: pip install 'melt[toolchain]'")
    assert not {row.kernel: row.spills for row in single if row.spills}


def test_gpu_page_lists_the_kernels_there_are(single):
    listed = set(re.findall(r"^\| `([\w.]+)`", GPU_MD.read_text(), flags=re.M))
    assert listed == {row.kernel for row in single}, "run python -m melt.check.ptx"


def test_double_precision_instructions_are_seen():
    def wide(x, y):
        i = _compile.cuda.grid(1)
        if i < x.shape[0]:
            y[i] = 0.1 * x[i] * x[i] + 0.3  # NVVM narrows simpler ones by itself

    x = np.zeros(3, np.float32)
    library = ptx.lower(_compile.Kernel(wide), (numba.typeof(x), numba.typeof(x)), (9, 0))
    _compile.KERNELS.pop()
    assert ptx.double_instructions("\n".join(library.get_asm_strs(cc=(9, 0))))


def test_occupancy_of_known_register_counts():
    assert ptx.occupancy(32, (9, 0)) == 1.0
    assert ptx.occupancy(64, (9, 0)) == 0.5
    assert ptx.occupancy(255, (9, 0)) == 0.125
    assert ptx.occupancy(64, (7, 5)) == 1.0
