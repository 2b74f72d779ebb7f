# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Descriptions of frames for ``decode_many`` and ``encode_many``. Each family has a module, loaded on first use."""
