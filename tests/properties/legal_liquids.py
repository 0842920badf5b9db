"""Strategies of legal scenes of liquids in a box (melting, boiling, slime), as dictionaries of some 100 particles.

Everything is drawn in spacings and steps, then given in metres and seconds: what is legal does not depend on units.
"""

from hypothesis import strategies as st

SPACINGS = (1e-3, 0.05, 0.1, 1.0, 30.0)
PRECISIONS = st.sampled_from(["single", "mixed", "double"])
GRAVITY = 9.81


def given(**options):
    """Return a dictionary strategy whose keys may all be missing."""
    return st.fixed_dictionaries({}, optional=options)


def numbers(low, high):
    return st.floats(low, high, allow_nan=False, allow_subnormal=False)


@st.composite
def boxes(draw, walls=True, flat=False, periodic=()):
    """Return (section [domain], cells (x, y, z), spacing) of a box of 2 to 4 cells, wherever it stands."""
    d = draw(st.sampled_from(SPACINGS))
    cells = [12 if axis in periodic else draw(st.integers(2, 4)) for axis in "xyz"]
    lower = [d * draw(st.sampled_from([0.0, -2.5, 1000.0])) for _ in range(3)]
    if flat:
        lower[1] = 0.0
    sides = draw(st.sampled_from([["floor", "sides"], "all", "none", "floor", ["x-", "z-"]]) if walls else st.just(["floor", "sides"]))
    return {
        "lower": lower, "upper": [a + n * d for a, n in zip(lower, cells)], "spacing": d,
        "walls": {"sides": sides, "layers": 1},
        **draw(given(leave=st.sampled_from(["keep", "delete"]))),
    }, cells, d


@st.composite
def shapes(draw, low, cells, d):
    """Return a shape inside of the cells from ``low`` (in metres) on, with one lattice point in it at least."""
    kind = draw(st.sampled_from(["box", "box", "centred", "sphere", "cylinder", "mesh"]))
    size = [n * d for n in cells]
    middle = [a + 0.5 * s for a, s in zip(low, size)]
    if kind == "box":
        top = draw(st.integers(1, cells[2]))
        return {"lower": low, "upper": [low[0] + size[0], low[1] + size[1], low[2] + top * d]}
    if kind == "centred":
        return {"position": [*middle[:2], low[2]], "anchor": "base", "size": [size[0], size[1], d]}
    if kind == "mesh" and min(cells) >= 3:
        return {"shape": "mesh", "file": "duck", "position": middle, "particles": 12}
    radius = 0.5 * min(size[:2] if kind == "cylinder" else size)
    # a ball of one cell has its centre on the lattice; all larger ones hold a lattice point anyway
    if radius < 0.87 * d:
        middle, radius = [a + 0.5 * d for a in low], 0.4 * d
    if kind == "cylinder":
        return {"shape": "cylinder", "position": [*middle[:2], low[2]], "anchor": "base", "radius": radius, "height": d}
    return {"shape": "sphere", "position": middle, "radius": radius}


@st.composite
def times(draw, d):
    """Return the section [time]: steps of a share of the time in which a particle falls its spacing, few or many sub-steps."""
    dt = draw(st.sampled_from([1e-3, 0.02, 0.2])) * (2 * d / GRAVITY) ** 0.5
    given_too = draw(given(n_sub=st.integers(1, 3), output_every=st.just(dt)))
    return {"end": 10 * dt, "dt": dt, "n_sub_max": draw(st.sampled_from([4, 40, 1000])), **given_too}


def _fills(draw, low, cells, d, most=2):
    """Return one to ``most`` fills within cells; they may overlap."""
    velocity = st.sampled_from([[0.0, 0.0, 0.0], [(GRAVITY * d) ** 0.5, 0.0, 0.0]])
    found = []
    for _ in range(draw(st.integers(1, most))):
        found.append(draw(shapes(low, cells, d)) | draw(given(velocity=velocity, temperature=numbers(-20, 95))))
    return found


def _nozzle(draw, lower, cells, d):
    """Return an inflow under the lid that points down."""
    place = [a + 0.5 * n * d for a, n in zip(lower, cells)]
    place[2] = lower[2] + (cells[2] - 0.5) * d
    return {"position": place, "direction": [0, 0, -1], "radius": 0.5 * d, "speed": (GRAVITY * d) ** 0.5, "layers": 2}


HEAT = given(
    law=st.sampled_from(["paper", "physical"]),
    solver=st.sampled_from(["auto", "pairs_seq", "pairs_coloured", "onesided", "cg", "explicit"]),
    sweep_dt=st.sampled_from(["half", "full"]),
    latent=st.booleans(),
    refreeze=st.booleans(),
    freeze_layers=st.integers(0, 1),
    substeps=st.sampled_from([1, 2, "auto"]),
    wall_temperature=numbers(-50, 150),
)


@st.composite
def melting(draw):
    """Weakly compressible liquids with or without solids, heat, heaters, obstacles, inflows, viscosity."""
    domain, cells, d = draw(boxes())
    low = domain["lower"]
    heat = draw(st.none() | HEAT)
    scene = {
        "time": draw(times(d)), "domain": domain, "fluid": draw(given(
            temperature=numbers(0.5, 90), viscosity=st.sampled_from(["artificial", "laminar"]), alpha=numbers(0, 0.5),
            xsph=numbers(0, 0.3), drag=numbers(0, 1), surface_tension=numbers(0, 0.1), expansion=st.sampled_from([0.0, 2e-4]),
            clamp=st.booleans(), density=numbers(500, 2000))),
        "solver": draw(given(
            precision=PRECISIONS, neighbours=st.sampled_from(["grid", "kdtree"]), kernel=st.sampled_from(["cubic", "wendland2", "mueller"]),
            integration=st.sampled_from(["symplectic", "kdk"]), rotation=st.sampled_from(["svd", "horn", "iterative"]),
            width=st.integers(0, 2), guard=st.booleans(), contact=st.booleans(), connect=st.sampled_from([6, 18, 26]),
            refill=st.sampled_from(["all", "changed", "affected"]), solid_volume=st.sampled_from(["rest", "akinci", "shell"]))),
    }  # fmt: skip
    half = cells[2] // 2
    scene["fluid"]["fill"] = _fills(draw, low, [cells[0], cells[1], half], d)
    if draw(st.booleans()):
        top = [low[0], low[1], low[2] + half * d]
        scene["solid"] = [draw(shapes(top, [*cells[:2], cells[2] - half], d)) | draw(given(
            density=numbers(300, 3000), melting_point=st.sampled_from([-5.0, 0.0, "never"]), temperature=numbers(-30, 60)))]
    elif draw(st.booleans()):
        scene["inflow"] = [_nozzle(draw, low, cells, d)]
    if draw(st.booleans()):
        scene["obstacle"] = [{"lower": low, "upper": [a + d for a in low]}]
    if heat is not None:
        if draw(st.booleans()):
            heat["heater"] = [{"position": low, "size": [d, d, d], **draw(
                st.fixed_dictionaries({"rate": numbers(-5, 5)}) | st.fixed_dictionaries({"temperature": numbers(0, 100)}))}]
        if draw(st.booleans()):
            heat |= {"ambient_temperature": draw(numbers(-20, 40)), "ambient_transfer": draw(numbers(0, 10))}
        scene["heat"] = heat
    return _of_preset(draw, scene, ["default", "paper", "physical"] if heat else ["default"])


def _of_preset(draw, scene, names):
    name = draw(st.sampled_from(names))
    return scene if name == "default" else {**scene, "preset": name}


@st.composite
def boiling(draw):
    """Position based liquids and Mueller's SPH, that boil or not."""
    domain, cells, d = draw(boxes(walls=False))
    domain["leave"] = "keep"
    pressure = draw(st.sampled_from(["pbf", "pbf", "sph"]))
    boost = ["off", "rate", "literal", "boussinesq"] + ["viscosity"] * (pressure == "pbf")
    scene = {
        "time": draw(times(d)), "domain": domain,
        "fluid": {"temperature": draw(numbers(20, 100)), "fill": _fills(draw, domain["lower"], [*cells[:2], 1], d, 1)},
        "solver": {"pressure": pressure, **draw(given(precision=PRECISIONS, kernel=st.sampled_from(["cubic", "wendland2"])))},
    }
    for fill in scene["fluid"]["fill"]:
        fill.pop("temperature", None)
    if pressure == "pbf":
        scene["solver"]["pbf"] = draw(given(iterations=st.integers(1, 4), one_sided=st.booleans(), vorticity=numbers(0, 0.1),
                                            precision=st.booleans(), push=numbers(0, 0.1)))
    if draw(st.booleans()):
        model = draw(st.sampled_from(["particle", "particle10", "grid"]))
        scene["boiling"] = draw(given(
            seed=st.integers(-1, 2**64 - 1), diffusivity=numbers(0, 1e-3).map(lambda a: a * d), latent_scale=numbers(0, 1),
            nucleation_time=numbers(0, 0.1), boost=st.sampled_from(boost), vapour=given(life=numbers(0.5, 3), precision=st.booleans()),
            mass_model=st.sampled_from(["cargo"] if model == "grid" else ["cargo", "nucleate", "recycle"]),
            surface_transfer=st.just(0.0) if model == "grid" else numbers(0, 1),
            heater=given(mode=st.sampled_from(["robin", "dirichlet"]), temperature=numbers(100, 200)),
            bubbles=given(radius_law=st.sampled_from(["default", "paper"]), merge_position=st.sampled_from(["centre", "mean"])),
        )) | {"heat_model": model}  # fmt: skip
        return _of_preset(draw, scene, ["default", "paper", "physical"] if model != "grid" else ["default"])
    return scene


@st.composite
def slime(draw):
    """Incompressible liquids in two and three dimensions, with ghosts, APIC, viscosity, periodic sides or heat."""
    flat = draw(st.booleans())
    pressure = draw(st.sampled_from(["dfsph", "isph", "hybrid"]))
    periodic = draw(st.sampled_from([[], [], ["x"]])) if flat else []
    domain, cells, d = draw(boxes(flat=flat, periodic=periodic))
    domain |= {"periodic": periodic, "dimensions": 2 if flat else 3}
    low = domain["lower"]
    fills = _fills(draw, low, [*cells[:2], cells[2] // 2], d)
    if flat:  # only boxes are sure to meet the plane
        fills = [{"lower": low, "upper": [low[0] + cells[0] * d, low[1] + d, low[2] + d]}]
    scene = {
        "time": draw(times(d)), "domain": domain, "fluid": {"fill": fills, **draw(given(
            jitter=numbers(0, 0.1), seed=st.integers(0, 2**64 - 1), density=numbers(500, 2000),
            flow=given(kind=st.sampled_from(["rotation", "stretch", "taylor_green"]), length=st.just(4 * d))))},
        "solver": {"pressure": pressure, "dfsph": draw(given(
            accelerate=st.booleans(), warm_start=numbers(0, 1), clamp=st.booleans(), semi_lagrangian=st.booleans(),
            order=st.sampled_from(["late", "bk"]), on_fail=st.sampled_from(["retry", "raise", "warn"]))),
            **draw(given(precision=PRECISIONS, kernel=st.sampled_from(["cubic", "wendland2"]),
                         ghosts=st.just(True) | given(jitter=numbers(0, 0.25))))},
    }  # fmt: skip
    extra = draw(st.sampled_from(["", "apic", "heat", "inflow", "obstacle"]))
    if extra == "apic":
        scene["solver"]["apic"] = draw(given(per_axis=st.integers(1, 2), flip=numbers(0, 0.9), affine=st.booleans()))
    if extra == "heat" and not flat:
        scene["heat"] = {**draw(HEAT), "refreeze": False}
    if extra == "inflow":
        scene["inflow"] = [_nozzle(draw, low, cells, d)]
        scene["inflow"][0]["position"][1] = 0.0 if flat else scene["inflow"][0]["position"][1]
    if extra == "obstacle":
        top = low[2] + cells[2] * d
        body = {"lower": [low[0], low[1], top - d], "upper": [low[0] + d, low[1] + d, top]}
        scene["obstacle"] = [{**body, "velocity": [0.0, 0.0, -0.1 * d]}]
    if draw(st.booleans()):
        scene["viscosity"] = draw(given(mu=numbers(0, 100), index=numbers(0.5, 1.5), stokes=st.sampled_from(["auto", "al", "split"]),
                                        wall=numbers(0, 2)))
    return _of_preset(draw, scene, ["default", "paper", "physical"])
