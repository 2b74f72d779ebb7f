# Licence 0BSD: you may use, change and distribute this file without any condition.
"""Tables from the manuals, except frames, registers and procedures. Each family has a module, loaded on first use."""
