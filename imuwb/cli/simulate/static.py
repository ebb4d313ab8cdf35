"""imuwb simulate static: a still IMU on a bench."""

from dataclasses import dataclass
from typing import Annotated

from imuwb.cli.options import Force
from imuwb.cli.simulate.options import Output, Sensor, Warm, check_output, save
from imuwb.options import POSITIVE, Options


@dataclass(frozen=True)
class Length(Options):
    """How long a still IMU is recorded."""

    hours: Annotated[float, "duration of the log (h)", POSITIVE] = 1.0


def static(*, output: Output, sensor: Sensor, length: Length, samples: Warm, force: Force = False) -> None:
    """Simulate a still IMU with the noise of a published sensor or of an error model.

    Example: imuwb simulate static --preset 3dm-gx3-25 --hours 7 --seed 1 -o static.mcap
    """
    from imuwb import simulation  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.terminal import progress  # noqa: PLC0415

    model, seconds = sensor.model(), length.hours * 3600
    celsius = samples.celsius(seconds)
    check_output(output, force=force)
    with progress("simulating") as report:
        log = simulation.static(
            model, seconds, samples.rate, samples.seed, celsius=celsius, quantize=samples.quantize,
            bandwidth=samples.bandwidth, progress=report,
        )  # fmt: skip
    save({output: log}, force=force)
