"""The gallery: each kind of analysis on a sample log, with its answer, its figures, its page and its recording."""

from dataclasses import dataclass
from pathlib import Path

import imuwb
from imuwb.notebook import Outcome
from imuwb.review.answers.panel import Origin, panel
from imuwb.review.page.canvas import render
from imuwb.review.page.themes import PAPER
from making.markdown import console, index

ROOT = Path(__file__).resolve().parents[2]
SAMPLES = ROOT / "samples"
MOST_FIGURES = 3


@dataclass(frozen=True, slots=True)
class Exhibit:
    """One analysis of the gallery."""

    name: str
    title: str
    text: str  #: what the analysis answers
    analysis: str
    log: str
    options: dict[str, object]


EXHIBITS = (
    Exhibit("noise", "Noise of a still sensor", "How noisy is each axis, by which process, and with what certainty?", "noise", "static.mcap", {}),
    Exhibit("allan", "Allan deviation", "The curve of the field, with the terms that make it.", "allan", "static.mcap", {}),
    Exhibit("psd", "Power spectral density", "The same noise by frequency.", "psd", "static.mcap", {}),
    Exhibit("lssa", "Least-squares spectrum", "Are there periodic lines, and how sure is that?", "lssa", "static.mcap", {}),
    Exhibit("autocorrelation", "Autocorrelation", "Does the noise remember itself?", "autocorrelation", "static.mcap", {}),
    Exhibit("autoregressive", "Autoregressive models", "Models that predict a sample from those before it.", "autoregressive", "static.mcap", {}),
    Exhibit("outage", "A drive without GNSS", "How far does a filter drift, and is its sigma right?", "outage", "drive.mcap", {"error_model": "3dm-gx3-25"}),
    Exhibit("health", "Health of a log", "What is wrong with a log, worst first?", "health", "drive.mcap", {}),
)  # fmt: skip


def make(folder: Path) -> None:
    """Write a page for each analysis."""
    for exhibit in EXHIBITS:
        outcome = _make(exhibit, folder)
        if exhibit.name == "noise":  # the commands of the pages take it as the log's own model
            outcome.save(folder.parent / "run" / "static.error-model.toml")
    index(
        folder, "Gallery",
        "Each kind of analysis, run on the sample logs when these pages are built. Every page has the answer that the terminal shows, the "
        "figures, and two files: the page for a browser and the recording for the Rerun viewer.",
        [exhibit.name for exhibit in EXHIBITS],
    )  # fmt: skip


def _make(exhibit: Exhibit, folder: Path) -> Outcome:
    outcome = imuwb.run(exhibit.analysis, SAMPLES / exhibit.log, **exhibit.options)
    files = folder / "files"
    files.mkdir(exist_ok=True)
    for suffix in ("html", "rrd"):
        outcome.save(files / f"{exhibit.name}.{suffix}", force=True)
    own = [picture for picture in outcome.figures if picture.tab not in ("Overview", "Streams")][:MOST_FIGURES]
    parts = [f"# {exhibit.title}", exhibit.text]
    typed = " ".join(f"--{name.replace('_', '-')} {value}" for name, value in exhibit.options.items())
    command = f"imuwb {exhibit.analysis} {exhibit.log} {typed}".strip()
    parts.append(console(command, "\n".join(panel(outcome.answer, Origin(exhibit.analysis, (exhibit.log,))))))
    for i, picture in enumerate(own):
        name = f"{exhibit.name}-{i + 1}.svg"
        (files / name).write_text(render(picture.drawing, PAPER, "svg").decode("utf-8"), "utf-8")
        parts.append(f"```{{figure}} files/{name}\n:alt: {picture.title}\n\n{picture.title}\n```")
    parts.append(
        f"{{download}}`The page <files/{exhibit.name}.html>` · {{download}}`the recording <files/{exhibit.name}.rrd>` "
        "(`imuwb view`)."
    )
    (folder / f"{exhibit.name}.md").write_text("\n\n".join(parts) + "\n", "utf-8")
    return outcome
