# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Finds frames in the captures of logic analyzers."""
