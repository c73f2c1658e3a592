"""Methods, one folder each; reached through the method registry, never imported by the library."""
