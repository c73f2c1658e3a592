"""Strict checks of an environment's arguments: names, flags, integers.

Python accepts too much: 1.7 as 1, "no" as true, a string as a list of its letters. Each check
rejects such values by name and says what is valid.
"""

from __future__ import annotations

import operator
import reprlib
from collections.abc import Collection, Iterable, Sequence
from typing import SupportsIndex, cast

import numpy as np
from numpy.typing import NDArray

from lcrl_bench.errors import UnknownNameError, UsageError


def whole_number(value: object, *, least: int = 0, most: int | None = None) -> int | None:
    """Convert a Python, NumPy or torch integer to `int`; None if it isn't one, or is out of range.

    True and False are not integers; arrays and tensors count if they hold a single integer.

    Args:
        value: Anything.
        least: The smallest valid value.
        most: The largest valid value; None means no limit.
    """
    if isinstance(value, (bool, np.bool_)) or str(getattr(value, "dtype", "")).endswith("bool"):
        return None
    try:
        number = operator.index(cast(SupportsIndex, value))
    except TypeError:
        return None
    return number if number >= least and (most is None or number <= most) else None


def check_count(argument: str, value: object) -> int:
    """Check a count, which must be at least one.

    Raises:
        UsageError: If it isn't a positive integer.
    """
    number = whole_number(value, least=1)
    if number is None:
        raise UsageError(f"{argument} is {reprlib.repr(value)}. Valid: a positive integer.")
    return number


def check_seed(value: object) -> int | None:
    """Check a seed, which may be None.

    Raises:
        UsageError: If it is neither None nor a non-negative integer.
    """
    if value is None:
        return None
    number = whole_number(value)
    if number is None:
        raise UsageError(f"seed is {reprlib.repr(value)}. Valid: a non-negative integer, or None.")
    return number


def check_flag(argument: str, value: object) -> bool:
    """Check a boolean.

    Raises:
        UsageError: If it is neither True nor False.
    """
    if not isinstance(value, (bool, np.bool_)):
        raise UsageError(f"{argument} is {reprlib.repr(value)}. Valid: True, False.")
    return bool(value)


def check_name(argument: str, value: object, valid: Collection[str]) -> str:
    """Check a name against the valid ones.

    Raises:
        UsageError: If it is not a string.
        UnknownNameError: If it is not among them.
    """
    if not isinstance(value, str):
        listing = ", ".join(sorted(valid))
        raise UsageError(f"{argument} is {reprlib.repr(value)}, not a string. Valid: {listing}.")
    if value not in valid:
        raise UnknownNameError(argument.replace("_", " "), value, valid)
    return value


def check_task_id(argument: str, value: object) -> str:
    """Check the type of a task's id.

    Raises:
        UsageError: If it is not a string.
    """
    if not isinstance(value, str):
        raise UsageError(
            f"{argument} is {reprlib.repr(value)}, not a string. "
            "Valid: the id of a task, as in the benchmark's tasks.json."
        )
    return value


def check_task_ids(argument: str, value: object) -> tuple[str, ...]:
    """Check the type of several tasks' ids.

    Raises:
        UsageError: If it is not a list of strings.
    """
    if isinstance(value, (str, bytes)) or not isinstance(value, Iterable):
        raise UsageError(f"{argument} is {reprlib.repr(value)}. Valid: a list of task ids.")
    return tuple(check_task_id(f"{argument}[{k}]", each) for k, each in enumerate(value))


def check_seeds(value: object, environments: int) -> list[int | None]:
    """Check the seeds of sub-environments: one for the first, from which the next count on, or all.

    Args:
        value: None, an integer, or a sequence of integers and Nones.
        environments: Number of sub-environments.

    Raises:
        UsageError: If it is none of them, or the sequence has another length.
    """
    if value is None:
        return [None] * environments
    number = whole_number(value)
    if number is not None:
        return [number + k for k in range(environments)]
    if not isinstance(value, (list, tuple, np.ndarray)) or len(value) != environments:
        raise UsageError(
            f"seed is {reprlib.repr(value)}. Valid: a non-negative integer, None, or a list of "
            f"{environments} of them, one per sub-environment."
        )
    return [check_seed(each) for each in value]


def check_actions(
    actions: object, environments: int, most: int, *, ignored: Sequence[int]
) -> NDArray[np.int64]:
    """Check the actions of sub-environments: int64 [sub-environment].

    Args:
        actions: An array, a tensor or a list.
        environments: Number of sub-environments.
        most: The largest valid action.
        ignored: Sub-environments whose actions don't matter; they become 0.

    Raises:
        UsageError: If they are not that many integers, or one is out of range.
    """
    array = np.asarray(actions)
    if array.shape != (environments,) or array.dtype.kind not in "iu":
        found = f"{array.dtype}{list(array.shape)}"
        raise UsageError(
            f"actions are {found}. Valid: {environments} integers 0 .. {most}, one per "
            "sub-environment."
        )
    if len(ignored):
        array = array.copy()
        array[ignored] = 0
    # A single bit beyond those of the largest action, or a sign, shows in the union of all bits.
    if not 0 <= int(np.bitwise_or.reduce(array)) <= most:
        number = int(np.flatnonzero((array < 0) | (array > most))[0])
        raise UsageError(
            f"{array[number]} is not an action (sub-environment {number}). "
            f"Valid: integers 0 .. {most}."
        )
    return array.astype(np.int64, copy=False)
