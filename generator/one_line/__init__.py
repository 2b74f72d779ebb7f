"""An encoder described in one line, such as ``biss:position=32,error,warning,crc=6:0x43``.

``parse`` reads the line, ``fields`` its fields, and ``options`` the words before them. ``spec`` writes it as a spec,
and ``encoder`` builds the device that this spec describes.
"""
