"""The suite's content: the 61 classes, taxonomies, furniture recipes, collision hulls."""
