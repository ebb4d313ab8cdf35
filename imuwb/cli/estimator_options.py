"""The options that say how a model becomes an estimator's numbers: they are the same for its file and for its explanation."""

from __future__ import annotations

import shlex
from dataclasses import dataclass, fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

from imuwb.errors import UsageError
from imuwb.options import Form

if TYPE_CHECKING:  # help must not wait for numpy
    from imuwb.estimators import Options
    from imuwb.stochastic import ImuErrorModel


@dataclass(frozen=True)
class Chosen:
    """Rate, step and horizon; what stands for an unknown; the noise in motion; the temperature."""

    rate: Annotated[
        float | None,
        "Rate of the samples (Hz), for tools whose values depend on it. Default: that of the model.",
        Form("HZ"),
    ] = None
    step: Annotated[
        float | None,
        "Step of the estimator's filter (s), for px4 and ardupilot. Default: 0.01 and 0.0125.",
        Form("SECONDS"),
    ] = None
    horizon: Annotated[
        float,
        "Time without aids (s) after which the estimator's drift is to be right, where a process must stand for another.",
        Form("SECONDS"),
    ] = 60.0
    limits: Annotated[bool, "Write what the record does not show at its upper limit. Default: left out."] = False
    in_motion: Annotated[
        str | None,
        "Noise in motion: factors of N, such as gyro=23,accel=10, or the model or filter that a replay of a drive has saved.",
        Form("FACTORS|FILE.toml"),
    ] = None
    scale_factor: Annotated[
        float | None, "1-sigma of the scale factors (ppm), for tools that have a place for it.", Form("PPM")
    ] = None
    celsius: Annotated[
        float | None,
        "Temperature (°C) at which a model that depends on it is written. Default: what the model states without it.",
        Form("T"),
    ] = None

    def of(self, model: Path) -> tuple[ImuErrorModel, Options, tuple[str, ...]]:
        """Return a model, in motion where that is asked for, the options, and what the factors of a file are.

        Raises:
            UsageError: a file that is no model, or an option out of range.
        """
        from imuwb.estimators import Factors, Options, with_motion  # noqa: PLC0415 - help must not wait
        from imuwb.simulation import sensor_model  # noqa: PLC0415

        read = sensor_model(model)
        factors, said = None, ()
        if self.in_motion is not None and self.in_motion.endswith(".toml"):
            read, sentence = with_motion(read, _road_model(Path(self.in_motion)))
            said = (sentence,)
        elif self.in_motion is not None:
            factors = Factors.of_text(self.in_motion)
        scale = None if self.scale_factor is None else self.scale_factor * 1e-6
        options = Options(self.rate, self.step, self.horizon, self.limits, scale, factors, self.celsius)
        return read, options, said

    def words(self) -> str:
        """Return the options that differ from their defaults, as they are typed, each after a space."""
        texts: list[str] = []
        for field in fields(self):
            value, flag = getattr(self, field.name), f" --{field.name.replace('_', '-')}"
            if value is True:
                texts.append(flag)
            elif value != field.default:
                texts.append(f"{flag} {value:g}" if isinstance(value, float) else f"{flag} {shlex.quote(str(value))}")
        return "".join(texts)


def _road_model(path: Path) -> ImuErrorModel:
    """Return the error model of a file that a replay saved: a model, or a filter, which has one inside."""
    from imuwb.navigation.filter_document import read_filter  # noqa: PLC0415 - help must not wait
    from imuwb.replay.noise.added_noise import with_added  # noqa: PLC0415
    from imuwb.stochastic import ImuErrorModel  # noqa: PLC0415

    try:
        return ImuErrorModel.read(path)
    except UsageError as no_model:
        try:
            saved = read_filter(path)
        except UsageError:
            raise no_model from None
    return with_added(saved.error_model, saved.vibration.white, (0.0, 0.0))  # at the drive's mean vibration
