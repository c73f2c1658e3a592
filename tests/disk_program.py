"""Commands on a disk that is full or read-only at first, in a mount namespace of their own.

Run with a folder, the name of a command, what is on the disk (`home` or `cache`), and `full` or
`read-only`. Prints one JSON object: exit codes, and what was said and left.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path

from command_samples import COMMANDS, begin, digests, finish, left, prepare

TIGHT = {"full": "size=16k", "read-only": "size=64m,ro"}


def mount(place: Path, *options: str) -> None:
    subprocess.run(["mount", "-t", "tmpfs", *options, "tmpfs", str(place)], check=True)


def work(folder: Path, name: str, disk: str, fault: str) -> dict:
    prepare(folder, name)
    whole, home = folder / "whole", folder / "home"
    begin(name, folder, whole)
    _, code = finish(whole, COMMANDS[name](folder, whole))
    assert code == 0
    home.mkdir()
    place = home if disk == "home" else home / "cache"
    place.mkdir(exist_ok=True)
    mount(place, "-o", TIGHT[fault])
    words = COMMANDS[name](folder, home)
    log = home.with_suffix(".log")
    _, first = finish(home, words)
    said, remains = log.read_text(), left(home)
    mount(place, "-o", "remount,rw,size=64m")
    _, second = finish(home, words)
    same = digests(home) == digests(whole)
    return {"codes": [first, second], "said": said, "left": remains, "same": same}


if __name__ == "__main__":
    os.environ["TMPDIR"] = sys.argv[1]
    print(json.dumps(work(Path(sys.argv[1]), *sys.argv[2:])))
