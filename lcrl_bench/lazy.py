"""Lazy re-exports: a package's names, imported from its modules on first use (PEP 562).

    if TYPE_CHECKING:
        from lcrl_bench.mdp.expert import expert_policy as expert_policy
    else:
        __getattr__, __dir__, __all__ = lazy_names(__name__, {"expert_policy": ".expert"})

Type checkers see the first branch, the second one runs. A name must not be that of a module of the
package: importing the module would replace the name.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def lazy_names(
    package: str, modules: Mapping[str, str]
) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """Make a package's lazy re-exports.

    Args:
        package: Its `__name__`.
        modules: Name -> the module that defines it, absolute or relative to the package.

    Returns:
        The package's `__getattr__`, `__dir__` and `__all__`.
    """
    names = sorted(modules)

    def get(name: str) -> Any:  # noqa: ANN401
        if name not in modules:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(import_module(modules[name], package), name)
        # Cached: from now on it is found without this function.
        setattr(sys.modules[package], name, value)
        return value

    def list_names() -> list[str]:
        return sorted({*vars(sys.modules[package]), *names})

    return get, list_names, names
