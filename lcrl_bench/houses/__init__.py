"""Houses (typed rooms, walls with openings, placed labelled objects) and their sources."""
