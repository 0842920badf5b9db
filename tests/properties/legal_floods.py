"""Strategy of legal floods of some 20 columns, as dictionaries. The bed is 2 by 1 in units of 8 spacings."""

from hypothesis import strategies as st
from legal_liquids import PRECISIONS, given, numbers

from melt.geometry.terrain_shapes import SHAPES

SIDES = ("west", "east", "south", "north")


@st.composite
def floods(draw):
    """Water on an analytic bed with or without friction, control, rain, inflow, edges, obstacles, gauges."""
    r = draw(st.sampled_from([0.02, 0.4, 25.0]))
    low = [r * draw(st.sampled_from([0.0, -3.0, 20000.0])) for _ in "xy"]
    size = [8 * r, 4 * r]
    depth = r * draw(numbers(0.5, 2))
    at = [low[0] + 0.5 * size[0], low[1] + 0.5 * size[1]]
    shape = draw(st.sampled_from(sorted(SHAPES)))
    wet = {"lower": low, "upper": [low[0] + 0.6 * size[0], low[1] + size[1]], "depth": depth}
    place = draw(st.sampled_from(["box", "circle", "polygon", "all"]))
    if place == "circle":
        wet = {"centre": at, "radius": 1.5 * r, "depth": depth}
    if place == "polygon":
        wet = {"polygon": [low, [low[0] + size[0], low[1]], at], "depth": depth}
    if place == "all":
        wet = {"depth": depth}
    dt = draw(st.sampled_from([0.02, 0.2, 1.0])) * r / (9.81 * depth) ** 0.5
    scene = {
        "time": {"end": 100 * dt, "dt": dt, "n_sub_max": draw(st.sampled_from([4, 1000]))},
        "terrain": {"shape": shape, "lower": low, "upper": [a + s for a, s in zip(low, size)], "cell": r,
                    **draw(given(sampler=st.sampled_from(["bspline", "bilinear", "bicubic"])))},
        "fluid": {"spacing": r, "reference_depth": depth, "fill": [wet], "capacity": 80, **draw(given(
            layout=st.sampled_from(["equal_mass", "equal_area", "hexagonal", "lattice"]), jitter=numbers(0, 1), even=st.booleans(),
            seed=st.integers(0, 2**64 - 1), release_height=st.sampled_from([0.0, r])))},
        "boundary": draw(given(columns=st.booleans(), law=st.sampled_from(["mirror", "paper"]), spacing=st.sampled_from([0.5, 1.0]))),
        "solver": draw(given(
            precision=PRECISIONS, kernel=st.sampled_from(["cubic", "wendland2"]), iterations=st.integers(0, 8),
            form=st.sampled_from(["variational", "symmetric", "balanced", "linear"]), alpha=numbers(0, 2),
            first_kick=st.sampled_from(["half", "full"]), clamp=st.booleans())) | {"top_speed": 1e6},
        "output": {"raster": "none", **draw(given(maps=st.booleans()))},
        **draw(given(
            friction=st.sampled_from([{}, {"law": "chezy", "chezy": 30.0}, {"law": "darcy", "darcy": 0.1}, {"manning": 0.0}]),
            control=given(mode=st.sampled_from(["descent", "bead", "paper"]), clamp=st.booleans()),
            rain=st.sampled_from([{"rate": "20 mm/h"}, {"rate": {"table": [[0.0, 0.0], [1.0, 1e-4]]}}]),
            infiltration=st.just({"rate": "10 mm/h"}),
            obstacle=st.just([{"shape": "cylinder", "centre": at, "radius": r}]),
            gauge=st.just([{"position": [low[0] + r, low[1] + r]}]))),
    }  # fmt: skip
    entry = draw(st.sampled_from(["", "inflow", "edge", "open"]))
    if entry == "inflow":
        scene["inflow"] = [{"discharge": 0.1 * r**2, "centre": [low[0] + 6.5 * r, at[1]], "radius": r}]
        scene.pop("obstacle", None)
    if entry == "edge":
        given_there = [{"depth": depth}, {"discharge": 0.1 * r**2}, {"depth": depth, "far": True}]
        scene["edge"] = [{"side": "west", **draw(st.sampled_from(given_there))}]
    if entry == "open":
        scene["boundary"] |= dict.fromkeys(draw(st.lists(st.sampled_from(SIDES), min_size=1, unique=True)), "open")
    return scene if draw(st.booleans()) else {**scene, "preset": draw(st.sampled_from(["paper", "physical"]))}
