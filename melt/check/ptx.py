"""Compile every CUDA kernel to PTX without a GPU, and report what ``ptxas`` says about it.

``cuda.compile`` needs only NVVM, but a call from a kernel into a compiled scalar asks for the
compute capability of the current device; a stand-in answers. Each kernel is lowered once for each
precision with the argument types that its stage launches it with, then compiled for every
capability. ``python -m melt.check.ptx`` writes ``docs/gpu.md``.
"""

import concurrent.futures
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import types
from typing import NamedTuple

import numba

from melt import _compile
from melt.check.compare import poisoned, stage_function
from melt.check.inputs import choices, make
from melt.stages import STAGES

CAPABILITIES = ((7, 5), (8, 0), (9, 0), (10, 0))
#: Warps and blocks that fit on a multiprocessor; it has 4 x 16384 registers, given to warps 256 at a time.
RESIDENT = {(7, 5): (32, 16), (8, 0): (64, 32), (9, 0): (64, 32), (10, 0): (64, 32)}

class Compiled(NamedTuple):
    """One kernel, precision and capability. Registers, spills and stack are None without ptxas."""

    kernel: str
    precision: str
    capability: tuple
    doubles: int  # double-precision instructions
    registers: int | None
    spills: int | None  # bytes stored and loaded
    stack: int | None  # bytes
    error: str = ""

    @property
    def occupancy(self):
        """Share of the warps that fit on a multiprocessor, by registers and blocks."""
        return None if self.registers is None else occupancy(self.registers, self.capability)


def why_not():
    """Return why kernels cannot be compiled here, or an empty string."""
    if _compile.CUDA_MISSING:
        return _compile.CUDA_MISSING
    if _compile.SIMULATED:
        return "the simulator replaces the compiler"
    try:
        from numba.cuda.cudadrv import nvvm

        nvvm.NVVM()
    except Exception as error:  # noqa: BLE001  (whatever keeps NVVM from loading)
        return f"NVVM cannot be loaded ({type(error).__name__}): pip install 'melt[toolchain]'"
    return ""


def ptxas():
    """Return the path of ptxas: that of the Python packages, which fits their NVVM, else that on PATH."""
    for folder in map(pathlib.Path, sys.path):
        for found in sorted(folder.glob("nvidia/*/bin/ptxas")):
            return str(found)
    return shutil.which("ptxas")


def name_of(kernel):
    """Return ``file.function`` of a kernel."""
    return f"{kernel.py_func.__module__.removeprefix('melt.cuda.')}.{kernel.py_func.__name__}"


def launches(stage, precision):
    """Return {(kernel, argument types)} of the launches of a stage, without running any.

    All variants of the stage's input are launched: some pick other kernels or other types.
    """
    found = {}

    def record(kernel, arguments):
        found[name_of(kernel), tuple(numba.typeof(a) for a in arguments)] = kernel

    before = _compile.Kernel.emulated, _compile.Kernel.recorder
    _compile.Kernel.emulated, _compile.Kernel.recorder = True, record
    try:
        for choice in choices(stage):
            arrays, params, _ = make(stage, precision, choice=choice)
            entry = STAGES[stage]
            given = {a: params[a] if a in entry.params else arrays[a] for a in entry.arguments}
            given.update({a: poisoned(arrays[a]) * 0 for a in entry.scratch if given[a].dtype.kind == "i"})
            stage_function(stage, "cuda")(*given.values())
    finally:
        _compile.Kernel.emulated, _compile.Kernel.recorder = before
    return found


def lower(kernel, argument_types, capability):
    """Return numba's code library of a kernel, from which PTX of any capability can be had."""
    from numba.cuda import compiler, dispatcher

    original = dispatcher.get_current_device
    dispatcher.get_current_device = lambda: types.SimpleNamespace(compute_capability=capability)
    try:
        library, _ = compiler._compile_pyfunc_with_fixup(
            kernel.py_func, argument_types, device=False, cc=capability, abi="numba"
        )
        return library
    finally:
        dispatcher.get_current_device = original


def double_instructions(text):
    """Return the instructions of a PTX text that use float64 in any way."""
    return re.findall(r"^\s+(?:@!?%p\d+\s+)?[a-z]\w*(?:\.\w+)*\.f64\b[^\n]*$", text, flags=re.M)


def assemble(text, capability, tool):
    """Return (registers, spilled bytes, stack bytes) that ptxas reports for one kernel."""
    with tempfile.NamedTemporaryFile("w", suffix=".ptx") as file:
        file.write(text)
        file.flush()
        arch = f"sm_{capability[0]}{capability[1]}"
        done = subprocess.run(
            [tool, "-v", f"-arch={arch}", file.name, "-o", "/dev/null"], capture_output=True, text=True
        )
    if done.returncode:
        raise RuntimeError(f"ptxas: {done.stderr.strip().splitlines()[0]}")
    log = done.stderr + done.stdout
    registers = max(int(r) for r in re.findall(r"Used (\d+) registers", log))
    spills = sum(int(b) for b in re.findall(r"(\d+) bytes spill (?:stores|loads)", log))
    stack = max([int(b) for b in re.findall(r"(\d+) bytes stack frame", log)], default=0)
    return registers, spills, stack


def occupancy(registers, capability, block=128):
    """Return resident warps / possible warps of a kernel without shared memory."""
    warps, blocks = RESIDENT[capability]
    per_warp = -(-max(registers, 1) * 32 // 256) * 256
    by_registers = 4 * (16384 // per_warp) * 32 // block
    return min(blocks, warps * 32 // block, by_registers) * (block // 32) / warps


def compile_stage(stage, precision, capabilities=CAPABILITIES, assembled=True, only=None):
    """Return a `Compiled` for each kernel, set of types and capability of a stage.

    ``only``: names of launches to compile (`assignment`), None for all.
    """
    tool = ptxas() if assembled else None
    rows = []
    for (name, argument_types), kernel in launches(stage, precision).items():
        if only is not None and _key(name, argument_types) not in only:
            continue
        try:
            library = lower(kernel, argument_types, capabilities[0])
        except Exception as error:  # noqa: BLE001  (a kernel that does not compile belongs in the report)
            lines = [line for line in str(error).splitlines() if line.strip()]
            what = f"{type(error).__name__}: {lines[0]}"
            rows.append(Compiled(name, precision, capabilities[0], 0, None, None, None, what))
            continue
        for capability in capabilities:
            text = "\n".join(library.get_asm_strs(cc=capability))
            numbers = assemble(text, capability, tool) if tool else (None, None, None)
            rows.append(Compiled(name, precision, capability, len(double_instructions(text)), *numbers))
    return rows


def _key(name, argument_types):
    return f"{name}({', '.join(map(str, argument_types))})"


def assignment(precision):
    """Return {stage: launches that no earlier stage makes}: shared kernels are compiled once."""
    seen, found = set(), {}
    for stage in STAGES:
        keys = {_key(*launch) for launch in launches(stage, precision)}
        found[stage] = keys - seen
        seen |= keys
    return {stage: keys for stage, keys in found.items() if keys}


def _job(task):
    return compile_stage(*task)


def compile_all(precision="single", capabilities=CAPABILITIES, assembled=True, workers=2):
    """Return the rows of all stages, compiled in ``workers`` processes."""
    tasks = [
        (stage, precision, capabilities, assembled, keys) for stage, keys in assignment(precision).items()
    ]
    with concurrent.futures.ProcessPoolExecutor(workers) as pool:
        return [row for rows in pool.map(_job, tasks) for row in rows]


def _table(rows, capabilities):
    """Return lines of a Markdown table, one kernel a line, the worst of its argument types."""
    heads = " | ".join(f"{a}.{b}" for a, b in capabilities)
    lines = [
        f"| kernel | f64 | registers {heads} | spilled bytes | stack | occupancy {heads} |",
        "|---" * (4 + 2 * len(capabilities)) + "|",
    ]
    for kernel in sorted({row.kernel for row in rows}):
        own = {c: [r for r in rows if r.kernel == kernel and r.capability == c] for c in capabilities}
        every = [r for found in own.values() for r in found]
        registers = " | ".join(str(max(r.registers for r in own[c])) for c in capabilities)
        occupied = " | ".join(f"{100 * min(r.occupancy for r in own[c]):.0f} %" for c in capabilities)
        lines.append(
            f"| `{kernel}` | {max(r.doubles for r in every)} | {registers} | "
            f"{max(r.spills for r in every)} | "
            f"{max(r.stack for r in every)} | {occupied} |"
        )
    return lines


def document(single, double, double_capability=(9, 0)):
    """Return the text of docs/gpu.md."""
    kernels = {row.kernel for row in single}
    spilling = sorted({r.kernel for r in single if r.spills})
    return "\n".join(
        [
            "# CUDA kernels, seen from a machine without a GPU",
            "",
            "Generated by `python -m melt.check.ptx`: every kernel is compiled by NVVM with the argument",
            "types its stage launches it with, and assembled by `ptxas` for each compute capability.",
            "Nothing here was measured on a device, and nothing here is a time.",
            "",
            f"numba {numba.__version__}, {_ptxas_version()}. {len(kernels)} kernels. "
            f"Double-precision instructions in single precision: {sum(r.doubles for r in single)}. "
            f"Kernels that spill in single precision: {', '.join(f'`{k}`' for k in spilling) or 'none'}.",
            "",
            "Occupancy is theoretical: blocks of 128 threads, limited by registers and by blocks.",
            "",
            "## Single precision",
            "",
            *_table(single, CAPABILITIES),
            "",
            "## Double precision",
            "",
            *_table(double, (double_capability,)),
            "",
        ]
    )


def _ptxas_version():
    done = subprocess.run([ptxas(), "--version"], capture_output=True, text=True)
    return "ptxas " + re.search(r"release ([\d.]+)", done.stdout)[1]


def main(path="docs/gpu.md"):
    """Write the report; return 1 if a kernel does not compile or uses float64 in single precision."""
    obstacle = why_not() or ("" if ptxas() else "ptxas is not installed: pip install 'melt[toolchain]'")
    if obstacle:
        raise SystemExit(obstacle)
    single, double = compile_all("single"), compile_all("double", ((9, 0),))
    failed = [row for row in single + double if row.error]
    for row in failed:
        print(f"{row.kernel} ({row.precision}): {row.error}", file=sys.stderr)
    wide = {row.kernel for row in single if row.doubles}
    for kernel in sorted(wide):
        print(f"{kernel}: double-precision instructions in single precision", file=sys.stderr)
    good = [[row for row in rows if not row.error] for rows in (single, double)]
    pathlib.Path(path).write_text(document(*good))
    return 1 if failed or wide else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
