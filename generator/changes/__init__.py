"""Compare two versions of specs, and report the impact of each change on users of the outputs.

Resolved models are compared: ``families`` goes through two families, ``pairs`` and ``counterparts`` recognise renamed
things, and ``compare`` compares their members by the rules in the table of ``model.members``. ``expressions`` compares
numbers by their values. ``rules`` defines the impact of each rule. The ``report`` modules present the changes.
``version`` derives the version, and ``release_files`` saves it with the changes.
"""
