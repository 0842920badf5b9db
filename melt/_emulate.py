"""Run CUDA kernels on the host with real dtypes, at full problem size, thread after thread.

A kernel's Python function is given other globals in which ``cuda`` is a stand-in whose
``grid``, ``gridsize`` and ``atomic`` are compiled host functions; a compiled driver loops
over the threads. Unlike numba's simulator this type-checks the kernel and rounds in float32
where the device would. Kernels with barriers or shared memory cannot run this way; melt has
none. Threads run in order, so races do not show: one writer per element is law.
"""

import ctypes
import types

import llvmlite.binding as llvm
from llvmlite import ir
from numba import njit
from numba.core import types as nbtypes
from numba.extending import intrinsic

_SLOTS = (ctypes.c_int64 * 2)()  # current thread, number of threads
_SYMBOL = "melt_emulated_grid"
llvm.add_symbol(_SYMBOL, ctypes.addressof(_SLOTS))


def _slot(builder, k):
    module = builder.module
    try:
        variable = module.get_global(_SYMBOL)
    except KeyError:
        variable = ir.GlobalVariable(module, ir.ArrayType(ir.IntType(64), 2), _SYMBOL)
        variable.linkage = "external"
    index = ir.IntType(32)
    return builder.gep(variable, [index(0), index(k)])


def _getter(k):
    @intrinsic
    def get(typingctx):
        def codegen(context, builder, signature, args):
            return builder.load(_slot(builder, k))

        return nbtypes.int64(), codegen

    return get


def _setter(k):
    @intrinsic
    def put(typingctx, value):
        def codegen(context, builder, signature, args):
            builder.store(args[0], _slot(builder, k))
            return context.get_dummy_value()

        return nbtypes.void(nbtypes.int64), codegen

    return put


_thread, _threads = _getter(0), _getter(1)
_set_thread, _set_threads = _setter(0), _setter(1)


@njit
def _grid(ndim):
    return _thread()


@njit
def _gridsize(ndim):
    return _threads()


@njit
def _atomic_add(array, index, value):
    old = array[index]
    array[index] += value
    return old


@njit
def _atomic_max(array, index, value):
    old = array[index]
    if value > old:
        array[index] = value
    return old


@njit
def _atomic_min(array, index, value):
    old = array[index]
    if value < old:
        array[index] = value
    return old


cuda_standin = types.ModuleType("host_cuda")
cuda_standin.grid, cuda_standin.gridsize = _grid, _gridsize
cuda_standin.atomic = types.ModuleType("host_cuda.atomic")
cuda_standin.atomic.add = _atomic_add
cuda_standin.atomic.max = _atomic_max
cuda_standin.atomic.min = _atomic_min


#: Up to this many threads the loop over them runs in Python (4 microseconds a thread, measured),
#: which is quicker than compiling a loop around the kernel (0.1-0.2 s).
FEW = 5000


class emulate:  # noqa: N801  (used like a function)
    """``emulate(source)(threads, *arguments)`` runs the kernel ``source`` on host arrays.

    The compiled body is kept on disk, in a file named after the kernel's own function and checked
    against its source file; `melt._compile.source_hash` covers what it calls.
    """

    def __init__(self, source, cache=False):
        moved = types.FunctionType(
            source.__code__, {**source.__globals__, "cuda": cuda_standin}, source.__name__
        )
        moved.__qualname__ = f"{source.__qualname__}_on_host"
        moved.__module__ = source.__module__
        self.body = njit(error_model="numpy", cache=cache)(moved)
        self._driver = None

    def __call__(self, threads, *arguments):
        if threads > FEW:
            self._drive(threads, arguments)
            return
        _SLOTS[1] = threads
        body = self.body
        for t in range(threads):
            _SLOTS[0] = t
            body(*arguments)

    def _drive(self, threads, arguments):
        if self._driver is None:
            body = self.body

            @njit(error_model="numpy")
            def drive(threads, *args):
                _set_threads(threads)
                for t in range(threads):
                    _set_thread(t)
                    body(*args)

            self._driver = drive
        self._driver(threads, *arguments)
