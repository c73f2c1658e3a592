"""House to MuJoCo scene: meshes, collision, MJCF, the walkable grid and the panoramas."""
