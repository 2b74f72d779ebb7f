# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Decodes and encodes many frames at once, as columns."""
