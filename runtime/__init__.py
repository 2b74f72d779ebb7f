"""The runtime: source files that the generated code needs, the same for all manufacturers, copied unchanged."""
