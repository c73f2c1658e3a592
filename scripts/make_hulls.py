"""Make the convex hulls of the hollow templates: `assets/hulls/*.npz` and their manifest.

    python scripts/make_hulls.py            # those whose template changed
    python scripts/make_hulls.py --all      # every one

A maintainers' script: run it after a change in `lcrl_bench/scenes/shapes/hollows.py` and commit
what it writes. CoACD runs in a process of its own (its wheel brings a second OpenMP runtime), on
one thread and with a fixed seed, so the same template gives the same hulls.
"""

from __future__ import annotations

import argparse
import io
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any, Final

import numpy as np
import trimesh
from numpy.typing import NDArray

from lcrl_bench.scenes.shapes.hollows import hollow_names, hollow_template
from lcrl_bench.scenes.shapes.hulls import mesh_hash
from lcrl_bench.scenes.shapes.primitives import Template
from lcrl_bench.storage import sha256_of, write_bytes, write_json

FOLDER: Final = Path(__file__).resolve().parents[1] / "assets" / "hulls"
SETTINGS: Final = {"threshold": 0.08, "max_convex_hull": 8, "max_ch_vertex": 32, "seed": 0}
"""CoACD's: the concavity it stops at, and how many hulls of how many vertices it may make."""


def decompose(template: Template) -> list[NDArray[np.float32]]:
    """The vertices of the convex hulls CoACD finds, by a subprocess, within the unit box."""
    with tempfile.TemporaryDirectory() as folder:
        source, target = Path(folder, "mesh.npz"), Path(folder, "hulls.npz")
        np.savez(source, vertices=template.vertices, faces=template.faces)
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        command = [sys.executable, __file__, "--worker", str(source), str(target)]
        subprocess.run(command, check=True, env=environment, stdout=subprocess.DEVNULL)
        with np.load(target, allow_pickle=False) as arrays:
            hulls = [arrays[name] for name in sorted(arrays.files)]
    return [np.clip(hull, 0.0, 1.0).astype(np.float32) for hull in hulls]


def worker(source: str, target: str) -> None:
    """Run CoACD on the mesh in `source`; write the hulls' vertices to `target`."""
    import coacd

    coacd.set_log_level("error")
    with np.load(source, allow_pickle=False) as arrays:
        mesh = coacd.Mesh(arrays["vertices"], arrays["faces"])
    pieces = coacd.run_coacd(mesh, preprocess_mode="off", decimate=True, **SETTINGS)
    arrays: dict[str, Any] = {f"h{k:03d}": piece[0] for k, piece in enumerate(pieces)}
    np.savez(target, **arrays)


def packed(hulls: list[NDArray[np.float32]]) -> bytes:
    """The npz file of some hulls: `v0`, `f0`, `v1`, `f1`, ..."""
    arrays: dict[str, Any] = {}
    for k, points in enumerate(hulls):
        # The hull of the rounded points: rounding must not leave a dent.
        mesh = trimesh.Trimesh(np.round(points.astype(np.float64), 4)).convex_hull
        arrays[f"v{k}"] = mesh.vertices.astype(np.float32)
        arrays[f"f{k}"] = mesh.faces.astype(np.uint8)
    buffer = io.BytesIO()
    np.savez_compressed(buffer, **arrays)
    return buffer.getvalue()


def make(every: bool) -> None:
    """Bring the folder up to date with the templates; remove what no template asks for."""
    path = FOLDER / "manifest.json"
    made = json.loads(path.read_text("utf-8"))["hollows"] if path.exists() else {}
    made = {name: row for name, row in made.items() if name in hollow_names()}
    for name in hollow_names():
        template, file = hollow_template(name), FOLDER / f"{name}.npz"
        mesh = mesh_hash(template)
        if not every and made.get(name, {}).get("mesh") == mesh and file.exists():
            continue
        hulls = decompose(template)
        data = packed(hulls)
        write_bytes(file, data)
        made[name] = {"mesh": mesh, "file": sha256_of(data), "hulls": len(hulls)}
        # After each: an interrupted run leaves files that fit their hashes.
        write_json(path, {"coacd": SETTINGS, "hollows": made})
        print(f"{name}: {len(hulls)} hulls, {len(data)} bytes", flush=True)
    write_json(path, {"coacd": SETTINGS, "hollows": made})
    for file in FOLDER.glob("*.npz"):
        if file.stem not in made:
            file.unlink()


def main() -> None:
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--all", action="store_true", help="also those whose template is unchanged")
    parser.add_argument("--worker", nargs=2, metavar=("SOURCE", "TARGET"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.worker:
        worker(*arguments.worker)
    else:
        make(arguments.all)


if __name__ == "__main__":
    main()
