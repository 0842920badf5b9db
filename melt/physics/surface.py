"""Free surface test. Melting spec 2.8."""

from melt._compile import scalar


@scalar
def on_surface(gx, gy, gz, count, full_neighbours, smoothing):
    """Return 1 if |Sum V gradW| h > 0.5 or fewer than 0.75 of a full lattice's neighbours.

    Lattice values of the sum: 0 inside, 0.08 second layer, 1.15 face, 1.27 edge, 1.21 corner.
    """
    real = type(gx)
    h = smoothing.support
    if real(count) < real(0.75) * full_neighbours:
        return 1
    return 1 if (gx * gx + gy * gy + gz * gz) * h * h > real(0.25) else 0
