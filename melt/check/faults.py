"""Planted faults: wrappers that break a stage as a slip in a twin would. Each must turn the check red."""

import numpy as np

from melt.stages import STAGES


def _outputs(stage, arguments):
    return [v for a, v in zip(stage.arguments, arguments) if a in stage.writes and a not in stage.scratch]


def sign_flip(name, function):
    """The change that the stage makes has the wrong sign; flags and indices are inverted."""
    stage = STAGES[name]

    def faulty(*arguments):
        before = [v.copy() for v in _outputs(stage, arguments)]
        function(*arguments)
        for old, new in zip(before, _outputs(stage, arguments)):
            accumulates = stage.partial and new.dtype.kind == "f"
            new[...] = (
                np.where(new == old, new, 2 * old - new) if accumulates else -new - (new.dtype.kind == "i")
            )

    return faulty


def missing_last_row(name, function):
    """The loop ends one element early: the last element that changes is left as it was."""
    stage = STAGES[name]

    def faulty(*arguments):
        before = [v.copy() for v in _outputs(stage, arguments)]
        function(*arguments)
        for old, new in zip(before, _outputs(stage, arguments)):
            changed = np.flatnonzero((new != old).ravel())
            if changed.size:
                new.reshape(-1)[changed[-1]] = old.reshape(-1)[changed[-1]]

    return faulty


def swappable(name, arguments, kinds="fi"):
    """Return positions of two inputs of equal shape and dtype but different values, or None; reals first."""
    stage = STAGES[name]
    reads = [k for k, a in enumerate(stage.arguments) if a not in stage.params and a in stage.reads]
    for kind in kinds:
        for k in reads:
            for m in reads:
                x, y = arguments[k], arguments[m]
                if (
                    k < m
                    and x.dtype.kind == kind
                    and (x.shape, x.dtype) == (y.shape, y.dtype)
                    and x.tobytes() != y.tobytes()
                ):
                    return k, m
    return None


def swapped_arguments(name, function):
    """Two inputs of one shape change places in the call."""

    def faulty(*arguments):
        arguments = list(arguments)
        pair = swappable(name, arguments)
        if pair is not None:
            k, m = pair
            x, y = arguments[k].copy(), arguments[m].copy()
            if not {STAGES[name].arguments[p] for p in pair} & set(STAGES[name].writes):
                arguments[k], arguments[m] = y, x
            else:
                arguments[k][...], arguments[m][...] = y, x
        function(*arguments)

    return faulty


def wrong_field(name, function):
    """The first real input that is not written is mistaken for one of other values (here: back to front)."""
    stage = STAGES[name]

    def faulty(*arguments):
        arguments = list(arguments)
        for k, a in enumerate(stage.arguments):
            if (
                a not in stage.params
                and a not in stage.writes
                and arguments[k].dtype.kind == "f"
                and arguments[k].size
            ):
                arguments[k] = np.ascontiguousarray(arguments[k][..., ::-1])
                break
        function(*arguments)

    return faulty


def stale_output(name, function):
    """The stage returns without writing."""

    def faulty(*arguments):
        pass

    return faulty


FAULTS = {f.__name__: f for f in (sign_flip, missing_last_row, swapped_arguments, wrong_field, stale_output)}
