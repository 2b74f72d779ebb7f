"""Mutants of specs: planted transcription mistakes that show which mistakes ``check`` detects."""
