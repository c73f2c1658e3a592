"""A job on Ray that is interrupted: run with a folder as argument. Prints what is left as JSON."""

from __future__ import annotations

import json
import os
import signal
import sys
import threading
import time
from pathlib import Path

from job_samples import word_job
from ray.cluster_utils import Cluster

from lcrl_bench.jobs.engine import run_jobs
from lcrl_bench.jobs.ray_cluster import RayExecutor


def main(folder: Path) -> None:
    node = {"num_cpus": 1, "object_store_memory": 80 * 1024 * 1024, "include_dashboard": False}
    cluster = Cluster(initialize_head=True, head_node_args=node)

    def stop() -> None:
        while not (folder / "begun").exists():
            time.sleep(0.05)
        os.kill(os.getpid(), signal.SIGINT)

    thread = threading.Thread(target=stop)
    thread.start()
    jobs = [word_job(folder, word) for word in ("a:long", "b")]
    stopped = False
    try:
        list(run_jobs(jobs, RayExecutor(cluster.address, {}, workers=0)))
    except KeyboardInterrupt:
        stopped = True
    thread.join()
    left = [str(path.name) for path in folder.rglob(".partial-*")]
    left += [str(path.name) for path in folder.rglob("*.done")]
    cluster.shutdown()
    worker = int((folder / "a.tried").read_text())
    until = time.monotonic() + 600
    while Path(f"/proc/{worker}").exists() and time.monotonic() < until:
        time.sleep(0.1)
    alive = Path(f"/proc/{worker}").exists()
    print(json.dumps({"stopped": stopped, "alive": alive, "left": left}))


if __name__ == "__main__":
    main(Path(sys.argv[1]))
