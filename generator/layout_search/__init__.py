"""Find the layout of an unknown encoder from several of its frames.

``checks`` finds CRCs and parity bits that all frames satisfy, ``numbers`` measures how much the values of a field
surprise, and ``fields`` splits the other bits into a position, other numbers and constants. ``search`` ranks the
layouts by their description length, and ``answers`` writes each as a line.
"""
