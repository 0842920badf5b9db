"""How tests run one stage on arrays that they hold."""

import numpy as np

from melt import params as P
from melt.check.compare import run_stage
from melt.stages import STAGES


def run_with(stage, backend, a, real, changes, kinds, given=None):
    """Run a stage, put what it writes into ``a`` and return that.

    ``changes``: other values of parameters, or scalars. ``kinds``: name of a tuple -> (its type, values); ``given``: tuples as they are.
    """
    params = dict(given or {})
    for name in STAGES[stage].params:
        if name in params:
            continue
        if name in kinds:
            kind, values = kinds[name]
            params[name] = P.make(kind, real, **{**values, **{k: v for k, v in changes.items() if k in values}})
        else:
            params[name] = np.int32(changes[name]) if isinstance(changes[name], int) else real(changes[name])
    out = run_stage(stage, backend, a, params)
    a.update(out)
    return out
