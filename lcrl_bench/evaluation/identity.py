"""The identity of a run: everything its results depend on. Equal identities give equal bits.

A run's `config.json` records its spec and, under `made_with`, the version of lcrl_bench, digests of
its code and of the method's files, the kernel, torch's threads and device, and the renderer.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Final

import torch

from lcrl_bench.mdp.kernels.dispatch import kernel_name
from lcrl_bench.methods.contract import Method
from lcrl_bench.methods.source import method_source, suite_source
from lcrl_bench.version import __version__

MADE_WITH: Final = "made_with"
COMPUTED_BY: Final = ("kernel", "threads", "device", "renderer")
"""Keys of `made_with` that say how a run was computed, rather than what."""
_METHOD: Final = "method_files"
_SUITE: Final = "suite_code"
_WORDS: Final = {"lcrl_bench": "version of lcrl_bench"}
_MISSING: Final = object()


def made_with(
    method: type[Method] | None,
    device: torch.device,
    *,
    threads: int | None = None,
    renderer: str = "auto",
) -> dict[str, Any]:
    """The `made_with` of a run, as JSON.

    Args:
        method: The method's class; None for a control, which is part of the suite.
        device: The device it computes on.
        threads: Number of torch threads; None means the current one.
        renderer: The renderer requested; any other than `auto` ignores frozen views.
    """
    return {
        "lcrl_bench": __version__,
        _SUITE: suite_source(method),
        _METHOD: {} if method is None else method_source(method),
        "kernel": kernel_name(device),
        "threads": torch.get_num_threads() if threads is None else threads,
        "device": str(device),
        "renderer": renderer,
    }


def differences(before: object, now: Mapping[str, Any]) -> tuple[str, ...]:
    """The differences of two identities, one phrase each: `threads (2 then, 1 now)`.

    Args:
        before: The content of a `config.json`.
        now: The identity of the run to compare with.
    """
    if not isinstance(before, Mapping):
        return ("its config.json, which is not that of a run",)
    if MADE_WITH in now and not isinstance(before.get(MADE_WITH), Mapping):
        return ("what it was made with, which an older version did not record",)
    old, new = _flat(before), _flat(now)
    keys = [key for key in dict.fromkeys([*new, *old]) if old.get(key) != new.get(key)]
    # A setting given explicitly is among all settings too: named once.
    asked = {key[1] for key in keys if key[0] == "settings"}
    named = [key for key in keys if not (key[0] == "resolved" and key[1] in asked)]
    return tuple(_phrase(key, old.get(key, _MISSING), new.get(key, _MISSING)) for key in named)


def edited_since(config: Mapping[str, Any], method: type[Method]) -> tuple[str, ...]:
    """The code that changed since a run was made: `the method's files`, `the code of ...`."""
    before = config.get(MADE_WITH)
    if not isinstance(before, Mapping):
        return ()
    names = []
    if before.get(_METHOD) != method_source(method):
        names.append("the method's files")
    if before.get(_SUITE) != suite_source(method):
        names.append("the code of lcrl_bench")
    return tuple(names)


def without_computer(config: Any) -> Any:  # noqa: ANN401 - a JSON object, if it is a run's
    """An identity without `COMPUTED_BY`: the same results up to rounding."""
    if not isinstance(config, Mapping) or not isinstance(config.get(MADE_WITH), Mapping):
        return config
    kept = {key: value for key, value in config[MADE_WITH].items() if key not in COMPUTED_BY}
    return {**config, MADE_WITH: kept}


def _flat(config: Mapping[str, Any]) -> dict[tuple[str, str], Any]:
    """All values of an identity by group and name; top-level ones have no group."""
    found: dict[tuple[str, str], Any] = {}
    for key, value in config.items():
        if key == MADE_WITH:
            files = value.get(_METHOD)
            files = files if isinstance(files, Mapping) else {}
            found |= {("", name): each for name, each in value.items() if name != _METHOD}
            found |= {(_METHOD, name): each for name, each in files.items()}
        elif isinstance(value, Mapping):
            found |= {(key, name): each for name, each in value.items()}
        else:
            found["", key] = value
    return found


def _phrase(key: tuple[str, str], before: object, now: object) -> str:
    group, name = key
    if name == _SUITE:
        return "the code of lcrl_bench (edited since)"
    if group == _METHOD:
        how = "new" if before is _MISSING else "gone" if now is _MISSING else "edited since"
        return f"the method's {name} ({how})"
    return f"{_WORDS.get(name, name)} ({_said(before)} then, {_said(now)} now)"


def _said(value: object) -> str:
    text = "unset" if value is _MISSING else str(value)
    return text if len(text) <= 40 else f"{text[:12]}..."
