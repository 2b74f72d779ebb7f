"""Compare two versions of specs, and report the impact of each change on users of the outputs.

Resolved models are compared: ``walk`` goes through two families side by side, ``pairs`` recognises renamed things, and
``values`` compares expressions by their values. Each difference has a rule in ``rules``, which gives its impact.
``text``, ``markdown`` and ``data`` report the changes, ``version`` derives the version, and ``record`` saves them.
``revisions`` reads specs from git.
"""
