"""CUDA twin of `melt.reference.apic_emit`."""

from melt._compile import cuda, cuda_kernel
from melt.physics.phases import LIQUID


@cuda_kernel
def _emit_apic(
    inflow_position, inflow_velocity, inflow_mass, apic_offset, first, count, slot, lag,
    apic_phase, apic_position, apic_velocity, apic_affine, apic_mass, apic_strain,
):
    k = cuda.grid(1)
    m = apic_offset.shape[1]
    if k >= count * m:
        return
    real = apic_mass.dtype.type
    i, o, p = first + k // m, k % m, slot + k
    apic_phase[p] = LIQUID
    apic_mass[p] = inflow_mass[i] / real(m)
    for a in range(3):
        v = inflow_velocity[a, i]
        apic_velocity[a, p] = v
        apic_position[a, p] = inflow_position[a, i] + (lag * v + apic_offset[a, o])
    for a in range(9):
        apic_affine[a, p] = real(0)
    if apic_strain.shape[1] > 0:
        for a in range(6):
            apic_strain[a, p] = real(1) if a < 3 else real(0)


def emit_apic(
    inflow_position, inflow_velocity, inflow_mass, apic_offset, first, count, slot, lag,
    apic_phase, apic_position, apic_velocity, apic_affine, apic_mass, apic_strain,
):
    """See `melt.reference.apic_emit.emit_apic`."""
    _emit_apic.launch(
        count * apic_offset.shape[1], inflow_position, inflow_velocity, inflow_mass, apic_offset, first, count, slot, lag,
        apic_phase, apic_position, apic_velocity, apic_affine, apic_mass, apic_strain,
    )
