"""imuwb: a workbench for inertial logs.

``imuwb.read(path)`` gives a Log; ``imuwb.identification`` and its neighbours take its arrays.
"""

import os
import sys

if sys.argv[:1] == ["-m"] and sys.path[:1] in ([""], [os.getcwd()]):  # noqa: PTH109 - as Python itself writes it
    # ``python -m`` looks for modules in the current folder first, where a stranger's file may have the name of one.
    _here = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))  # noqa: PTH100, PTH120 - pathlib is slow to import
    if os.path.realpath(sys.path[0] or os.curdir) != os.path.realpath(_here):
        del sys.path[0]

import lazy_loader

# The public names are in __init__.pyi. Each is imported when it is first used, so that ``import imuwb`` is fast.
_attached, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    """Return a public name, or the version from the package's metadata, which are slow to import."""
    if name == "__version__":
        from importlib.metadata import version  # noqa: PLC0415 - slow to import

        return version("imuwb")
    return _attached(name)
