"""Explanations of frames with an error by common mistakes."""

#: Frames that are judged together. More of them do not change what explains all of them.
MOST_FRAMES = 100
