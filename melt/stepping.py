"""From step to step: frames, checkpoints, warnings, and a clean end."""

import time
from types import SimpleNamespace

import numpy as np

from melt.ending import recorded
from melt.finite import not_finite
from melt.interrupt import asked_to_stop
from melt.output import checkpoint
from melt.watch.alarms import check_speed
from melt.watch.watchdog import Watchdog


def in_pieces(sim, dt):
    """Advance by one outer step of ``dt`` seconds: at once, or in 2^halvings equal steps of which it counts as one.

    So frames, checkpoints and all that happens every so many steps keep their times. Counts of the notes are those of
    all pieces, forces the mean over them; gauges are read at the end of the last.
    """
    do, clock = sim.do, sim.do.clock
    step, start, pieces, counted = clock.step, clock.time, 2**clock.halvings, {}
    for k in range(pieces):
        clock.step, read = step, len(clock.readings)
        sim.prepared.page(do, dt / pieces)
        clock.time = start + (k + 1) * dt / pieces
        if not np.isfinite([clock.max_speed, clock.max_acceleration]).all():
            raise not_finite(sim)
        check_speed(sim)
        if k + 1 < pieces:
            del clock.readings[read:]
        for name in ("n_sub", *clock.tally):
            value = do.notes.get(name, 0)
            counted[name] = counted.get(name, 0) + (value / pieces if name.startswith("force/") else value)
    if pieces > 1:
        do.notes.update(counted)


def append_frame(writer, sim, say):
    values = sim.series()
    if sim.do.clock.alarms:
        writer.tell("alarms", "\n".join(sim.do.clock.alarms))
    writer.append(sim.time, sim.frame(), values, sim.readings())
    lost = values["lost_particles"]
    if lost and not sim.lost_told:
        sim.lost_told = True
        say("warning", message=f"t = {sim.time:.4g} s: {lost} particles are outside of the domain")
    sim.restart_timers()
    say("frame", time=sim.time, frames=writer.frames)


def save(writer, sim, state):
    arrays, meta = state
    checkpoint.save(checkpoint.beside(writer.path), arrays, meta | {"frames": writer.frames, "backend": sim.backend.name})


def loop(sim, writer, say, total):
    """Step to step ``total``; Ctrl-C ends after the step that is under way, with a last checkpoint."""
    t, began = sim.scene.time, time.perf_counter()
    say("start", steps=total, step=sim.do.clock.step, particles=sim.do.clock.active, simulation=sim)
    dog = Watchdog(sim, writer, say)
    with asked_to_stop() as stop, recorded(writer, dog, total):
        while sim.do.clock.step < total and not stop.asked:
            if not dog.step():  # it went back
                continue
            step = sim.do.clock.step
            if sim.do.notes.get("inflow_stopped") == step:
                say("warning", message=f"t = {sim.time:.4g} s: all slots are taken, the inflow stopped")
            if sim.do.warning and (kind := sim.do.warning.split()[0]) not in sim.told:
                sim.told.add(kind)
                say("warning", message=f"t = {sim.time:.4g} s: {sim.do.warning}")
            say("step", step=step, time=sim.time, n_sub=sim.do.notes.get("n_sub", 0))
            if writer and (step % t.output_steps == 0 or step == total):
                append_frame(writer, sim, say)
            state = dog.keep(step == total)
            if writer and ((t.checkpoint_steps and step % t.checkpoint_steps == 0) or step == total):
                save(writer, sim, state)
        if stop.asked and writer:
            sim.check()
            save(writer, sim, sim.checkpoint())
        if writer and sim.prepared.finish:
            sim.prepared.finish(sim, writer, say)
    say("end", interrupted=stop.asked)
    return SimpleNamespace(simulation=sim, interrupted=stop.asked, seconds=time.perf_counter() - began)
