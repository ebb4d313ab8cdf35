"""imuwb plugins new: writes a complete plugin with its tests, as one file or as a package."""

import ast
import keyword
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib.resources import files
from importlib.util import find_spec
from pathlib import Path
from typing import Annotated, Literal, TypeAlias

import typer

from imuwb import registry
from imuwb.cli.options import Force, output_option
from imuwb.errors import ImuwbError, UsageError

Kind: TypeAlias = Literal["analysis", "conditioner", "reader"]

EXAMPLES = "imuwb.testing.examples"
NAME = "plugin_name"  #: stands for the name in the examples
GOOD = re.compile(r"[a-z][a-z0-9_]{1,39}")
PLUGIN = "The plugin"  #: group of the options in the help


@dataclass(frozen=True, slots=True)
class _Use:
    """How a plugin of one kind is registered and used."""

    group: str
    use: str  #: of a package
    public: tuple[str, ...]  #: names that the package gives


_USES: dict[Kind, _Use] = {
    "analysis": _Use(
        registry.ANALYSES, "`imuwb plugin_name LOG` is its command",
        ("Axis", "Parameters", "Result", "answer", "draw", "run"),
    ),
    "conditioner": _Use(
        registry.CONDITIONERS, "`imuwb ANALYSIS LOG --through plugin_name:samples=5` is how it is used",
        ("Applied", "Parameters", "condition", "draw"),
    ),
    "reader": _Use(
        registry.READERS, "all commands of imuwb read logs of its format", ("FIRST", "ROW", "format", "probe", "stream", "uses")
    ),
}  # fmt: skip


def new(
    kind: Annotated[
        Kind, typer.Argument(help="analysis, conditioner or reader.", metavar="KIND", rich_help_panel=PLUGIN)
    ],
    name: Annotated[
        str,
        typer.Argument(help="Name of the plugin: small letters, digits and _.", metavar="NAME", rich_help_panel=PLUGIN),
    ],
    *,
    package: Annotated[
        bool,
        typer.Option(
            "--package", help="Write a folder that pip installs, in place of one file.", rich_help_panel=PLUGIN
        ),
    ] = False,
    folder: Annotated[
        Path, output_option("--folder", text="Folder in which the files are written.", metavar="FOLDER")
    ] = Path(),
    force: Force = False,
) -> None:
    """Write a complete plugin with its tests, to be changed into your own.

    An analysis and a conditioner are used as files at once: imuwb ./NAME.py LOG, --through ./NAME.py:key=value. A reader is found when
    its package is installed, so give --package.

    Example: imuwb plugins new analysis scatter
    """
    from imuwb.analysis import Answer, Step  # noqa: PLC0415 - help must not wait
    from imuwb.cli.places import check_place  # noqa: PLC0415
    from imuwb.cli.terminal import print_panel  # noqa: PLC0415
    from imuwb.review.answers.panel import Origin  # noqa: PLC0415
    from imuwb.writers import together, write_text  # noqa: PLC0415

    _check_name(kind, name)
    if not folder.is_dir():
        raise UsageError(f"{folder}: there is no such folder; make it, or name another one with --folder")
    made = _package(kind, name) if package else _file(kind, name)
    places = {folder / place: text for place, text in made.items()}
    for place in places:
        if place.exists():
            check_place(place, force=force)
    _make_folders(places)
    with together(places):  # all of them, or none
        for place, text in places.items():
            write_text(place, text)
    root = folder / name if package else folder / f"{name}.py"
    steps = (
        (Step(f'pip install -e "{root}[test]"', "then imuwb finds it"), Step(f"pytest {root}", "its own tests"))
        if package
        else (Step(f"imuwb plugins check {root}{' LOG' if kind == 'reader' else ''}", "does it keep its contract?"), Step(f"pytest {folder / f'test_{name}.py'}", "its own tests"))
    )  # fmt: skip
    sentence = "It is complete and keeps its contract. Change what it computes, then its tests."
    print_panel(
        Answer(f"a new {kind}, {name}", sentences=(sentence,), next=steps),
        Origin("plugin", (), wrote=(f"{root} ({len(places)} files)",) if package else tuple(map(str, places))), data=False,
    )  # fmt: skip


def _make_folders(places: Iterable[Path]) -> None:
    """Make the folders of some files.

    Raises:
        ImuwbError: a folder cannot be made.
    """
    for folder in dict.fromkeys(place.parent for place in places):
        try:
            folder.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise ImuwbError(
                f"{folder}: this folder cannot be made ({error.strerror}); choose another name, or another --folder"
            ) from error


def _check_name(kind: Kind, name: str) -> None:
    """Check that a name can be that of a plugin and of a module.

    Raises:
        UsageError: it cannot.
    """
    from imuwb.cli.app import COMMANDS  # noqa: PLC0415 - app imports this module

    if not GOOD.fullmatch(name):
        raise UsageError(
            f"{name!r}: the name of a plugin must be 2 to 40 small letters (a to z), digits and _, and begin with a letter"
        )
    if keyword.iskeyword(name):
        raise UsageError(f"{name}: this is a keyword of Python, so no module can have the name; choose another one")
    if kind == "analysis" and name in COMMANDS:
        raise UsageError(f"{name}: a command of imuwb has this name; choose another one")
    for group in (registry.ANALYSES, registry.CONDITIONERS, registry.READERS):
        if name in registry.installed(group):
            raise UsageError(f"{name}: a plugin of {group} has this name; choose another one")
    if find_spec(name) is not None:
        raise UsageError(f"{name}: Python finds a module of this name already; choose another one")


def _file(kind: Kind, name: str) -> Mapping[str, str]:
    """Return {path: text} of a plugin in one file, and of its test."""
    return {
        f"{name}.py": _example(f"{kind}.py", name, f"./{name}.py"),
        f"test_{name}.py": _example(f"test_{kind}.py", name),
    }


def _package(kind: Kind, name: str) -> Mapping[str, str]:
    """Return {path: text} of a package."""
    code = _example(f"{kind}.py", name)
    doc = ast.get_docstring(ast.parse(code), clean=False) or ""
    return {
        **dict(_about(kind, name, doc.partition("\n")[0])),
        f"{name}/src/{name}/__init__.py": f'"""{doc}"""\n\nimport lazy_loader\n\n'
        "# The public names are in __init__.pyi; each is imported when it is first used.\n"
        "__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)\n",
        f"{name}/src/{name}/__init__.pyi": "".join(f"from .{kind} import {one} as {one}\n" for one in _USES[kind].public),
        f"{name}/src/{name}/py.typed": "",
        f"{name}/src/{name}/{kind}.py": code,
        f"{name}/tests/test_{name}.py": _example(f"test_{kind}.py", name),
    }  # fmt: skip


def _about(kind: Kind, name: str, summary: str) -> Iterator[tuple[str, str]]:
    """Yield path and text of the files that describe a package."""
    from imuwb import __version__  # noqa: PLC0415 - it reads the installed metadata

    use = _USES[kind]
    for file in ("pyproject.toml", "README.md"):
        text = files(EXAMPLES).joinpath("package", f"{file}.txt").read_text("utf-8")
        words = {
            "plugin_summary": summary, "plugin_use": use.use, "plugin_group": use.group, "plugin_file": kind, "imuwb_version": __version__,
        }  # fmt: skip
        for word, value in words.items():
            text = text.replace(word, value)
        yield f"{name}/{file}", text.replace(NAME, name)


def _example(file: str, name: str, command: str = "") -> str:
    """Return an example under another name; ``command``: how it is named after imuwb."""
    text = files(EXAMPLES).joinpath(file).read_text("utf-8")
    if command:
        text = text.replace(f"Example: imuwb {NAME}", f"Example: imuwb {command}")
    return text.replace(NAME, name)
