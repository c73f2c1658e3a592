"""How fast the suite is: each computation that matters, timed beside a simpler implementation."""
