"""The error models that commands take: files, or published sensors by name."""

from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # help must not wait for numpy
    from imuwb.stochastic import ImuErrorModel


def model_of(given: Path) -> "ImuErrorModel":
    """Return the model in a file; or that of a published sensor, where no file has that name.

    Raises:
        UsageError: neither of them.
    """
    from imuwb.simulation import preset, preset_names  # noqa: PLC0415 - help must not wait
    from imuwb.stochastic import ImuErrorModel  # noqa: PLC0415

    if not given.exists() and str(given) in preset_names():
        return preset(str(given))
    return ImuErrorModel.read(given)
