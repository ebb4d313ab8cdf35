"""Write the table of the licences of all dependencies, or check that it still fits what is installed.

    python .ci/licences.py              writes LICENCES.md
    python .ci/licences.py --check      fails if what a user of imuwb installs is not in it, or has a licence that is not known to fit

A licence is what the metadata of a package states: its SPDX expression, else its classifier.
"""

import re
import sys
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement

TABLE = Path(__file__).resolve().parents[1] / "LICENCES.md"
EXTRAS = ("", "fleet", "mdf", "novatel", "pdf", "test", "bench", "dev")
PASSED_ON = ("", "fleet", "mdf", "novatel", "pdf")  #: what a user of imuwb installs
#: licences under which a program with the licence of imuwb (MIT) may use a library
FITTING = {
    "0BSD", "Apache-2.0", "Apache-2.0 WITH LLVM-exception", "BSD", "CNRI-Python", "MIT-0", "BSD-2-Clause", "BSD-3-Clause", "CC0-1.0", "ISC", "MIT", "MIT-CMU",
    "MPL-2.0", "PSF-2.0", "Python-2.0", "Unlicense", "Zlib", "LGPL",
}  # fmt: skip
CLASSIFIERS = {
    "Apache Software License": "Apache-2.0", "BSD License": "BSD", "ISC License (ISCL)": "ISC", "MIT License": "MIT",
    "Mozilla Public License 2.0 (MPL 2.0)": "MPL-2.0", "Python Software Foundation License": "PSF-2.0",
    "The Unlicense (Unlicense)": "Unlicense", "GNU Lesser General Public License v3 or later (LGPLv3+)": "LGPL-3.0-or-later",
    "GNU General Public License v2 or later (GPLv2+)": "GPL-2.0-or-later", "Mozilla Public License 1.1 (MPL 1.1)": "MPL-1.1",
    "GNU Lesser General Public License v2 or later (LGPLv2+)": "LGPL-2.0-or-later",
    "GNU Lesser General Public License v3 (LGPLv3)": "LGPL-3.0", "GNU Library or Lesser General Public License (LGPL)": "LGPL",
}  # fmt: skip
FREE_TEXT = {
    "3-Clause BSD License": "BSD-3-Clause",
    "BSD": "BSD",
    "MIT License": "MIT",
    "Apache License 2.0": "Apache-2.0",
}
#: what the metadata do not say
REMARKS = {
    "finufft": "its wheels contain FFTW, which is under GPL-2.0-or-later; a benchmark alone uses it",
    "numpy": "its wheels contain libgfortran and libquadmath, under the GPL with the exception for run-time libraries",
    "scipy": "its wheels contain libgfortran and libquadmath, under the GPL with the exception for run-time libraries",
    "asammdf": "an extra that the user chooses; imuwb works without it",
}


def normal(name: str) -> str:
    """Return a name as an index of packages writes it."""
    return re.sub(r"[-_.]+", "-", name).lower()


def needed(extra: str) -> dict[str, Distribution]:
    """Return the distributions that imuwb with an extra needs, on this system and this version of Python."""
    found, asked = dict[str, Distribution](), [("imuwb", extra)]
    seen = set[tuple[str, str]]()
    while asked:
        name, own = asked.pop()
        if (normal(name), own) in seen:
            continue
        seen.add((normal(name), own))
        try:
            found[normal(name)] = distribution(name)
        except PackageNotFoundError:
            print(f"{name} is not installed; its licence is not looked at", file=sys.stderr)
            continue
        for text in found[normal(name)].requires or []:
            requirement = Requirement(text)
            if requirement.marker is None or requirement.marker.evaluate({"extra": own}):
                asked += [(requirement.name, more) for more in requirement.extras or {""}]
    del found["imuwb"]
    return found


def licence_of(package: Distribution) -> str:
    """Return the licence that a package states."""
    said = package.metadata
    if expression := said.get("License-Expression"):
        return expression
    classes = [
        line.rpartition("::")[2].strip() for line in said.get_all("Classifier") or [] if line.startswith("License")
    ]
    known = [CLASSIFIERS.get(name, name) for name in classes if name != "OSI Approved"]
    text = (said.get("License") or "").strip().partition("\n")[0]
    return " OR ".join(known) or FREE_TEXT.get(text, text) or "not stated"


def fits(licence: str) -> bool:
    """Return whether every part of a licence, or one of its alternatives, is known to fit."""
    alternatives = re.split(r"\s+OR\s+", licence.replace("(", "").replace(")", ""))
    return any(all(_known(part) for part in re.split(r"\s+AND\s+", one)) for one in alternatives)


def _known(part: str) -> bool:
    return part in FITTING or part.startswith("LGPL")


def rows() -> dict[str, tuple[str, str]]:
    """Return {package: (licence, extras that need it)}."""
    found = {extra: needed(extra) for extra in EXTRAS}
    core = found[""]
    every = {name: package for extra in EXTRAS for name, package in found[extra].items()}
    return {
        name: (licence_of(package), "imuwb" if name in core else ", ".join(e for e in EXTRAS[1:] if name in found[e]))
        for name, package in sorted(every.items())
    }


def main() -> int:
    """Write or check the table; return the exit code."""
    found = rows()
    tools = {extra for extra in EXTRAS if extra not in PASSED_ON}
    doubtful = [
        f"{name}: {licence}"
        for name, (licence, by) in found.items()
        if not set(by.split(", ")) <= tools and not fits(licence)
    ]
    if "--check" in sys.argv:
        text = TABLE.read_text("utf-8")
        used = {name for name, (_, by) in found.items() if not set(by.split(", ")) <= tools}
        absent = [name for name in sorted(used) if f"| {name} |" not in text]
        for problem, names in (
            ("not in LICENCES.md; run python .ci/licences.py", absent),
            ("a licence that is not known to fit", doubtful),
        ):
            if names:
                print(f"{problem}: {'; '.join(names)}", file=sys.stderr)
        return int(bool(absent or doubtful))
    lines = [f"| {name} | {licence} | {by} | {REMARKS.get(name, '')} |" for name, (licence, by) in found.items()]
    head = (
        "# Licences of the dependencies\n\n    python .ci/licences.py\n\nimuwb is under the MIT licence (`LICENSE`). It contains no code of these "
        f"packages; pip installs them. Users install what imuwb and the extras {', '.join(PASSED_ON[1:])} need: these licences allow "
        "a program under the MIT licence to use them; mind the remarks. What only test, bench and dev need are tools of contributors.\n"
    )
    table = "\n".join(("| package | licence | needed by | remark |", "| --- | --- | --- | --- |", *lines))
    TABLE.write_text(f"{head}\n{table}\n", "utf-8")
    for line in doubtful:
        print(f"a licence that is not known to fit: {line}", file=sys.stderr)
    return int(bool(doubtful))


if __name__ == "__main__":
    raise SystemExit(main())
