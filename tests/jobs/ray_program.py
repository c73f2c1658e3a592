"""Jobs on a Ray cluster of two nodes, of which one is taken away: run with a folder as argument.

A job kills its worker, and the second node is removed while a job waits on it. Prints what came of
every job as JSON.
"""

from __future__ import annotations

import json
import sys
import threading
import time
from pathlib import Path

from job_samples import word_job
from ray.cluster_utils import Cluster

from lcrl_bench.jobs.engine import run_jobs
from lcrl_bench.jobs.ray_cluster import RayExecutor

STORE = 80 * 1024 * 1024
"""Bytes of a node's object store; Ray takes no less."""
WORDS = ("a:wait", "b:wait", "c:die-once", "d", "e:fail")


def main(folder: Path) -> None:
    node = {"num_cpus": 1, "object_store_memory": STORE, "include_dashboard": False}
    cluster = Cluster(initialize_head=True, head_node_args=node)
    second = cluster.add_node(num_cpus=1, object_store_memory=STORE)
    cluster.wait_for_nodes()

    def take_away() -> None:
        while len(list(folder.glob("*.begun"))) < 2:
            time.sleep(0.05)
        workers = [int((folder / f"{name}.tried").read_text()) for name in "ab"]
        cluster.remove_node(second, allow_graceful=False)
        while all(Path(f"/proc/{worker}").exists() for worker in workers):
            time.sleep(0.05)
        (folder / "go").touch()

    thread = threading.Thread(target=take_away)
    thread.start()
    jobs = [word_job(folder, word) for word in WORDS]
    executor = RayExecutor(cluster.address, {}, workers=0)
    ended = {each.key: [each.error, each.answer.value] for each in run_jobs(jobs, executor)}
    thread.join()
    cluster.shutdown()
    print(json.dumps(ended))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
