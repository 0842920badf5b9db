"""Scalar formulas of birth, merging and bursting of bubbles. Boiling spec 2.5, 3.

Volumes and what is summed over bubbles are float64 in every precision: callers hand over float64, and each formula
computes in the type of its first argument.
"""

import numpy as np

from melt._compile import scalar, scalar_lookup
from melt.params import MASS_NUCLEATE
from melt.physics.bubbles import radius_of, sphere_volume
from melt.physics.search import axis_cell


@scalar
def current_volume(volume, radius):
    """Return the volume of a bubble of birth volume V0 and radius r as it is now.

    V0 itself where r is the rounded radius of V0, to 8 ulp (`radius_of` errs by 3, on whatever machine the run began):
    bubbles that did not grow merge without loss, although the cube of a float32 radius is off by 2e-7. Else
    (4/3) pi r^3.
    """
    wide, real = type(volume), type(radius)
    ulp = abs(real(3) * (real(4) / real(3) - real(1)) - real(1))
    born = real(radius_of(volume))
    if abs(radius - born) <= real(8) * ulp * born:
        return volume
    return sphere_volume(wide(radius))


@scalar
def boil_excess(mass, temperature, store, boiling):
    """Return the heat [J] of a particle that boils above what the vapour takes: m (store - L_eff + c_p (T - T_b)).

    A particle that stays (MASS_NUCLEATE) gives its store and what it cools down by: m (store + c_p dT).
    """
    real = type(mass)
    if boiling.mass_model == MASS_NUCLEATE:
        return mass * (store + real(boiling.specific_heat) * real(boiling.subcooling))
    above = temperature - real(boiling.boiling_point)
    return mass * (store - real(boiling.latent_heat) + real(boiling.specific_heat) * above)


@scalar
def coarse_count(count, coarse):
    """Return how many blocks of ``coarse`` cells cover the cells of one axis."""
    return (int(count) - 1) // int(coarse) + 1


@scalar
def coarse_cell(x, y, z, grid, coarse):
    """Return the linear coarse cell of a point, x fastest."""
    a = axis_cell(x, grid.origin_x, grid.inverse_cell, grid.nx) // int(coarse)
    b = axis_cell(y, grid.origin_y, grid.inverse_cell, grid.ny) // int(coarse)
    c = axis_cell(z, grid.origin_z, grid.inverse_cell, grid.nz) // int(coarse)
    return a + coarse_count(grid.nx, coarse) * (b + coarse_count(grid.ny, coarse) * c)


@scalar
def column_of(x, y, grid):
    """Return the column of the neighbour grid over a point, x fastest."""
    a = axis_cell(x, grid.origin_x, grid.inverse_cell, grid.nx)
    b = axis_cell(y, grid.origin_y, grid.inverse_cell, grid.ny)
    return a + int(grid.nx) * b


@scalar
def height_steps(z, floor, spacing):
    """Return the height above the floor in 1/4096 of a spacing, to the nearest, from 0 to 2^30; NaN counts as 0."""
    wide = type(z)
    t = (z - wide(floor)) * (wide(4096) / wide(spacing)) + wide(0.5)
    if t >= wide(1 << 30):
        return 1 << 30
    if t > wide(0):
        return int(t)
    return 0


@scalar
def steps_height(steps, spacing):
    """Return the height [m] of a number of steps of `height_steps`."""
    real = type(spacing)
    return real(steps) * (spacing / real(4096))


@scalar_lookup
def merged_sums(
    place, bubble_index, bubble_count, merge_root, merge_size, bubble_volume, bubble_radius, position, velocity, cargo
):
    """Return the sums of V, V x (3), V v (3), x (3) and cargo over what merges with the root at ``place`` of the list.

    In ascending id and without fastmath: the same bits wherever the bubbles are stored.
    """
    wide = bubble_volume.dtype.type
    root = bubble_index[place]
    total = wide(0)
    mx = my = mz = mu = mv = mw = px = py = pz = wide(0)
    carried, left = 0, int(merge_size[root])
    b = np.int64(place)  # the index of a parallel loop is unsigned
    while left > 0 and b < bubble_count[0]:
        j = bubble_index[b]
        if merge_root[j] == root:
            V = current_volume(bubble_volume[j], bubble_radius[j])
            x, y, z = wide(position[0, j]), wide(position[1, j]), wide(position[2, j])
            total += V
            mx, my, mz = mx + V * x, my + V * y, mz + V * z
            mu, mv, mw = mu + V * wide(velocity[0, j]), mv + V * wide(velocity[1, j]), mw + V * wide(velocity[2, j])
            px, py, pz = px + x, py + y, pz + z
            carried += int(cargo[j])
            left -= 1
        b += 1
    return total, mx, my, mz, mu, mv, mw, px, py, pz, carried
