"""Capsules: the inputs of one call of a stage in one HDF5 file, to be replayed anywhere (`melt.check.replay`).

Layout::

    /                    attributes: kind, version, stage, step, time, alarm, backend, precision, versions, digest ...
    /arrays/NAME         what the stage was given, by argument; what it only writes has a shape and no contents
    /outputs/NAME        what it wrote in the run
    /params/NAME         attributes of a tuple (``type`` names it in `melt.params`), or one number
    /scales              attributes: natural scales of fields, for the tolerances
    /scene               the scene as run (TOML)

Compiled code looks at no bounds: a capsule whose checksum is wrong is refused.
"""

import hashlib
import pathlib
from typing import NamedTuple

import h5py
import numpy as np

from melt import params as tuples
from melt.output.errors import RunFileError, read_error
from melt.output.provenance import provenance
from melt.output.whole import write_whole
from melt.stages import STAGES

KIND, VERSION = "melt capsule", 1


class Capsule(NamedTuple):
    """What a capsule holds."""

    stage: str
    arrays: dict  # argument -> array
    params: dict  # argument -> tuple or number
    outputs: dict  # argument -> array, of the run
    scales: dict  # kind of field -> natural scale
    facts: dict  # name -> text or number


def beside(run_path):
    """Return where the capsule of a run file is: ``NAME.vtkhdf.capsule.h5``."""
    return pathlib.Path(f"{run_path}.capsule.h5")


def write(path, found, scales, scene, **facts):
    """Write the capsule of a `melt.watch.hunt.Culprit` in a run of ``scene`` (TOML); return its size [bytes].

    Raises:
        OutputError: a full disk, no permission; an older capsule stays then.
    """
    stage = STAGES[found.stage]
    # what is only written matters by its shape: nothing of it is stored
    unread = [n for n in stage.writes if n not in stage.reads and not stage.partial]
    arrays = {n: np.zeros_like(a) if n in unread else a for n, a in found.arrays.items()}
    facts = {
        **provenance(facts.pop("backend"), facts.pop("precision")),
        "stage": found.stage, "field": found.field, "index": list(found.index), "call": found.call, "step": found.step, "time": found.time,
        **facts,
    }  # fmt: skip
    packed = {"compression": "gzip", "compression_opts": 4, "shuffle": True}
    # made in memory, so that a full disk is met by one plain write
    with h5py.File("capsule", "w", driver="core", backing_store=False) as file:
        file.attrs.update(kind=KIND, version=VERSION, digest=_digest(found.stage, arrays, found.params, found.outputs), **facts)
        for folder, given in (("arrays", arrays), ("outputs", found.outputs)):
            group = file.create_group(folder)
            for name, array in given.items():
                group.create_dataset(name, data=array, **(packed if array.size else {}))
        group = file.create_group("params")
        for name, value in found.params.items():
            if hasattr(value, "_asdict"):
                group.create_group(name).attrs.update(type=type(value).__name__, **value._asdict())
            else:
                group[name] = value
        file.create_group("scales").attrs.update(scales)
        file["scene"] = scene
        file.flush()
        image = file.id.get_file_image()
    write_whole(path, image)
    return len(image)


def read(path):
    """Return the `Capsule` in a file.

    Raises:
        RunFileError: there is none, it is damaged, it is something else, or of another version of melt.
    """
    try:
        open(path, "rb").close()
    except OSError as error:
        raise read_error("open capsule", path, error) from error
    try:
        with h5py.File(path, "r") as file:
            facts = {name: _plain(value) for name, value in file.attrs.items()}
            if facts.get("kind") != KIND:
                raise RunFileError(f"{path} is no capsule of melt: a run that ends in an alarm writes one beside its run file.")
            _of_this_version(path, facts)
            found = Capsule(
                facts["stage"],
                {name: item[()] for name, item in file["arrays"].items()},
                {name: _param(item) for name, item in file["params"].items()},
                {name: item[()] for name, item in file["outputs"].items()},
                {name: float(value) for name, value in file["scales"].attrs.items()},
                facts,
            )
    except (OSError, KeyError, TypeError, ValueError, AttributeError, RuntimeError) as error:
        if isinstance(error, RunFileError):
            raise
        remedy = "it was damaged or is another kind of file; copy it again"
        raise RunFileError(f"{path} cannot be read as a capsule ({error}): {remedy}.") from error
    if _digest(*found[:4]) != facts.get("digest"):
        raise RunFileError(f"capsule {path} is damaged: its checksum is wrong. Copy it again, or repeat the run.")
    return found


def _of_this_version(path, facts):
    stage = STAGES.get(facts.get("stage"))
    if facts.get("version") != VERSION or stage is None or facts.get("arguments", "").split() != list(stage.arguments):
        raise RunFileError(
            f"capsule {path} was written by melt {facts.get('melt', 'of unknown version')} (commit {facts.get('commit', 'unknown')}), "
            f"whose stage {facts.get('stage')!r} is not the one of this version: replay it there."
        )


def _plain(value):
    return value.item() if isinstance(value, np.generic) else value.tolist() if isinstance(value, np.ndarray) else value


def _param(item):
    """Return a parameter: a tuple of `melt.params`, or a number."""
    if not isinstance(item, h5py.Group):
        return item[()]
    values = dict(item.attrs)
    return getattr(tuples, values.pop("type"))(**values)


def _digest(stage, arrays, params, outputs):
    """Return a checksum of all that a replay is given."""
    digest = hashlib.blake2b(stage.encode(), digest_size=16)
    for given in (arrays, outputs):
        for name in sorted(given):
            array = np.ascontiguousarray(given[name])
            digest.update(f"{name} {array.dtype.str} {array.shape}".encode() + array.tobytes())
    for name in sorted(params):
        values = params[name] if hasattr(params[name], "_asdict") else (params[name],)
        digest.update(f"{name} {type(params[name]).__name__}".encode() + b"".join(np.asarray(v).tobytes() for v in values))
    return digest.hexdigest()
