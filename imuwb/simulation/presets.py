"""Published sensors: error models with the figures of the three papers."""

from importlib.resources import files

from imuwb.errors import UsageError
from imuwb.stochastic import ImuErrorModel


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
    return ImuErrorModel.from_toml(text, f"preset {name}")
