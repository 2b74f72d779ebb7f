"""Mutants of specs: planted mistakes of a transcriber, to see which of them ``check`` refuses."""
