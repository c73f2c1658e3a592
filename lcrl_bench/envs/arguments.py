"""Checks of what users hand an environment: names, flags, whole numbers.

Python takes much for what it isn't: 1.7 for 1, "no" for true, a string for a list of its letters.
Each check refuses that by name and says what is valid.
"""

from __future__ import annotations

import operator
import reprlib
from collections.abc import Collection, Iterable
from typing import SupportsIndex, cast

import numpy as np

from lcrl_bench.errors import UnknownNameError, UsageError


def whole_number(value: object, *, least: int = 0, most: int | None = None) -> int | None:
    """An integer of Python, NumPy or torch as Python's; None if it is none, or out of range.

    True and False are truth values, not 1 and 0; arrays and tensors count if they hold one integer.

    Args:
        value: Anything.
        least: The smallest that is valid.
        most: The largest that is valid; None means any.
    """
    if isinstance(value, (bool, np.bool_)) or str(getattr(value, "dtype", "")).endswith("bool"):
        return None
    try:
        number = operator.index(cast(SupportsIndex, value))
    except TypeError:
        return None
    return number if number >= least and (most is None or number <= most) else None


def check_count(argument: str, value: object) -> int:
    """A number of things, at least one.

    Raises:
        UsageError: If it is not.
    """
    number = whole_number(value, least=1)
    if number is None:
        raise UsageError(f"{argument} is {reprlib.repr(value)}. Valid: a whole number from 1 on.")
    return number


def check_seed(value: object) -> int | None:
    """A seed; None means none.

    Raises:
        UsageError: If it is neither None nor a whole number from 0 on.
    """
    number = whole_number(value)
    if value is not None and number is None:
        raise UsageError(
            f"seed is {reprlib.repr(value)}. Valid: a whole number from 0 on, or None."
        )
    return number


def check_flag(argument: str, value: object) -> bool:
    """A truth value.

    Raises:
        UsageError: If it is neither True nor False.
    """
    if not isinstance(value, (bool, np.bool_)):
        raise UsageError(f"{argument} is {reprlib.repr(value)}. Valid: True, False.")
    return bool(value)


def check_name(argument: str, value: object, valid: Collection[str]) -> str:
    """One of a few names.

    Raises:
        UsageError: If it is no string.
        UnknownNameError: If it is none of them.
    """
    if not isinstance(value, str):
        listing = ", ".join(sorted(valid))
        raise UsageError(f"{argument} is {reprlib.repr(value)}, no string. Valid: {listing}.")
    if value not in valid:
        raise UnknownNameError(argument.replace("_", " "), value, valid)
    return value


def check_task_id(argument: str, value: object) -> str:
    """What may be a task's id.

    Raises:
        UsageError: If it is no string.
    """
    if not isinstance(value, str):
        raise UsageError(
            f"{argument} is {reprlib.repr(value)}, no string. "
            "Valid: the id of a task, as in the benchmark's tasks.json."
        )
    return value


def check_task_ids(argument: str, value: object) -> tuple[str, ...]:
    """What may be several tasks' ids.

    Raises:
        UsageError: If it is no list of strings.
    """
    if isinstance(value, (str, bytes)) or not isinstance(value, Iterable):
        raise UsageError(f"{argument} is {reprlib.repr(value)}. Valid: a list of ids of tasks.")
    return tuple(check_task_id(f"{argument}[{k}]", each) for k, each in enumerate(value))
