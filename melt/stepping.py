"""From step to step: frames, checkpoints, warnings, and a clean end."""

import time
from types import SimpleNamespace

from melt.interrupt import asked_to_stop
from melt.output import checkpoint


def append_frame(writer, sim, say):
    sim.check()
    values = sim.series()
    writer.append(sim.time, sim.frame(), values, sim.readings())
    lost = values["lost_particles"]
    if lost and not sim.lost_told:
        sim.lost_told = True
        say("warning", message=f"t = {sim.time:.4g} s: {lost} particles are outside of the domain")
    sim.restart_timers()
    say("frame", time=sim.time, frames=writer.frames)


def save(writer, sim):
    sim.check()
    arrays, meta = sim.checkpoint()
    meta |= {"frames": writer.frames, "backend": sim.backend.name}
    checkpoint.save(checkpoint.beside(writer.path), arrays, meta)


def loop(sim, writer, say, total):
    """Step to step ``total``; Ctrl-C ends after the step that is under way, with a last checkpoint."""
    t, began = sim.scene.time, time.perf_counter()
    say("start", steps=total, step=sim.do.clock.step, particles=sim.do.clock.active, simulation=sim)
    with asked_to_stop() as stop:
        while sim.do.clock.step < total and not stop.asked:
            sim.step()
            step = sim.do.clock.step
            if sim.do.notes.get("inflow_stopped") == step:
                say("warning", message=f"t = {sim.time:.4g} s: all slots are taken, the inflow stopped")
            if sim.do.warning and (kind := sim.do.warning.split()[0]) not in sim.told:
                sim.told.add(kind)
                say("warning", message=f"t = {sim.time:.4g} s: {sim.do.warning}")
            say("step", step=step, time=sim.time, n_sub=sim.do.notes.get("n_sub", 0))
            if writer and (step % t.output_steps == 0 or step == total):
                append_frame(writer, sim, say)
            if writer and ((t.checkpoint_steps and step % t.checkpoint_steps == 0) or step == total):
                save(writer, sim)
        if stop.asked and writer:
            save(writer, sim)
        if writer and sim.prepared.finish:
            sim.prepared.finish(sim, writer, say)
    say("end", interrupted=stop.asked)
    return SimpleNamespace(simulation=sim, interrupted=stop.asked, seconds=time.perf_counter() - began)
