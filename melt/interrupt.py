"""Ctrl-C and SIGTERM end a run after the step that is under way."""

import contextlib
import signal
from types import SimpleNamespace


class Terminated(KeyboardInterrupt):
    """SIGTERM came where nothing waits for the end of a step: files are closed on the way out, as on Ctrl-C."""


@contextlib.contextmanager
def asked_to_stop():
    """Yield an object whose ``asked`` turns into the signal's number with the first one; the second does not wait."""
    stop = SimpleNamespace(asked=0)

    def ask(signum, frame):
        if stop.asked:
            raise KeyboardInterrupt if signum == signal.SIGINT else Terminated
        stop.asked = int(signum)

    with _handled(ask, signal.SIGINT, signal.SIGTERM):
        yield stop


@contextlib.contextmanager
def terminable():
    """Let SIGTERM raise `Terminated`, so that a command ends by it as by Ctrl-C."""

    def end(signum, frame):
        raise Terminated

    with _handled(end, signal.SIGTERM):
        yield


@contextlib.contextmanager
def _handled(handler, *signals):
    """Handle signals in the main thread; elsewhere the caller does."""
    previous = {}
    try:
        with contextlib.suppress(ValueError):
            for number in signals:
                previous[number] = signal.signal(number, handler)
        yield
    finally:
        for number, old in previous.items():
            signal.signal(number, signal.SIG_DFL if old is None else old)  # None: not set from Python
