"""A benchmark and runs, made here and on a Ray cluster that loses a worker and a node.

Run with a folder as argument. Prints, as JSON, the SHA-256 of every file of both.
"""

from __future__ import annotations

import json
import os
import sys
import threading
import time
from pathlib import Path

import noise_method
from ray.cluster_utils import Cluster

from lcrl_bench.cli.main import main
from lcrl_bench.houses.document import write_house
from lcrl_bench.houses.procedural import generate_house
from lcrl_bench.storage import canonical_json, sha256_of

STORE = 80 * 1024 * 1024
"""Bytes of a node's object store; Ray takes no less."""
TIMED = {"wall_s", "made_with"}
"""Keys of what differs between equal runs."""
PASSING = {"DONE", "environment.json", "metrics.jsonl"}
"""Files that say when and where."""


def commands(home: Path, fatal: Path, cluster: list[str]) -> dict[str, list[str]]:
    """The verbs, writing to a folder."""
    build = ["--houses", str(home.parent / "houses"), "--name", "tiny", "--nav", "4", "--pick", "2"]
    search = ["--method", f"{noise_method.__file__}:NoiseMethod", "--houses", "1"]
    search += ["--try", f"dies_once={fatal}", "passes=3,4", "--out", str(home / "runs")]
    return {
        "build": ["benchmark", "build", *build, "--out", str(home / "tiny"), *cluster],
        "search": ["search", *search, "--benchmark", str(home / "tiny"), *cluster],
    }


def digests(home: Path) -> dict[str, str]:
    """SHA-256 of every file, without what says when and where."""
    found = {}
    for path in sorted(path for path in home.rglob("*") if path.is_file()):
        name = path.relative_to(home)
        if path.name in PASSING or name.parts[0] == "cache":
            continue
        data = path.read_bytes()
        if path.suffix == ".json":
            value = json.loads(data)
            data = canonical_json({k: v for k, v in value.items() if k not in TIMED})
        found[str(name)] = sha256_of(data)
    return found


def work(home: Path, fatal: Path, cluster: list[str]) -> dict[str, int]:
    """Run the verbs; returns their exit codes."""
    os.environ["LCRL_BENCH_HOME"] = str(home / "cache")
    made = commands(home, fatal, cluster).items()
    return {f"{home.name} {name}": main(words) for name, words in made}


def program(folder: Path) -> None:
    for seed in (11, 12, 13):
        write_house(folder / "houses" / f"{seed}.json", generate_house(seed, rooms=4))
    fatal = folder / "fatal"
    codes = work(folder / "local", fatal, ["--workers", "1"])

    node = {"num_cpus": 1, "object_store_memory": STORE, "include_dashboard": False}
    cluster = Cluster(initialize_head=True, head_node_args=node)
    second = cluster.add_node(num_cpus=1, object_store_memory=STORE)
    cluster.wait_for_nodes()
    fatal.touch()
    lost = {}

    def take_away() -> None:
        while not list((folder / "ray" / "runs").rglob("metrics.jsonl")):
            time.sleep(0.05)
        cluster.remove_node(second, allow_graceful=False)
        lost["node"] = True

    thread = threading.Thread(target=take_away)
    thread.start()
    codes |= work(folder / "ray", fatal, ["--cluster", cluster.address])
    thread.join()
    cluster.shutdown()
    answer = {
        "codes": codes,
        "lost": {**lost, "worker": not fatal.exists()},
        "local": {"files": digests(folder / "local")},
        "ray": {"files": digests(folder / "ray")},
        "left": [str(path) for path in folder.rglob(".partial-*")],
    }
    print(json.dumps(answer))


if __name__ == "__main__":
    program(Path(sys.argv[1]))
