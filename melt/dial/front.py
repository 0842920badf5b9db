"""The Pareto front of measured points, and which of them the presets are."""

import math

#: A preset "draft" may be this far off [percent], or three times as far as the scene as it is, whichever is more.
DRAFT_ERROR = 10.0
#: A preset "accurate" may cost this many times the scene as it is.
ACCURATE_COST = 4.0
#: The rules in words, for the head of a stored front.
RULES = (
    f"accurate: cheapest within the spread of the lowest error at up to {ACCURATE_COST:g}x default's cost; "
    f"draft: cheapest with at most {DRAFT_ERROR:g} % or 3x default's error; balanced: the knee between them"
)


def on_front(points):
    """Return the indices of points that no other beats in both cost and error, cheapest first. Failed ones are none."""
    good = [i for i, p in enumerate(points) if not p.failure and math.isfinite(p.error)]
    order = sorted(good, key=lambda i: (points[i].s_per_simulated_s, points[i].error))
    front, best = [], math.inf
    for i in order:
        if points[i].error < best:
            front.append(i)
            best = points[i].error
    return front


def presets_of(points):
    """Return {preset: index of its point}, for points whose first is the scene as it is.

    accurate: of the front's points that cost at most 4 times the default, the cheapest whose error is the lowest or within the
    spread of it. draft: the cheapest of the front whose error is at most 10 %, or three times the default's if that is more. balanced:
    the knee between the two: nearest to the corner of draft's cost and accurate's error, both as logarithms over their range.
    A draft that would be dearer than accurate is accurate.
    """
    front, default = on_front(points), points[0]
    if not front:
        return {}
    allowed = ACCURATE_COST * default.s_per_simulated_s if not default.failure else math.inf
    within = [i for i in front if points[i].s_per_simulated_s <= allowed] or front[:1]
    lowest = points[within[-1]]
    accurate = next(i for i in within if points[i].error <= lowest.at_most)
    cap = max(DRAFT_ERROR, 3 * default.error if math.isfinite(default.error) else 0.0)
    draft = next((i for i in within if points[i].error <= cap), accurate)
    if front.index(draft) > front.index(accurate):
        draft = accurate
    between = front[front.index(draft) : front.index(accurate) + 1]
    return {"draft": draft, "balanced": _knee(points, between), "accurate": accurate}


def _knee(points, indices):
    """Return the index nearest to the corner of least cost and least error; the cheaper of equal ones."""
    def share(values):
        logs = [math.log(max(v, 1e-12)) for v in values]
        low, high = min(logs), max(logs)
        return [(x - low) / (high - low) if high > low else 0.0 for x in logs]

    cost, error = (share([getattr(points[i], name) for i in indices]) for name in ("s_per_simulated_s", "error"))
    far = [math.hypot(c, e) for c, e in zip(cost, error)]
    return indices[far.index(min(far))]
