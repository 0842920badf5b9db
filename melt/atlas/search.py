"""Along a row: where runs stop being stable, and where they fail, to a quarter of an octave, in few runs.

Places are numbers k of quarters of an octave, 0 at the predicted bound. The search takes for granted that what is not stable at
one place is not stable farther on; runs of which that is not true are told (`islands`) and not counted.
"""

from melt.atlas.alarms import FAILED, REFUSED, STABLE

QUARTERS = 4


def factor_of(k):
    """Return the multiple of the predicted bound at place ``k``."""
    return 2.0 ** (k / QUARTERS)


def search(grade, farthest, nearest):
    """Return ({k: grade}, last stable k or None, last k that does not fail or None) of a row.

    Args:
        grade: function k -> one of the grades; called once per place.
        farthest: octaves above the bound to look at most.
        nearest: octaves below it.
    """
    known = {}

    def at(k):
        if k not in known:
            known[k] = grade(k)
        return known[k]

    high, low = farthest * QUARTERS, -nearest * QUARTERS
    stable = _last(at, lambda g: g == STABLE, 0, low, high)
    if stable is not None and at(0) == REFUSED:
        return known, stable, stable
    begin = 0 if stable is None else stable
    whole = _last(at, lambda g: g not in (FAILED, REFUSED), begin, low, high)
    return known, stable, whole


def _last(at, good, begin, low, high):
    """Return the last place that is good, looking up from ``begin`` in growing strides, or down if that is not; None if none is."""
    stride = QUARTERS
    if good(at(begin)):
        inside, outside = begin, None
        while inside < high:
            k = min(inside + stride, high)
            if not good(at(k)):
                outside = k
                break
            inside, stride = k, 2 * stride if inside > begin else stride
        if outside is None:
            return inside
    else:
        inside, outside = None, begin
        while outside > low:
            k = max(outside - stride, low)
            if good(at(k)):
                inside = k
                break
            outside, stride = k, 2 * stride
        if inside is None:
            return None
    while outside - inside > 1:
        middle = (inside + outside) // 2
        inside, outside = (middle, outside) if good(at(middle)) else (inside, middle)
    return inside


def reach(known, good):
    """Return the last place of ``known`` ({k: grade}) up to which all from the first good one on are good; None if none is."""
    inside = None
    for k in sorted(known):
        if good(known[k]):
            inside = k
        elif inside is not None:
            break
    return inside


def islands(known, stable):
    """Return how many places are stable though a nearer one is not."""
    return sum(grade == STABLE for k, grade in known.items() if stable is not None and k > stable)
