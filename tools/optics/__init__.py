"""Camera optics: which eye height, pitch and tile size show enough to solve the tasks."""
