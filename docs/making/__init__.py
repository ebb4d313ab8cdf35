"""The pages that come from the code: commands, notes, schemas, papers, studies, gallery, figures. They are made before each build, and not committed."""

import os
import shutil
from pathlib import Path

from making import commands, gallery, glossary, mounting, notes, papers, schemas, studies, terms

FOLDER, RUN = "made", "run"  #: RUN: where the commands of the pages run
SAMPLES = Path(__file__).resolve().parents[2] / "samples"
KEEP = "IMUWB_DOCS_KEEP"  #: for those who write a page, and do not want to wait


def make(docs: Path) -> None:
    """Make all pages in ``docs/made`` again; with ``KEEP`` in the environment, only if there are none."""
    made = docs / FOLDER
    if os.environ.get(KEEP) and made.is_dir():
        return
    shutil.rmtree(made, ignore_errors=True)
    run = made / RUN
    run.mkdir(parents=True)
    for file in (*SAMPLES.glob("*.mcap"), *(docs / "tutorials").glob("*.toml")):
        shutil.copyfile(file, run / file.name)
    for part in (terms, mounting, glossary, commands, notes, schemas, papers, studies, gallery):
        folder = made / part.__name__.rpartition(".")[2]
        folder.mkdir(parents=True)
        part.make(folder)
