"""Laws of the convex parts that stand for the objects in collisions, and of the hulls' files."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from lcrl_bench.errors import IntegrityError, InvalidFileError
from lcrl_bench.scenes.shapes import (
    collision_parts,
    hulls,
    object_parts,
    shape_count,
    shaped_labels,
)
from lcrl_bench.scenes.shapes.hollows import hollow_names, hollow_template
from lcrl_bench.storage import sha256_of

SHAPES = [(label, shape) for label in shaped_labels() for shape in range(shape_count(label))]
SIZES = [(0.6, 0.5, 0.4), (0.15, 0.2, 0.25)]


@pytest.fixture
def folder(repository: Path) -> Path:
    """Where the hulls are kept."""
    return repository / "assets" / "hulls"


@pytest.mark.parametrize("name", hollow_names())
def test_hulls_were_made_from_todays_template(name: str):
    made = hulls.hull_manifest().get(name, {}).get("mesh")
    assert made == hulls.mesh_hash(hollow_template(name)), (
        f"the template '{name}' changed: run scripts/make_hulls.py and commit assets/hulls"
    )


def test_the_manifest_lists_exactly_the_files_that_are_there(folder: Path):
    listed = hulls.hull_manifest()
    assert {path.stem for path in folder.glob("*.npz")} == set(listed) == set(hollow_names())
    for name, row in listed.items():
        assert sha256_of((folder / f"{name}.npz").read_bytes()) == row["file"]


def test_the_hulls_are_small(folder: Path):
    assert sum(path.stat().st_size for path in folder.iterdir()) < 300_000


@pytest.mark.parametrize(("label", "shape"), SHAPES)
@pytest.mark.parametrize("size", SIZES)
def test_collision_parts_are_convex_and_inside_the_box(
    label: str, shape: int, size: tuple[float, float, float]
):
    for part in collision_parts(label, size, shape):
        mesh = trimesh.Trimesh(part.vertices, part.faces, process=False)
        assert mesh.is_watertight, part.name
        assert part.convex
        assert mesh.volume > 0.99 * mesh.convex_hull.volume > 0, part.name
        assert (np.abs(part.vertices) <= np.array(size) / 2 + 1e-3).all(), part.name


def distances_to_hulls(points: np.ndarray, name: str) -> np.ndarray:
    """Distance of each point of the unit box to the nearest hull; 0 inside one."""
    nearest = np.full(len(points), np.inf)
    for hull in hulls.hollow_hulls(name):
        mesh = trimesh.Trimesh(hull.vertices, hull.faces, process=False)
        _, distance, _ = trimesh.proximity.closest_point_naive(mesh, points)
        normals, origins = mesh.face_normals, mesh.triangles_center
        outside = ((points[:, None] - origins) * normals).sum(axis=-1).max(axis=1) > 1e-6
        nearest = np.minimum(nearest, np.where(outside, distance, 0.0))
    return nearest


@pytest.mark.parametrize("name", hollow_names())
def test_the_hulls_cover_the_surface_they_were_made_from(name: str):
    template = hollow_template(name)
    mesh = trimesh.Trimesh(*template, process=False)
    points = trimesh.sample.sample_surface(mesh, 400, seed=np.random.default_rng(0))[0]
    distance = distances_to_hulls(np.asarray(points), name)
    assert distance.max() < 0.1
    assert distance.mean() < 0.02


@pytest.mark.parametrize("name", hollow_names())
def test_the_hulls_fill_little_more_than_the_walls(name: str):
    filled = sum(
        trimesh.Trimesh(hull.vertices, hull.faces, process=False).volume
        for hull in hulls.hollow_hulls(name)
    )
    assert filled < 2 * trimesh.Trimesh(*hollow_template(name), process=False).volume


@pytest.mark.parametrize("name", ["bathtub-square", "basin-square", "bowl", "pan", "tumbler"])
def test_a_hollow_stays_hollow(name: str):
    inside = np.array([[0.5, 0.5, height] for height in (0.6, 0.8, 0.95)])
    assert distances_to_hulls(inside, name).min() > 0.05


def test_a_solid_part_collides_as_itself():
    size = (1.6, 0.9, 0.75)
    shown = object_parts("dining_table", size, 0)
    assert collision_parts("dining_table", size, 0) == shown


def test_damaged_hulls_are_refused(folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    copy = tmp_path / "hulls"
    copy.mkdir()
    data = bytearray((folder / "bowl.npz").read_bytes())
    data[100] ^= 1
    (copy / "bowl.npz").write_bytes(data)
    (copy / "manifest.json").write_text((folder / "manifest.json").read_text())
    monkeypatch.setattr(hulls.resources, "files", lambda _: tmp_path)
    hulls.hollow_hulls.cache_clear()
    with pytest.raises(IntegrityError, match=r"bowl\.npz: expected SHA-256.*make_hulls"):
        hulls.hollow_hulls("bowl")
    with pytest.raises(InvalidFileError, match=r"pan\.npz: this hollow has no hulls"):
        hulls.hollow_hulls("pan")


def test_the_manifest_says_how_the_hulls_were_made(folder: Path):
    manifest = json.loads((folder / "manifest.json").read_text())
    assert set(manifest["coacd"]) == {"max_ch_vertex", "max_convex_hull", "seed", "threshold"}
