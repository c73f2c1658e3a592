"""`Document`: the base of the pydantic models of files, and how parsed JSON becomes one."""

from __future__ import annotations

import reprlib
from pathlib import Path
from typing import Annotated, TypeVar

from pydantic import BaseModel, ConfigDict, StringConstraints, ValidationError

from lcrl_bench.errors import InvalidFileError
from lcrl_bench.storage import json_place

Text = Annotated[
    str, StringConstraints(strict=True, max_length=200, pattern=r"^[^\x00-\x1f\x7f-\x9f]*$")
]
"""A line of text: at most 200 characters, none of them control characters."""


class Document(BaseModel):
    """What a file holds: frozen, and with no field besides the declared ones."""

    model_config = ConfigDict(extra="forbid", frozen=True)


Model = TypeVar("Model", bound=Document)


def parse_document(
    model: type[Model], value: object, *, path: Path | str, kind: str, fix: str
) -> Model:
    """Validate parsed JSON against a document model.

    Args:
        model: The document model.
        value: The parsed JSON.
        path: Where it was read from, for messages.
        kind: What it should contain, for messages (`"a House JSON"`).
        fix: The next step, for messages.

    Raises:
        InvalidFileError: If `value` does not fit; names the first place and counts the others.
    """
    try:
        return model.model_validate(value)
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        more = f" (and {error.error_count() - 1} more)" if error.error_count() > 1 else ""
        # A missing field's "input" is the whole object it is missing from, which is no help.
        found = "" if first["type"] == "missing" else f", found {_short(first['input'])}"
        reason = f"not {kind}: {first['msg']}{found}{more}"
        where = json_place(first["loc"])
        raise InvalidFileError(path, reason, where=where, fix=fix) from error


def _short(value: object) -> str:
    text = reprlib.repr(value)
    return text if len(text) <= 60 else text[:57] + "..."
