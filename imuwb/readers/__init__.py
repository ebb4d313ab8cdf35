"""Reads files as Logs. The leading bytes of a file decide its format, never its suffix."""

import lazy_loader

# The public names are in __init__.pyi; each is imported when it is first used.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
