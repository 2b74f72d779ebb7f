# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Reads files of frames, and writes files of columns."""
