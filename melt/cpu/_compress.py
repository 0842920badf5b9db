"""Sixteen candidates at a time, the hits packed by AVX-512. Used by `melt.cpu.neighbours`.

The loop vectoriser cannot pack hits, hence LLVM instructions by hand. They round exactly as
the portable loop: subtract in the precision of the positions, round to that of the support,
x x + y y + z z without fused operations. Packing in a register and storing all of it beats
a compressing store (which Zen 4 does in microcode).
"""

import llvmlite.binding as llvm
from llvmlite import ir
from numba.core import cgutils, types
from numba.core.registry import cpu_target
from numba.extending import intrinsic

LANES = 16
#: What numba compiles for (NUMBA_CPU_FEATURES counts), not what the machine could do.
#: llvm.experimental.vector.compress exists since LLVM 20.
AVAILABLE = (
    "+avx512f" in str(cpu_target.target_context.codegen().magic_tuple())
    and llvm.llvm_version_info[0] >= 20
)

_I1, _I16, _I32, _I64 = (ir.IntType(bits) for bits in (1, 16, 32, 64))


def _vector(element):
    return ir.VectorType(element, LANES)


def _splat(builder, value):
    start = builder.insert_element(ir.Constant(_vector(value.type), ir.Undefined), value, _I32(0))
    return builder.shuffle_vector(start, start, ir.Constant(_vector(_I32), [0] * LANES))


def _at(context, builder, array_type, array, k, element):
    """Return a pointer to 16 elements of an array from k on."""
    data = context.make_array(array_type)(context, builder, array).data
    return builder.bitcast(builder.gep(data, [k]), _vector(element).as_pointer())


def _squared_distances(context, builder, sig, args, k, centre):
    """Return 16 squared distances of the candidates from k on, in the precision of h2."""
    wide = context.get_value_type(sig.args[0].dtype)
    real = context.get_value_type(sig.args[7])
    total = None
    for a in range(3):
        source = _at(context, builder, sig.args[a], args[a], k, wide)
        d = builder.fsub(centre[a], builder.load(source, align=sig.args[a].dtype.bitwidth // 8))
        if wide != real:
            d = builder.fptrunc(d, _vector(real))
        d = builder.fmul(d, d)
        total = d if total is None else builder.fadd(total, d)
    return total


@intrinsic
def append_near(typingctx, x, y, z, stop, x_i, y_i, z_i, h2, found):
    """Write the k < stop with (x_i - x[k])^2 + ... < h2 to ``found``, return their number.

    stop is a multiple of 16 (int64); x, y, z are contiguous; ``found`` (int32) has room for
    ``stop`` + 16 elements.
    """
    signature = types.int64(x, y, z, types.int64, x.dtype, x.dtype, x.dtype, h2, found)

    def codegen(context, builder, sig, args):
        module = builder.module
        lanes = ir.Constant(_vector(_I32), list(range(LANES)))
        pack = cgutils.get_or_insert_function(
            module, ir.FunctionType(_vector(_I32), [_vector(_I32), _vector(_I1), _vector(_I32)]),
            f"llvm.experimental.vector.compress.v{LANES}i32")
        ones = cgutils.get_or_insert_function(module, ir.FunctionType(_I16, [_I16]), "llvm.ctpop.i16")
        centre = [_splat(builder, value) for value in args[4:7]]
        limit = _splat(builder, args[7])
        total = cgutils.alloca_once_value(builder, _I64(0))
        with cgutils.for_range_slice(builder, _I64(0), args[3], _I64(LANES)) as (k, _):
            squares = _squared_distances(context, builder, sig, args, k, centre)
            hit = builder.fcmp_ordered("<", squares, limit)
            slots = builder.add(_splat(builder, builder.trunc(k, _I32)), lanes)
            packed = builder.call(pack, [slots, hit, ir.Constant(_vector(_I32), ir.Undefined)])
            count = builder.load(total)
            builder.store(packed, _at(context, builder, sig.args[8], args[8], count, _I32), align=4)
            hits = builder.call(ones, [builder.bitcast(hit, _I16)])
            builder.store(builder.add(count, builder.zext(hits, _I64)), total)
        return builder.load(total)

    return signature, codegen
