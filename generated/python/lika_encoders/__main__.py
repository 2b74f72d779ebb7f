# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Command line of the package. Its option --help describes it."""

import sys

from codewheel_runtime.commands import main as command


def main() -> int:
    """Run the command with the arguments of the process, and return the exit code."""
    return command.main(str(__package__))


if __name__ == "__main__":
    sys.exit(main())
