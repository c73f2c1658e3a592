"""Digests of source code: a method's own files, and the suite's code that a run goes through.

Imports are read from the text, not run: a file counts if it is imported anywhere, at the top or in
a function, directly or by another file that counts. Every byte counts, comments too. What is
installed (`site-packages`, the standard library) does not: its versions are in
`environment.json`. A method that is itself installed counts with its own package.
"""

from __future__ import annotations

import ast
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import cache
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Final

from lcrl_bench.errors import UsageError
from lcrl_bench.storage import canonical_json, sha256_of

if TYPE_CHECKING:
    from lcrl_bench.methods.contract import Method

SUITE: Final = "lcrl_bench"
BASELINES: Final = "lcrl_bench.baselines"
"""What is in there is a method's own code, not the suite's."""
ENTRIES: Final = ("lcrl_bench.evaluation.run", "lcrl_bench.evaluation.optimizers")
"""Where a run begins: what these import, directly or not, is the code that it goes through."""
_INSTALLED: Final = {"site-packages", "dist-packages"}


@cache
def method_source(method: type[Method]) -> dict[str, str]:
    """The files that a method consists of, as of the first call.

    Args:
        method: Its class. The files of its base classes count too, unless they are the suite's.

    Returns:
        Module, or the file's name if the module is in no package -> SHA-256 of the file.

    Raises:
        UsageError: If the class is in no file.
    """
    if _file(method.__module__) is None:
        raise UsageError(
            f"The class {method.__name__} is in no file, so its results could not be told from "
            "those of another version. Write it to a file."
        )
    files = {name: path for name, path in _files(method).items() if not _is_suite(name)}
    return {
        name if "." in name else path.name: sha256_of(path.read_bytes())
        for name, path in sorted(files.items())
    }


@cache
def suite_source(method: type[Method] | None = None) -> str:
    """One digest over `suite_files`, as of the first call."""
    files = suite_files(method)
    return sha256_of(canonical_json({k: sha256_of(v.read_bytes()) for k, v in files.items()}))


def suite_files(method: type[Method] | None = None) -> dict[str, Path]:
    """The suite's files that runs of a method go through, by module; None: those of the controls.

    These are what the evaluation and the method import: no command line, drawing or leaderboard.
    """
    return {name: path for name, path in _files(method).items() if _is_suite(name)}


@cache
def _files(method: type[Method] | None) -> dict[str, Path]:
    """Module -> file of all the code that a run goes through, except what is installed.

    Cached: `method_source` and `suite_source` both need it, and parsing the code takes a second.
    """
    bases = [] if method is None else [base.__module__ for base in method.__mro__]
    own = None if method is None else method.__module__.partition(".")[0]

    def counts(name: str) -> bool:
        top = name.partition(".")[0]
        if top == SUITE:
            return name != BASELINES
        return top not in sys.stdlib_module_names and (top == own or not _is_installed(name))

    return _imported([*ENTRIES, *bases], counts)


def _is_suite(name: str) -> bool:
    return name.partition(".")[0] == SUITE and not name.startswith(f"{BASELINES}.")


def _imported(roots: Sequence[str], counts: Callable[[str], bool]) -> dict[str, Path]:
    """Module -> file of some modules and of all that they import, as far as it counts."""
    found: dict[str, Path] = {}
    waiting = list(roots)
    while waiting:
        name = waiting.pop()
        path = None if name in found or not counts(name) else _file(name)
        if path is None:
            continue
        found[name] = path
        # A package's __init__.py is run before any of its modules.
        waiting += [name.rpartition(".")[0]] if "." in name else []
        if path.suffix == ".py":
            package = name if path.name == "__init__.py" else name.rpartition(".")[0]
            waiting += _imports(path, package)
    return found


def _imports(path: Path, package: str) -> Iterator[str]:
    """The names of what a file imports; of `from a import b` both `a` and `a.b`."""
    try:
        tree = ast.parse(path.read_bytes())
    except (SyntaxError, ValueError):  # of another Python, or never imported after all
        return
    later = handed_on(tree)
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            for alias in node.names:
                yield from _whole(alias.name)
        elif isinstance(node, ast.ImportFrom) and node.module not in later.values():
            parts = package.split(".")
            above = parts[: len(parts) - node.level + 1] if node.level else []
            base = ".".join([*above, *([node.module] if node.module else [])])
            yield base
            names = _handed_on(base)
            for alias in node.names:
                every = names.values() if alias.name == "*" else _whole(f"{base}.{alias.name}")
                yield from [names[alias.name]] if alias.name in names else every


def handed_on(tree: ast.Module) -> dict[str, str]:
    """Names that a package hands on by `lcrl_bench.lazy`, and the modules that define them.

    Args:
        tree: Its `__init__.py`. What it imports only for type checkers are these names.
    """
    branches = [
        node.body
        for node in tree.body
        if isinstance(node, ast.If) and any("lazy_names" in ast.dump(part) for part in node.orelse)
    ]
    return {
        alias.name: node.module
        for branch in branches
        for node in branch
        if isinstance(node, ast.ImportFrom) and node.module
        for alias in node.names
    }


def _whole(name: str) -> Iterator[str]:
    """A module, and if it is a package that hands names on, the modules that define them."""
    yield name
    yield from _handed_on(name).values()


@cache
def _handed_on(name: str) -> dict[str, str]:
    path = _file(name) if name.partition(".")[0] == SUITE else None
    if path is None or path.name != "__init__.py":
        return {}
    return handed_on(ast.parse(path.read_bytes()))


@cache
def _is_installed(name: str) -> bool:
    path = _file(name)
    return path is None or not _INSTALLED.isdisjoint(path.parts)


def _file(name: str) -> Path | None:
    """The file of a module, which is not imported for it; None if it has none."""
    module = sys.modules.get(name)
    text = getattr(module, "__file__", None)
    if text is None and module is None:
        spec = _spec(name)
        text = spec.origin if spec is not None and spec.has_location else None
    path = None if text is None else Path(text)
    return path if path is not None and path.is_file() else None


def _spec(name: str) -> ModuleSpec | None:
    module = sys.modules.get(name)
    if module is not None:
        return getattr(module, "__spec__", None)
    parent = name.rpartition(".")[0]
    try:
        if not parent:
            return find_spec(name)
        above = _spec(parent)
        folders = None if above is None else above.submodule_search_locations
        return None if folders is None else PathFinder.find_spec(name, list(folders))
    except (ImportError, ValueError):
        return None
