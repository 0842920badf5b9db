"""Values over time, and the columns that they become: hydrographs, emitters, rain, regions (flood E17, E19)."""

import json

import numpy as np
import pytest

from melt.errors import GeometryError, InputError, UnitError
from melt.flood.hydrographs import Emitter, Hydrograph, Rain, emptiest
from melt.geometry.regions import Box, Disc, Line, Polygon

STEEP = Hydrograph([0, 10, 10, 25, 100], [2, 4, 10, 10, 0], after="zero")


def test_values_between_points_and_at_a_step():
    assert [STEEP.value(t) for t in (-5, 0, 5, 9.999999, 10, 20, 62.5, 100, 101)] == pytest.approx([2, 2, 3, 4, 10, 10, 5, 0, 0], abs=1e-6)
    assert Hydrograph([3], [7.0]).value(-100) == Hydrograph([3], [7.0]).value(100) == 7
    alone = Hydrograph([3], [7.0], before="zero", after="zero")
    assert [alone.value(t) for t in (2, 3, 4)] == [0, 7, 0]


@pytest.mark.parametrize(
    "start, stop, volume",
    [
        (0, 10, 30), (0, 5, 12.5), (4, 6, 6), (9, 11, 3.9 + 10), (10, 25, 150), (0, 100, 30 + 150 + 375), (-4, 0, 8), (90, 200, 20 / 3),
        (7, 7, 0),
    ],
)
def test_integrals_by_hand(start, stop, volume):
    assert STEEP.integral(start, stop) == pytest.approx(volume, rel=1e-14)
    assert STEEP.integral(stop, start) == -STEEP.integral(start, stop)


def test_outside_of_the_table():
    held, zero = Hydrograph([10, 20], [4, 6]), Hydrograph([10, 20], [4, 6], before="zero", after="zero")
    assert held.integral(0, 30) == 40 + 50 + 60 and zero.integral(0, 30) == 50
    assert [zero.value(t) for t in (9, 10, 20, 21)] == [0, 4, 6, 0]


def test_parts_of_an_integral_add_up():
    rng = np.random.default_rng(1)
    table = Hydrograph(np.sort(rng.uniform(0, 100, 40)), rng.uniform(0, 9, 40))
    cuts = np.sort(rng.uniform(-5, 120, 3000))
    parts = [table.integral(a, b) for a, b in zip(cuts, cuts[1:])]
    assert sum(parts) == pytest.approx(table.integral(cuts[0], cuts[-1]), rel=1e-13)
    fine = np.linspace(-5, 120, 400001)
    values = np.array([table.value(t) for t in fine[::40]])
    assert np.trapezoid(values, fine[::40]) == pytest.approx(table.integral(-5, 120), rel=1e-4)


@pytest.mark.parametrize(
    "times, values, said",
    [
        ([], [], "at least one"), ([0, 1], [1], "2 times and 1 values"), ([0, 2, 1], [1, 1, 1], "sort the table"),
        ([0, 1], [1, np.nan], "point 2 is not finite"), ([0, np.inf], [1, 1], "point 2 is not finite"),
    ],
)
def test_bad_tables_are_refused(times, values, said):
    with pytest.raises(InputError, match=said):
        Hydrograph(times, values)


def test_bad_policy_is_refused():
    with pytest.raises(InputError, match="'hold' or 'zero'"):
        Hydrograph([0], [1], after="repeat")


@pytest.mark.parametrize(
    "text",
    ["time,discharge\n0,1\n1.5,3\n", "# gauge 7\n\n0;1\n1.5;3\n", "0 1\n1.5   3", "\ufefft\tq\n0\t1\n1.5\t3\n", "0, 1\r\n1.5, 3\r\n"],
)
def test_files_of_two_columns(tmp_path, text):
    path = tmp_path / "q.csv"
    path.write_text(text, encoding="utf-8")
    found = Hydrograph.read(path, time_unit="h", unit="ft^3/s")
    assert found.times == pytest.approx([0, 5400]) and found.values == pytest.approx([0.3048**3, 3 * 0.3048**3])


@pytest.mark.parametrize(
    "text, said",
    [
        ("t,q\n0,1\n1,many\n", "line 3"), ("0,1\n2,\n", "line 2"), ("0,1,5\n0,2,5\n", "line 2"),
        ("t;q\n0,5;1\n1,5;2\n", "decimals with a point"), ("t,q\n", "no line of two numbers"), ("0,1\n5,2\n4,2\n", "sort"),
    ],
)
def test_bad_files_say_where_and_what_to_do(tmp_path, text, said):
    path = tmp_path / "q.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=said):
        Hydrograph.read(path)


def test_files_that_are_not_there_and_units_that_do_not_fit(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        Hydrograph.read(tmp_path / "none.csv")
    (tmp_path / "rain.csv").write_text("0,36\n1,18\n")
    rain = Hydrograph.read(tmp_path / "rain.csv", "min", "mm/h", "speed")
    assert rain.values == pytest.approx([1e-5, 5e-6]) and rain.times[1] == 60
    with pytest.raises(UnitError, match="no unit of discharge"):
        Hydrograph.read(tmp_path / "rain.csv", "min", "mm/h")
    with pytest.raises(UnitError, match="no unit of time"):
        Hydrograph.read(tmp_path / "rain.csv", "m", "mm/h", "speed")


def test_an_emitter_never_owes_or_is_ahead_by_a_column():
    rng = np.random.default_rng(2)
    emitter = Emitter(STEEP, Disc((0, 0), 1), 0.37, seed=5)
    time = entered = 0.0
    while time < 130:
        time += rng.uniform(0, 0.6)
        entered += 0.37 * len(emitter.emit(time))
        assert abs(entered - STEEP.integral(0, time)) <= 0.37
    assert entered == pytest.approx(555, abs=0.37) and len(emitter.emit(1e6)) == 0


def test_whole_columns_come_on_time():
    """1 m^3/s in columns of 0.1 m^3 and steps of 0.1 s: one each, although 0.1 is no binary number."""
    emitter = Emitter(Hydrograph([0], [1.0]), Disc((0, 0), 1), 0.1)
    assert [len(emitter.emit(0.1 * k)) for k in range(1, 200)] == [1] * 199


def test_what_has_no_room_stays_owed():
    emitter = Emitter(Hydrograph([0], [1.0]), Disc((0, 0), 1), 0.25)
    assert len(emitter.emit(10, most=3)) == 3 and emitter.owed(10) == 9.25
    assert len(emitter.emit(10)) == 37 and emitter.owed(10) == 0


@pytest.mark.parametrize("kind", ["emitter", "rain"])
def test_a_checkpoint_as_json_goes_on_with_the_same_columns(kind):
    def make(state=None):
        if kind == "emitter":
            return Emitter(STEEP, Polygon([(0, 0), (3, 0), (1, 2)]), 0.2, seed=3, number=2, state=state)
        return Rain(Hydrograph([0], [0.01]), (0, 0), (10, 7), 2.0, 0.2, seed=3, number=2, state=state)

    whole, first = make(), make()
    places = whole.emit(40)
    parts = [first.emit(13.3)]
    again = make(json.loads(json.dumps(first.state)))
    parts.append(again.emit(40))
    assert again.state == whole.state
    if kind == "emitter":  # columns do not depend on how the time is cut; those of rain gather in other cells
        assert (np.concatenate(parts) == places).all()
    assert len(np.concatenate(parts)) == len(places) > 5


def test_columns_differ_between_seeds_and_emitters():
    seen = [Emitter(STEEP, Box((0, 0), (1, 1)), 1.0, seed=s, number=k).emit(5).tobytes() for s, k in ((0, 0), (1, 0), (0, 1))]
    assert len(set(seen)) == 3


def test_velocity_of_what_enters():
    inflow = Emitter(STEEP, Line([(0, 0), (4, 0)]), 1.0, direction=(0, 2), width=4.0, depth=0.5)
    assert inflow.velocity(20).tolist() == [0, 5] and Emitter(STEEP, Disc((0, 0), 1), 1.0).velocity(20).tolist() == [0, 0]


def test_bad_emitters_are_refused():
    with pytest.raises(InputError, match="leaves over open sides"):
        Emitter(Hydrograph([0, 1], [1, -1]), Disc((0, 0), 1), 1.0)
    with pytest.raises(InputError, match="must be positive"):
        Emitter(STEEP, Disc((0, 0), 1), 0.0)


def test_rain_as_a_whole_and_of_each_cell_owes_less_than_a_column():
    """Cells at the upper edges are cut, one is dry and one gets double."""
    weight = np.ones((4, 5))
    weight[1, 1], weight[2, 3] = 0, 2
    rate = Hydrograph([0, 300, 600], [0, 2e-5, 0], after="zero")
    rain = Rain(rate, (10, -5), (33, 14), 5.0, 0.05, weight, seed=4)
    area = float((weight * np.outer([5, 5, 5, 4], [5, 5, 5, 5, 3])).sum())
    places, total = [], 0
    for time in np.linspace(0, 700, 200)[1:]:
        new = rain.emit(time)
        total += len(new)
        places.append(new)
        assert abs(total * 0.05 - rate.integral(0, time) * area) <= 0.05 * (1 + 1e-6)
        assert np.abs(rain.owed(time)).max() <= 0.05 * (1 + 1e-6)
    x = np.concatenate(places)
    assert total == int(6e-3 * area / 0.05)
    cells = np.floor((x - (10, -5)) / 5).astype(int)
    assert (cells == cells[:, :1]).all()  # candidates of a column lie in its cell
    got = np.zeros((4, 5))
    np.add.at(got, (cells[:, 0, 1], cells[:, 0, 0]), 0.05)
    assert got == pytest.approx(6e-3 * weight * np.outer([5, 5, 5, 4], [5, 5, 5, 5, 3]), abs=0.0501)
    assert (x >= (10, -5)).all() and (x < (33, 14)).all()


def test_rain_takes_turns():
    """Of 100 equal cells each gets one column before any gets two, in no order of the plane."""
    rain = Rain(Hydrograph([0], [0.01]), (0, 0), (10, 10), 1.0, 0.1)
    first = np.concatenate([np.floor(rain.emit(0.1 * k)[:, 0]).astype(int) for k in range(1, 101)])
    number = first[:, 1] * 10 + first[:, 0]
    assert sorted(number) == list(range(100)) and np.abs(np.diff(number)).mean() > 20
    assert len(rain.emit(60.0)) == 500 and set(rain.state["emitted"]) == {6}


def test_bad_rain_is_refused():
    with pytest.raises(InputError, match=r"shape \(2, 3\)"):
        Rain(Hydrograph([0], [1e-5]), (0, 0), (3, 2), 1.0, 0.1, np.ones((3, 2)))
    with pytest.raises(InputError, match="negative"):
        Rain(Hydrograph([0], [-1e-5]), (0, 0), (3, 2), 1.0, 0.1)


def test_the_emptiest_candidate_is_taken_and_then_no_longer_empty():
    candidates = np.array([[(0, 0), (5, 5)], [(5, 5.1), (0, 1)], [(5, 5), (9, 9)]], float)
    clearance = np.array([[1, 2], [3, 0.5], [9, 0.2]])
    # (5, 5); then it is 0.1 from (5, 5.1) and (0, 1) is left; then (5, 5) is taken and (9, 9) is best
    assert emptiest(candidates, clearance).tolist() == [[5, 5], [0, 1], [9, 9]]
    assert emptiest(np.zeros((0, 8, 2)), np.zeros(0)).shape == (0, 2)


def test_best_candidates_keep_their_distance():
    """Nearest neighbours of 200 columns in a square: evener than as many random points."""
    emitter = Emitter(Hydrograph([0], [1.0]), Box((0, 0), (1, 1)), 0.01, seed=9)
    candidates = emitter.emit(2.0)
    best = emptiest(candidates, np.full((200, 8), 9.0))

    def nearest(x):
        r = np.hypot(*(x[:, None] - x[None]).T) + 9 * np.eye(len(x))
        return r.min(axis=0)

    assert np.percentile(nearest(best), 5) > 3 * np.percentile(nearest(candidates[:, 0]), 5)


def uniform(n=200_000):
    return np.random.default_rng(7).random((n, 2))


@pytest.mark.parametrize(
    "region, area, centre",
    [
        (Disc((2, 3), 1.5), np.pi * 2.25, (2, 3)),
        (Box((1, 2), (4, 3)), 3, (2.5, 2.5)),
        (Polygon([(0, 0), (4, 0), (0, 3)]), 6, (4 / 3, 1)),
        (Polygon([(0, 0), (0, 2), (3, 2), (3, 1), (1, 1), (1, 0)]), 4, ((2 * 0.5 + 2 * 2) / 4, (2 * 1 + 2 * 1.5) / 4)),
        (Polygon([(0, 0), (4, 4), (8, 0), (4, 1)][::-1]), 12, (4, 5 / 3)),
    ],
    ids=["disc", "box", "triangle", "L", "arrow"],
)
def test_regions_are_filled_evenly(region, area, centre):
    x = region.points(uniform())
    assert x.mean(axis=0) == pytest.approx(centre, abs=0.01)
    # the share in a window is its share of the area
    window = (np.abs(x - centre) < 0.25).all(axis=1).mean()
    assert window == pytest.approx(0.25 / area, rel=0.03)
    assert region.points(uniform(6).reshape(2, 3, 2)).shape == (2, 3, 2)


def test_places_lie_in_their_polygon():
    """An arrow with a notch: below the notch there is nothing."""
    x = Polygon([(0, 0), (4, 4), (8, 0), (4, 1)]).points(uniform(50_000))
    a, b = x[:, 0], x[:, 1]
    left = a <= 4
    assert (b <= np.where(left, a, 8 - a) + 1e-12).all() and (b >= np.where(left, a / 4, (8 - a) / 4) - 1e-12).all()


def test_places_on_a_line_are_even_along_it():
    x = Line([(0, 0), (3, 0), (3, 1)]).points(uniform())
    assert ((x[:, 1] == 0) | (x[:, 0] == 3)).all() and (x[:, 0] < 3).mean() == pytest.approx(0.75, abs=0.005)


@pytest.mark.parametrize(
    "make",
    [
        lambda: Disc((0, 0), 0), lambda: Box((1, 1), (0, 2)), lambda: Line([(1, 1)]), lambda: Line([(1, 1), (1, 1)]),
        lambda: Polygon([(0, 0), (1, 0)]), lambda: Polygon([(0, 0), (1, 1), (2, 2)]), lambda: Polygon([(0, 0), (1, 1), (1, 0), (0, 1)]),
    ],
)
def test_regions_without_an_inside_are_refused(make):
    with pytest.raises(GeometryError):
        make()
