"""What a scene may ask of the position based fluid and of solids in it. Boiling spec 2.1, 6."""

from melt.position_based import relaxation, stiffness


def check_pbf(scene):
    """Refuse, in words, what the position based fluid cannot do or what would not be stable.

    Raises:
        ValueError: with the remedy.
    """
    s, f = scene.solver, scene.fluid
    missing = {
        "solids ([[solid]]; in pbf there may be some)": bool(scene.solid) and s.pressure == "sph",
        "heat ([heat]; it is for solids that melt, a liquid that is heated: [boiling])": scene.heat is not None and not scene.solid,
        "inflow ([[inflow]])": bool(scene.inflow),
        "fluid.viscosity = laminar": f.viscosity == "laminar" and f.mu > 0,
        "fluid.drag": f.drag > 0,
        "fluid.surface_tension": f.surface_tension > 0,
        "fluid.xsph (use solver.pbf.xsph)": f.xsph > 0,
        "fluid.expansion (use boiling.boost = boussinesq)": f.expansion != 0,
    }
    if wanted := [name for name, here in missing.items() if here]:
        raise ValueError(f"solver.pressure = {s.pressure} moves liquid between walls, without {', '.join(wanted)}: use wcsph")
    if scene.solid:
        _check_solids(scene)
    if s.support < 1.6:
        raise ValueError(f"solver.support = {s.support:g} is too short for pressure = {s.pressure}: at least 1.6 (lattice sums collapse)")
    if s.pressure == "sph":
        if s.pbf.precision:
            raise ValueError("solver.pbf.precision is of the position based solve: set it to false, or pressure = pbf")
        return
    product = relaxation(scene) * stiffness(s.support).largest
    if product > 2:
        raise ValueError(
            f"solver.pbf: omega/(1 + eps_rel) = {relaxation(scene):.3g} times the lattice's largest eigenvalue "
            f"{stiffness(s.support).largest:.3g} is {product:.3g}, above 2 the solve diverges: "
            f"lower omega, or raise eps_rel to {s.pbf.omega * stiffness(s.support).largest / 1.5 - 1:.2g} or more"
        )


def _check_solids(scene):
    """Refuse what solids in a position based fluid do not go together with."""
    s, heat, boiling = scene.solver, scene.heat, scene.boiling
    refused = {
        "solver.pbf.precision (solids have the full one)": s.pbf.precision,
        "solver.baseline = rigid (it turns forces into motion; here there are none)": s.baseline == "rigid",
        "solver.motion = false": not s.motion,
    }
    if heat is not None:
        refused |= {
            "heat.law = paper (its heat is in K m^3; use physical)": heat.law == "paper",
            "heat.volume = current": heat.volume == "current",
            "heat.refreeze and heat.nuclei (nothing freezes here; use wcsph or dfsph)": heat.refreeze,
        }
    if boiling is not None:
        refused |= {
            "boiling.heat_model and boiling.diffusivity (heat conducts as [heat] says)": boiling.heat_model != "particle"
            or boiling.diffusivity is not None,
            "boiling.mass_model = nucleate or recycle (use cargo)": boiling.mass_model != "cargo",
            "boiling.boost = viscosity": boiling.boost == "viscosity",
        }
    if wanted := [name for name, here in refused.items() if here]:
        raise ValueError(f"solids in a liquid of solver.pressure = pbf go without {', '.join(wanted)}")
    if boiling is not None and heat is None:
        raise ValueError("[boiling] with solids ([[solid]]) has one heat for all of the tank: add [heat] with law = physical")
