"""AGILE: a goal classifier and the agent that tries to please it, learned together."""
