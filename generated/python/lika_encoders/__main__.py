# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Command line of the package. ``python -m PACKAGE decode --help`` describes it."""

import sys

from codewheel_runtime.command import main

if __name__ == "__main__":
    sys.exit(main(str(__package__)))
