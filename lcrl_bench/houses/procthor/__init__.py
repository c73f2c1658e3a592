"""ProcTHOR / AI2-THOR house files (schema 1.0.0) as a house source."""

from lcrl_bench.houses.procthor.importer import import_procthor

__all__ = ["import_procthor"]
