"""Reads the sidecar ``LOG.toml`` beside a text log; it states what the log itself does not."""

from dataclasses import replace
from pathlib import Path
from typing import Any, cast

from imuwb.documents import document_of, shown
from imuwb.errors import UnreadableLogError, UsageError
from imuwb.log import AXES
from imuwb.notes import Note
from imuwb.readers.batch import Remark, simulated
from imuwb.readers.read_options import ReadOptions
from imuwb.sidecars import MARK, mark_of

#: key -> the rule for its value
_KEYS = {
    "rate": "a number (Hz)",
    "columns": "a list of names",
    "units": 'a table such as { gyro = "deg/s" }',
    "frame": '"FRD" or "FLU"',
    "simulated": "a table of texts",
    "epoch": '"unix" (1970 UTC), "boot" (power-up) or "log" (the log\'s start)',
    MARK: "a text, which a sidecar has that imuwb writes",
}
#: keys of error models, of filters, and of lists of limits (``imuwb model check``)
_OTHERS = {*AXES, "error_model", "gyro", "accel"}


def with_sidecar(path: Path, options: ReadOptions) -> tuple[ReadOptions, tuple[Remark, ...]]:
    """Return the options, completed by the log's sidecar, and remarks on what the sidecar states.

    An option that is set overrides the sidecar. An error model or a filter under a sidecar's name is no sidecar.

    Raises:
        UsageError: the sidecar is not TOML, or has an unknown key or a wrong value.
        UnreadableLogError: the sidecar was written with another table.
    """
    passed: list[Remark] = []
    for sidecar in _candidates(path):
        stated = _content(sidecar)
        if _is_model(stated):
            text = f"{sidecar.name} is an error model, a filter or a list of limits, and no sidecar; it is not used to read the log"
            passed.append(Remark(Note("no-sidecar", text)))
            continue
        _check(sidecar, stated)
        if stated.pop(MARK, None) not in (None, mark_of(path)):
            raise UnreadableLogError(
                f"{sidecar} was written with another table than {path.name}, which has changed since then, or was replaced; write the "
                f"table again, or, if all that {sidecar.name} states is true of it, delete the line that begins with {MARK!r} there"
            )
        try:
            completed = replace(
                options,
                rate=options.rate or stated.get("rate"),
                columns=options.columns or tuple(stated.get("columns", ())),
                units={**stated.get("units", {}), **options.units},
                frame=options.frame or stated.get("frame"),
                epoch=options.epoch or stated.get("epoch"),
            )
        except UsageError as error:
            raise UsageError(f"{sidecar}: {error}") from error
        note = Note("sidecar", f"{sidecar.name} states {', '.join(stated) or 'nothing'}")
        truth = stated.get("simulated")
        return completed, (*passed, Remark(note), *([simulated(truth)] if truth else ()))
    return options, tuple(passed)


def sidecar_of(path: Path) -> Path | None:
    """Return the sidecar that the reading of a log uses; None: there is no file with the content of one."""
    for sidecar in _candidates(path):
        try:
            stated = _content(sidecar)
        except UsageError:
            continue
        if stated and stated.keys() <= _KEYS.keys():
            return sidecar
    return None


def _candidates(path: Path) -> list[Path]:
    """Return the files that may be the sidecar of a log."""
    return [place for name in names_of(path.name) if (place := path.parent / name).is_file()]


def names_of(log: str) -> tuple[str, ...]:
    """Return the names that the sidecar of a log of some name may have."""
    return tuple(dict.fromkeys((f"{log}.toml", f"{log.split('.', maxsplit=1)[0]}.toml")))


def _content(sidecar: Path) -> dict[str, Any]:
    return document_of(sidecar, "the log's sidecar")


def _is_model(stated: dict[str, Any]) -> bool:
    """Return whether a document is another one of imuwb: it has a part that only those have, and nothing that a sidecar has."""
    return bool(stated.keys() & _OTHERS) and not stated.keys() & _KEYS.keys()


def _check(sidecar: Path, stated: dict[str, Any]) -> None:
    for key, value in stated.items():
        if key not in _KEYS:
            raise UsageError(f"{sidecar}: unknown key {shown(key)}; a sidecar may have {', '.join(_KEYS)}")
        if not _has_type(key, value):
            raise UsageError(f"{sidecar}: {key} is {shown(value)}; it must be {_KEYS[key]}")


def _has_type(key: str, value: object) -> bool:
    if key == "rate":
        return isinstance(value, int | float) and not isinstance(value, bool)
    if key in ("frame", "epoch", MARK):
        return isinstance(value, str)
    if key == "columns":
        return isinstance(value, list) and all(isinstance(name, str) for name in cast("list[object]", value))
    return isinstance(value, dict) and all(isinstance(unit, str) for unit in cast("dict[str, object]", value).values())
