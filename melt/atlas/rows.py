"""What the runs of a row come to: how far it is stable, in multiples of the predicted bound."""

import math
from typing import NamedTuple

from melt.atlas.alarms import FAILED, REFUSED, STABLE
from melt.atlas.search import factor_of, islands, reach


class Row(NamedTuple):
    """A row of a map."""

    row: int
    value: float  # of the second knob
    bound: float  # predicted, in units of the first knob (mean over the run at the bound, where it follows the flow); NaN: not known
    governing: str
    stable: float | None  # multiple of the bound up to which runs are stable; None: none of those looked at
    whole: float | None  # and up to which they do not fail
    open: bool  # stable as far as was looked
    first: object  # the first `Cell` beyond, None if there is none
    islands: int  # stable runs beyond the first that is not

    @property
    def words(self):
        """The safety that is left."""
        if self.stable is None:
            return "never stable"
        return f"{'>= ' if self.open else ''}{self.stable:.3g} x"


def rows_of(cells, about):
    """Return the `Row` list of a map's cells; ``about`` are the attributes of its group."""
    found = []
    for row in sorted({c.row for c in cells}):
        own = {c.k: c for c in cells if c.row == row}
        grades = {k: c.grade for k, c in own.items()}
        stable = reach(grades, lambda grade: grade == STABLE)
        whole = reach(grades, lambda grade: grade not in (FAILED, REFUSED))
        beyond = [own[k] for k in sorted(own) if own[k].grade != STABLE and (stable is None or k > stable)]
        start = own[0]
        taken = [c.x / factor_of(c.k) for c in sorted(own.values(), key=lambda c: abs(c.k)) if c.steps and c.x > 0]
        bound = taken[0] if taken else math.nan  # melt refuses the whole row
        found.append(Row(
            row, start.value, float(about["bound"]) if about["bound"] == about["bound"] else bound, start.bound,
            None if stable is None else factor_of(stable), None if whole is None else factor_of(whole),
            stable == 4 * int(about["octaves"]), beyond[0] if beyond else None,
            islands(grades, stable),
        ))
    return found
