"""imuwb plan: how long to record a still sensor."""

import math
import shlex
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from imuwb.cli.options import Force, Full, output_option
from imuwb.errors import UsageError

if TYPE_CHECKING:  # help must not wait for numpy
    from collections.abc import Iterator, Mapping, Sequence

    from imuwb.analysis import Answer, Review, Step
    from imuwb.identification import RecordPlan
    from imuwb.review.answers.panel import Origin
    from imuwb.stochastic import ImuErrorModel

LETTERS = "QNBK"
USUAL_RATE = 100.0  #: Hz
FASTEST, LONGEST, WIDEST = 1e6, 1e4, 0.9  #: Hz, h, and half width
SENSOR, RECORD = "The sensor", "The record"


_Want = Annotated[
    str,
    typer.Option(
        help="Half the width of the interval that each coefficient is to have, of its value.",
        metavar="N:1%,B:10%,K:30%",
        rich_help_panel=RECORD,
    ),
]
_Preset = Annotated[
    str | None,
    typer.Option(help="A published sensor; imuwb model list has the names.", metavar="NAME", rich_help_panel=SENSOR),
]
_Model = Annotated[
    Path | None, typer.Option(help="The error model of a sensor.", metavar="FILE.toml", rich_help_panel=SENSOR)
]
_Record = Annotated[
    Path | None,
    typer.Option(help="A first, short record of the still sensor.", metavar="LOG", rich_help_panel=SENSOR),
]
_Rate = Annotated[
    float | None,
    typer.Option(
        help="Rate of the samples (Hz). Default: that of the model or of the record, else 100.",
        metavar="HZ",
        rich_help_panel=RECORD,
    ),
]
_Hours = Annotated[
    float | None,
    typer.Option(help="State what a record of this length (h) reaches.", metavar="HOURS", rich_help_panel=RECORD),
]
_Output = Annotated[
    Path | None,
    output_option("--output", "-o", text="Draw the widths against the length in this recording.", metavar="FILE.rrd"),
]
_Json = Annotated[bool, output_option("--json", text="Print JSON on stdout.")]


def plan(
    *,
    want: _Want = "N:1%,B:10%,K:30%",
    preset: _Preset = None,
    model: _Model = None,
    record: _Record = None,
    rate: _Rate = None,
    hours: _Hours = None,
    output: _Output = None,
    force: Force = False,
    full: Full = False,
    json: _Json = False,
) -> None:
    """State how long to record a still sensor, so that its noise is known as well as wanted.

    The answer comes from the Fisher information of the likelihood by which imuwb estimates noise.

    Example: imuwb plan --preset mpu-6050 --want N:1%,B:10% --rate 200
    """
    from imuwb.cli.terminal import progress  # noqa: PLC0415 - help must not wait for numpy
    from imuwb.review.answers.panel import Origin  # noqa: PLC0415

    wants = wanted(want)
    _check(rate, hours, output)
    sensor, own_rate, name, typed = _sensor(preset, model, record)
    used = rate or own_rate or USUAL_RATE
    with progress(f"planning the record of {name}"):
        from imuwb.identification import plan_record  # noqa: PLC0415 - the first line must not wait for it
        from imuwb.review.answers.plan_answer import plan_answer  # noqa: PLC0415

        try:
            found = plan_record(sensor, wants, used, hours=hours)
        except ValueError as error:
            raise UsageError(f"--hours {hours}: {error}") from error
    again = f"imuwb plan {typed} --want {shlex.quote(want)} --rate {used:g}"
    answer, origin = plan_answer(found, wants, tuple(_steps(again, found.hours))), Origin("plan", (name,))
    if output is not None:
        _written(found, sensor, wants, output, answer, origin, [path for path in (model, record) if path], force=force)
    _print(found, wants, output, answer, origin, full=full, json=json)


def _check(rate: float | None, hours: float | None, output: Path | None) -> None:
    for name, value, most in (("--rate", rate, FASTEST), ("--hours", hours, LONGEST)):
        if value is not None and not 0 < value <= most:
            raise UsageError(f"{name} is {value}; it must be above 0 and at most {most:g}")
    if output is not None and output.suffix != ".rrd":
        raise UsageError(f"--output {output}: the suffix must be .rrd")


def _steps(again: str, hours: float | None) -> "Iterator[Step]":
    """Yield what to do next; ``hours``: of the plan, None where no length reaches what is wanted."""
    from imuwb.analysis import Step  # noqa: PLC0415 - help must not wait
    from imuwb.cli.next_steps import analysis_steps  # noqa: PLC0415

    if hours is not None and (twice := _round(2 * hours)) <= LONGEST:
        yield Step(f"{again} --hours {twice:g}", "what twice the time reaches")
    yield from (Step(step.command.replace("{log}", "RECORD"), step.why) for step in analysis_steps({"imu"}))


def _print(
    found: "RecordPlan", wants: "Mapping[str, float]", output: Path | None, answer: "Answer", origin: "Origin", *,
    full: bool, json: bool,
) -> None:  # fmt: skip
    from dataclasses import replace  # noqa: PLC0415 - as small as the command

    from imuwb.cli.terminal import print_panel, shower  # noqa: PLC0415 - help must not wait
    from imuwb.review.answers.plan_answer import plan_table  # noqa: PLC0415

    if json:
        typer.echo(_json(found, wants))
        return
    if full:
        shower(data=True)(plan_table(found))
    wrote = () if output is None else (f"{output} (imuwb view)",)
    print_panel(answer, replace(origin, wrote=wrote), data=True)


def wanted(text: str) -> dict[str, float]:
    """Return the widths of ``N:1%,B:10%``: letter -> half width, a fraction.

    Raises:
        UsageError: another form, letter, or a width outside of 0 % to 90 %.
    """
    found: dict[str, float] = {}
    for part in text.split(","):
        letter, _, size = part.strip().partition(":")
        try:
            width = float(size.strip().removesuffix("%")) / (100 if size.strip().endswith("%") else 1)
        except ValueError:
            width = math.nan
        if letter not in tuple(LETTERS) or not 0 < width <= WIDEST or letter in found:
            raise UsageError(
                f"--want {text}: {part.strip()!r} is not understood; write a letter of {', '.join(LETTERS)} and a width above 0 % and "
                f"at most {100 * WIDEST:g} %, each letter once, such as N:1%,B:10%,K:30%"
            )
        found[letter] = width
    return found


def _sensor(
    preset: str | None, model: Path | None, record: Path | None
) -> "tuple[ImuErrorModel, float | None, str, str]":
    """Return a sensor's model, its rate (Hz), its name, and the option that was typed."""
    from imuwb.estimators.export import model_rate  # noqa: PLC0415 - help must not wait
    from imuwb.simulation import preset as preset_named  # noqa: PLC0415
    from imuwb.simulation import sensor_model  # noqa: PLC0415

    given = [
        (option, value) for option, value in (("--preset", preset), ("--model", model), ("--record", record)) if value
    ]
    if len(given) != 1:
        raise UsageError(
            "a plan needs one sensor: give --preset NAME, --model FILE.toml, or --record LOG, a first short record"
        )
    option, value = given[0]
    typed = f"{option} {shlex.quote(str(value))}"
    if preset is not None:
        return preset_named(preset), None, preset, typed
    if model is not None:
        read = sensor_model(model)
        return read, model_rate(read), str(model), typed
    read, rate = _fitted(Path(str(value)))
    return read, rate, str(value), typed


def _fitted(path: Path) -> "tuple[ImuErrorModel, float]":
    """Return the likeliest terms of a short record, and its rate (Hz)."""
    from imuwb.axes import axes_of  # noqa: PLC0415 - help must not wait
    from imuwb.cli.reading import read_log  # noqa: PLC0415
    from imuwb.errors import MissingDataError  # noqa: PLC0415
    from imuwb.health import stillness_of  # noqa: PLC0415
    from imuwb.identification import fit_likelihood, model_of_fits  # noqa: PLC0415
    from imuwb.readers.read_options import ReadOptions  # noqa: PLC0415

    log = read_log(path, ReadOptions())
    still = stillness_of(log)
    if still is not None and still.moving:
        raise MissingDataError(
            f"{path}: the IMU moves in most of the record, which then shows the motion and not the sensor's noise; give --record a record "
            "of the still sensor"
        )
    axes = axes_of(log.imu())
    try:
        fits = {name: fit_likelihood(axis.longest, axis.clock.interval) for name, axis in axes.items()}
    except ValueError as error:
        raise MissingDataError(f"{path}: {error}") from error
    return model_of_fits(log.imu().name, fits), max(1 / axis.clock.interval for axis in axes.values())


def _round(hours: float) -> float:
    return float(f"{hours:.2g}")


def _json(found: "RecordPlan", wants: "Mapping[str, float]") -> str:
    from imuwb.review.answers.document import json_text  # noqa: PLC0415 - only here

    return json_text({"schema": 1, "wants": dict(wants), "plan": found})


def _written(
    found: "RecordPlan", sensor: "ImuErrorModel", wants: "Mapping[str, float]", output: Path, answer: "Answer", origin: "Origin",
    inputs: "Sequence[Path]", *, force: bool,
) -> None:  # fmt: skip
    from imuwb.cli.places import reserved  # noqa: PLC0415 - help must not wait
    from imuwb.review.answers.plan_answer import by_length, plan_figure, plan_table  # noqa: PLC0415
    from imuwb.review.recording.answered import write_answer  # noqa: PLC0415 - the viewer's library is slow to import

    def draw(review: "Review") -> None:
        for kind in by_length(found, ("gyro", "accel")):
            figure = plan_figure(found, sensor, wants, kind)
            if figure is not None:
                review.figure(figure)
        review.table(plan_table(found))

    with reserved([output], inputs, force=force):
        write_answer(output, "Plan", answer, origin, origin.logs, {"plan": found}, draw)
