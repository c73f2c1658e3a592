"""Progress on stderr: a bar on a terminal, elsewhere a line every ten seconds.

Each step also lets a stop through that was lost on its way (see `interruption`).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from types import TracebackType
from typing import Any

from tqdm import tqdm

from lcrl_bench.cli.output import bars_wanted
from lcrl_bench.cli.pulse import Pulse, pulsing
from lcrl_bench.interruption import raise_if_stopped


@contextmanager
def counting(label: str, total: int) -> Iterator[Callable[[str], None]]:
    """Progress over `total` named things (0: not known); yields what is told each one that is done.

    A stop that was lost on its way is raised at the next of them.
    """
    pulse = Pulse(label, total or None)
    with tqdm(desc=label, total=total, disable=not bars_wanted(), leave=False) as bar:

        def advance(name: str) -> None:
            raise_if_stopped()
            bar.set_postfix_str(name, refresh=False)
            bar.update()
            pulse.done, pulse.note = pulse.done + 1, f"last {name}" if name else ""

        with pulsing(pulse):
            yield advance


@contextmanager
def working(label: str) -> Iterator[None]:
    """Progress of something that can't be counted: lines that it is still at work."""
    with pulsing(Pulse(label)):
        yield
    raise_if_stopped()


class Bar:
    """Progress over training steps, with the loss."""

    def __init__(self, label: str, *, afterwards: str = "") -> None:
        """Start it.

        Args:
            label: What is trained.
            afterwards: What is done inside the block once all steps are: `"evaluating"`.
        """
        self.pulse = Pulse(label)
        self._afterwards = afterwards
        self._bar: tqdm[Any] = tqdm(desc=label, disable=not bars_wanted())
        self._open = ExitStack()

    def __enter__(self) -> Bar:
        self._open.enter_context(pulsing(self.pulse))
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._open.close()
        self._bar.close()

    def log(self, row: dict[str, Any]) -> None:
        """Take a row of metrics: `{"step": 3, "steps": 600, "loss": 0.12, ...}`."""
        raise_if_stopped()
        self._bar.total = row.get("steps", self._bar.total)
        shown = {
            key: f"{value:.3f}"
            for key, value in row.items()
            if key not in ("step", "steps") and isinstance(value, float)
        }
        self._bar.set_postfix(shown, refresh=False)
        done = row.get("step", self._bar.n)
        self._bar.update(done + 1 - self._bar.n)
        self.pulse.done, self.pulse.total = done, row.get("steps")
        self.pulse.note = ", ".join(f"{key} {value}" for key, value in shown.items())
        if self._afterwards and self.pulse.total is not None and done >= self.pulse.total:
            self.pulse.note = self._afterwards
