"""Houses: typed rooms, walls with openings, placed labelled objects; and where they come from."""
