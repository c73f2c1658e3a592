"""Vectors of sixteen numbers (SIMD) for numba: what the encoder's kernel is written in.

LLVM does not vectorise numba's own loops over sixteen filters well: they were ten times slower. So
vectors are a type here, and `load`, `add` and the like are single LLVM instructions on them, which
LLVM splits where a processor's vectors are narrower.

Imports numba: only kernels may import this module.
"""

# An intrinsic's arguments are numba types during typing and LLVM values during lowering.
# ruff: noqa: ANN001, ANN201, ANN202

from __future__ import annotations

from typing import Any

from llvmlite import ir
from numba import extending
from numba.core import cgutils, types
from numba.extending import models, register_model

LANES = 16
"""Numbers per vector: the filters of the first convolution."""

intrinsic: Any = extending.intrinsic
"""numba's decorator; the decorated function is called without its first, the typing context."""

_FLOAT, _INTEGER = ir.FloatType(), ir.IntType(32)


class FloatLanes(types.Type):
    """Sixteen float32."""

    def __init__(self) -> None:
        super().__init__(name="FloatLanes")


class IntegerLanes(types.Type):
    """Sixteen int32."""

    def __init__(self) -> None:
        super().__init__(name="IntegerLanes")


@register_model(FloatLanes)
class _FloatModel(models.PrimitiveModel):
    def __init__(self, manager, kind) -> None:
        super().__init__(manager, kind, ir.VectorType(_FLOAT, LANES))


@register_model(IntegerLanes)
class _IntegerModel(models.PrimitiveModel):
    def __init__(self, manager, kind) -> None:
        super().__init__(manager, kind, ir.VectorType(_INTEGER, LANES))


floats, integers = FloatLanes(), IntegerLanes()


@intrinsic
def load(_typing, table, offset):
    """Load sixteen numbers of a flat float32 array, from `offset` on."""

    def lower(context, builder, signature, values):
        where = address(context, builder, signature.args[0], values[0], values[1])
        return builder.load(as_vector(builder, where), align=4)

    return floats(table, types.intp), lower


@intrinsic
def load_integers(_typing, table, offset):
    """Load sixteen numbers of a flat int32 array, from `offset` on."""

    def lower(context, builder, signature, values):
        where = address(context, builder, signature.args[0], values[0], values[1])
        kind = ir.VectorType(_INTEGER, LANES).as_pointer()
        return builder.load(builder.bitcast(where, kind), align=4)

    return integers(table, types.intp), lower


@intrinsic
def store(_typing, table, offset, vector):
    """Store sixteen numbers in a flat array, from `offset` on."""

    def lower(context, builder, signature, values):
        where = address(context, builder, signature.args[0], values[0], values[1])
        builder.store(values[2], builder.bitcast(where, values[2].type.as_pointer()), align=4)
        return context.get_dummy_value()

    return types.void(table, types.intp, vector), lower


@intrinsic
def splat(_typing, number):
    """Broadcast a float32 to all lanes."""

    def lower(_context, builder, _signature, values):
        return spread(builder, values[0])

    return floats(types.float32), lower


@intrinsic
def splat_integer(_typing, number):
    """Broadcast an int32 to all lanes."""

    def lower(_context, builder, _signature, values):
        return spread(builder, values[0])

    return integers(types.int32), lower


@intrinsic
def add(_typing, left, right):
    """Add lane by lane."""
    return floats(floats, floats), lambda _c, builder, _s, values: builder.fadd(*values)


@intrinsic
def subtract(_typing, left, right):
    """Subtract lane by lane."""
    return floats(floats, floats), lambda _c, builder, _s, values: builder.fsub(*values)


@intrinsic
def divide(_typing, left, right):
    """Divide lane by lane."""
    return floats(floats, floats), lambda _c, builder, _s, values: builder.fdiv(*values)


@intrinsic
def multiply_add(_typing, left, right, addend):
    """Compute left * right + addend lane by lane, rounded once where the processor can."""

    def lower(_context, builder, _signature, values):
        return fused(builder, *values)

    return floats(floats, floats, floats), lower


@intrinsic
def larger(_typing, left, right):
    """The larger of two, lane by lane."""

    def lower(_context, builder, _signature, values):
        left, right = values
        return builder.select(builder.fcmp_ordered(">", left, right), left, right)

    return floats(floats, floats), lower


@intrinsic
def where_larger(_typing, left, right, yes, no):
    """`yes` in the lanes where left > right, `no` elsewhere."""

    def lower(_context, builder, _signature, values):
        left, right, yes, no = values
        return builder.select(builder.fcmp_ordered(">", left, right), yes, no)

    return yes(floats, floats, yes, yes), lower


@intrinsic
def equal(_typing, left, right):
    """In which lanes two vectors are equal: uint16, a bit per lane."""

    def lower(_context, builder, _signature, values):
        return builder.bitcast(builder.fcmp_ordered("==", *values), ir.IntType(LANES))

    return types.uint16(floats, floats), lower


@intrinsic
def where_set(_typing, bits, yes, no):
    """`yes` in the lanes whose bit is set, `no` elsewhere."""

    def lower(_context, builder, _signature, values):
        bits, yes, no = values
        lanes = builder.bitcast(bits, ir.VectorType(ir.IntType(1), LANES))
        return builder.select(lanes, yes, no)

    return floats(types.uint16, floats, floats), lower


@intrinsic
def differs(_typing, left, right):
    """Whether two vectors differ in any lane."""

    def lower(_context, builder, _signature, values):
        lanes = builder.bitcast(builder.fcmp_unordered("!=", *values), ir.IntType(LANES))
        return builder.icmp_unsigned("!=", lanes, lanes.type(0))

    return types.boolean(floats, floats), lower


def address(context, builder, kind, array, offset):
    """Address of the element at `offset` of an array."""
    return builder.gep(context.make_array(kind)(context, builder, array).data, [offset])


def as_vector(builder, where):
    """The same address as a pointer to sixteen float32."""
    return builder.bitcast(where, ir.VectorType(_FLOAT, LANES).as_pointer())


def spread(builder, number):
    """Broadcast a number to all lanes."""
    kind = ir.VectorType(number.type, LANES)
    first = builder.insert_element(ir.Constant(kind, ir.Undefined), number, _INTEGER(0))
    return builder.shuffle_vector(
        first, ir.Constant(kind, ir.Undefined), ir.Constant(ir.VectorType(_INTEGER, LANES), None)
    )


def fused(builder, left, right, addend):
    """Write the instruction for left * right + addend."""
    kind = ir.VectorType(_FLOAT, LANES)
    signature = ir.FunctionType(kind, [kind] * 3)
    name = f"llvm.fmuladd.v{LANES}f32"
    function = cgutils.get_or_insert_function(builder.module, signature, name)
    return builder.call(function, [left, right, addend])
