"""How a run ends, recorded in its file: complete, stopped by an alarm or an error, or interrupted. `melt info` tells it."""

import contextlib

from melt.errors import MeltError, Unstable


@contextlib.contextmanager
def recorded(writer, dog, total):
    """Record how the steps within end, of which ``total`` are complete; what fails here never hides an error.

    Args:
        writer: of the run file, or None. dog: the `melt.watch.watchdog.Watchdog` that steps.
    """
    try:
        yield
    except BaseException as error:
        if writer:
            with contextlib.suppress(MeltError):
                writer.end(**_broken_off(error, dog))
        raise
    if writer:
        clock, scene = dog.sim.do.clock, dog.sim.scene.time
        early = {"why": f"as far as asked for, of {scene.end:g} s in all"} if total < scene.steps else {}
        done = clock.step >= total
        writer.end("complete" if done else "interrupted", step=clock.step, time=clock.time, **(early if done else {}))


def _broken_off(error, dog):
    """Return what the file shall tell of a run that an exception ended; an alarm names the step in which it came."""
    clock = dog.sim.do.clock
    if isinstance(error, Unstable):
        return {"how": "alarm", "step": dog.begun[0] + 1, "time": dog.begun[1], "why": error.what, "capsule": dog.written}
    facts = {"how": "error", "step": clock.step, "time": clock.time}
    if isinstance(error, KeyboardInterrupt):
        return facts | {"how": "interrupted"}
    return facts | {"why": str(error) if isinstance(error, MeltError) else f"{type(error).__name__}: {error}"}


def described(end, resumable):
    """Return in words what the file of a run tells of its end; ``resumable``: it has a checkpoint."""
    how, why = end.get("how"), end.get("why", "")
    if how is None:
        return "not recorded: the file is of an earlier version"
    when = f"step {end['step']}, t = {end['time']:.5g} s" if "step" in end else ""
    if how == "complete":
        return f"complete, {when}{f', {why}' if why else ''}"
    goes_on = "; melt resume goes on from its checkpoint" if resumable else ""
    if how == "running":
        return f"unfinished: it still runs, or was killed{goes_on}"
    if how == "interrupted":
        return f"interrupted, {when}{goes_on}"
    why = why if why.startswith("step ") else f"{when}: {why}"  # most alarms tell it themselves
    capsule = f" Capsule: {end['capsule']}." if end.get("capsule") else ""
    return f"stopped by an {how}, {why}{capsule}"
