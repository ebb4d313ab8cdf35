"""Published sensors: error models with the figures of the three papers, and the numbers of data sheets."""

import tomllib
from importlib.resources import files
from pathlib import Path

from imuwb.errors import UsageError
from imuwb.stochastic import ImuErrorModel, is_data_sheet, read_data_sheet


def preset_names() -> tuple[str, ...]:
    """Return the names of all presets."""
    data = files("imuwb.simulation").joinpath("preset_data")
    return tuple(sorted(entry.name.removesuffix(".toml") for entry in data.iterdir() if entry.name.endswith(".toml")))


def preset(name: str) -> ImuErrorModel:
    """Return a published sensor's error model.

    Raises:
        UsageError: no such preset; the message lists all.
    """
    if name not in preset_names():
        raise UsageError(f"there is no preset {name!r}; there are: {', '.join(preset_names())}")
    text = files("imuwb.simulation").joinpath("preset_data", f"{name}.toml").read_text("utf-8")
    if is_data_sheet(tomllib.loads(text)):
        return read_data_sheet(text, f"preset {name}")
    return ImuErrorModel.from_toml(text, f"preset {name}")


def sensor_model(given: str | Path) -> ImuErrorModel:
    """Return the model in a file; or that of a published sensor, where no file has that name.

    Raises:
        UsageError: neither of them.
    """
    if not Path(given).exists() and str(given) in preset_names():
        return preset(str(given))
    if not Path(given).exists() and not Path(given).suffix:
        raise UsageError(
            f"{given}: there is no such file, and no published sensor of that name; imuwb model list lists them"
        )
    return ImuErrorModel.read(given)
