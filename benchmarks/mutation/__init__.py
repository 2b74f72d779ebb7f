"""Mutants of specs: the slips of a transcriber, made on purpose, to see which of them ``check`` refuses."""
