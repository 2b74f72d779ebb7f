"""Operations of the generated code, independent of its language.

This package decides once which operations are needed and in which order. A target decides how to write each operation
in its language. The reference codec never imports this package, since every target is tested against it.
"""
