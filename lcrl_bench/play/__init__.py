"""Walking the agent by keyboard: what it sees, a map and a guide, drawn in a terminal."""
