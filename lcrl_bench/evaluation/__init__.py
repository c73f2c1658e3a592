"""The harness: a fitted method on every split, its controls, tables and run directories."""
