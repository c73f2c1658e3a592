"""How jobs on several processes go: a bar on a terminal.

Elsewhere a line as a job begins and as it ends, and one every ten seconds in between.
"""

from __future__ import annotations

import time
from contextlib import ExitStack
from types import TracebackType
from typing import TYPE_CHECKING, Any

from tqdm import tqdm

from lcrl_bench.cli.output import bars_wanted, say
from lcrl_bench.cli.pulse import Pulse, pulsing

if TYPE_CHECKING:
    # At run time this would import torch.
    from lcrl_bench.evaluation.workers import Ended

_FORMAT = "{percentage:3.0f} %|{bar}| {n:.1f} of {total} [{elapsed}, {remaining} left]{postfix}"


class JobBar:
    """A bar over jobs that counts the shares of those at work; a `workers.Watcher`."""

    def __init__(self, total: int) -> None:
        """Start a bar over so many jobs."""
        self._total, self._done, self._began = total, 0, time.perf_counter()
        self._shares: dict[str, float] = {}
        self._wanted = bars_wanted()
        self.pulse = Pulse("jobs", total)
        self._open = ExitStack()
        self._bar: tqdm[Any] = tqdm(total=total, disable=not self._wanted, bar_format=_FORMAT)

    def __enter__(self) -> JobBar:
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

    def started(self, key: str) -> None:
        """A job began."""
        self._shares[key] = 0.0
        if not self._wanted:
            say(f"{key}: started")
        self._show()

    def advanced(self, key: str, share: float) -> None:
        """A job is so far."""
        self._shares[key] = share
        self._show()

    def ended(self, ended: Ended) -> None:
        """A job ended: a line that stays."""
        self._shares.pop(ended.key, None)
        self._done += 1
        how = f"{ended.seconds:.0f} s" if ended.error is None else f"failed: {ended.error}"
        line = f"[{self._done}/{self._total}] {ended.key}: {how}{self._left()}"
        if self._wanted:
            self._bar.write(line)
        else:
            say(line)
        self._show()

    def _left(self) -> str:
        done = self._done + sum(self._shares.values())
        if done >= self._total:
            return ""
        elapsed = time.perf_counter() - self._began
        minutes = elapsed * (self._total - done) / done / 60
        return f" (about {minutes:.0f} min left)" if minutes >= 1 else ""

    def _show(self) -> None:
        running = [f"{key} {100 * share:.0f} %" for key, share in self._shares.items()]
        self.pulse.done, self.pulse.note = self._done, ", ".join(running)
        self._bar.set_postfix_str(self.pulse.note, refresh=False)
        self._bar.update(self._done + sum(self._shares.values()) - self._bar.n)
        self._bar.refresh()
