"""imuwb: a workbench for inertial logs.

``imuwb.read(path)`` gives a Log; ``imuwb.identification`` and its neighbours take its arrays.
"""

import lazy_loader

# The public names are in __init__.pyi. Each is imported when it is first used, so that ``import imuwb`` is fast.
_attached, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> object:
    """Return a public name, or the version from the package's metadata, which are slow to import."""
    if name == "__version__":
        from importlib.metadata import version  # noqa: PLC0415 - slow to import

        return version("imuwb")
    return _attached(name)
