"""`--preset` and `--set key=value`: a method's configuration with some fields replaced."""

from __future__ import annotations

import dataclasses
import typing
from collections.abc import Mapping
from typing import Any

from pydantic import TypeAdapter, ValidationError
from pydantic_core import to_jsonable_python

from lcrl_bench.errors import UnknownNameError, UsageError
from lcrl_bench.methods.contract import Method


def parse_settings(words: tuple[str, ...]) -> dict[str, str]:
    """Split `("passes=10", "learning_rate=1e-3")` at the first `=` in each.

    Raises:
        UsageError: If a word has no `=`.
    """
    pairs = [word.partition("=") for word in words]
    if bad := [key for key, equals, _ in pairs if not equals]:
        raise UsageError(f"--set takes key=value, found '{bad[0]}'. Example: --set passes=10")
    return {key: value for key, _, value in pairs}


def settings_document(method: Method) -> dict[str, Any]:
    """All settings of a method as JSON; empty if it has none."""
    config = getattr(method, "config", None)
    if not dataclasses.is_dataclass(config) or isinstance(config, type):
        return {}
    return to_jsonable_python(dataclasses.asdict(config))


DEFAULT_PRESET = "default"
"""The preset that changes nothing."""


def make_method(
    method: type[Method], settings: Mapping[str, str], *, preset: str = DEFAULT_PRESET
) -> Method:
    """Make a method with a preset's configuration, overridden by `settings`.

    Raises:
        UnknownNameError: If there is no such preset, or the configuration has no such field; lists
            the valid ones.
        UsageError: If a value has the wrong type for its field.
    """
    factory: Any = method
    presets = {DEFAULT_PRESET: {}, **method.presets}
    if preset not in presets:
        raise UnknownNameError("preset", preset, presets)
    config_class = getattr(method, "Config", None)
    if config_class is None:
        if settings:
            raise UnknownNameError("setting", next(iter(settings)), ())
        return factory()
    types = typing.get_type_hints(config_class)
    fields = {field.name for field in dataclasses.fields(config_class)}
    changes: dict[str, Any] = dict(presets[preset])
    for key, text in settings.items():
        if key not in fields:
            raise UnknownNameError("setting", key, fields)
        try:
            changes[key] = TypeAdapter(types[key]).validate_python(text)
        except ValidationError as error:
            reason = error.errors()[0]["msg"]
            raise UsageError(f"--set {key}={text}: {reason}.") from error
    return factory(config_class(**changes))
