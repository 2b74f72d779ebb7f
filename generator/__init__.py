"""Turn descriptions of absolute encoders into code, XML and documentation."""

#: Version of the distribution. ``pyproject.toml`` takes it from here.
__version__ = "0.1.0"
