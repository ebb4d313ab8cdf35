"""imuwb: a workbench for inertial logs.

``imuwb.read(path)`` gives a Log; ``imuwb.identification`` and its neighbours take its arrays.
"""

from importlib.metadata import version

import lazy_loader

__version__ = version("imuwb")

# The public names are in __init__.pyi; each is imported when it is first used, so that ``import imuwb`` is fast.
__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
