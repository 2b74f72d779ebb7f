"""Find the layout of an unknown encoder from several of its frames.

``checks`` finds CRCs and parity bits that are correct in all frames, and ``fields`` splits the other bits into a
position, other numbers and constants. ``search`` ranks the layouts by the number of bits that describe the frames, and
``answers`` writes each layout as a line.
"""
