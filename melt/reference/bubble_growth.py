r"""Radius of bubbles. Boiling spec 2.5.

With :math:`r_0 = (3 V_0/(4\pi))^{1/3}`, the height y of the centre above the floor, birth height :math:`y_g` and age t:

.. math::
    r = r_0 \Big(1 + \frac{\beta}{\alpha} \xi \tau\Big), \quad \xi = \mathrm{clamp}\Big(\frac{y - y_g}{H_w}, 0, 1\Big),
    \quad \tau = \mathrm{clamp}\Big(\frac{t}{t_{ref}}, 0, 1\Big)

RECONSTRUCTED: the same alpha and beta as in the paper's :math:`r = \alpha h + \beta (y - h) t` (h = birth height),
which mixes units and makes the first radius depend on the height of birth. That law is kept as
``literal_radius``, with :math:`h = \max(y_g, d)`, between birth radius and largest radius. True growth by falling
pressure is only about 1 % in 0.3 m of water.
"""

import numpy as np


def bubble_growth(
    position, bubble_index, bubble_count, bubble_volume, birth_height, bubbles, dt, age, bubble_radius, rest_volume,
):
    """Let bubbles age by dt and write their radius and the volume by which they displace.

    Growth stops at ``largest``; a bubble that merged to more keeps its r_0. Without growth (not yet risen, or of
    age 0) the radius is r_0 rounded, to the last bit.

    Reads: position (3, n) [m], bubble_index (n,) of which the first bubble_count[0] count, bubble_volume (n,)
        [m^3, float64], birth_height (n,) [m], age (n,) [s].
    Writes: of the listed, age, bubble_radius (n,) [m], rest_volume (n,) [m^3] of at most ``most_volume``.
    """
    b, largest = bubbles, float(bubbles.largest)
    for i in bubble_index[: int(bubble_count[0])]:
        t, y_g = float(age[i]) + float(dt), float(birth_height[i])
        y = float(position[2, i]) - float(b.floor)
        r0 = np.cbrt(3 * bubble_volume[i] / (4 * np.pi))
        if b.literal_radius == 1:
            r = float(b.radius_height) * max(y_g, float(b.spacing)) + float(b.radius_rate) * (y - y_g) * t
            r = min(max(r, float(b.birth_radius)), largest)
        else:
            xi = min(max((y - y_g) / float(b.depth), 0.0), 1.0)
            tau = min(max(t / float(b.growth_time), 0.0), 1.0)
            r = min(r0 * (1 + float(b.growth) * xi * tau), max(r0, largest))
        age[i], bubble_radius[i] = t, r
        rest_volume[i] = min(4 / 3 * np.pi * r**3, float(b.most_volume))


def largest_bubble(phase, bubble_radius, largest_bubble):
    """Write the largest radius [m] of bubbles in each of the pieces; infinite for a NaN.

    Reads: phase (n,), bubble_radius (n,) [m].
    Writes: largest_bubble (pieces,): piece p covers the particles from p n/pieces on; 0 where it has no bubble.
    """
    n, pieces = phase.shape[0], largest_bubble.shape[0]
    for p in range(pieces):
        part = slice(p * n // pieces, (p + 1) * n // pieces)
        r = bubble_radius[part][phase[part] == 3]
        largest_bubble[p] = np.where(np.isnan(r), np.inf, r).max(initial=0.0)
