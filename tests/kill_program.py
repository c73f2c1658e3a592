"""Commands killed by SIGKILL at random moments, and run again to their end.

Run with a folder, the name of a command, how often to kill it, and a seed. Prints one JSON object:
what came of it.
"""

from __future__ import annotations

import json
import random
import shutil
import signal
import sys
from pathlib import Path

from command_samples import COMMANDS, begin, digests, finish, left, prepare


def kill_often(folder: Path, name: str, times: int, seed: int) -> dict:
    """Kill a command so often, at moments that a seed draws, and compare what it makes at last."""
    draw, whole = random.Random(seed), folder / "whole"
    begin(name, folder, whole)
    duration, code = finish(whole, COMMANDS[name](folder, whole))
    assert code == 0, whole.with_suffix(".log").read_text()
    expected = digests(whole)
    answer = {"killed": 0, "same": 0, "files": len(expected), "left": [], "wrong": []}
    for number in range(times):
        home = folder / "home"
        begin(name, folder, home)
        fraction = draw.random()
        words = COMMANDS[name](folder, home)
        _, code = finish(home, words, fraction * duration)
        answer["killed"] += code == -signal.SIGKILL
        _, code = finish(home, words)
        found = digests(home)
        if code == 0 and found == expected:
            answer["same"] += 1
        else:
            differing = [key for key in {*found, *expected} if found.get(key) != expected.get(key)]
            said = home.with_suffix(".log").read_text()[-2000:]
            answer["wrong"].append([number, fraction, code, differing, said])
        answer["left"] += left(home)
        shutil.rmtree(home)
        home.with_suffix(".log").unlink()
    return {**answer, "cpu_s": round(duration, 2)}


if __name__ == "__main__":
    place = Path(sys.argv[1])
    prepare(place, sys.argv[2])
    print(json.dumps(kill_often(place, sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))))
