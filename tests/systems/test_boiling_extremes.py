"""Spec 6 of boiling: long steps, empty and full pools, bubbles and tanks of all sizes, particles at one place."""

import numpy as np
import pytest
from boiling_scenes import AT_ONCE, HOT, D, N, bits, pot, sound, stepped, tank, warnings_of
from scipy.spatial import cKDTree

from melt import simulation
from melt.errors import MeltError
from melt.geometry.build import build
from melt.output.run_reader import open_run
from melt.physics.phases import BUBBLE, INACTIVE, LIQUID, VAPOUR
from melt.plan import prepare
from melt.position_based import bottom_compression
from melt.preflight import plan
from melt.simulation import Simulation

# ---- time step


def test_a_step_too_large_is_cut_into_sub_steps_and_how_many_is_told():
    scene = pot(*HOT, "time.dt=0.0166666667")
    sim = stepped(scene, 3)
    n = sound(sim)["n_sub"]
    assert n == 3
    assert bottom_compression(scene, 8, scene.time.dt) > 0.1  # in one step it would not do
    assert bottom_compression(scene, 8, scene.time.dt / n) <= scene.solver.pbf.compression
    assert sim.do.clock.sub_step == 3 * n
    assert f"sub-steps per outer step at the start: {n}" in "\n".join(plan(scene).lines())


def test_too_many_sub_steps_are_refused_with_the_longest_and_its_formula():
    """Before anything is compiled."""
    said = r"sub-steps of 0\.00687 s = sqrt\(C J d omega' c2/\(0\.86 N g\)\), 44 of them .*n_sub_max is 16"
    with pytest.raises(MeltError, match=said):
        Simulation(pot("time.dt=0.3"), "cpu")


def test_too_few_given_sub_steps_are_a_warning_and_the_run_goes_on():
    scene = pot(*HOT, "time.dt=0.05", "time.n_sub=1")
    assert any("time.n_sub = 1 makes sub-steps of 0.05 s" in text for text in warnings_of(scene))
    sim = stepped(scene, 4)
    assert sound(sim)["step_over_limit"] > 8
    assert sim.series()["largest_speed"] <= 0.5 * D / 0.05 * 4  # cut in S2; corrections come on top


@pytest.mark.parametrize("layers", [50, 200])
def test_a_tall_thin_tank_takes_more_sub_steps_as_the_root_of_its_layers(layers):
    scene = tank((1, 1), layers, boiling={"heater": {"half_size": [D, D], "temperature": 130}})
    longest = prepare(scene, build(scene)).settings.longest_step
    assert longest == pytest.approx(np.sqrt(0.025 / bottom_compression(scene, 1, 1.0) / layers), rel=1e-12)
    sim = stepped(scene, 20)
    s = sound(sim)
    assert s["n_sub"] == int(np.ceil(1 / 240 / min(longest, 0.5 * D / np.sqrt(2 * 9.81 * layers * D))))
    x = sim.read("position")[sim.read("phase") == LIQUID]
    assert (x[:, :2] > 0.249 * D).all() and (x[:, :2] < 0.751 * D).all()  # both walls act
    assert s["density_error_max"] < 0.1


# ---- nothing there


@pytest.mark.parametrize("overrides", [[], ["boiling.vapour.per_burst=2", "solver.pbf.precision=true"], ["boiling.heat_model=grid"],
                                       ["solver.pressure=sph"], ["boiling.mass_model=recycle"]])
def test_a_tank_without_liquid_steps(overrides):
    s = sound(stepped(pot("fluid.fill=[]", *overrides), 3))
    assert s["liquid_particles"] == s["bubbles"] == s["vapour_particles"] == s["boiled"] == 0


def test_no_bubbles_launch_no_stage_of_bubbles():
    sim = stepped(pot("fluid.temperature=20"), 3)
    assert sound(sim)["bubbles"] == 0
    assert not [stage for stage in sim.do.launches if stage.startswith(("bubble_", "merge_", "burst_", "spawn_", "vapour_"))]


def test_boiled_dry_a_run_ends_well_with_a_warning(tmp_path):
    told, path = [], tmp_path / "dry.vtkhdf"

    def progress(event, message="", **_):
        told.extend([message] if event == "warning" else [])

    scene = pot(*AT_ONCE, "boiling.bubbles.capacity=2304", "boiling.bubbles.merge_age=0", "time.end=0.15 s", "time.output_every=0.05 s")
    done = simulation.run(scene, path, backend="cpu", progress=progress)
    assert not done.interrupted and done.simulation.do.clock.step == scene.time.steps
    s = sound(done.simulation)
    assert s["liquid_particles"] == s["bubbles"] == 0 and s["boiled"] == N and s["released_mass"] == pytest.approx(N * 0.008)
    assert abs(s["heat_missing"]) < 1e-10 * done.simulation.do.clock.ledger["start_heat"]
    assert sum("all of the liquid has boiled away" in text for text in told) == 1
    assert sum("slots for 2304 bubbles are taken" in text for text in told) == 1  # on the way there
    with open_run(path) as run:
        assert len(run) == 4 and run.frame(3)["id"].size == 0


# ---- all at once, and full


def test_all_particles_boil_in_one_step_if_there_are_slots():
    sim = stepped(pot(*AT_ONCE, f"boiling.bubbles.capacity={4 * N}"), 1)
    s = sound(sim)
    assert s["boiled"] == N and s["deferred"] == 0 and s["liquid_particles"] == 0
    assert s["bubbles"] + s["vanished"] + s["burst"] == 4 * N
    assert abs(s["heat_missing"]) < 1e-10 * sim.do.clock.ledger["start_heat"]


def test_with_fewer_slots_the_smallest_ids_boil_and_the_others_wait():
    scene = pot(*AT_ONCE, "boiling.bubbles.capacity=402")
    first, second = stepped(scene, 1), stepped(scene, 1)
    s = sound(first)
    assert s["boiled"] == 100 and s["deferred"] == N - 100 and s["bubbles"] <= 400
    assert first.read("phase")[:N].tolist() == [INACTIVE] * 100 + [LIQUID] * (N - 100)  # by id
    assert bits(first) == bits(second)
    assert "1052 particles at the boiling point wait" in first.do.warning and "capacity" in first.do.warning
    assert sound(stepped(scene, 30))["bubbles"] <= 402


def test_vapour_that_finds_no_slot_is_dropped_and_counted():
    """The newest; liquid and bubbles keep their slots."""
    scene = pot(*HOT, "boiling.latent_scale=0", "boiling.vapour.per_burst=5", "boiling.vapour.capacity=7", "boiling.bubbles.merge_age=0")
    sim = Simulation(scene, "cpu")
    oldest = None
    for _ in range(120):
        sim.step()
        ids = sim.read("id")[sim.read("phase") == VAPOUR]
        assert ids.size <= 7
        if oldest is None and ids.size == 7:
            oldest = set(ids.tolist())
    s = sound(sim)
    assert s["burst"] > 2 and s["vapour_dropped"] == 5 * s["burst"] - 7
    assert s["vapour_particles"] == 7 and set(sim.read("id")[sim.read("phase") == VAPOUR].tolist()) == oldest


# ---- large bubbles, narrow tanks


def with_bubbles(scene, places, radius):
    """Return an initial state with bubbles in free slots."""
    initial = build(scene)
    slots = np.flatnonzero(initial["phase"] == INACTIVE)[: len(places)]
    n = initial["id"].size
    given = dict(
        bubble_radius=np.zeros(n), bubble_volume=np.zeros(n), birth_height=np.zeros(n), age=np.zeros(n), cargo=np.zeros(n, np.int32)
    )
    radius = np.broadcast_to(radius, len(places))
    given["bubble_radius"][slots], given["bubble_volume"][slots] = radius, 4 / 3 * np.pi * radius**3
    given["birth_height"][slots] = np.array(places)[:, 2]
    initial.arrays.update(given)
    initial["phase"][slots], initial["position"][:, slots] = BUBBLE, np.array(places).T
    return initial


@pytest.mark.parametrize("radius", [3 * D, 0.5])
@pytest.mark.parametrize("pressure", ["pbf", "sph"])
def test_a_bubble_larger_than_the_support_or_the_tank(radius, pressure):
    scene = pot("boiling.heater.temperature=90", f"solver.pressure={pressure}", "time.n_sub_max=64", "watch.density_error=off")
    sim = Simulation(scene, "cpu", initial=with_bubbles(scene, [[0.07, 0.17, 0.06]], radius))
    assert sim.do.clock.bubbles == 1 and sim.do.clock.largest_bubble == pytest.approx(radius)
    for _ in range(4):
        sim.step()
        values = sound(sim)
        on = sim.read("phase") == BUBBLE
        r, x = sim.read("bubble_radius")[on], sim.read("position")[on]
        for k in range(on.sum()):
            for axis in (0, 1):
                low, high = (r[k], 0.24 - r[k]) if 2 * r[k] <= 0.24 else (0.12, 0.12)  # in the middle if it does not fit
                assert low - 1e-9 <= x[k, axis] <= high + 1e-9
        assert (r <= max(radius, 2 * 2.2 * D) * (1 + 1e-12)).all()  # growth stops at twice the support
    assert values["burst"] + values["bubbles"] == 1


def test_liquid_leaves_the_inside_of_a_large_bubble():
    scene = pot("boiling.heater.temperature=90", "fluid.fill=[{lower=[0,0,0],upper=[0.24,0.24,0.32]}]")
    sim = Simulation(scene, "cpu", initial=with_bubbles(scene, [[0.12, 0.12, 0.08]], 2.5 * D))
    for _ in range(3):
        sim.step()
    on, liquid = sim.read("phase") == BUBBLE, sim.read("phase") == LIQUID
    sound(sim)
    away = np.linalg.norm(sim.read("position")[liquid] - sim.read("position")[on], axis=1)
    assert on.sum() == 1 and away.min() > 0.9 * sim.read("bubble_radius")[on][0]  # it rises within the step


@pytest.mark.parametrize("cells", [(1, 1), (2, 1), (2, 3)])
@pytest.mark.parametrize("pressure", ["pbf", "sph"])
def test_a_tank_narrower_than_the_support_boils(cells, pressure):
    half = [cells[0] * D / 2, cells[1] * D / 2]
    sim = stepped(tank(cells, 8, boiling={"heater": {"half_size": half, "temperature": 130}}, solver={"pressure": pressure},
                       time={"n_sub_max": 64}), 120)
    s = sound(sim)
    assert s["boiled"] > 0
    x = sim.read("position")[sim.read("phase") == LIQUID]
    assert (x[:, :2] >= 0).all() and (x[:, 0] <= cells[0] * D).all() and (x[:, 1] <= cells[1] * D).all()


# ---- coincident and lonely particles


def test_a_thousand_particles_at_one_point_are_apart_within_60_steps():
    scene = tank((12, 12), 7, head=12, boiling={"heater": None}, watch={"density_error": "off"})
    initial = build(scene)
    liquid = np.flatnonzero(initial["phase"] == LIQUID)
    assert liquid.size > 1000
    initial["position"][:, liquid[:1000]] = np.array([[0.12], [0.12], [0.16]])
    sim = Simulation(scene, "cpu", initial=initial)
    for _ in range(60):
        sim.step()
        s = sound(sim)
        # predictions and corrections are cut: half a spacing each
        assert s["largest_speed"] <= (1 + sim.do.settings.iterations) * 0.5 * D * 240 * s["n_sub"]
    x = sim.read("position")[sim.read("phase") == LIQUID]
    nearest = cKDTree(x).query(x, k=2)[0][:, 1]
    assert s["coincident_particles"] == 0
    assert nearest.min() > 0.3 * D and np.median(nearest) > 0.8 * D  # measured 0.45, 0.85
    assert s["density_error_max"] < 0.2


@pytest.mark.parametrize("eps", [0.0, 1.0])
def test_a_lonely_particle_falls_ballistically(eps):
    """D = 0 and eps = 0: lambda = 0, no NaN; v += g dt, exactly."""
    scene = tank((10, 10), 2, head=40, fluid={"fill": [{"lower": [0.1, 0.1, 0.7], "upper": [0.12, 0.12, 0.72]}], "temperature": 50},
                 solver={"pbf": {"eps_rel": eps, "omega": 0.5}}, boiling={"boost": "off", "heater": None})
    sim = stepped(scene, 30)
    on = sim.read("phase") == LIQUID
    v, dt, x = 0.0, 1 / 240 / sim.series()["n_sub"], 0.71
    for _ in range(30 * sim.series()["n_sub"]):
        v -= 9.81 * dt
        x += dt * v
    assert on.sum() == 1
    assert sim.read("velocity")[on][0] == pytest.approx([0, 0, v], rel=1e-10, abs=1e-14)
    assert sim.read("position")[on][0] == pytest.approx([0.11, 0.11, x], rel=1e-12)
    assert sound(sim)["temperature_mean"] == 50
