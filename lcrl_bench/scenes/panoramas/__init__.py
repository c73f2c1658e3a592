"""What an agent sees: the four semantic views from a standing point, by OpenGL or by rays."""
