"""An encoder described in one line, such as ``biss:position=32,error,warning,crc=6:0x43``.

``parse`` reads the line, and ``fields`` reads its fields. ``spec`` writes the line as a spec, and builds the device
that this spec describes.
"""
