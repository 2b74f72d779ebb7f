"""Explanations of frames with an error by common mistakes."""

#: Frames that are judged together. More of them do not change what explains all of them.
MOST_FRAMES = 100
#: One of this many frames must fail before a mistake is assumed that half of all frames would reveal.
LEAST_FAILED = 4
