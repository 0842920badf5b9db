"""What a scene launches and holds, beside the same scene with everything switched on: ``docs/scenes.md``.

Counts and bytes follow from the plan alone, so that the page changes if, and only if, a scene begins to pay for
something else; milliseconds are in the experiment `scene_costs`.
"""

import pathlib
from typing import NamedTuple

from melt.errors import MeltError
from melt.geometry.build import build
from melt.plan import prepare
from melt.scene import load_scene
from melt.scene.load import shipped_scenes

#: What can be switched on, one override after the other; what a scene cannot have is left out (it is refused in words).
MELTING = [
    "heat.law=physical", "heat.latent=true", "heat.ambient_temperature=20", "heat.ambient_transfer=10", "heat.refreeze=true",
    "heat.nuclei=1", "fluid.expansion=2e-4", "fluid.drag=0.1", "fluid.xsph=0.1", "fluid.surface_tension=1", "fluid.viscosity=laminar",
    "domain.leave=delete",
]
BOILING = [
    "boiling.vapour.per_burst=4", "boiling.boost=boussinesq", "boiling.surface_transfer=1", "boiling.mass_model=recycle",
    "solver.pbf.precision=true", "solver.pbf.vorticity=0.1", "domain.leave=delete",
]
FLOOD = [
    "solver.form=balanced", "control.mode=descent", "friction.manning=0.03", "fluid.release_height=1",
    "rain.rate=1e-5", "infiltration.rate=1e-6", "boundary.west=open", "output.maps=true",
]
SLIME = [
    "solver.pressure=hybrid", "solver.ghosts=true", "solver.apic=true", "viscosity.mu=10", "viscosity.stokes=al", "viscosity.index=0.5",
    "elastic.modulus=300", "fluid.sigma=0.07", "solver.dfsph.semi_lagrangian=true", "fluid.jitter=0.05", "domain.leave=delete",
]


class Cost(NamedTuple):
    """What a scene needs whatever the machine."""

    particles: int  # walls and free slots too
    stages: int  # launched in its first outer step
    fields: int  # allocated
    nbytes: int  # of all fields
    required: str

    @property
    def bytes_per_particle(self):
        """Memory of all fields over all particles [bytes]."""
        return self.nbytes / max(self.particles, 1)


def cost_of(scene):
    """Return the `Cost` of a scene."""
    initial = build(scene)
    prepared = prepare(scene, initial)
    return Cost(initial["id"].size, len(prepared.stages), len(prepared.fields), prepared.nbytes, prepared.required)


def switches_of(scene):
    """Return the overrides that may switch on what a scene lacks, in words of its system."""
    if scene.system == "melting":
        return [_ice(scene), *MELTING] if not scene.solid and scene.solver.motion else MELTING
    if scene.system == "slime" and scene.solid:  # ice in an incompressible liquid may have what melts, and little of what flows
        return MELTING
    return {"flood": FLOOD, "boiling": BOILING, "slime": SLIME}[scene.system]


def _ice(scene):
    """Return the override that puts a cube of 3^3 particles into the middle of the domain."""
    low, high, d = scene.domain.lower, scene.domain.upper, scene.spacing
    middle = [0.5 * (a + b) for a, b in zip(low, high)]
    return f"solid=[{{name='ice', position={middle}, size={[3 * d] * 3}}}]"


def everything_of(name):
    """Return the overrides with which a scene has all that its system offers and that it may have."""
    taken = []
    for override in switches_of(load_scene(name)):
        try:
            scene = load_scene(name, [*taken, override])
            if scene.kind != "flood":  # the starts of floods take seconds, and what may be is seen without
                prepare(scene, build(scene))
        except MeltError:
            continue
        taken.append(override)
    return taken


def has_data(scene):
    """Return whether the measured terrain of a scene is here (MELT_DATA)."""
    file = scene.terrain.file if scene.kind == "flood" else None
    return file is None or pathlib.Path(file).is_file()


def rows_of(text):
    """Return {scene: its line} of a docs/scenes.md."""
    lines = [line for line in text.splitlines() if line.startswith("| ")]
    return {line.split(" | ")[0].removeprefix("| "): line for line in lines[1:]}


def page(older=""):
    """Return the text of docs/scenes.md; scenes whose measured terrain is not here keep the rows that ``older`` has of them."""
    kept = rows_of(older)
    lines = [
        "# What scenes cost",
        "",
        "Generated from the plans by `python -m melt.docs`; a test holds it to them, so that no scene begins to pay for what it does",
        "not name. Bytes are those of all fields over all particles (walls and free slots too). On the right the same scene with",
        "everything switched on that its system offers and that it may have (`melt/costs.py`); milliseconds are in",
        "[results.md](results.md), experiment `scene_costs`.",
        "",
        "| scene | requires | particles | stages | fields | bytes per particle | everything on: stages | fields | bytes per particle |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    rows = [row(name) if has_data(load_scene(name)) else kept.get(name) for name in shipped_scenes()]
    return "\n".join([*lines, *filter(None, rows)]) + "\n"


def row(name):
    """Return the line of a scene in docs/scenes.md."""
    own, full = cost_of(load_scene(name)), cost_of(load_scene(name, everything_of(name)))
    figures = (f"{c.stages} | {c.fields} | {c.bytes_per_particle:,.0f}" for c in (own, full))
    return f"| {name} | {own.required} | {own.particles:,} | {' | '.join(figures)} |"
