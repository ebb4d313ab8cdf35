"""Published sensors: error models with the figures of the three papers, and the numbers of data sheets."""

import tomllib
from importlib.resources import files

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
