"""The registry of methods: folders of `baselines/`, other packages' entry points, a file.

Listing imports neither torch nor a method: a baseline folder names itself in `method.toml`.
"""

from __future__ import annotations

import importlib
import inspect
import pkgutil
import sys
import tomllib
from importlib.metadata import EntryPoint, entry_points
from importlib.resources import files
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Final

from lcrl_bench.errors import InvalidFileError, UnknownNameError, UsageError
from lcrl_bench.names import slug
from lcrl_bench.registry import Registry
from lcrl_bench.storage import sha256_of

if TYPE_CHECKING:
    # At run time this would import torch.
    from lcrl_bench.methods.contract import Method

BASELINES: Final = "lcrl_bench.baselines"
ENTRY_POINT_GROUP: Final = "lcrl_bench.methods"
"""Where another package offers methods: `my-method = "my_package.method:MyMethod"`."""
METHOD_FILE: Final = "method.py"
"""What the file of a method is called in a folder of its own."""
_KEYS: Final = {"name", "target", "summary"}


def method_registry() -> Registry[type[Method]]:
    """All methods there are: baselines first, then other packages' in order of name.

    Raises:
        InvalidFileError: If a baseline's `method.toml` is not what it must be.
        DuplicateNameError: If two methods bear one name.
    """
    registry: Registry[type[Method]] = Registry("method")
    for module in pkgutil.iter_modules(importlib.import_module(BASELINES).__path__):
        if module.ispkg:
            _register_baseline(registry, module.name)
    for point in sorted(entry_points(group=ENTRY_POINT_GROUP), key=lambda each: each.name):
        registry.register(point.name, point.value, summary=_summary(point))
    return registry


def list_methods() -> tuple[str, ...]:
    """Names of all methods there are, sorted.

    Example:
        >>> lcrl_bench.list_methods()[:3]
        ('agile', 'cloning', 'gail_exact')
    """
    return tuple(entry.name for entry in method_registry())


def check_method(name: str) -> None:
    """Refuse a name that no method has, and a file that is not there; imports neither.

    Raises:
        UnknownNameError: If no method is called so.
        UsageError: If the file does not exist.
    """
    if ".py:" in name:
        _method_file(name)
        return
    registry = method_registry()
    if name not in registry:
        raise UnknownNameError(registry.kind, name, registry.entries)


def resolve_method(name: str) -> type[Method]:
    """The class of a method, by its name or as `path/to/file.py:Class`.

    Raises:
        UnknownNameError: If no method is called so.
        UsageError: If the file or its class does not exist, or the class is no `Method` or does
            not say what it learns.
    """
    found = _from_file(name) if ".py:" in name else method_registry().get(name)
    from lcrl_bench.methods.contract import Method

    if not (isinstance(found, type) and issubclass(found, Method)):
        raise UsageError(f"'{name}' is not a subclass of lcrl_bench.methods.contract.Method.")
    learns = getattr(found, "learns", None)
    # An abstract one could be trained, and would fail when it is saved.
    if not isinstance(learns, type) or inspect.isabstract(learns):
        reason = "does not say what fit returns: add `learns = MyReward` to the class, a Reward or"
        raise UsageError(f"'{name}' {reason} Policy that defines save and load.")
    return found


def short_name(method: str) -> str:
    """What the runs of a method are called, as an identifier.

    Args:
        method: A registered name, or `path/to/file.py:Class`: then the file's name, or, if that is
            `method.py`, its folder's.
    """
    path, colon, _ = method.rpartition(":")
    if not colon:
        return slug(method)
    file = Path(path)
    return slug(file.parent.name if file.name == METHOD_FILE and file.parent.name else file.stem)


def _register_baseline(registry: Registry[type[Method]], folder: str) -> None:
    """Register what a folder's `method.toml` says; a folder without one is skipped."""
    path = files(BASELINES).joinpath(folder, "method.toml")
    if not path.is_file():
        return
    try:
        entry = tomllib.loads(path.read_text("utf-8"))
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InvalidFileError(str(path), f"not valid TOML: {error}") from error
    if set(entry) != _KEYS or not all(isinstance(value, str) for value in entry.values()):
        keys = ", ".join(sorted(_KEYS))
        raise InvalidFileError(str(path), f"must hold the strings {keys} and nothing else")
    registry.register(entry["name"], entry["target"], summary=entry["summary"])


def _summary(point: EntryPoint) -> str:
    package = point.dist.name if point.dist is not None else "another package"
    return f"from {package}"


def _from_file(name: str) -> object:
    """Import `path/to/file.py:Class`."""
    path, attribute = _method_file(name)
    module = _import_file(path)
    if not hasattr(module, attribute):
        raise UsageError(f"{path} has no class '{attribute}'.")
    return getattr(module, attribute)


def _method_file(name: str) -> tuple[Path, str]:
    """The file and the class of `path/to/file.py:Class`."""
    text, _, attribute = name.rpartition(":")
    path = Path(text).expanduser().resolve()
    if not path.is_file():
        raise UsageError(f"No file {path} (wanted for method '{name}').")
    return path, attribute


def _import_file(path: Path) -> ModuleType:
    # Two files of one name are two modules: a class is looked up in its module, by name.
    module_name = f"lcrl_bench_method_{path.stem}_{sha256_of(bytes(path))[:8]}"
    spec = spec_from_file_location(module_name, path)
    if spec is None or spec.loader is None:
        raise UsageError(f"{path} can't be imported as Python.")
    module = module_from_spec(spec)
    # Dataclasses look their module up by name.
    sys.modules[module_name] = module
    try:
        spec.loader.exec_module(module)
    except BaseException:
        del sys.modules[module_name]
        raise
    return module
