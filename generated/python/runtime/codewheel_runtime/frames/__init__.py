# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Frames and registers: their classes, and the encoding and decoding of one of them."""
