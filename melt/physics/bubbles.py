"""Scalars of bubbles: radius and volume, walls, growth, drag. Boiling spec 2.5."""

import math

from melt._compile import scalar


@scalar
def radius_of(volume):
    r"""Return the radius :math:`(3 V/(4\pi))^{1/3}` of a sphere.

    The one place where V0 becomes a radius: called with the float64 V0 and then rounded, it gives every stage the
    same bits, so that a bubble that has not grown is known by its radius. A power, since kernels have no cube
    root; it is within 3 units in the last place of one.
    """
    real = type(volume)
    return (volume * real(3 / (4 * math.pi))) ** real(1 / 3)


@scalar
def sphere_volume(radius):
    r"""Return :math:`\frac{4}{3}\pi r^3`."""
    return type(radius)(4 / 3 * math.pi) * (radius * radius * radius)


@scalar
def inside(x, lower, upper, radius):
    """Return the coordinate of a centre, a radius away from both walls; the middle if there is no room."""
    real = type(x)
    if real(2) * radius > upper - lower:
        return real(0.5) * (lower + upper)
    return min(max(x, lower + radius), upper - radius)


@scalar
def too_wide(radius, support):
    """Return whether a bubble is so large that the liquid within its support is none, or only what it carries along."""
    return radius > type(radius)(0.75) * support


@scalar
def drag_loss(radius, reach):
    r"""Return the share of its relative velocity that a bubble loses to quadratic drag in a step.

    ``reach`` is :math:`c = 4 K \Delta t s_0` [m] with k = K/r, the relative speed s_0 before the step and, after
    it, :math:`s_1 = (-1 + \sqrt{1 + 4 k \Delta t s_0})/(2 k \Delta t)`. Multiplied out, without the difference of
    nearly equal numbers (and for any r >= 0):

    .. math:: 1 - \frac{s_1}{s_0} = \frac{c}{(\sqrt{r} + \sqrt{r + c})^2}
    """
    sum_of_roots = math.sqrt(radius) + math.sqrt(radius + reach)
    return reach / (sum_of_roots * sum_of_roots)


@scalar
def grown_radius(start, height, birth_height, age, bubbles):
    """Return the radius of a bubble that began with ``start``, ``height`` above the floor; unchanged bits at age 0."""
    real = type(start)
    rise = height - birth_height
    if bubbles.literal_radius == 1:
        r = bubbles.radius_height * max(birth_height, bubbles.spacing) + bubbles.radius_rate * rise * age
        return min(max(r, bubbles.birth_radius), bubbles.largest)
    risen = min(max(rise / bubbles.depth, real(0)), real(1))
    lived = min(max(age / bubbles.growth_time, real(0)), real(1))
    return min(start * (real(1) + bubbles.growth * risen * lived), max(start, bubbles.largest))
