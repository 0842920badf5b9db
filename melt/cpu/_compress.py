"""Sixteen candidates at a time, the hits packed by AVX-512. Used by `melt.cpu.neighbours` and `melt.cpu.flood_neighbours`.

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


def _pack(context, builder, array_type, array, total, values, hit):
    """Append the values whose lane is a hit to an int32 array from ``total`` on, and count them there."""
    module = builder.module
    pack = cgutils.get_or_insert_function(
        module, ir.FunctionType(_vector(_I32), [_vector(_I32), _vector(_I1), _vector(_I32)]),
        f"llvm.experimental.vector.compress.v{LANES}i32")
    ones = cgutils.get_or_insert_function(module, ir.FunctionType(_I16, [_I16]), "llvm.ctpop.i16")
    packed = builder.call(pack, [values, hit, ir.Constant(_vector(_I32), ir.Undefined)])
    count = builder.load(total)
    builder.store(packed, _at(context, builder, array_type, array, count, _I32), align=4)
    hits = builder.call(ones, [builder.bitcast(hit, _I16)])
    builder.store(builder.add(count, builder.zext(hits, _I64)), total)


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
        lanes = ir.Constant(_vector(_I32), list(range(LANES)))
        centre = [_splat(builder, value) for value in args[4:7]]
        limit = _splat(builder, args[7])
        total = cgutils.alloca_once_value(builder, _I64(0))
        with cgutils.for_range_slice(builder, _I64(0), args[3], _I64(LANES)) as (k, _):
            squares = _squared_distances(context, builder, sig, args, k, centre)
            hit = builder.fcmp_ordered("<", squares, limit)
            slots = builder.add(_splat(builder, builder.trunc(k, _I32)), lanes)
            _pack(context, builder, sig.args[8], args[8], total, slots, hit)
        return builder.load(total)

    return signature, codegen


def _masked(context, builder, array_type, array, k, mask):
    """Return elements k .. k+15 of an array where the mask is set: nothing is read behind its end."""
    element = context.get_value_type(array_type.dtype)
    kind, bits = ("f" if isinstance(array_type.dtype, types.Float) else "i"), array_type.dtype.bitwidth
    pointer = _at(context, builder, array_type, array, k, element)
    load = cgutils.get_or_insert_function(
        builder.module,
        ir.FunctionType(_vector(element), [pointer.type, _I32, _vector(_I1), _vector(element)]),
        f"llvm.masked.load.v{LANES}{kind}{bits}.p0")
    return builder.call(load, [pointer, _I32(bits // 8), mask, ir.Constant(_vector(element), None)])


def _narrow(builder, value, real):
    return value if value.type == _vector(real) else builder.fptrunc(value, _vector(real))


def _larger(builder, first, second):
    """Return the larger of two vectors; the second where the first is NaN."""
    return builder.select(builder.fcmp_ordered(">", first, second), first, second)


def _below(builder, squares, limit):
    """Return where dx^2 + dy^2 < limit, as `squared_in_plane` rounds it."""
    total = builder.fadd(builder.fmul(squares[0], squares[0]), builder.fmul(squares[1], squares[1]))
    return builder.fcmp_ordered("<", total, limit)


@intrinsic
def append_near_box(typingctx, x, y, h, phase, start, stop, low_x, high_x, low_y, high_y, own, growth, found, count):
    """Append those k in [start, stop) to ``found`` from ``count`` on that may be near a column of a box; return the new count.

    Near: of phase 0 and closer than sqrt(max(own, (growth h[k])^2)) to the box. ``start``, ``stop``, ``count``
    are int64; ``found`` (int32) has room for 16 more elements than there may be.
    """
    signature = types.int64(
        x, y, h, phase, types.int64, types.int64, x.dtype, x.dtype, x.dtype, x.dtype, h.dtype, h.dtype, found, types.int64)

    def codegen(context, builder, sig, args):
        real = context.get_value_type(sig.args[2].dtype)
        zero, lanes = ir.Constant(_vector(real), None), ir.Constant(_vector(_I32), list(range(LANES)))
        edges = [_splat(builder, value) for value in args[6:10]]
        own_limit, factor = _splat(builder, args[10]), _splat(builder, args[11])
        total = cgutils.alloca_once_value(builder, args[13])
        last = _splat(builder, builder.trunc(args[5], _I32))
        with cgutils.for_range_slice(builder, args[4], args[5], _I64(LANES)) as (k, _):
            slots = builder.add(_splat(builder, builder.trunc(k, _I32)), lanes)
            mask = builder.icmp_signed("<", slots, last)
            apart = []
            for a in range(2):
                at = _masked(context, builder, sig.args[a], args[a], k, mask)
                below = _narrow(builder, builder.fsub(edges[2 * a], at), real)
                above = _narrow(builder, builder.fsub(at, edges[2 * a + 1]), real)
                apart.append(_larger(builder, above, _larger(builder, below, zero)))
            reach = builder.fmul(factor, _masked(context, builder, sig.args[2], args[2], k, mask))
            reach = _larger(builder, reach, zero)
            limit = _larger(builder, builder.fmul(reach, reach), own_limit)
            kind = _masked(context, builder, sig.args[3], args[3], k, mask)
            water = builder.icmp_signed("==", kind, ir.Constant(kind.type, None))
            hit = builder.and_(builder.and_(mask, water), _below(builder, apart, limit))
            _pack(context, builder, sig.args[12], args[12], total, slots, hit)
        return builder.load(total)

    return signature, codegen


@intrinsic
def append_in_reach(typingctx, x, y, reach, number, stop, x_i, y_i, own, found):
    """Write number[k] of the k < stop with (x_i - x[k])^2 + (y_i - y[k])^2 < max(own, reach[k]) to ``found``; return how many.

    stop is a multiple of 16 (int64); arrays are contiguous; ``found`` (int32) has room for ``stop`` + 16 elements.
    """
    signature = types.int64(x, y, reach, number, types.int64, x.dtype, x.dtype, reach.dtype, found)

    def codegen(context, builder, sig, args):
        wide, real = (context.get_value_type(sig.args[a].dtype) for a in (0, 2))
        centre, own_limit = [_splat(builder, value) for value in args[5:7]], _splat(builder, args[7])
        total = cgutils.alloca_once_value(builder, _I64(0))

        def read(a, k, element):
            source = _at(context, builder, sig.args[a], args[a], k, element)
            return builder.load(source, align=sig.args[a].dtype.bitwidth // 8)

        with cgutils.for_range_slice(builder, _I64(0), args[4], _I64(LANES)) as (k, _):
            apart = [_narrow(builder, builder.fsub(centre[a], read(a, k, wide)), real) for a in range(2)]
            hit = _below(builder, apart, _larger(builder, read(2, k, real), own_limit))
            _pack(context, builder, sig.args[8], args[8], total, read(3, k, _I32), hit)
        return builder.load(total)

    return signature, codegen
