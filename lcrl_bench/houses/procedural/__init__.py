"""Houses generated from a seed: laid out, furnished and checked without outside data."""

from lcrl_bench.houses.procedural.generate import generate_house, house_id

__all__ = ["generate_house", "house_id"]
