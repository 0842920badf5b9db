"""Run files: what was written is read back, by melt and by VTK; errors name what, where and what to do."""

import os

import h5py
import numpy as np
import pytest
from run_samples import particles, same, vtk_frames

from melt.output import hdf5
from melt.output.errors import OutputError, RunFileError
from melt.output.hdf5_messages import lookup3
from melt.output.run_file import RunWriter
from melt.output.run_reader import open_run
from melt.output.run_tables import series_unit

SCENE = '[scene]\nname = "Eiswürfel"\n'
COUNTS = [100, 7, 0, 3000, 2048, 1]


def write(path, counts=COUNTS, **options):
    with RunWriter(path, SCENE, {"melt": "0.1.0", "seed": 3, "tolerance": 0.5}, **options) as writer:
        for k, n in enumerate(counts):
            writer.append(
                0.1 * k, particles(k, n), {"kinetic_energy": 2.0 * k, "ms/density": 0.5, "liquid_count": n}
            )
    return path


def test_checksum_is_the_one_of_the_library(tmp_path):
    with h5py.File(tmp_path / "a.h5", "w", libver="latest") as file:
        file["a"] = np.arange(3)
    data = (tmp_path / "a.h5").read_bytes()
    assert lookup3(data[:44]) == int.from_bytes(data[44:48], "little")
    assert lookup3(b"") == 0xDEADBEEF
    assert lookup3(b"Four score and seven years ago") == 0x17770551  # published self-test of lookup3


def test_reads_back_everything(tmp_path):
    with open_run(write(tmp_path / "a.vtkhdf")) as run:
        assert len(run) == len(COUNTS) and run.scene_text == SCENE
        assert run.provenance == {"melt": "0.1.0", "seed": 3, "tolerance": 0.5}
        assert np.array_equal(run.times, 0.1 * np.arange(len(COUNTS))) and np.array_equal(run.counts, COUNTS)
        assert run.series["kinetic_energy"].tolist() == [2.0 * k for k in range(len(COUNTS))]
        assert run.series["liquid_count"].tolist() == COUNTS and run.series["liquid_count"].dtype == np.int64
        assert run.series_units == {
            "time": "s",
            "kinetic_energy": "J",
            "ms/density": "ms",
            "liquid_count": "1",
        }
        assert (
            run.units["velocity"] == "m/s"
            and run.units["temperature"] == "degC"
            and run.units["position"] == "m"
        )
        for k, n in enumerate(COUNTS):
            assert same(run.frame(k), particles(k, n)), k
        assert same(run.frame(-1), particles(len(COUNTS) - 1, COUNTS[-1]))
        assert set(run.frame(0, ["phase"])) == {"phase"}


@pytest.mark.parametrize("counts", [COUNTS, [0], [0, 0, 5], [4] * 9, [5, 4, 3, 2, 1, 0]])
def test_vtk_reads_every_step(tmp_path, counts):
    frames = vtk_frames(write(tmp_path / "a.vtkhdf", counts))
    times = [0.1 * k for k in range(len(counts))]
    assert [t for t, _ in frames] == (times if len(times) > 1 else [None])
    for k, (_, frame) in enumerate(frames):
        expected = particles(k, counts[k])
        assert all(np.array_equal(frame[name], expected[name]) for name in frame)
        assert counts[k] == 0 or set(frame) == set(expected)


def test_vtk_opens_a_run_without_frames(tmp_path):
    assert vtk_frames(write(tmp_path / "a.vtkhdf", [])) == []
    with open_run(tmp_path / "a.vtkhdf") as run:
        assert len(run) == 0 and run.scene_text == SCENE


def test_positions_in_double_precision(tmp_path):
    with RunWriter(tmp_path / "a.vtkhdf", "", {}) as writer:
        writer.append(0, particles(1, 20, np.float64))
    with open_run(tmp_path / "a.vtkhdf") as run:
        assert same(run.frame(0), particles(1, 20, np.float64))
    assert np.array_equal(
        vtk_frames(tmp_path / "a.vtkhdf")[0][1]["position"], particles(1, 20, np.float64)["position"]
    )


def test_many_chunks_make_a_deep_index(tmp_path):
    """64^2 chunks and more: an index of three levels, with full and partial nodes at its edge."""
    sizes = [1, 62, 1, 1, 4000, 30, 1, 1, 300]  # 64, 65 and 4096 chunks are crossed
    root, file = hdf5.Group(), hdf5.File(tmp_path / "a.h5", os.O_RDWR | os.O_CREAT)
    data = root.children["a"] = hdf5.Chunked(np.float32, (3,), 1)
    values = np.arange(3 * sum(sizes), dtype=np.float32).reshape(-1, 3)
    for size in sizes:
        data.append(file, values[data.rows : data.rows + size])
        file.commit(root)
        with h5py.File(tmp_path / "a.h5", locking=False) as f:
            assert np.array_equal(f["a"][:], values[: data.rows]), data.rows
            assert f["a"].id.get_num_chunks() == data.rows
    file.close()


def test_series_that_come_and_go(tmp_path):
    with RunWriter(tmp_path / "a.vtkhdf", "", {}) as writer:
        for k, series in enumerate(({"a_energy": 1.0}, {"n": 3}, {"a_energy": 2.0, "n": 4}, {})):
            writer.append(k, particles(k, 2), series)
    with open_run(tmp_path / "a.vtkhdf") as run:
        assert np.array_equal(run.series["a_energy"], [1, np.nan, 2, np.nan], equal_nan=True)
        assert run.series["n"].tolist() == [0, 3, 4, 0]
    assert series_unit("momentum_x") == "kg m/s" and series_unit("energy_error") == "1"


def test_existing_output_is_left_as_it_is(tmp_path):
    path = write(tmp_path / "a.vtkhdf")
    before = path.read_bytes()
    with pytest.raises(OutputError, match="exists already.*--overwrite"):
        RunWriter(path, SCENE, {})
    assert path.read_bytes() == before
    write(path, [3], overwrite=True)
    assert len(open_run(path)) == 1 and os.listdir(tmp_path) == ["a.vtkhdf"]


def test_missing_folder_and_no_permission(tmp_path, monkeypatch):
    with pytest.raises(OutputError, match="folder does not exist"):
        RunWriter(tmp_path / "no" / "a.vtkhdf", "", {})

    def refuse(*_):
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(hdf5.os, "open", refuse)  # tests may run as root, whom no folder refuses
    with pytest.raises(OutputError, match="no permission.*--out"):
        RunWriter(tmp_path / "a.vtkhdf", "", {})


@pytest.mark.parametrize(
    "change, message",
    [
        ({"temperature": np.zeros(3)}, "shape"),
        ({"velocity": np.zeros((3, 5))}, "shape"),
        ({"extra": np.zeros(5)}, "keeps the fields"),
        ({"phase": np.zeros(5, complex)}, "type"),
    ],
)
def test_refuses_frames_that_do_not_fit(tmp_path, change, message):
    with RunWriter(tmp_path / "a.vtkhdf", "", {}) as writer:
        writer.append(0, particles(0, 5))
        with pytest.raises(OutputError, match=message):
            writer.append(1, particles(0, 5) | change)
        with pytest.raises(OutputError, match="later"):
            writer.append(0, particles(0, 5))
        writer.append(1, particles(1, 5))
    assert same(open_run(tmp_path / "a.vtkhdf").frame(1), particles(1, 5))


def test_foreign_truncated_and_missing_files(tmp_path):
    path = write(tmp_path / "a.vtkhdf")
    data = path.read_bytes()
    cases = {
        "empty": b"",
        "text": b"hello" * 100,
        "short": data[:30],
        "half": data[: len(data) // 2],
        "tail": data[:-1],
    }
    for name, content in cases.items():
        (tmp_path / name).write_bytes(content)
        with pytest.raises(RunFileError) as error:
            open_run(tmp_path / name)
        assert name in str(error.value) and "\n" not in str(error.value), error.value
    with h5py.File(tmp_path / "foreign.h5", "w") as file:
        file["a"] = 1
    with pytest.raises(RunFileError, match="no run file of melt"):
        open_run(tmp_path / "foreign.h5")
    with pytest.raises(RunFileError, match="no such file"):
        open_run(tmp_path / "missing")
    with pytest.raises(RunFileError, match="6 frames"):
        open_run(path).frame(6)
    with pytest.raises(RunFileError, match="no field 'depth'.*temperature"):
        open_run(path).frame(0, ["depth"])


def datasets(path):
    with h5py.File(path) as file:
        found = {}
        file.visititems(
            lambda name, item: found.update({name: item[()]} if isinstance(item, h5py.Dataset) else {})
        )
        attrs = {}
        file.visititems(
            lambda name, item: attrs.update(
                {(name, k): np.asarray(v).tolist() for k, v in item.attrs.items()}
            )
        )
    return found, attrs


@pytest.mark.parametrize("keep", range(len(COUNTS) + 1))
def test_resumed_file_equals_an_uninterrupted_one(tmp_path, keep):
    whole, cut = write(tmp_path / "whole.vtkhdf"), write(tmp_path / "cut.vtkhdf")
    with RunWriter.resume(cut, frames=keep) as writer:
        assert writer.frames == keep
        assert len(open_run(cut)) == keep
        assert len(vtk_frames(cut)) == keep
        for k in range(keep, len(COUNTS)):
            n = COUNTS[k]
            writer.append(
                0.1 * k, particles(k, n), {"kinetic_energy": 2.0 * k, "ms/density": 0.5, "liquid_count": n}
            )
    (a, a_attrs), (b, b_attrs) = datasets(whole), datasets(cut)
    assert a.keys() == b.keys() and a_attrs == b_attrs
    for name in a:
        assert np.asarray(a[name]).tobytes() == np.asarray(b[name]).tobytes(), name
    assert len(vtk_frames(cut)) == len(COUNTS)


def test_cutting_gives_the_space_back(tmp_path):
    path = write(tmp_path / "a.vtkhdf", [5000] * 20)
    size = path.stat().st_size
    RunWriter.resume(path, frames=5).close()
    assert path.stat().st_size < 0.4 * size
    with open_run(path) as run:
        assert len(run) == 5 and same(run.frame(4), particles(4, 5000))


def test_resume_refuses_more_frames_than_there_are(tmp_path):
    path = write(tmp_path / "a.vtkhdf")
    with pytest.raises(RunFileError, match="6 frames"):
        RunWriter.resume(path, frames=7)
    assert len(open_run(path)) == 6


def test_metadata_do_not_pile_up(tmp_path):
    path = write(tmp_path / "a.vtkhdf", [0] * 400)
    assert path.stat().st_size < 400_000  # 8 areas; one per frame would be 8 MB


def test_heats_of_the_paper_law_are_no_joules():
    from melt.output.run_tables import series_unit

    assert series_unit("thermal_energy") == "J" and series_unit("thermal_energy", paper=True) == "K m^3"
    assert series_unit("kinetic_energy", paper=True) == "J"
