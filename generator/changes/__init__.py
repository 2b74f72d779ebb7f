"""Compare two versions of specs, and report the impact of each change on users of the outputs.

Resolved models are compared: ``families`` goes through two families, ``counterparts`` recognizes renamed parts, and
``compare`` compares their members by the rules in the table of ``model.members``. ``family_pair`` and ``values``
compare numbers by their values. ``rules`` defines the impact of each rule. ``report`` presents the changes.
"""
