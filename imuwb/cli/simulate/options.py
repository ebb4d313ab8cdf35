"""What the commands of ``imuwb simulate`` share: their options, the sensor, and where logs go."""

from __future__ import annotations

from collections.abc import Generator, Mapping
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from imuwb.cli.options import output_option
from imuwb.errors import UsageError
from imuwb.options import NOT_NEGATIVE, POSITIVE, Form, Options
from imuwb.renames import draft_of, settle

if TYPE_CHECKING:  # help must not wait for numpy
    from imuwb.log import Log
    from imuwb.simulation import Temperature
    from imuwb.stochastic import ImuErrorModel

LEAST_RAMP = 1.0  #: s
TRUTH = "It states its true parameters: imuwb info --full shows them."

Output = Annotated[
    Path,
    output_option("--output", "-o", text="The log to write; its suffix, .mcap or .csv, is its format.", metavar="FILE"),
]


def sensor_names() -> tuple[str, ...]:
    """Return the names of the published sensors, for a shell."""
    from imuwb.simulation import preset_names  # noqa: PLC0415 - only a shell asks

    return preset_names()


@dataclass(frozen=True)
class Sensor(Options):
    """The sensor that is simulated: a published sensor, or one with the user's error model."""

    preset: Annotated[
        str | None,
        "name of a published sensor; with an unknown name, the error lists all sensors",
        Form("NAME", words=sensor_names),
    ] = None
    error_model: Annotated[Path | None, "error model of a sensor of your own", Form("MODEL.toml")] = None

    def model(self) -> ImuErrorModel:
        """Return the sensor's error model."""
        return model_of(self.preset, "--preset", self.error_model)


@dataclass(frozen=True)
class Samples(Options):
    """The samples that a sensor puts out."""

    rate: Annotated[float, "samples per second (Hz)", POSITIVE, Form("HZ")] = 100.0
    seed: Annotated[int, "seed of the random numbers; the same seed gives the same log", NOT_NEGATIVE] = 0
    quantize: Annotated[bool, "round to the lsb that the error model states"] = False


@dataclass(frozen=True)
class Filtered(Samples):
    """Samples whose noise may be low-pass filtered."""

    bandwidth: Annotated[
        float | None, "cutoff of a Butterworth low-pass of second order for the noise (Hz)", POSITIVE, Form("HZ")
    ] = None


@dataclass(frozen=True)
class Warm(Filtered):
    """Samples of a sensor whose temperature may change."""

    temperature: Annotated[
        float | tuple[tuple[float, float], ...] | None,
        "temperature of the sensor (°C): one value; FROM:TO, a ramp over the whole log; or corners of a curve as "
        "seconds:temperature, straight lines between them",
        Form("CELSIUS|FROM:TO|S:CELSIUS,...", "25, -40:70 or 0:-30,600:-30,1200:45"),
    ] = None

    def celsius(self, duration: float) -> Temperature | float | None:
        """Return the temperature over a log of a given length in seconds.

        Raises:
            UsageError: times that do not rise, or a temperature that no sensor has.
        """
        from imuwb.simulation import Temperature  # noqa: PLC0415 - help must not wait for numpy

        if not isinstance(self.temperature, tuple):
            return self.temperature
        try:
            if len(self.temperature) == 1:
                return Temperature.ramp(*self.temperature[0], max(duration, LEAST_RAMP))
            return Temperature(self.temperature)
        except UsageError as error:
            raise UsageError(f"--temperature: {error}") from error


#: group of options -> its panel of the help, by the name of its dataclass
PANELS = {
    "Sensor": "The IMU", "Samples": "The IMU", "Filtered": "The IMU", "Warm": "The IMU", "Vehicle": "The IMU",
    "BenchSensor": "The IMU", "BenchSamples": "The IMU", "Bench": "The bench", "Positions": "The bench",
    "Table": "The bench", "SetPoints": "The chamber", "Length": "The IMU", "Drive": "The drive", "Disturbances": "The road, and noise in motion",
    "Gnss": "The GNSS receiver", "Wheels": "The odometer",
}  # fmt: skip


def model_of(name: str | None, option: str, error_model: Path | None) -> ImuErrorModel:
    """Return the error model of a published sensor, or the user's error model.

    Raises:
        UsageError: neither of the two is given, or both are.
    """
    from imuwb.simulation import preset  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.stochastic import ImuErrorModel  # noqa: PLC0415

    if name is not None and error_model is None:
        return preset(name)
    if error_model is not None and name is None:
        return ImuErrorModel.read(error_model)
    raise UsageError(f"simulate needs one sensor: give either {option} NAME or --error-model MODEL.toml")


def check_output(output: Path, *, force: bool) -> None:
    """Check before the work begins that a log can be written."""
    from imuwb.cli.places import check_place  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.writers import SUFFIXES  # noqa: PLC0415

    if output.suffix not in SUFFIXES:
        raise UsageError(f"--output {output}: the suffix must be {' or '.join(SUFFIXES)}")
    check_place(output, force=force)


def check_folder(folder: Path, files: list[Path], *, force: bool) -> None:
    """Check before the work begins that a folder can be written, and that it contains no other logs."""
    from imuwb.cli.places import check_place  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.writers import SUFFIXES  # noqa: PLC0415

    if folder.suffix in SUFFIXES:
        raise UsageError(f"--output {folder}: the logs are written into a folder; give a name without {folder.suffix}")
    if not folder.is_dir():
        check_place(folder, force=False)
        return
    settle(folder)
    held = sorted(set(folder.iterdir()) - set(files) - set(map(draft_of, files)))
    if held or any(file.exists() for file in files):
        if not force:
            raise UsageError(
                f"--output {folder}: the folder is not empty; choose another one, or overwrite logs of these names with --force"
            )
        if held:
            typer.echo(f"note: {folder} has {len(held)} other files, such as {held[0].name}; they stay", err=True)
    for file in files:
        check_place(file, force=force)


@contextmanager
def made(folder: Path) -> Generator[None]:
    """Make a folder; take it away again if the work in it fails and leaves it empty."""
    existed = folder.is_dir()
    folder.mkdir(exist_ok=True)
    try:
        yield
    except BaseException:
        if not existed:
            with suppress(OSError):  # it is not empty
                folder.rmdir()
        raise


def save(logs: Mapping[Path, Log], texts: Mapping[Path, str] | None = None, *, force: bool) -> None:
    """Write logs and texts, and print where."""
    from imuwb.cli.places import reserved  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.cli.terminal import progress  # noqa: PLC0415
    from imuwb.cli.written import print_written  # noqa: PLC0415
    from imuwb.writers import places, write, write_text  # noqa: PLC0415

    texts = texts or {}
    files = [*(place for path, log in logs.items() for place in places(log, path)), *texts]
    with reserved(files, [], force=force):
        for path, log in logs.items():
            with progress(f"writing {path.name}") as report:
                write(log, path, report)
        for path, text in texts.items():
            write_text(path, text)
    first = next(iter(logs.values()))
    known = (f"The truth is in {' and '.join(path.name for path in texts)}.",) if texts else ()
    truth = () if texts or not first.truth else (TRUTH,)
    print_written("simulate", first, files, (*known, *truth), len(logs))
