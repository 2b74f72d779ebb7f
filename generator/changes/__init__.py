"""What another version of the specs changes for those who use what is made of them.

Compared are resolved models: ``walk`` goes through two families side by side, ``pairs`` finds what was only renamed,
``values`` compares expressions by what they come to, and each difference has a rule of ``rules``, which says whom it
reaches. ``text``, ``markdown`` and ``data`` tell the changes, ``version`` draws the version from them, ``record`` keeps
them. ``revisions`` reads specs as they were in git.
"""
