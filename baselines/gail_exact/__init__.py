"""GAIL-Exact."""
