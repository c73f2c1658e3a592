"""The leaderboard's folder: the page, its rows' recordings and pictures, and the player.

index.html          the page
rows/<submission>/  recording.rrd, the same as a script for the player, and pictures
player/             Rerun's viewer, loaded when a recording is played
"""

from __future__ import annotations

from pathlib import Path
from typing import Final

from lcrl_bench.board.details import Media, Picture
from lcrl_bench.board.entries import Collection, Entry
from lcrl_bench.board.exhibits import Exhibits, read_exhibits
from lcrl_bench.board.page import page
from lcrl_bench.board.player import Viewer, as_script, write_player
from lcrl_bench.storage import write_bytes

FILE: Final = "index.html"
ROWS: Final = "rows"


def write_site(
    collection: Collection, out: Path, *, recordings: Path, viewer: Viewer | None
) -> Path:
    """Write the page and everything it links to.

    Args:
        collection: What it shows.
        out: The folder to write.
        recordings: What verifications recorded, one folder per submission.
        viewer: Plays the recordings in the page; None: they are only linked to.

    Returns:
        The page.
    """
    entries = [entry for board in collection.boards for entry in board.entries]
    media = {
        entry.stem: _write_row(entry, out, recordings, player=viewer is not None)
        for entry in entries
    }
    if viewer is not None and any(row.script for row in media.values()):
        write_player(viewer, out)
    write_bytes(out / FILE, page(collection, media).encode())
    return out / FILE


def _write_row(entry: Entry, out: Path, recordings: Path, *, player: bool) -> Media:
    exhibits = read_exhibits(recordings / entry.stem, submission=entry.digest)
    if exhibits is None:
        return Media()
    home, place = out / ROWS / entry.stem, f"{ROWS}/{entry.stem}"
    recording = script = ""
    if exhibits.recording is not None:
        data = exhibits.recording.read_bytes()
        write_bytes(home / "recording.rrd", data)
        recording = f"{place}/recording.rrd"
        if player:
            write_bytes(home / "recording.js", as_script("recording", data))
            script = f"{entry.stem}/recording.js"
    pictures = []
    for name, source, caption in _pictures(exhibits):
        write_bytes(home / name, source.read_bytes())
        pictures.append(Picture(f"{place}/{name}", caption))
    return Media(recording, script, tuple(pictures))


def _pictures(exhibits: Exhibits) -> list[tuple[str, Path, str]]:
    """The pictures of a row: name, file, caption."""
    found = []
    if exhibits.picture is not None:
        found.append(
            ("showcase.png", exhibits.picture, "The house, the agent's views, the learned reward")
        )
    for number, (episode, path) in enumerate(exhibits.maps(), start=1):
        end = "reached" if episode.reached else "not reached"
        caption = f"“{episode.command}” ({episode.split}): {end}"
        found.append((f"map-{number}.png", path, caption))
    return found
