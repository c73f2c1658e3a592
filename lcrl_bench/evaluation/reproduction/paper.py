"""The paper's results, read from `assets/paper_tables.toml`."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from importlib import resources

from lcrl_bench.errors import UnknownNameError


@dataclass(frozen=True)
class PaperTable:
    """One table of the paper, success in percent."""

    name: str
    label: str
    """The table's label in the paper's source."""
    title: str
    rows: Mapping[str, Mapping[str, float]]
    """Row → column → success; a column is `<split>.<pick|nav|total>`."""

    def figure(self, row: str | None, column: str) -> float | None:
        """The result for a row and a column; None if the paper has none.

        Raises:
            UnknownNameError: If the table has no such row.
        """
        if row is None:
            return None
        if row not in self.rows:
            raise UnknownNameError(f"row of the paper's {self.name}", row, self.rows)
        return self.rows[row].get(column)


@lru_cache(maxsize=1)
def paper_tables() -> Mapping[str, PaperTable]:
    """All tables by name."""
    path = resources.files("lcrl_bench.assets").joinpath("paper_tables.toml")
    document = tomllib.loads(path.read_text("utf-8"))
    return {
        name: PaperTable(
            name=name,
            label=table["label"],
            title=table["title"],
            rows={
                row: dict(zip(table["columns"], figures, strict=True))
                for row, figures in table["rows"].items()
            },
        )
        for name, table in document.items()
    }
