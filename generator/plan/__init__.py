"""What code has to do, in no language: typed operations that each target spells.

Which operations there are, and in which order, is decided here once. A target decides how an operation is written in
its language. The reference codec never imports this: it is what every target is tested against.
"""
