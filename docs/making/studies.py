"""Validation: the Monte Carlo studies, as the repository has them."""

import re
from pathlib import Path

from making.coverage import with_pictures
from making.markdown import index

STUDIES = Path(__file__).resolve().parents[2] / "tests" / "studies"
ELSEWHERE = {"comparison"}  #: has a page of its own, which includes it
COMMAND = re.compile(r"^    (python \S+.*)$", re.MULTILINE)


def make(folder: Path) -> None:
    """Write a page for each study: its title, the command, what it asks, its tables."""
    names: list[str] = []
    for path in sorted(path for path in STUDIES.glob("*.md") if path.stem not in ELSEWHERE):
        text = path.read_text("utf-8")
        command = COMMAND.search(text)
        title = re.search(r"^# (.+)$", text, re.MULTILINE)
        if command is None or title is None:
            continue
        body = text[title.end() :].strip()
        version = next((line for line in text[: title.start()].splitlines() if line.startswith("imuwb ")), "")
        parts = [f"# {title[1]}", f"```console\n$ {command[1]}\n```", version, with_pictures(body, folder, path.stem)]
        (folder / path.name).write_text("\n\n".join(part for part in parts if part) + "\n", "utf-8")
        names.append(path.stem)
    index(
        folder, "Validation",
        "Whether the intervals of imuwb hold is measured: each study simulates many records whose truth is known, and counts how often the "
        "intervals contain it. The pages are those of `tests/studies`, with the command that makes each again.",
        names,
    )  # fmt: skip
