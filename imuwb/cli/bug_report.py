"""imuwb bug-report: what a report of a fault needs, without any sample of a log."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, cast

import typer

from imuwb.cli.help import LOG
from imuwb.cli.options import Force, output_option
from imuwb.readers.read_options import ReadOptions

LIBRARIES = ("numpy", "scipy", "numba", "rerun-sdk", "typer", "pyarrow", "mcap", "rosbags", "PyWavelets", "matplotlib")
CONTENT = (
    "versions of imuwb, Python and the libraries; the operating system and the processor; installed plugins",
    "names of the IMUWB_ and NUMBA_ variables that are set, without their values",
    "the last fault of imuwb: its kind and its places in the code, numbers and quoted words of its message left out",
    "of the log: its summary, as imuwb info --json states it, and the kinds of its faults; or why it cannot be read",
)


def bug_report(
    log: Annotated[
        str | None,
        typer.Argument(help="The log that shows the fault, if there is one.", metavar="LOG", rich_help_panel=LOG),
    ] = None,
    *,
    reading: ReadOptions,
    output: Annotated[Path, output_option("--output", "-o", text="The file to write.", metavar="FILE.json")] = Path(
        "imuwb-bug-report.json"
    ),
    force: Force = False,
) -> None:
    """Collect what a report of a fault needs, without any sample of a log.

    The file is plain text: versions, the last fault, the summary of the log, without folders and names of users.

    Example: imuwb bug-report flight.bin
    """
    from imuwb.cli.last_fault import last_fault  # noqa: PLC0415 - help must not wait
    from imuwb.cli.places import check_place  # noqa: PLC0415
    from imuwb.errors import UnreadableLogError  # noqa: PLC0415
    from imuwb.readers.bytes.address import place_of  # noqa: PLC0415
    from imuwb.review.answers.document import json_text  # noqa: PLC0415
    from imuwb.writers import write_text  # noqa: PLC0415

    check_place(output, force=force)
    if log is not None and isinstance(place := place_of(log), Path) and not place.exists():
        raise UnreadableLogError(f"{log}: there is no such file; give the path of the log, or leave it out")
    content: dict[str, object] = {
        "schema": 1,
        "content": list(CONTENT if log is not None else CONTENT[:-1]),
        "versions": _versions(),
        "machine": _machine(),
        "plugins": _plugins(),
        "variables": _variables(),
        "last_fault": last_fault(),
    }
    if log is not None:
        content["log"] = _of_log(log, reading)
    write_text(output, json_text(_clean(content, _folders(log))) + "\n")
    typer.echo(f"wrote {output}. It contains:")
    for line in content["content"] if isinstance(content["content"], list) else ():
        typer.echo(f"- {line}")
    typer.echo("It contains no sample of the log, no user name, and no folder. Look at it before you send it.")


def _of_log(log: str, reading: ReadOptions) -> object:
    """Return the summary and the kinds of faults of a log; where it cannot be read, why."""
    from imuwb.cli.info import faults_of  # noqa: PLC0415 - help must not wait
    from imuwb.cli.last_fault import masked  # noqa: PLC0415
    from imuwb.cli.reading import read_log  # noqa: PLC0415
    from imuwb.errors import ImuwbError  # noqa: PLC0415
    from imuwb.readers.bytes.address import place_of  # noqa: PLC0415
    from imuwb.review.answers.document import plain  # noqa: PLC0415
    from imuwb.summary import summarize  # noqa: PLC0415

    place = place_of(log)
    try:
        whole = read_log(place, reading)
        faults = sorted({f"{fault.severity}: {fault.kind}" for fault in faults_of(whole)})
        return {"summary": plain(summarize(whole)), "faults": faults}
    except ImuwbError as error:
        size = place.stat().st_size if isinstance(place, Path) and place.is_file() else None
        return {"error": type(error).__name__, "message": masked(str(error)), "size": size}
    except Exception as error:  # noqa: BLE001 - a fault of imuwb is what is reported
        return {"fault": type(error).__name__, "message": masked(str(error))}


def _versions() -> dict[str, str]:
    import platform  # noqa: PLC0415 - as small as the command
    from importlib.metadata import PackageNotFoundError, version  # noqa: PLC0415

    found = {"imuwb": "", "python": f"{platform.python_implementation()} {platform.python_version()}"}
    for name in ("imuwb", *LIBRARIES):
        try:
            found[name] = version(name)
        except PackageNotFoundError:
            found[name] = "not installed"
    return found


def _machine() -> dict[str, object]:
    import os  # noqa: PLC0415 - as small as the command
    import platform  # noqa: PLC0415
    import sys  # noqa: PLC0415

    system = f"{platform.system()} {platform.release()}"
    return {
        "system": system,
        "processor": platform.machine(),
        "processors": os.cpu_count(),
        "encoding": sys.stdout.encoding,
        "terminal": sys.stdout.isatty(),
    }


def _plugins() -> dict[str, list[str]]:
    from imuwb import registry  # noqa: PLC0415 - help must not wait
    from imuwb.cli.plugins import KINDS  # noqa: PLC0415

    return {
        kind: [
            f"{name} ({point.dist.name} {point.dist.version})" if point.dist is not None else name
            for name, point in registry.installed(group).items()
        ]
        for kind, group in KINDS
    }


def _variables() -> list[str]:
    import os  # noqa: PLC0415 - as small as the command

    return sorted(name for name in os.environ if name.startswith(("IMUWB_", "NUMBA_")))


def _folders(log: str | None) -> list[str]:
    """Return the folders that texts about a log may have before the names of files."""
    import os  # noqa: PLC0415 - as small as the command

    place = Path(log or ".")
    known = {str(folder) for folder in (place.parent, place.resolve().parent, Path.cwd(), Path.home())} - {".", os.sep}
    return [folder + os.sep for folder in known]


def _clean(value: object, folders: Sequence[str]) -> object:
    """Return plain values in which no text has a folder, or the name of the user or of the machine."""
    from imuwb.cli.last_fault import without_names  # noqa: PLC0415 - help must not wait

    if isinstance(value, str):
        return without_names(value, folders)
    if isinstance(value, Mapping):
        return {str(key): _clean(item, folders) for key, item in cast("Mapping[object, object]", value).items()}
    if isinstance(value, list | tuple):
        return [_clean(item, folders) for item in cast("list[object]", value)]
    return value
