"""The contract a method keeps, and the registry that finds it. No concrete method."""
