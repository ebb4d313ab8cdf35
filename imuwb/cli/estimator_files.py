"""imuwb model export, import and explain: the files of estimators and simulators."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from imuwb.cli.completion import completer
from imuwb.cli.estimator_options import Chosen
from imuwb.cli.options import Full
from imuwb.errors import UsageError
from imuwb.options import Form

if TYPE_CHECKING:  # help must not wait for numpy
    from collections.abc import Mapping, Sequence


_Model = Annotated[Path, typer.Argument(help="The error model, or the name of a published sensor.", metavar="MODEL")]
_Tool = "kalibr, openvins, vins, orb-slam3, lio-sam, fast-lio, gtsam, kimera, ros, kf-gins, ob-gins, navego, psins, pyins, inertial-explorer, px4, ardupilot, matlab, gnss-ins-sim, gazebo, airsim, pegasus, rotors"
_Calibration = "kalibr-imu, openvins-imu, imu-tk, imu-calib, px4-cal, ardupilot-ins"
_Thermal = "ardupilot-tcal, px4-tc"
_FORMS = tuple(f"{_Tool}, {_Calibration}, {_Thermal}, json".split(", "))
_tools = completer(Form("TOOL", words=_FORMS))
_Rate = Annotated[
    float | None,
    typer.Option(help="Rate of the samples (Hz), for tools whose values depend on it. Default: that of the model."),
]
_Step = Annotated[
    float | None,
    typer.Option(help="Step of the estimator's filter (s), for px4 and ardupilot. Default: 0.01 and 0.0125."),
]
_Output = Annotated[
    Path | None, typer.Option("--output", "-o", help="The file to write. Default: stdout.", metavar="FILE")
]
_Force = Annotated[bool, typer.Option("--force", help="Overwrite files that exist.")]


def export(
    model: _Model,
    *,
    to: Annotated[
        str,
        typer.Option(
            help=f"The tool: {_Tool}; json (the whole model, SI); for a calibration {_Calibration}; for biases by temperature {_Thermal}.",
            metavar="TOOL",
            autocompletion=_tools,
        ),
    ],
    chosen: Chosen,
    instance: Annotated[
        int | None,
        typer.Option(
            help="Number of the autopilot's IMU, from 0, for parameters of its own. Default: that of the model's log, else 0."
        ),
    ] = None,
    output: _Output = None,
    force: _Force = False,
) -> None:
    """Write an error model as the file of an estimator or simulator, in its units.

    The comments of the file state what was chosen, matched and left out, and what that does to a drift.

    Example: imuwb model export static.error-model.toml --to vins --rate 200 -o imu.yaml
    """
    from imuwb.cli.places import check_place  # noqa: PLC0415 - help must not wait
    from imuwb.cli.terminal import progress  # noqa: PLC0415
    from imuwb.estimators import as_json  # noqa: PLC0415
    from imuwb.estimators import export as exported  # noqa: PLC0415
    from imuwb.estimators.calibration import FILES, THERMAL_FORMS, calibration_text, thermal_text  # noqa: PLC0415

    if to not in _FORMS:
        raise UsageError(
            f"--to {to}: there is no such form; it must be one of {_Tool}, json; for a calibration {_Calibration}; for biases by "
            f"temperature {_Thermal}"
        )
    files = _files(output, to)
    for file in files.values():
        check_place(file, force=force)
    celsius = chosen.celsius
    if celsius is not None and to in ("json", *THERMAL_FORMS):
        raise UsageError(f"--celsius {celsius:g}: --to {to} keeps all temperatures; leave it out")
    with progress(f"reading {model.name}"):
        read, options, said = chosen.of(model)
    with progress(f"matching the terms to {to}"):
        if to == "json":
            text, notes = as_json(read), ()
        elif to in FILES:
            text, notes = calibration_text(read, to, instance, celsius)
        elif to in THERMAL_FORMS:
            text, notes = thermal_text(read, to, instance)
        else:
            made = exported(read, to, options, said)
            text, notes = made.text, made.notes
    _write(text, notes, files, to, model)


def _write(text: str, notes: "Sequence[str]", files: "Mapping[str, Path]", to: str, model: Path) -> None:
    """Write an export to its files, or to stdout where there is none."""
    from imuwb.estimators.calibration import imu_tk_files  # noqa: PLC0415 - help must not wait
    from imuwb.writers import together, write_text  # noqa: PLC0415

    two = to == "imu-tk"  # its files have no comments
    parts = imu_tk_files(text) if two else {"": text}
    with together(files.values()):
        for part, file in files.items():
            write_text(file, parts[part])
    if not files:
        typer.echo(text, nl=False)
        for note in notes if two else ():
            typer.echo(f"note: {note}", err=True)
        return
    _panel("model export", f"for {to}", model, notes, tuple(files.values()))


def _panel(command: str, about: str, read: Path, notes: "Sequence[str]", files: "Sequence[Path]") -> None:
    """Print what was written, and what is in none of it."""
    from imuwb.analysis import Answer, Step  # noqa: PLC0415 - help must not wait
    from imuwb.cli.terminal import print_panel  # noqa: PLC0415
    from imuwb.review.answers.panel import Origin  # noqa: PLC0415

    sentences = tuple(f"{note[:1].upper()}{note[1:]}{'' if note.endswith('.') else '.'}" for note in notes)
    steps = () if command == "model export" else (Step(f"imuwb model show {files[0]}", "its terms"),)
    answer = Answer(about, sentences=sentences, next=steps)
    print_panel(answer, Origin(command, (str(read),), wrote=tuple(map(str, files))), data=False)


def _files(output: Path | None, to: str) -> dict[str, Path]:
    """Return the files to write: one, or one for each triad, which is what imu_tk loads."""
    if output is None:
        return {}
    return (
        {part: output.with_suffix(f".{part}{output.suffix}") for part in ("acc", "gyro")}
        if to == "imu-tk"
        else {"": output}
    )


def import_(
    file: Annotated[Path, typer.Argument(help="File of an estimator, or of data-sheet numbers.", metavar="FILE")],
    *,
    from_: Annotated[
        str | None,
        typer.Option(
            "--from",
            help=f"The tool. Default: by the names in the file. {_Tool}.",
            metavar="TOOL",
            autocompletion=_tools,
        ),
    ] = None,
    rate: _Rate = None,
    step: _Step = None,
    output: Annotated[
        Path | None,
        typer.Option("--output", "-o", help="The error model to write. Default: stdout.", metavar="MODEL.toml"),
    ] = None,
    force: _Force = False,
) -> None:
    """Read the numbers of an estimator's file into an error model. What the file does not state stays unknown.

    Example: imuwb model import imu.yaml -o stated.toml
    """
    import math  # noqa: PLC0415 - as small as the command

    from imuwb.cli.places import check_places  # noqa: PLC0415 - help must not wait
    from imuwb.estimators import Setting, read_estimator_file  # noqa: PLC0415
    from imuwb.writers import write_text  # noqa: PLC0415

    for name, value in (("--rate", rate), ("--step", step)):
        if value is not None and not 0 < value < math.inf:
            raise UsageError(f"{name} is {value}; it must be above 0")
    if output is not None:
        check_places([output], [file], force=force)
    reading = read_estimator_file(file, from_, Setting(rate or math.nan, step or math.nan))
    for note in reading.notes:
        typer.echo(f"note: {note}", err=True)
    if output is None:
        typer.echo(reading.model.to_toml(), nl=False)
        return
    write_text(output, reading.model.to_toml())
    _panel("model import", f"read as {reading.form}", file, (), (output,))


def explain(
    model: _Model,
    *,
    for_: Annotated[str, typer.Option("--for", help=f"The tool: {_Tool}.", metavar="TOOL", autocompletion=_tools)],
    chosen: Chosen,
    full: Full = False,
) -> None:
    """Say what to write into an estimator's file and why, and how wrong the usual shortcuts are for this sensor.

    Example: imuwb model explain static.error-model.toml --for vins
    """
    from imuwb.analysis import Step  # noqa: PLC0415 - help must not wait
    from imuwb.cli.terminal import print_panel, shower  # noqa: PLC0415
    from imuwb.estimators import explain as explained  # noqa: PLC0415
    from imuwb.review.answers.explanations import explain_answer, explain_notes, explain_tables  # noqa: PLC0415
    from imuwb.review.answers.panel import Origin  # noqa: PLC0415

    read, options, said = chosen.of(model)
    found = explained(read, for_, options, said)
    if full:
        values, shortcuts = explain_tables(found, chosen.horizon)
        show = shower(data=True)
        show(values)
        for sentence in explain_notes(found):
            typer.echo(sentence)
        show(shortcuts)
        return
    same = chosen.words()
    steps = (
        Step(f"imuwb model export {{log}} --to {for_}{same}", "the file"),
        Step(f"imuwb model explain {{log}} --for {for_}{same} --full", "all values and notes"),
    )
    print_panel(explain_answer(found, chosen.horizon, steps), Origin("explain", (str(model),)), data=True)


def merge(
    models: Annotated[list[Path], typer.Argument(help="Two or more error models.", metavar="MODEL.toml...")],
    *,
    take: Annotated[
        list[str],
        typer.Option(
            help="Terms, and the model that gives them, by its file name or its place: N,B,K=1 or AR=old.toml. Others: the first. Terms: Q, N, B, K, R, GM, AR, lines, turn-on, calibration, sensor.",
            metavar="TERMS=MODEL",
        ),
    ],
    output: Annotated[Path, typer.Option("--output", "-o", help="The error model to write.", metavar="MODEL.toml")],
    force: _Force = False,
) -> None:
    """Make one error model of the terms of several, such as the noise of a long record and the biases of a calibration.

    Example: imuwb model merge static.toml cube.toml --take calibration=cube.toml -o sensor.toml
    """
    from imuwb.cli.places import check_places  # noqa: PLC0415 - help must not wait
    from imuwb.simulation import sensor_model  # noqa: PLC0415 - help must not wait
    from imuwb.stochastic import merge as merged  # noqa: PLC0415
    from imuwb.writers import write_text  # noqa: PLC0415

    if len(models) < 2:  # noqa: PLR2004 - one has nothing to be merged with
        raise UsageError(f"{len(models)} model is given; merge needs two or more")
    check_places([output], models, force=force)
    taken: dict[str, int] = {}
    for text in take:
        parts, _, source = text.partition("=")
        taken |= dict.fromkeys((part.strip() for part in parts.split(",")), _place(source.strip(), models))
    write_text(output, merged([sensor_model(model) for model in models], taken).to_toml())
    _panel("model merge", f"{len(models)} models are one", models[0], (), (output,))


def _place(source: str, models: list[Path]) -> int:
    """Return which of the models a word names: by its place from 1, or by its file name."""
    if source.isdecimal() and 1 <= int(source) <= len(models):
        return int(source) - 1
    found = [i for i, model in enumerate(models) if source in (str(model), model.name, model.stem)]
    if len(found) != 1:
        raise UsageError(f"--take ...={source}: it must be 1 to {len(models)}, or the name of one of the models")
    return found[0]
