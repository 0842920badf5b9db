"""Contact of two solid particles, or of one and a wall. Melting spec 3.3."""

from melt._compile import scalar


@scalar
def lattice_steps(i, j, k, connect):
    """Return how many bonds lead from a voxel to the one at (i, j, k) in a full lattice; ``connect`` 6, 18 or 26."""
    a, b, c = abs(i), abs(j), abs(k)
    if connect == 6:
        return a + b + c
    # an edge neighbour is two axes in one bond
    return max(a, b, c) if connect == 26 else max(max(a, b, c), (a + b + c + 1) // 2)


@scalar
def reduced_mass(mass_i, mass_j, wall_j):
    """Return m_i m_j/(m_i + m_j) [kg]; m_i against a wall, which is infinitely heavy."""
    return mass_i if wall_j else mass_i * mass_j / (mass_i + mass_j)


@scalar
def contact_normal(r, v_n, reduced, contact, dt):
    """Return N >= 0 [N]: penalty k_c (d - r) and damping of the approach v_n = v_ij . n < 0."""
    real = type(r)
    penalty = contact.stiffness * reduced / (dt * dt) * (contact.distance - r)
    return penalty + contact.damping * reduced * max(-v_n, real(0)) / dt


@scalar
def contact_friction(normal, speed, reduced, contact, dt):
    """Return b >= 0 [N s/m] of the friction -b v_t: Coulomb, at most what stops a quarter of v_t.

    The quarter keeps the four or so contacts of one particle on a lattice from reversing its
    sliding within a sub-step.
    """
    real = type(normal)
    most = real(0.25) * reduced / dt
    limit = contact.friction * normal
    return most if most * speed <= limit else limit / speed
