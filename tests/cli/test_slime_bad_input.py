"""Incompressible liquids from the command line: what does not go together is refused in words; plan and schema know them."""

import json
import os
import pathlib

import pytest
from small_runs import melt, refused

SCENE = """
[scene]
name = "syrup"
[time]
end = 0.02
dt = 0.01
output_every = 0.01
[domain]
lower = [-0.6, 0, 0]
upper = [0.6, 0, 1.0]
spacing = 0.1
dimensions = 2
[[fluid.fill]]
lower = [-0.3, -1, 0]
upper = [0.3, 1, 0.5]
[solver]
pressure = "hybrid"
[solver.ghosts]
"""
FILL = "[[fluid.fill]]\nlower = [-0.3, -1, 0]\nupper = [0.3, 1, 0.5]\n"
SPACE = SCENE.replace("dimensions = 2\n", "").replace("[-0.6, 0, 0]", "[-0.6, -0.3, 0]").replace("[0.6, 0, 1.0]", "[0.6, 0.3, 1.0]")
APIC, VISCOUS, HEAT = "[solver.apic]\n", "[viscosity]\nmu = 50\n", '[heat]\nlaw = "physical"\n'
SOLID = "[[solid]]\nposition = [0, 0, 0.7]\nsize = [0.2, 0.2, 0.2]\n"
NODES = SPACE.replace('"hybrid"\n[solver.ghosts]', '"dfsph"')
WEAK = SPACE.replace('pressure = "hybrid"\n[solver.ghosts]', "")
BODY = "[[obstacle]]\nlower = [-0.1, -0.2, 0.6]\nupper = [0.1, 0.2, 0.8]\n"
BALL = "[[fluid.fill]]\nshape = 'sphere'\nposition = [0, 0.5, 0.3]\nradius = 0.2\n"
NOZZLE = "[[inflow]]\nposition = [0, 0, 0.9]\ndirection = [0, 0, -1]\nradius = 0.15\nspeed = 1\nlayers = 3\n"

BAD = {
    "viscosity of a weakly compressible liquid": (WEAK + VISCOUS, ["only with solver.pressure = dfsph", "fluid.viscosity", "wcsph"]),
    "elastic of a weakly compressible liquid": (WEAK + "[elastic]\n", ["[elastic]", "only with solver.pressure"]),
    "two dimensions of one": (SCENE.replace('pressure = "hybrid"\n[solver.ghosts]', ""), ["domain.dimensions = 2", "only with"]),
    "periodic sides of one": (WEAK.replace("spacing", 'periodic = ["x"]\nspacing'), ["domain.periodic", "only with"]),
    "a flow of one": (WEAK + "[fluid.flow]\nrate = 1\n", ["[fluid.flow]", "only with"]),
    "a moving body of one": (WEAK + BODY + "velocity=[1,0,0]\n", ["obstacle.velocity", "only with"]),
    "a held nozzle of one": (WEAK + NOZZLE + "hold = 2\n", ["inflow.hold", "only with"]),
    "ghosts of one": (WEAK + "[solver.ghosts]\n", ["need pressure = dfsph, isph or hybrid, not wcsph"]),
    "apic of one": (WEAK + APIC, ["[solver.apic]", "not wcsph"]),
    "apic and heat": (SPACE + APIC + HEAT, ["[heat] needs particles of constant mass", "leave [solver.apic] out"]),
    "heat in two dimensions": (SCENE + HEAT, ["[heat] is for three dimensions", "dimensions = 3"]),
    "elastic without apic": (SCENE + VISCOUS + "[elastic]\n", ["[elastic] lives on APIC particles", "add [solver.apic]"]),
    "a law without temperatures": (SCENE + VISCOUS + 'law = "arrhenius"\n', ["viscosity.law needs temperatures", "add [heat]"]),
    "kinematic viscosity": (SCENE + "[viscosity]\nmu = '1e-3 m^2/s'\n", ["viscosity.mu", "Pa s"]),
    "viscosity below zero": (SCENE + "[viscosity]\nmu = -1\n", ["viscosity.mu"]),
    "caps the wrong way round": (SCENE + VISCOUS + "smallest = 10\nlargest = 1\n", ["smallest = 10 Pa s exceeds largest = 1 Pa s"]),
    "a periodic axis too short": (SCENE.replace("dimensions", "periodic = ['x']\ndimensions").replace("0.6", "0.2"), ["two support radii"]),
    "a fraction of a spacing": (SCENE.replace("dimensions", "periodic = ['x']\ndimensions").replace("0.6", "0.63"), ["whole number"]),
    "y in two dimensions": (SCENE.replace("dimensions", "periodic = ['y']\ndimensions"), ["in two dimensions there is no y"]),
    "apic between unequal periods": (SCENE.replace("dimensions", "periodic = ['x', 'z']\ndimensions") + APIC, ["equally long"]),
    "a tree for neighbours": (SCENE.replace("[solver]", "[solver]\nneighbours = 'kdtree'"), ["works without solver.neighbours = kdtree"]),
    "xsph": (SCENE.replace(FILL, "[fluid]\nxsph = 0.1\n"), ["fluid.xsph (use [viscosity])"]),
    "another kernel": (SCENE.replace("[solver]", "[solver]\nkernel = 'mueller'"), ["use cubic or wendland2"]),
    "another leap-frog": (SCENE.replace("[solver]", "[solver]\nintegration = 'kdk'"), ["integration = kdk"]),
    "solids and viscosity": (NODES + VISCOUS + SOLID, ["scenes with solids have no [viscosity]", "laminar"]),
    "solids and ghosts": (SPACE + SOLID, ["[solver.ghosts]", "use dfsph"]),
    "nothing moves": (SCENE.replace("[solver]", "[solver]\nmotion = false"), ["solver.motion = false", "leave solver.pressure out"]),
    "a fill beside the plane": (SCENE + BALL, ["fluid.fill 1", "does not meet y = 0"]),
    "times out of order": (SCENE + BODY + "motion=[[1,0,0,0],[0,1,0,0]]\n", ["times must ascend"]),
    "enclosed with a surface": (SCENE.replace(FILL, "[fluid]\nenclosed = true\n" + FILL), ["no free surface", "leave [solver.ghosts]"]),
    "a shift out of the surface": (SCENE + "[solver.dfsph]\nshift = 0.1\n", ["solver.dfsph.shift", "fluid.enclosed = true"]),
    "the force on a body of one": (WEAK + BODY + "force = true\n", ["motion or force", "only with"]),
    "an unknown key": (SCENE + "[viscosity]\nmuh = 3\n", ["viscosity.muh is not a known key"]),
    "an unknown solver": (SCENE.replace("hybrid", "hybird"), ["solver.pressure", "hybrid"]),
    "too long a step": (SCENE.replace("dt = 0.01", "dt = 10").replace("0.02", "20"), ["time step", "n_sub_max", "semi_lagrangian"]),
}


@pytest.fixture(autouse=True)
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.mark.parametrize("case", BAD)
def test_what_does_not_go_together_is_refused_and_leaves_no_file(case):
    text, said = BAD[case]
    pathlib.Path("syrup.toml").write_text(text)
    refused(melt("run", "syrup.toml", "-b", "cpu"), *said)
    assert os.listdir() == ["syrup.toml"]


def test_plan_show_scenes_and_schema_know_incompressible_liquids():
    pathlib.Path("syrup.toml").write_text(SCENE + APIC + VISCOUS + "[elastic]\n")
    told = melt("plan", "syrup.toml")
    assert told.exit_code == 0, told.output
    for words in ("requires: incompressible, dfsph, poisson, apic, ghosts, viscosity", "elastic", "ghost_candidates", "apic_to_nodes",
                  "viscous_apply", "time step bound elastic", "viscosity: mu dt/(rho h^2) =", "APIC transfers", "they add a viscosity of"):
        assert words in told.stdout, words
    assert "sound speed" not in told.stdout
    shown = melt("show", "syrup.toml")
    assert "semi_lagrangian = false" in shown.stdout and "per_axis = 2" in shown.stdout
    pathlib.Path("again.toml").write_text(shown.stdout)
    assert melt("show", "again.toml").stdout == shown.stdout
    listed = melt("scenes").stdout
    assert all(name in listed for name in ("honey_coil", "slime_drop", "rotating_square", "warm_honey"))
    schema = json.loads(melt("schema").stdout)
    assert {"Viscosity", "Elastic", "Apic", "Ghosts", "Incompressible", "Flow"} <= set(schema["$defs"])


def test_a_poisson_equation_without_ghosts_is_a_warning():
    pathlib.Path("syrup.toml").write_text(SCENE.replace("[solver.ghosts]\n", ""))
    told = melt("plan", "syrup.toml").stdout
    assert "warning: solver.pressure = hybrid without [solver.ghosts]" in told and "Fix: add [solver.ghosts]" in told


def test_a_nozzle_that_does_not_hold_viscous_liquid_is_a_note():
    pathlib.Path("syrup.toml").write_text(SCENE + VISCOUS + NOZZLE)
    assert "note: inflow 'inflow 0' lets go of liquid at once" in melt("plan", "syrup.toml").stdout
