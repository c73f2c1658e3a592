"""Progress bars on stderr, drawn only on a terminal."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import TracebackType
from typing import Any

from tqdm import tqdm

from lcrl_bench.cli.output import bars_wanted


@contextmanager
def counting(label: str, total: int) -> Iterator[Callable[[str], None]]:
    """A bar over `total` named things; yields what is to be told each one as it is done."""
    with tqdm(desc=label, total=total, disable=not bars_wanted(), leave=False) as bar:

        def advance(name: str) -> None:
            bar.set_postfix_str(name, refresh=False)
            bar.update()

        yield advance


class Bar:
    """A bar over training steps that shows the loss."""

    def __init__(self, label: str) -> None:
        self._bar: tqdm[Any] = tqdm(desc=label, disable=not bars_wanted())

    def __enter__(self) -> Bar:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._bar.close()

    def log(self, row: dict[str, Any]) -> None:
        """Take a row of metrics: `{"step": 3, "steps": 600, "loss": 0.12, ...}`."""
        self._bar.total = row.get("steps", self._bar.total)
        shown = {
            key: f"{value:.3f}"
            for key, value in row.items()
            if key not in ("step", "steps") and isinstance(value, float)
        }
        self._bar.set_postfix(shown, refresh=False)
        self._bar.update(row.get("step", self._bar.n) + 1 - self._bar.n)
