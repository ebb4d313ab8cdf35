"""The files of a folder of results: no output may replace them, and none is a log."""

from pathlib import Path

RUN_JSON, PROGRESS, PARTS = "run.json", "progress.jsonl", "parts"


def results_of(file: Path) -> Path | None:
    """Return the folder of results whose own file a file is, or would be; None: it is none."""
    place = file.resolve()
    for folder in place.parents:
        if (folder / RUN_JSON).is_file():
            from imuwb.fleet.schemas import TABLES, file_of  # noqa: PLC0415 - pyarrow is imported for folders of results only

            tables = [file_of(name) for name in TABLES]
            name = place.relative_to(folder)
            own = name.as_posix() in (RUN_JSON, PROGRESS, *tables) or name.parts[0] == PARTS
            if own and any((folder / known).exists() for known in (PARTS, *tables)):
                return folder
    return None
