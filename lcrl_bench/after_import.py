"""Import one module right after another: how our environments get registered with Gymnasium.

Gymnasium only knows environments whose package has been imported. Importing Gymnasium here would
make `import lcrl_bench` slow, so registration waits until somebody imports Gymnasium.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib import import_module
from importlib.abc import Loader, MetaPathFinder
from importlib.machinery import ModuleSpec
from importlib.util import find_spec
from types import ModuleType


def import_after(awaited: str, module: str) -> None:
    """Import `module` now if `awaited` has been imported, otherwise as soon as it is.

    Args:
        awaited: A package, installed or not.
        module: The module to import.
    """
    if awaited in sys.modules:
        import_module(module)
    elif not any(
        isinstance(finder, _Finder) and finder.module == module for finder in sys.meta_path
    ):
        sys.meta_path.insert(0, _Finder(awaited, module))


class _Finder(MetaPathFinder):
    """Finds the awaited package once, as the other finders do, and extends its loader."""

    def __init__(self, awaited: str, module: str) -> None:
        self.awaited = awaited
        self.module = module

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """The awaited package's own spec, with an extended loader."""
        if fullname != self.awaited or self not in sys.meta_path:
            return None
        sys.meta_path.remove(self)
        spec = find_spec(fullname)
        if spec is not None and spec.loader is not None:
            spec.loader = _Loader(spec.loader, self.module)
        return spec


class _Loader(Loader):
    """Loads with another loader, then imports a module."""

    def __init__(self, loader: Loader, module: str) -> None:
        self._loader = loader
        self._module = module

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """Create the module with the other loader."""
        return self._loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        """Run the module with the other loader, which it keeps; then import the one waiting."""
        if module.__spec__ is not None:
            module.__spec__.loader = self._loader
        module.__loader__ = self._loader
        self._loader.exec_module(module)
        import_module(self._module)
