"""A new method's files: those of `assets/method_template`, with the name replaced, written at once.

The template is a method like any other, called `my_method`: it is linted, type-checked and tested
as it stands.
"""

from __future__ import annotations

import keyword
import re
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Final, Literal

from lcrl_bench.errors import (
    DuplicateNameError,
    InvalidNameError,
    UsageError,
)
from lcrl_bench.methods.registry import method_registry
from lcrl_bench.names import check_name
from lcrl_bench.storage import atomic_folder, write_bytes

Shape = Literal["folder", "package", "baseline"]
"""A folder run by its path, an installable package, or a method of the suite."""

NAME: Final = "my_method"
CLASS: Final = "MyMethod"
"""What the template is called, and its class."""
BY_FILE: Final = f"{NAME}/method.py:{CLASS}"
"""How the template is run, if nothing knows its name."""
SOURCES: Final[dict[Shape, dict[str, str]]] = {
    "folder": {
        "method.py": "method.py",
        "test_method.py": "test_method.py",
        "README.md": "README.md",
    },
    "package": {
        f"{NAME}/__init__.py": "",
        f"{NAME}/method.py": "method.py",
        f"{NAME}/test_method.py": "test_method.py",
        "README.md": "README.md",
        "pyproject.toml": "package.toml",
    },
    "baseline": {
        "__init__.py": "",
        "method.py": "method.py",
        "method.toml": "method.toml",
        "README.md": "README.md",
    },
}
"""Shape -> file to write -> file of the template, or "" for one that only has a docstring. A
baseline's contract is tested by `tests/methods/test_every_method.py`."""
RULE: Final = "use lower-case letters, digits and '_', starting with a letter, as in my_method"


def class_name(name: str) -> str:
    """`"my_method"` as a class is called: `"MyMethod"`."""
    return "".join(word.capitalize() for word in name.split("_"))


def check_method_name(name: str) -> None:
    """Refuse a name that a new method can't have.

    Raises:
        InvalidNameError: If it is no Python identifier in lower case, or its class would be called
            as something that the template's code uses.
        DuplicateNameError: If a method has it.
        UsageError: If a Python package of this environment has it.
    """
    check_name("method", name)
    if not name.isidentifier() or keyword.iskeyword(name) or keyword.iskeyword(class_name(name)):
        raise InvalidNameError("method", name, RULE)
    if name in method_registry():
        raise DuplicateNameError("method", name)
    code = _template("method.py").replace(CLASS, "")
    for word in (class_name(name), f"{class_name(name)}Config"):
        if re.search(rf"\b{word}\b", code):
            reason = f"{word} has a meaning in its code already; choose another name"
            raise InvalidNameError("method", name, reason)
    if find_spec(name) is not None:
        reason = f"'{name}' is the name of a Python package that is installed here."
        raise UsageError(f"{reason} Choose another name.")


def draft(name: str, shape: Shape) -> dict[str, str]:
    """The files of a new method: path in its folder -> text.

    Args:
        name: Checked by `check_method_name`.
        shape: What the folder is to be.
    """
    return {
        _named(path, name): _text(source, name, shape) for path, source in SOURCES[shape].items()
    }


def _text(source: str, name: str, shape: Shape) -> str:
    text = _template(source) if source else f'"""{CLASS}."""\n'
    if shape != "folder":
        text = text.replace(BY_FILE, NAME)
    return _named(text, name)


def _named(text: str, name: str) -> str:
    return text.replace(NAME, name).replace(CLASS, class_name(name))


def _template(file: str) -> str:
    return files("lcrl_bench.assets").joinpath("method_template", file).read_text("utf-8")


def write_folder(folder: Path, texts: dict[str, str]) -> None:
    """Write a folder that was not there: whole, or not at all.

    Args:
        folder: Where; the folders above it are made.
        texts: Path in it -> content.

    Raises:
        UsageError: If something is there already.
        EnvironmentMissingError: If it can't be written.
    """
    if folder.exists() or folder.is_symlink():
        reason = f"{folder} is there already, and is left as it is."
        raise UsageError(f"{reason} Choose another name, or another folder with --out.")
    with atomic_folder(folder) as fresh:
        for path, text in texts.items():
            write_bytes(fresh / path, text.encode())
