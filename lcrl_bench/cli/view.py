"""`lcrl-bench view`: open a recording in the installed viewer, offline."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import tyro

from lcrl_bench.cli.arguments import parse_arguments
from lcrl_bench.cli.output import print_table, say
from lcrl_bench.errors import ExitCode

_COLUMNS = ("episode", "command", "split", "reached")


@dataclass(frozen=True)
class ViewFlags:
    """Open the recording of a run, or any .rrd file.

    It opens in a window if there is a display, and as a page in a browser otherwise. The viewer is
    local to this machine, needs no network and sends no usage statistics.
    Examples: `lcrl-bench view`, `lcrl-bench view runs/mini/lcrl/seed0`, `lcrl-bench view
    ask/ask.rrd --web`.
    """

    target: Annotated[tyro.conf.Positional[Path], tyro.conf.arg(metavar="RUN_OR_FILE")] = Path(
        "runs"
    )
    """A .rrd file, the folder of a run, or one of several runs: the last one finished is used."""
    episode: str | None = None
    """Open this episode of the run: a name from `--list`, or a unique part of one."""
    list: bool = False
    """List the recorded episodes of the run, and open nothing."""
    web: bool = False
    """Serve it to a browser even if there is a display; Ctrl-C ends it."""
    screenshot: Path | None = None
    """Write a screenshot of the viewer to this .png, and open nothing."""


def main(argv: Sequence[str]) -> int:
    """Run the verb."""
    flags = parse_arguments(ViewFlags, argv, verb="view")
    from lcrl_bench.recording.index import find_recordings
    from lcrl_bench.recording.rerun.viewer import open_window, serve_page, window_wanted

    recordings = find_recordings(flags.target)
    if flags.list:
        rows = [
            (each.task, each.command, each.split, "yes" if each.reached else "no")
            for each in recordings.episodes
        ]
        print_table(_COLUMNS, rows, title=str(recordings.main))
        return ExitCode.DONE
    path = recordings.episode(flags.episode) if flags.episode else recordings.main
    say(f"recording: {path}")
    if flags.episode and path == recordings.main:
        say("this episode is part of the run's recording: choose it in the menu of timelines")
    own = sum("recording" in each.files for each in recordings.episodes)
    if own and not flags.episode:
        say(f"{own} more episodes have their own recordings: --list shows them")
    if flags.screenshot is not None:
        from lcrl_bench.recording.rerun.screenshot import write_screenshot

        write_screenshot(path, flags.screenshot)
        say(f"screenshot: {flags.screenshot}")
        return ExitCode.DONE
    if flags.web or not window_wanted():
        serve_page(path, lambda url: say(f"open {url}\nCtrl-C ends it"))
    else:
        open_window(path)
    return ExitCode.DONE
