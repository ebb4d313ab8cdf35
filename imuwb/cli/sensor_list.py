"""``imuwb model list``: the published sensors, one line each, or all that their sources state."""

from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from imuwb.stochastic import ImuErrorModel

LONGEST = 15  #: letters of a source in the short list, which fits in 80 columns
CAPTION = (
    "white noise N and flicker noise B. ≈: the source leaves the definition open, noise density by √2, bias instability by "
    "0.664. ≤: from the lowest point of the Allan curve. -: not stated. Notes and full sources: --full"
)


def list_(
    *,
    full: Annotated[bool, typer.Option("--full", help="All that the sources state, and the sources in full.")] = False,
) -> None:
    """List the published sensors that imuwb knows, and what their sources state.

    A name stands for a model: imuwb simulate static --preset NAME, imuwb model show NAME, imuwb model export NAME --to TOOL.
    """
    from imuwb.analysis import Table  # noqa: PLC0415 - help must not wait
    from imuwb.cli.terminal import shower  # noqa: PLC0415
    from imuwb.simulation import preset, preset_names  # noqa: PLC0415

    models = [(name, preset(name)) for name in preset_names()]
    if full:
        table = Table("Published sensors: the x axes", ("name", "grade", "gyro", "accelerometer", "source", "note"),
                      tuple((name, *_full(model)) for name, model in models))  # fmt: skip
    else:
        headings = ("name", "grade", "gyro N\ndeg/√h", "acc N\nµg/√Hz", "gyro B\ndeg/h", "source")
        table = Table("Published sensors: the x axes", headings, tuple((n, *_short(m)) for n, m in models), CAPTION)
    shower(data=True)(table)


def _full(model: "ImuErrorModel") -> tuple[str, ...]:
    from imuwb.stochastic.description import axis_text  # noqa: PLC0415 - help must not wait

    terms = (axis_text(axis, model.axes[axis]) if axis in model.axes else "-" for axis in ("gyro_x", "accel_x"))
    return (model.provenance.get("grade", ""), *terms, *(model.provenance.get(key, "") for key in ("source", "note")))


def _short(model: "ImuErrorModel") -> tuple[str, ...]:
    source = model.provenance.get("source", "").split(",")[0]
    source = source if len(source) <= LONGEST else source[: LONGEST - 1] + "…"
    shown = (
        _stated(model, *what)
        for what in (("gyro_x", "N", "deg/√h"), ("accel_x", "N", "µg/√Hz"), ("gyro_x", "B", "deg/h"))
    )
    return (model.provenance.get("grade", ""), *shown, source)


def _stated(model: "ImuErrorModel", axis: str, letter: str, unit: str) -> str:
    """Return a coefficient to three digits, with the sign of its definition; - if it is not stated."""
    from imuwb.units import unit as unit_of  # noqa: PLC0415 - help must not wait

    content = model.axes.get(axis)
    for place, term in enumerate(content.processes.terms if content else ()):
        value = getattr(term, letter, None)
        if isinstance(value, float) and content is not None:
            low, high = content.intervals.get(f"{place}.{letter}", (value, value))
            sign = "" if low == high else "≤" if low == 0 else "≈"
            return f"{sign}{unit_of(unit).from_si(value):.3g}"
    return "-"
