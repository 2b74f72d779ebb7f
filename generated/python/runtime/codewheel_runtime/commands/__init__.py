# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Command line of a package."""
