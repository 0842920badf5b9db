"""Ctrl-C ends a run after the step that is under way."""

import contextlib
import signal
from types import SimpleNamespace


@contextlib.contextmanager
def asked_to_stop():
    """Yield an object whose ``asked`` turns true with the first Ctrl-C; the second one does not wait."""
    stop = SimpleNamespace(asked=False)

    def ask(signum, frame):
        if stop.asked:
            raise KeyboardInterrupt
        stop.asked = True

    try:
        previous = signal.signal(signal.SIGINT, ask)
    except ValueError:  # not in the main thread: the caller handles Ctrl-C
        yield stop
        return
    try:
        yield stop
    finally:
        signal.signal(signal.SIGINT, previous)
