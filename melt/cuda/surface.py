"""CUDA twin of `melt.reference.surface`."""

from melt._compile import cuda, cuda_kernel
from melt.physics.phases import LIQUID, SOLID
from melt.physics.smoothing import dW_over_r
from melt.physics.surface import on_surface


@cuda_kernel
def _surface(position, phase, volume, neighbour_count, neighbour_index, smoothing, full_neighbours, surface):
    i = cuda.grid(1)
    if i >= phase.shape[0]:
        return
    real = type(smoothing.support)
    wide = position.dtype.type
    if phase[i] != LIQUID and phase[i] != SOLID:
        surface[i] = 0
        return
    x_i, y_i, z_i = position[0, i], position[1, i], position[2, i]
    gx = gy = gz = wide(0)
    for k in range(neighbour_count[i]):
        j = neighbour_index[i, k]
        x = real(x_i - position[0, j])
        y = real(y_i - position[1, j])
        z = real(z_i - position[2, j])
        c = volume[j] * dW_over_r(x * x + y * y + z * z, smoothing)
        gx += c * x
        gy += c * y
        gz += c * z
    surface[i] = on_surface(real(gx), real(gy), real(gz), neighbour_count[i], full_neighbours, smoothing)


def surface(position, phase, volume, neighbour_count, neighbour_index, smoothing, full_neighbours, surface):
    """See `melt.reference.surface.surface`."""
    _surface.launch(
        phase.shape[0], position, phase, volume, neighbour_count, neighbour_index, smoothing,
        full_neighbours, surface,
    )
