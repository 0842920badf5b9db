"""Scene -> what runs: stages in order, fields, memory, sub-steps. Recorded from the step page.

`prepare` gives all that a run needs beside the initial arrays; `melt.preflight` adds the forecast and
the findings that ``melt plan`` prints.
"""

import math
from dataclasses import dataclass, field
from types import SimpleNamespace

import numpy as np

from melt import boiling as boil
from melt import diagnostics
from melt.bind import Recorder
from melt.constants import list_capacity, params_of, sound_speed_of, tight_capacity
from melt.fields import CARRIED, FIELDS
from melt.fields_slime import APIC_CARRIED
from melt.flood import ledger as flood_ledger
from melt.flood import maps as flood_maps
from melt.flood import plan as flood_plan
from melt.physics.phases import LIQUID, SOLID
from melt.position_based import POINTS, adaptive, pbf_fields, pbf_of, short_lists, vessel_of
from melt.scales import fourier_number
from melt.slime import plan as slime_plan
from melt.state import REAL, bytes_of
from melt.systems import boiling, flood, melting, slime
from melt.systems.heat import thermal_substeps

#: Fields every run holds, whatever its stages use: they are written to the run file.
ALWAYS = ("id", "phase", "material", "position", "velocity", "mass", "rest_volume")
#: Arguments of stages that serve scenes with and without: left out (length 0) unless the scene needs them.
ONLY_IF = {
    "effect_precision": ("effect_precision", "support_radius", "iterations", "kernel_scale"),
    "latent": ("latent_energy", "latent_capacity", "latent_point", "heat_capacity_molten"),
    "temperature": ("temperature", "inflow_temperature"),
    "solids": ("site",),
}


@dataclass
class Prepared:
    """All that a run needs beside its initial arrays."""

    page: callable  # step(do, dt)
    system: object  # the module of the step page: start, step, step_limits
    need: SimpleNamespace  # what the scene requires
    settings: SimpleNamespace  # run-time choices of the step page
    params: dict  # parameter tuples by registry name
    sizes: dict  # extents
    precision: str
    stages: list  # names in order of first call
    renamed: dict  # stage: other fields that it works on
    fields: list  # names, allocated
    warnings: list = field(default_factory=list)
    steadier: str = "fluid.alpha"  # what to raise in a run that is not stable
    begin: object = None  # begin(simulation, writer): what is written before the first frame
    finish: object = None  # finish(simulation, writer, say): what is written when the run ends
    ledger: object = diagnostics  # the module that has `SERIES` and `series`

    @property
    def required(self):
        """What the scene requires, in words."""
        return ", ".join(name for name, needed in vars(self.need).items() if needed) or "liquid only"

    def bytes(self, name):
        """Return the memory of one field [bytes]."""
        return bytes_of(FIELDS[name], self.sizes, self.precision)

    @property
    def nbytes(self):
        """Memory of all fields [bytes]."""
        return sum(self.bytes(name) for name in self.fields)


def needs(scene, initial):
    """Return what the scene requires, as booleans that the step page asks for."""
    heat, fluid, solver = scene.heat, scene.fluid, scene.solver
    pbf, wcsph = scene.solver.pressure == "pbf", scene.solver.pressure == "wcsph"
    b = scene.boiling
    solids = initial.counts["solid"] > 0 or bool(scene.heat and heat.refreeze and scene.solid)
    melts = np.isfinite(initial["material_melting_point"]).any()
    matter = initial.counts["wall"] > 0 or solids
    return SimpleNamespace(
        incompressible=scene.incompressible,
        **slime_plan.needs_of(scene),
        pbf=pbf,
        sph=scene.solver.pressure == "sph",
        boiling=b is not None,
        heater=b is not None and boil.heater_box(scene) is not None,
        surface_loss=b is not None and b.surface_transfer > 0 and b.heat_model != "grid",
        boost=b is not None and b.boost in ("rate", "literal", "boussinesq"),
        warm_viscosity=b is not None and b.boost == "viscosity",
        vapour=b is not None and b.vapour is not None,
        condensate=b is not None and b.mass_model == "recycle",
        effect_precision=adaptive(scene),
        short_lists=short_lists(scene),
        vorticity=pbf and solver.pbf.vorticity > 0,
        blend=pbf and solver.pbf.xsph > 0,
        solids=solids,
        heat=heat is not None,
        temperature=heat is not None or b is not None,
        latent=heat is not None and heat.latent,
        heaters=heat is not None and bool(heat.heater),
        ambient=heat is not None and heat.ambient_transfer > 0,
        thermostats=heat is not None
        and (heat.wall_temperature is not None or any(h.temperature is not None for h in heat.heater)),
        melting=heat is not None and solids and bool(melts),
        freezing=heat is not None and heat.refreeze and solids and bool(melts),
        nucleation=heat is not None and heat.nuclei > 0 and solids and bool(melts),
        inflow=bool(scene.inflow),
        laminar=fluid.viscosity == "laminar" and fluid.mu > 0,
        buoyancy=heat is not None and fluid.expansion != 0,
        drag=fluid.drag > 0,
        surface_tension=fluid.surface_tension > 0,
        xsph=fluid.xsph > 0,
        guard=solver.guard and matter and wcsph,
        contact=solver.contact and solids and not pbf,
        domain=scene.domain.leave == "delete",
    )


def settings_of(scene, initial, sound_speed, precision):
    """Return the run-time choices of the step page."""
    s, f, t, heat = scene.solver, scene.fluid, scene.time, scene.heat
    mu = f.mu if f.viscosity == "laminar" else 0.0
    solid = initial["phase"] == SOLID
    density = initial["mass"][solid] / initial["rest_volume"][solid] if solid.any() else np.array([f.density])
    chosen = SimpleNamespace(
        neighbours=s.neighbours,
        solid_volume=s.solid_volume if s.pressure != "pbf" else "own",  # there solids have the volume of their place
        rigid=s.baseline == "rigid",
        lattice_damping=s.damping,
        leap_frog=s.integration,
        melt_every=s.melt_every,
        crumb=s.crumb,
        nozzles=initial.nozzles,
        capacity=initial["id"].size,
        n_sub=None if t.n_sub == "auto" else t.n_sub,
        n_sub_max=t.n_sub_max,
        support=scene.support,
        sound_speed=sound_speed,
        alpha=f.alpha,
        kinematic_viscosity=mu / f.density,
        gravity=math.hypot(*scene.domain.gravity),
        lightest_solid=float(density.min()) / f.density,
    )
    if heat is not None:
        chosen.dt, chosen.fourier_number = t.dt, fourier_number(scene, initial)
        chosen.heat_solver, chosen.heat_substeps = heat.solver, heat.substeps
        thermal_substeps(chosen)  # refuses too many
        chosen.heat_tolerance = heat.tolerance or (1e-8 if precision == "double" else 1e-5)
        chosen.heat_iterations = heat.max_iterations
    if scene.incompressible:
        vars(chosen).update(slime_plan.settings_of(scene, initial))
    return chosen


def sizes_of(scene, initial, params, precision):
    """Return the size of every extent."""
    n = initial["id"].size
    grid = params["grid"]
    cells = int(grid.nx) * int(grid.ny) * int(grid.nz) + 2
    support = scene.solver.support
    capacity = tight_capacity(support, scene.domain.dimensions) if scene.incompressible else list_capacity(support)
    return {
        "particle": n,
        "neighbour": scene.solver.max_neighbours or capacity,
        "cell": cells,
        "node": n,
        "chunk": math.ceil(max(n, cells, initial["apic_id"].size if "apic_id" in initial else 0) / 256) + 1,
        "site": initial["site_body"].size,
        "link": 27,
        "region": (2 * scene.solver.width + 1) ** 3,
        "material": initial["material_density"].size,
        "heater": initial["heater_mode"].size if "heater_mode" in initial else 0,
        "inlet": initial["inflow_mass"].size if "inflow_mass" in initial else 0,
        "nucleus": initial["nucleus_sites"].shape[1],
        "column": int(grid.nx) * int(grid.ny),
        "voxel": math.prod(boil.liquid_of(scene, initial).cells),
        "table": POINTS,
        "bin": 8 * scene.domain.cells[2],
        "reduction": 64,
    }


def prepare(scene, initial, precision=None):
    """Return the `Prepared` run of a scene, its plan recorded from the step page."""
    precision = precision or scene.solver.precision
    if scene.kind == "flood":
        return _flood(scene, initial, precision)
    position = initial["position"]
    liquid = initial["phase"] == LIQUID
    gravity = np.array(scene.domain.gravity)
    down = gravity / max(np.linalg.norm(gravity), 1e-300)
    depth = float(np.ptp(down @ position[:, liquid])) + scene.spacing if liquid.any() else 0.0
    fall = max((nozzle.position[2] - scene.domain.lower[2] for nozzle in scene.inflow), default=0.0)
    sound_speed, warning = sound_speed_of(scene, depth, fall)
    params = params_of(scene, initial["id"].size, sound_speed, REAL[precision])
    need = needs(scene, initial)
    settings = settings_of(scene, initial, sound_speed, precision)
    system = melting
    only_if = dict(ONLY_IF)
    if scene.incompressible:
        warning = ""
        params.update(slime_plan.params_of(scene, initial["id"].size, REAL[precision]))
        only_if.update(slime_plan.ONLY_IF)
        if not scene.solid:
            system = slime
    elif scene.system == "boiling":
        system, warning = boiling, ""
        _boiling(scene, initial, need, settings, params, REAL[precision])
    page = system.step if scene.solver.motion else melting.still_step
    absent = {f for what, fields in only_if.items() if not getattr(need, what) for f in fields}
    sizes = sizes_of(scene, initial, params, precision)
    if scene.incompressible:
        sizes.update(slime_plan.sizes_of(scene, initial, params))
    prepared = Prepared(page, system, need, settings, params, sizes, precision, [], {}, [], [warning] if warning else [])
    if need.incompressible:
        prepared.steadier = "solver.dfsph.max_iterations"
    if need.pbf or need.sph:
        prepared.steadier = "solver.pbf.iterations" if need.pbf else "solver.sph.viscosity"
    return _recorded(prepared, initial, scene.time.dt, set(ALWAYS), absent)


def _flood(scene, initial, precision):
    """Return the `Prepared` run of a flood."""
    need, settings = flood_plan.needs(scene, initial), flood_plan.settings_of(scene, initial, REAL[precision])
    params = flood_plan.params_of(scene, initial, REAL[precision])
    sizes = flood_plan.sizes_of(scene, initial, params)
    prepared = Prepared(flood.step, flood, need, settings, params, sizes, precision, [], {}, [])
    prepared.steadier, prepared.ledger = "solver.alpha", flood_ledger
    prepared.begin, prepared.finish = flood_maps.begin, flood_maps.finish
    always = set(ALWAYS) - {"material"}
    return _recorded(prepared, initial, scene.time.dt, always, flood_plan.absent_of(need, initial))


def _recorded(prepared, initial, dt, always, absent):
    """Complete a `Prepared` run by what its page does."""
    do = Recorder(prepared.params, prepared.need, _brief(prepared.settings))
    do.clock.layers = dict.fromkeys((nozzle.name for nozzle in initial.nozzles), 0)
    prepared.system.start(do)
    prepared.page(do, dt)
    names = (always | set(do.fields)) - absent
    prepared.stages, prepared.renamed = do.stages, do.renamed
    prepared.fields = [n for n in FIELDS if n in names]
    return prepared


def _brief(settings):
    """Return the settings of a step of two sub-steps and a start of one: they show all stages that any number does."""
    few = {name: min(most, value) for name, most in (("n_sub", 2), ("settle", 1e-9)) if (value := getattr(settings, name, None))}
    return SimpleNamespace(**{**vars(settings), **few})


def _boiling(scene, initial, need, settings, params, real):
    """Add the choices and parameters of the position based fluid, of plain SPH and of boiling."""
    liquid = boil.liquid_of(scene, initial)
    settings.__dict__.update(boiling.settings_of(scene, liquid, initial.top_speed, *boil.slots_of(scene, liquid.particles)))
    params.update(pbf=pbf_of(scene, real), vessel=vessel_of(scene, real))
    if need.sph:
        params["sph"] = boil.sph_of(scene, liquid.depth, real)
    if need.boiling:
        params.update(boiling=boil.boiling_of(scene, real, scene.time.dt), bubbles=boil.bubbles_of(scene, liquid, real))
        params["tank"] = boil.tank_of(scene, liquid, real)
    if need.condensate:
        params["condensate"] = boil.condensate_of(scene, real)
    if need.vapour:
        params["vapour"] = boil.vapour_of(scene, real)


def derived_fields(scene, initial, prepared):
    """Return initial arrays that follow from the method, not from the geometry."""
    found = {}
    if scene.kind == "flood":
        return found
    if prepared.need.effect_precision:
        found.update(pbf_fields(scene, initial["phase"]))
    if prepared.need.boiling:
        found.update(boil.boiling_fields(scene, boil.liquid_of(scene, initial)))
    return found


def carried(prepared):
    """Return the fields that a checkpoint must hold: those that later steps read before they write."""
    # derived anew, or as the scene says
    derived = {"neighbour", "cell", "chunk", "node", "reduction", "boundary", "terrain_node", "entry", "zone"}
    return [
        n
        for n in prepared.fields
        if n in CARRIED
        or n in APIC_CARRIED
        or (not derived & set(FIELDS[n].shape) and not {"particle", "apic", "ghost", "ghost_point"} & set(FIELDS[n].shape))
    ]
