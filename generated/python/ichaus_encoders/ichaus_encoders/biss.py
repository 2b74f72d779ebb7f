# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Register access over BiSS C. See ``codewheel_runtime.biss``, which contains all of these names."""

from codewheel_runtime.biss import *  # noqa: F403
from codewheel_runtime.biss import __all__ as __all__
