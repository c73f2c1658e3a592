"""How fast the suite is beside what its users would otherwise pick."""
