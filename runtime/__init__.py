"""Ordinary source files that are copied into the output unchanged."""
