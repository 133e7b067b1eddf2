"""`LANES` doubles that compiled code handles as one value: loaded, computed with and stored by SIMD instructions.

Numba leaves it to LLVM whether a loop over a few lanes becomes vector code, and arrays that might overlap prevent it.
Here the vector is a type of its own, so that a kernel that reads like one for one simulation advances `LANES` of them,
whatever the width of the processor's registers. Products and sums may be contracted to fused operations. The functions
of `palpate.materials.flow.arithmetic` are implemented for vectors here.
"""

from __future__ import annotations

import operator
from collections.abc import Callable
from typing import Any

import llvmlite.ir as ir
from numba import njit, types
from numba.core import cgutils
from numba.core.datamodel import PrimitiveModel
from numba.extending import intrinsic, lower_builtin, overload, register_model, type_callable

from palpate.materials.flow import arithmetic
from palpate.materials.flow.arithmetic import (
    exponential,
    greatest,
    log_of_one_plus,
    logarithm,
    magnitude,
    root,
    rough_log,
    where_less,
)

LANES = 8  # doubles of the widest registers in use
__all__ = [
    "LANES", "VECTOR", "Vector", "exponential", "greatest", "larger", "load", "log_of_one_plus", "logarithm",
    "magnitude", "root", "rough_log", "smaller", "splat", "store", "where_less",
]  # fmt: skip

_DOUBLES = ir.VectorType(ir.DoubleType(), LANES)
_INTEGERS = ir.VectorType(ir.IntType(64), LANES)
_ROUND = 1.5 * 2.0**52  # added and taken away again, it rounds to a whole number, which its lowest bits then hold
_LOG2_E = 1.4426950408889634
_LN2_HIGH, _LN2_LOW = 6.93147180369123816490e-01, 1.90821492927058770002e-10
_INVERSE_FACTORIALS = (
    1.0, 1.0, 1 / 2, 1 / 6, 1 / 24, 1 / 120, 1 / 720, 1 / 5040, 1 / 40320, 1 / 362880, 1 / 3628800, 1 / 39916800,
    1 / 479001600,
)  # fmt: skip


class Vector(types.Type):
    """Type of `LANES` doubles in compiled code."""

    def __init__(self) -> None:
        super().__init__(name=f"Vector{LANES}")


VECTOR = Vector()


@register_model(Vector)
class _VectorModel(PrimitiveModel):
    def __init__(self, manager, fe_type):
        super().__init__(manager, fe_type, _DOUBLES)


def _instruction(generator: Callable[..., Any]) -> Any:
    """Make an intrinsic of a function that types and generates an instruction; type checkers see no more."""
    return intrinsic(generator)


def _constant(value: float) -> ir.Constant:
    return ir.Constant(_DOUBLES, [value] * LANES)


def _integers(value: int) -> ir.Constant:
    return ir.Constant(_INTEGERS, [value] * LANES)


def _row(context, builder, array_type, array, index):
    """Return the pointer to row `index` of an array of rows of `LANES` doubles."""
    data = context.make_array(array_type)(context, builder, array).data
    start = builder.mul(index, ir.Constant(index.type, LANES))
    return builder.bitcast(builder.gep(data, [start]), _DOUBLES.as_pointer())


def _spread(context, builder, kind, value):
    """Return a vector as it is, and for a number the vector whose lanes all hold it."""
    if isinstance(kind, Vector):
        return value
    value = context.cast(builder, value, kind, types.float64)
    first = builder.insert_element(ir.Constant(_DOUBLES, ir.Undefined), value, ir.Constant(ir.IntType(32), 0))
    order = ir.Constant(ir.VectorType(ir.IntType(32), LANES), [0] * LANES)
    return builder.shuffle_vector(first, ir.Constant(_DOUBLES, ir.Undefined), order)


@_instruction
def load(typing_context, array, index):
    """Return row `index` (counting rows of `LANES`) of a contiguous array of doubles."""

    def generate(context, builder, signature, arguments):
        position = context.cast(builder, arguments[1], signature.args[1], types.intp)
        return builder.load(_row(context, builder, signature.args[0], arguments[0], position), align=8)

    return VECTOR(array, index), generate


@_instruction
def store(typing_context, array, index, value):
    """Write `value` to row `index` of a contiguous array of doubles.

    The `typing_context` is that of numba.
    """

    def generate(context, builder, signature, arguments):
        position = context.cast(builder, arguments[1], signature.args[1], types.intp)
        pointer = _row(context, builder, signature.args[0], arguments[0], position)
        builder.store(arguments[2], pointer, align=8)
        return context.get_dummy_value()

    return types.void(array, index, value), generate


@_instruction
def splat(typing_context, scalar):
    """Return a vector whose lanes all hold a double."""

    def generate(context, builder, signature, arguments):
        return _spread(context, builder, signature.args[0], arguments[0])

    return VECTOR(scalar), generate


def _typed(operation: Callable[..., Any], result: Callable[..., Any]) -> None:
    """Give the type of an operation's result in compiled code, of those of its operands: None where it is not ours.

    numba finds the number of operands in the signature of `result`.
    """
    type_callable(operation)(lambda context: result)


def _of_vectors(*operands):
    """Return the type of what vectors alone give."""
    return VECTOR if all(isinstance(operand, Vector) for operand in operands) else None


def _operator(operation: Callable[..., Any], name: str) -> None:
    """Let an operator of Python act on vectors, and on a vector and a number, by the instruction of that name."""

    def generate(context, builder, signature, arguments):
        operands = zip(signature.args, arguments, strict=True)
        vectors = [_spread(context, builder, kind, value) for kind, value in operands]
        return getattr(builder, name)(*vectors, flags=("contract",))

    kinds = ((Vector, Vector), (Vector, types.Number), (types.Number, Vector))

    def result(a, b):
        return VECTOR if any(isinstance(a, left) and isinstance(b, right) for left, right in kinds) else None

    _typed(operation, result)
    for left, right in kinds:
        lower_builtin(operation, left, right)(generate)


for _operation, _name in (
    (operator.add, "fadd"),
    (operator.sub, "fsub"),
    (operator.mul, "fmul"),
    (operator.truediv, "fdiv"),
):
    _operator(_operation, _name)


def _unary(function: Callable[..., Any], name: str) -> None:
    """Let a function act on vectors by LLVM's of that name."""

    def generate(context, builder, signature, arguments):
        kind = ir.FunctionType(_DOUBLES, [_DOUBLES])
        return builder.call(cgutils.get_or_insert_function(builder.module, kind, f"llvm.{name}.v{LANES}f64"), arguments)

    _typed(function, lambda x: _of_vectors(x))
    lower_builtin(function, Vector)(generate)


_unary(root, "sqrt")
_unary(magnitude, "fabs")
_typed(greatest, lambda x: types.float64 if isinstance(x, Vector) else None)
_typed(where_less, lambda a, b, then, otherwise: _of_vectors(a, b, then, otherwise))
_typed(rough_log, lambda x: _of_vectors(x))
_typed(arithmetic.constant, lambda x, value: _of_vectors(x))


@lower_builtin(greatest, Vector)
def _greatest(context, builder, signature, arguments):
    """Generate the largest of the lanes, those that are NaN aside."""
    kind = ir.FunctionType(ir.DoubleType(), [_DOUBLES])
    function = cgutils.get_or_insert_function(builder.module, kind, f"llvm.vector.reduce.fmax.v{LANES}f64")
    return builder.call(function, arguments)


@lower_builtin(where_less, Vector, Vector, Vector, Vector)
def _where_less(context, builder, signature, arguments):
    """Generate the choice of each lane."""
    return builder.select(builder.fcmp_ordered("<", arguments[0], arguments[1]), arguments[2], arguments[3])


@lower_builtin(rough_log, Vector)
def _rough_log(context, builder, signature, arguments):
    """Generate ln(x) of positive numbers to within 0.06 from their bits: the exponent, and the mantissa as it is."""
    bits = builder.sitofp(builder.bitcast(arguments[0], _INTEGERS), _DOUBLES)
    octaves = builder.fsub(builder.fmul(bits, _constant(2.0**-52)), _constant(1023.0))
    return builder.fmul(octaves, _constant(1 / _LOG2_E))


@lower_builtin(arithmetic.constant, Vector, types.Number)
def _constant_vector(context, builder, signature, arguments):
    """Generate the vector whose lanes all hold the number."""
    return _spread(context, builder, signature.args[1], arguments[1])


@_instruction
def _scaled_by_two_to(typing_context, value, shifted):
    """Return value * 2^n, where `shifted` is n added to the constant `_ROUND`."""

    def generate(context, builder, signature, arguments):
        whole = builder.bitcast(arguments[1], _INTEGERS)
        bits = builder.shl(whole, _integers(52))
        return builder.bitcast(builder.add(builder.bitcast(arguments[0], _INTEGERS), bits), _DOUBLES)

    return VECTOR(VECTOR, VECTOR), generate


def _exponential(x):
    """Return exp(x) for -708 < x < 709: a power of two times the Taylor polynomial over half an octave to either side.

    The polynomial ends with x^12 / 12!; relative errors stay below 3e-16 (Cody & Waite's reduction of the argument).
    """
    shifted = x * _LOG2_E + _ROUND
    whole = shifted - _ROUND
    f = (x - whole * _LN2_HIGH) - whole * _LN2_LOW
    p = f * _INVERSE_FACTORIALS[12] + _INVERSE_FACTORIALS[11]
    for k in range(10, -1, -1):
        p = p * f + _INVERSE_FACTORIALS[k]
    return _scaled_by_two_to(p, shifted)


@njit(cache=True)
def _log_of_ratio(z):
    """Return ln((1 + z) / (1 - z)) for a factor between root half and root two: 2 (z + z^3/3 + ... + z^23/23)."""
    square = z * z
    p = square * (2 / 23) + 2 / 21
    for k in range(19, 0, -2):
        p = p * square + 2 / k
    return p * z


def _log_of_one_plus(x):
    """Return ln(1 + x) for x > -1 to rounding, and so all digits of a small x; a power of two is taken out of 1 + x."""
    shifted = rough_log(1.0 + x) * (-_LOG2_E) + _ROUND
    whole = shifted - _ROUND
    scale = _scaled_by_two_to(splat(1.0), shifted)
    z = (scale * x + (scale - 1.0)) / (scale * x + (scale + 1.0))
    return _log_of_ratio(z) - whole * (_LN2_HIGH + _LN2_LOW)


def _logarithm(x):
    """Return ln(x) of a normal positive number to rounding; a power of two is taken out."""
    shifted = rough_log(x) * (-_LOG2_E) + _ROUND
    whole = shifted - _ROUND
    mantissa = _scaled_by_two_to(x, shifted)
    return _log_of_ratio((mantissa - 1.0) / (mantissa + 1.0)) - whole * (_LN2_HIGH + _LN2_LOW)


def _on_vectors(function: Callable[..., Any], own: Callable[..., Any]) -> None:
    """Implement a function of one number for vectors."""

    @overload(function, jit_options={"forceinline": True})
    def implementation(x):
        return own if isinstance(x, Vector) else None


_on_vectors(exponential, _exponential)
_on_vectors(log_of_one_plus, _log_of_one_plus)
_on_vectors(logarithm, _logarithm)


@overload(arithmetic.entry)
def _entry(row, k):
    return (lambda row, k: load(row, k)) if isinstance(row, types.Array) and row.ndim == 2 else None


@overload(arithmetic.whole)
def _whole(row, k):
    return (lambda row, k: int(row[k, 0])) if isinstance(row, types.Array) and row.ndim == 2 else None


@njit(cache=True)
def larger(a, b):
    """Return the larger of two numbers in each lane, a where one of them is NaN."""
    return where_less(a, b, b, a)


@njit(cache=True)
def smaller(a, b):
    """Return the smaller of two numbers in each lane, a where one of them is NaN."""
    return where_less(b, a, b, a)
