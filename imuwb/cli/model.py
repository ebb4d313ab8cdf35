"""imuwb model: show, compare, export and check error models."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from imuwb.cli import estimator_files, sensor_list
from imuwb.cli.options import Force, Full, output_option
from imuwb.cli.parameters import expanded
from imuwb.errors import ImuwbError, UsageError

if TYPE_CHECKING:
    from imuwb.analysis import Answer, Review
    from imuwb.review.answers.panel import Origin
    from imuwb.stochastic import ImuErrorModel

FEWEST = 100  #: samples for which curves are drawn

PANELS = {"Chosen": "The numbers"}

app = typer.Typer(no_args_is_help=True, help="Show, compare, check, export, import and explain error models.")

app.command("export")(expanded(estimator_files.export, PANELS))
app.command("import")(estimator_files.import_)
app.command("explain")(expanded(estimator_files.explain, PANELS))
app.command("merge")(estimator_files.merge)
app.command("list")(sensor_list.list_)

MODEL = "The error model"  #: group of the options in the help
_Model = Annotated[
    Path,
    typer.Argument(help="The error model, or the name of a published sensor.", metavar="MODEL", rich_help_panel=MODEL),
]
_Output = Annotated[
    Path | None,
    output_option(
        "--output", "-o", text="Draw the Allan deviation and the spectrum in this recording.", metavar="FILE.rrd"
    ),
]
_Rate = Annotated[
    float, output_option("--rate", text="Rate of the samples for which the curves are drawn (Hz).", metavar="HZ")
]
_Hours = Annotated[
    float, output_option("--hours", text="Length of the record for which the curves are drawn (h).", metavar="HOURS")
]


@app.command()
def show(
    model: _Model,
    *,
    rate: _Rate = 100.0,
    hours: _Hours = 10.0,
    output: _Output = None,
    force: Force = False,
    full: Full = False,
) -> None:
    """Show the terms of an error model; with -o also its Allan deviation and its spectrum.

    Example: imuwb model show static.error-model.toml -o model.rrd
    """
    _review([model], rate, hours, output, force=force, full=full)


@app.command()
def compare(
    models: Annotated[
        list[Path], typer.Argument(help="Two or more error models.", metavar="MODEL.toml", rich_help_panel=MODEL)
    ],
    *,
    rate: _Rate = 100.0,
    hours: _Hours = 10.0,
    output: _Output = None,
    force: Force = False,
    full: Full = False,
) -> None:
    """Compare the terms of error models; with -o also their Allan deviations and spectra.

    Example: imuwb model compare bench.toml chamber.toml
    """
    if len(models) < 2:  # noqa: PLR2004 - one has nothing to be compared with
        raise UsageError(f"{len(models)} model is given; compare needs two or more; for one model use imuwb model show")
    _review(models, rate, hours, output, force=force, full=full)


@app.command()
def check(
    model: _Model,
    *,
    against: Annotated[
        Path,
        typer.Option(
            help='File of limits, such as [gyro] N = "0.3 deg/√h", or another error model or published sensor: the upper ends of its intervals are the limits.',
            metavar="FILE.toml",
            rich_help_panel=MODEL,
        ),
    ],
    factor: Annotated[
        float,
        typer.Option(help="Factor by which the limits are multiplied.", metavar="NUMBER", rich_help_panel=MODEL),
    ] = 1.0,
    full: Full = False,
    json: Annotated[bool, output_option("--json", text="Print JSON on stdout.")] = False,
) -> None:
    """Check an error model against a data sheet or another sensor. Exit code 1: a limit is exceeded, or may be exceeded.

    Example: imuwb model check static.error-model.toml --against datasheet.toml --factor 1.2
    """
    from imuwb.analysis import Step  # noqa: PLC0415 - help must not wait
    from imuwb.cli.terminal import print_panel, shower  # noqa: PLC0415
    from imuwb.review.answers.document import plain  # noqa: PLC0415
    from imuwb.review.answers.model_answers import check_answer  # noqa: PLC0415
    from imuwb.review.answers.models import verdicts_table  # noqa: PLC0415
    from imuwb.review.answers.panel import Origin  # noqa: PLC0415
    from imuwb.simulation import preset_names, sensor_model  # noqa: PLC0415
    from imuwb.stochastic.model_check import check as checked  # noqa: PLC0415
    from imuwb.stochastic.model_check import limits, limits_of  # noqa: PLC0415

    if not 0 < factor < math.inf:
        raise UsageError(f"--factor is {factor}; it must be above 0")
    published = not against.exists() and str(against) in preset_names()
    wanted = limits_of(sensor_model(against), factor) if published else limits(against, factor)
    verdicts = checked(sensor_model(model), wanted)
    kept = all(v.outcome == "within" for v in verdicts)
    if json:
        import json as json_module  # noqa: PLC0415 - the option has its name

        content = {"model": str(model), "against": str(against), "passed": kept, "limits": plain(verdicts)}
        typer.echo(json_module.dumps(content, indent=1, ensure_ascii=False))
    else:
        if full:
            shower(data=True)(verdicts_table(verdicts, model.name, against.name))
        step = Step("imuwb model show {log}", "all its terms")
        print_panel(check_answer(verdicts, against.name, (step,)), Origin("check", (str(model),)), data=True)
    if not kept:
        failed = [f"{v.limit.axis} {v.limit.letter} ({v.outcome})" for v in verdicts if v.outcome != "within"]
        raise ImuwbError(f"{model}: not within {against}: {', '.join(failed)}")


def _review(paths: Sequence[Path], rate: float, hours: float, output: Path | None, *, force: bool, full: bool) -> None:
    """Print the terms; draw them only if a recording is wanted."""
    from imuwb.cli.next_steps import model_steps  # noqa: PLC0415
    from imuwb.cli.places import reserved  # noqa: PLC0415 - help must not wait
    from imuwb.cli.terminal import print_panel, shower  # noqa: PLC0415
    from imuwb.review.answers.model_answers import compare_answer, show_answer  # noqa: PLC0415
    from imuwb.review.answers.models import tables_of  # noqa: PLC0415
    from imuwb.review.answers.panel import Origin  # noqa: PLC0415
    from imuwb.simulation import sensor_model  # noqa: PLC0415

    if not (0 < rate < math.inf and 0 < hours < math.inf and hours * 3600 * rate >= FEWEST):
        raise UsageError(f"--rate is {rate}, --hours {hours}; both must be above 0, and give at least {FEWEST} samples")
    if output is not None and output.suffix != ".rrd":
        raise UsageError(f"--output {output}: the suffix must be .rrd")
    models = {path.name: sensor_model(path) for path in paths}
    if len(models) < len(paths):
        models = {str(path): sensor_model(path) for path in paths}
    steps = tuple(model_steps())
    answer = show_answer(next(iter(models.values())), steps) if len(models) == 1 else compare_answer(models, ())
    origin = Origin("model" if len(models) == 1 else "models", tuple(map(str, paths)))
    if output is not None:  # it is written before the first line is printed
        with reserved([output], paths, force=force):
            _draw(models, rate, hours, output, answer, origin)
    show = shower(data=True)
    for table in tables_of(models) if full else ():
        show(table)
    wrote = () if output is None else (f"{output} (imuwb view)",)
    print_panel(answer, replace(origin, wrote=wrote), data=True)


def _draw(
    models: "Mapping[str, ImuErrorModel]", rate: float, hours: float, output: Path, answer: "Answer", origin: "Origin"
) -> None:
    from imuwb.review.answers.models import draw_models  # noqa: PLC0415 - help must not wait
    from imuwb.review.recording.answered import write_answer  # noqa: PLC0415 - the viewer's library is slow to import

    def draw(review: "Review") -> None:
        draw_models(models, rate, hours * 3600, review)

    write_answer(
        output, "Model" if len(models) == 1 else "Models", answer, origin, tuple(models), {"models": models}, draw
    )
