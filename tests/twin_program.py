"""A command twice at the same time, with one cache and one output folder.

Run with a folder and the name of a command. Prints one JSON object: exit codes, and what was said.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path

from command_samples import COMMANDS, begin, digests, finish, left, prepare, start


def work(folder: Path, name: str) -> dict:
    prepare(folder, name)
    whole, home = folder / "whole", folder / "home"
    for place in (whole, home):
        begin(name, folder, place)
    _, code = finish(whole, COMMANDS[name](folder, whole))
    assert code == 0
    children = [start(home, COMMANDS[name](folder, home)) for _ in range(2)]
    codes = [os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) for child in children]
    said, same = home.with_suffix(".log").read_text(), digests(home) == digests(whole)
    return {"codes": codes, "said": said, "left": left(home), "same": same}


if __name__ == "__main__":
    print(json.dumps(work(Path(sys.argv[1]), sys.argv[2])))
