"""Measured floods: loaders of cases that are too large, or not ours, to ship, with the figures others reached on them.

The files lie in the folder that MELT_DATA names, or in ../shared/data beside the repository. A loader returns None where
its case is absent. Arrays are in SI units; a `Series` has gauges as columns. ``published`` holds what the literature, or a
first-order finite-volume run on the case's own grid, reached.
"""

import os
import pathlib
from dataclasses import dataclass

import numpy as np

MEASURED = pathlib.Path(__file__).parents[1] / "data" / "measured"


@dataclass(frozen=True)
class Series:
    """Gauges over time: t (n,) [s], values (n, k) [m], one column per name."""

    t: np.ndarray
    values: np.ndarray
    names: tuple

    def of(self, name):
        """Return (t, values) of one gauge."""
        return self.t, self.values[:, self.names.index(name)]


def folder(case):
    """Return the folder of a case, or None."""
    default = pathlib.Path(__file__).parents[1] / ".." / "shared" / "data"
    path = pathlib.Path(os.environ.get("MELT_DATA") or default) / case
    return path if path.is_dir() else None


def _table(path, **more):
    return np.genfromtxt(path, delimiter=",", names=True, deletechars="", **more)


def _series(path):
    table = _table(path)
    columns = [n for n in table.dtype.names if n != "t_s"]
    names = tuple(n.removeprefix("eta_").removesuffix("_m") for n in columns)
    return Series(table["t_s"], np.stack([table[c] for c in columns], -1), names)


@dataclass(frozen=True)
class TriangularSill:
    """Dam break over a sill: channel 0-38 m, gate at 15.5 m, Manning 0.0125, walls at both ends, 40 s.

    gauges: name -> (t, depth), digitised (0.01 m, 0.1-0.2 s); place: name -> x [m].
    """

    gauges: dict
    length = 38.0
    gate = 15.5
    reservoir = 0.75
    pool = 0.15
    manning = 0.0125
    end = 40.0
    place = {"G4": 19.5, "G10": 25.5, "G13": 28.5, "G20": 35.5}
    #: First-order finite volumes, 5 cm: RMSE [m], arrival [s], largest depth [m].
    published = {
        "rmse": {"G4": 0.070, "G10": 0.090, "G13": 0.027, "G20": 0.030},
        "arrival": {"G4": 1.15, "G10": 2.99, "G13": 4.32, "G20": 7.49},
        "peak": {"G4": 0.553, "G10": 0.621, "G13": 0.180, "G20": 0.495},
    }

    @staticmethod
    def bed(x):
        """Return the bed [m]: a triangle 0.40 m high from 25.5 over 28.5 to 31.5 m."""
        return np.maximum(0.0, 0.4 * (1 - np.abs(np.asarray(x, float) - 28.5) / 3))

    @classmethod
    def start(cls, x):
        """Return the depth [m] at t = 0: reservoir, dry, and a pool of stage 0.15 m behind the crest."""
        x = np.asarray(x, float)
        return np.where(x < cls.gate, cls.reservoir, np.where(x > 28.5, np.maximum(0.0, cls.pool - cls.bed(x)), 0.0))


def triangular_sill():
    """Return the `TriangularSill` (Chatelet and Hiver 2000; digitised by P. Ersing, MIT)."""
    path = folder("flood_triangular_sill")
    if path is None:
        return None
    tables = {name: _table(path / f"{name}.csv") for name in TriangularSill.place}
    return TriangularSill({name: (t["t_s"], t["h_m"]) for name, t in tables.items()})


def shipped_sill():
    """Return the `TriangularSill` with the thinned gauges of data/measured (at most 60 instants each), always there."""
    rows = np.loadtxt(MEASURED / "triangular_sill_gauges.csv", delimiter=",", skiprows=1, dtype=str)
    gauges = {name: rows[rows[:, 0] == name, 1:].astype(float).T for name in TriangularSill.place}
    return TriangularSill({name: tuple(columns) for name, columns in gauges.items()})


@dataclass(frozen=True)
class Monai:
    """Monai valley, tank 1:400, 5.488 m x 3.402 m, sea level 0; eta(t) enters at x = 0 until 22.5 s, other sides reflect.

    x (393,), y (244,) [m]; bed (ny, nx) [m]; incident: column "incident"; gauges: columns "g5", "g7", "g9" of eta, meaningful until 25 s.
    runup_place (3, 2) [m], runup (3, 6) [m]: three places, six repeated runs; the first place is the gully.
    """

    x: np.ndarray
    y: np.ndarray
    bed: np.ndarray
    incident: Series
    gauges: Series
    runup_place: np.ndarray
    runup: np.ndarray
    manning = 0.01
    place = {"g5": (4.521, 1.196), "g7": (4.521, 1.696), "g9": (4.521, 2.196)}
    #: First-order finite volumes on this grid: (peak [m], its time [s]), run-up [m]; RMSE over 10-25 s [m].
    published = {
        "peak": {"g5": (0.0341, 18.56), "g7": (0.0389, 17.05), "g9": (0.0425, 16.93)},
        "rmse": 0.004,
        "runup": (0.069, 0.057, 0.050),
    }


def monai():
    """Return the `Monai` case (Matsuyama and Tanaka 2001)."""
    path = folder("flood_monai_valley")
    if path is None:
        return None
    with np.load(path / "monai_bed.npz") as grid:
        x, y, bed = (np.asarray(grid[k], float) for k in ("x", "y", "z"))
    wave = _table(path / "incident_wave.csv")
    high = np.loadtxt(path / "observed_runup.csv", delimiter=",", skiprows=1)
    incident = Series(wave["t_s"], wave["eta_m"][:, None], ("incident",))
    return Monai(x, y, bed, incident, _series(path / "gauges_5_7_9.csv"), high[:, :2], high[:, 2:])


@dataclass(frozen=True)
class ConicalIsland:
    """Solitary wave on a conical island (Briggs et al. 1995), basin 25 m x 28.2 m, depth 0.32 m.

    case: "A", "B", "C"; gauges: eta, columns "g1".."g4" (offshore), "g6", "g9", "g16", "g22"; place: name -> (x, y) [m].
    runup: 24 angles, 90 on the lee side, 270 facing the wave (read off the values); runup_liu: the second published table, 0
    facing the wave, 180 lee. They differ by 30-50 % in case A. paddle: displacement [m].
    """

    case: str
    gauges: Series
    place: dict
    runup: np.ndarray  # (24, 2): angle [degrees], R [m]
    runup_liu: np.ndarray  # (9, 2)
    paddle: Series
    wave: float  # measured H [m]
    depth = 0.32
    centre = (12.96, 13.80)
    basin = (25.0, 28.2)
    #: Largest eta [m] and largest run-up [m], as measured.
    peaks = {
        "A": {"g6": 0.0156, "g9": 0.0230, "g16": 0.0232, "g22": 0.0178, "runup": 0.032},
        "B": {"g6": 0.0307, "g9": 0.0406, "g16": 0.0377, "g22": 0.0374, "runup": 0.088},
        "C": {"g6": 0.0607, "g9": 0.0631, "g16": 0.0623, "g22": 0.0911, "runup": 0.175},
    }
    published = peaks

    @classmethod
    def bed(cls, x, y):
        """Return the bed [m], still water at 0: a cone of slope 1:4, base diameter 7.2 m, crest diameter 2.2 m, height 0.625 m."""
        r = np.hypot(np.asarray(x, float) - cls.centre[0], np.asarray(y, float) - cls.centre[1])
        return -cls.depth + np.clip((3.6 - r) / 4, 0.0, 0.625)


def conical_island(case):
    """Return the `ConicalIsland` of case "A", "B" or "C" (H/d 0.045, 0.096, 0.181)."""
    path = folder("flood_conical_island")
    if path is None:
        return None
    offshore = {"A": 5.76, "B": 6.82, "C": 7.56}[case]
    place = {f"g{i + 1}": (offshore, y) for i, y in enumerate((16.05, 14.55, 13.05, 11.55))}
    place |= {"g6": (9.36, 13.80), "g9": (10.36, 13.80), "g16": (12.96, 11.22), "g22": (15.56, 13.80)}
    runup = _table(path / f"runup_nthmp_case{case}.csv")
    liu = _table(path / f"runup_liu1995_case{case}.csv")
    paddle = _table(path / "paddle_displacement_cm.csv")
    return ConicalIsland(
        case, _series(path / f"gauges_case{case}.csv"), place, np.stack([runup["angle_deg"], 0.01 * runup["runup_cm"]], -1),
        np.stack([liu["Angle"], liu["observed_R"]], -1), Series(paddle["t_s"], 0.01 * paddle[f"case{case}"][:, None], ("paddle",)),
        0.32 * {"A": 0.045, "B": 0.096, "C": 0.181}[case],
    )


@dataclass(frozen=True)
class SolitaryBeach:
    """Solitary wave on a plane beach 1:19.85 (Synolakis 1987); lengths over the still depth d, x = 0 at the shoreline, offshore > 0.

    runup (77, 3): H/d, R/d, d [m]; profiles: (H/d, t sqrt(g/d)) -> (n, 2) of x/d, eta/d.
    """

    runup: np.ndarray
    profiles: dict
    cotangent = 19.85
    #: H/d -> range of R/d
    published = {0.0185: (0.078, 0.085), 0.3: (0.55, 0.55)}

    @classmethod
    def bed(cls, x):
        """Return bed over depth, still water at 0."""
        return -np.minimum(np.asarray(x, float) / cls.cotangent, 1.0)


def solitary_beach():
    """Return the `SolitaryBeach` case."""
    path = folder("flood_solitary_beach")
    if path is None:
        return None
    profiles = {}
    for file in sorted(path.glob("profile_H*_t*.csv")):
        H, t = file.stem.removeprefix("profile_H").split("_t")
        profiles[float(H), float(t)] = np.loadtxt(file, delimiter=",", skiprows=1)
    return SolitaryBeach(np.loadtxt(path / "runup_max.csv", delimiter=",", skiprows=1) * [1, 1, 0.01], profiles)


@dataclass(frozen=True)
class Merewether:
    """Flood among houses, Newcastle, June 2007; EPSG:32756, metres.

    x (321,), y (416,) cell centres; bed (ny, nx), row 0 south, bare earth (NaN: no data); houses: list of (n, 2) polygons; road, extent
    (n, 2); marks: id -> (x, y, stage [m]). Inflow, sides and friction: the scene `merewether`.
    """

    x: np.ndarray
    y: np.ndarray
    bed: np.ndarray
    houses: list
    road: np.ndarray
    extent: np.ndarray
    marks: dict
    tuflow: dict  # id -> stages [m] on grids of 1, 0.5 and 2 m
    #: MAE [m] of TUFLOW (1, 0.5, 2 m) and of first-order finite volumes (1 m), with their stages [m]. The bed at 42 lies above the
    #: mark, the depth at 43 is 6 cm: 44, 31 and 32 judge.
    published = {
        "mae tuflow": (0.124, 0.202, 0.156), "mae fv": 0.14, "fv": {44: 22.87, 43: 23.16, 31: 20.17, 32: 18.47, 42: 23.61},
    }


def merewether():
    """Return the `Merewether` case (data: Water Research Laboratory UNSW; Smith and Wasko 2012)."""
    path = folder("flood_merewether")
    if path is None:
        return None
    with np.load(path / "merewether_dem_1m.npz") as grid:
        x, y, bed = (np.asarray(grid[k], float) for k in ("x", "y", "z"))
    corners = np.loadtxt(path / "houses.csv", delimiter=",", skiprows=1, dtype=str)  # a name may be 032_033
    houses = [corners[corners[:, 0] == name, 2:].astype(float) for name in np.unique(corners[:, 0])]
    road, extent = (np.loadtxt(path / f"{n}.csv", delimiter=",", skiprows=1) for n in ("road_polygon", "extent"))
    rows = np.loadtxt(path / "observed_stage.csv", delimiter=",", skiprows=1)
    marks = {int(r[2]): (float(r[0]), float(r[1]), float(r[3])) for r in rows}
    return Merewether(x, y, bed, houses, road, extent, marks, {int(r[2]): tuple(map(float, r[4:])) for r in rows})
