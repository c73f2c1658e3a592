"""`HouseSpec`: an environment's spec, which can be written as JSON.

Gymnasium writes specs with their arguments as JSON. Paths become strings, tuples become lists,
NumPy numbers become Python numbers, and members of an enumeration become their values.
A benchmark or a reward given as an object has no JSON; Gymnasium would fail with an obscure error
about some array inside it.
"""

from __future__ import annotations

import copy
import dataclasses
from enum import Enum
from os import PathLike, fspath
from typing import Any

import numpy as np
from gymnasium.envs.registration import EnvSpec

from lcrl_bench.errors import UsageError


class UnwritableSpecError(UsageError, ValueError):
    """A spec that JSON can't represent; also a ValueError, as Gymnasium raises for callables."""


class HouseSpec(EnvSpec):
    """Gymnasium's spec, compared by content."""

    @classmethod
    def of(cls, spec: EnvSpec) -> HouseSpec:
        """The same spec, with its arguments as they would come back from JSON, where possible."""
        if isinstance(spec, cls):
            return spec
        given: dict[str, Any] = {
            each.name: getattr(spec, each.name) for each in dataclasses.fields(spec) if each.init
        }
        given["kwargs"] = {key: _plain(value) for key, value in spec.kwargs.items()}
        return cls(**given)

    def to_json(self) -> str:
        """The spec as JSON, for `EnvSpec.from_json`.

        Raises:
            UnwritableSpecError: If an argument is an object that JSON can't represent.
        """
        plain = copy.copy(self)
        plain.kwargs = {key: _plain(value) for key, value in self.kwargs.items()}
        for key, value in plain.kwargs.items():
            if not _is_json(value):
                raise UnwritableSpecError(
                    f"{self.id} was made with {key}=<{type(value).__name__}>, which JSON can't "
                    f"represent. Give {key} as a string: a name, or the path of a folder."
                )
        return EnvSpec.to_json(plain)

    def __eq__(self, other: object) -> bool:
        """Compare by content, whatever the class of the other spec."""
        return isinstance(other, EnvSpec) and vars(self) == vars(other)

    __hash__ = None  # pyright: ignore[reportAssignmentType] - as EnvSpec: its content may change


def _plain(value: Any) -> Any:  # noqa: ANN401 - any argument
    if isinstance(value, PathLike):
        return fspath(value)
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, Enum):
        return value.value
    if isinstance(value, (list, tuple)):
        return [_plain(each) for each in value]
    if isinstance(value, dict):
        return {key: _plain(each) for key, each in value.items()}
    return value


def _is_json(value: Any) -> bool:  # noqa: ANN401 - any argument
    if isinstance(value, list):
        return all(map(_is_json, value))
    if isinstance(value, dict):
        return all(isinstance(key, str) and _is_json(each) for key, each in value.items())
    return value is None or isinstance(value, (str, bool, int, float))
