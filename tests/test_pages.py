"""The pages are executed: their Python blocks, and their plugin on the command line. Each command of a page exists, with its options."""

import re
import shlex
import sys
from functools import cache
from pathlib import Path

import pytest
import typer

from imuwb.cli import main
from imuwb.cli.app import build

ROOT = Path(__file__).resolve().parents[1]
DOCS = [page for page in sorted((ROOT / "docs").rglob("*.md")) if "made" not in page.relative_to(ROOT).parts]
BUILT, MARKED = (
    "command-output",
    "console",
)  #: a block that runs when the site is built; one that the site's style marks as not run
PAGES = [ROOT / "docs" / page for page in ("reference/notebook.md", "how-to/plugin.md")]
BLOCKS = [b for page in PAGES for b in re.findall(r"```python\n(.*?)```", page.read_text("utf-8"), re.DOTALL)]


@pytest.mark.slow
@pytest.mark.parametrize("block", [b for b in BLOCKS if "jerk" not in b])
def test_python_blocks_run(block, monkeypatch, capsys):
    monkeypatch.chdir(ROOT)
    exec(compile(block, "page", "exec"), {"__name__": "readme"})  # noqa: S102 - our own pages
    assert capsys.readouterr().out


def test_the_plugin_runs_and_is_as_short_as_its_page_states(monkeypatch, tmp_path, capsys):
    plugin = next(b for b in BLOCKS if b.startswith("# jerk.py"))
    assert len([line for line in plugin.splitlines() if line.strip()]) <= 27
    monkeypatch.chdir(tmp_path)
    Path("jerk.py").write_text(plugin, "utf-8")
    arguments = ["imuwb", "./jerk.py", str(ROOT / "samples" / "static.mcap"), "--axis", "x", "-o", "jerk.rrd"]
    monkeypatch.setattr(sys, "argv", arguments)
    with pytest.raises(SystemExit, match="0"):
        main()
    assert "m/s³" in capsys.readouterr().out
    assert Path("jerk.rrd").stat().st_size > 50_000


def test_the_plugin_of_the_page_keeps_its_contract(tmp_path):
    from imuwb import registry
    from imuwb.testing import check

    file = tmp_path / "jerk.py"
    file.write_text(next(b for b in BLOCKS if b.startswith("# jerk.py")), "utf-8")
    check(registry.load_file(file), "jerk", parameters={"axis": "x"}).require()


def test_the_plugin_runs_on_a_real_log(shared, monkeypatch, tmp_path, capsys):
    monkeypatch.chdir(tmp_path)
    Path("jerk.py").write_text(next(b for b in BLOCKS if b.startswith("# jerk.py")), "utf-8")
    log = shared / "mcap" / "husky_test1_ros2cdr_zstd.mcap"
    monkeypatch.setattr(sys, "argv", ["imuwb", "./jerk.py", str(log), "-o", "husky.rrd"])
    with pytest.raises(SystemExit, match="0"):
        main()
    assert "m/s³" in capsys.readouterr().out
    assert Path("husky.rrd").exists()


def _blocks(page):
    """Return the kind and the text of each block of a page; the text of a directive begins with its argument."""
    for fence, kind, argument, text in re.findall(
        r"^(`{3,}|:{3,})\{?([\w-]*)\}?[ ]*(.*)\n((?:.*\n)*?)\1$", page.read_text("utf-8"), re.MULTILINE
    ):
        del fence
        yield kind, argument, text


def _typed(page):
    """Return the commands of imuwb that a page types."""
    for kind, argument, text in _blocks(page):
        lines = [argument] if kind == BUILT else [line[2:] for line in text.splitlines() if line.startswith("$ ")]
        for line in lines:
            words = shlex.split(line, comments=True)
            ends = [i for i, word in enumerate(words) if word in ("&&", "|")] + [len(words)]
            for begin, end in zip([0, *(i + 1 for i in ends)], ends, strict=False):
                if words[begin:end][:1] == ["imuwb"]:
                    yield words[begin + 1 : end]


@cache
def _command(name, method):
    command, names = typer.main.get_command(build([name, method])), [name, method]
    # A group that does something by itself may stand alone.
    while hasattr(command, "commands") and not (command.invoke_without_command and names[0][:1] in ("", "-")):
        command = command.commands[names.pop(0)]
    return command, len(names)


@pytest.mark.parametrize("page", [*DOCS, ROOT / "README.md", ROOT / "CONTRIBUTING.md"], ids=lambda page: page.stem)
def test_each_command_of_a_page_exists_with_its_options(page):
    for words in _typed(page):
        if words[0].startswith("-") or words[0].endswith(".py"):
            continue
        command, left = _command(words[0], [*words, ""][1])
        context = typer.Context(command, info_name=words[0])
        command.make_parser(context).parse_args(words[2 - left :])  # an option that the command lacks is an error


@pytest.mark.parametrize("page", DOCS, ids=lambda page: page.stem)
def test_each_console_block_runs_when_the_site_is_built_or_is_marked(page):
    style = (ROOT / "docs" / "style" / "site.css").read_text("utf-8")
    assert f"div.highlight-{MARKED}::after" in style
    assert f'"```{MARKED}' not in (ROOT / "docs" / "making" / "markdown.py").read_text(
        "utf-8"
    )  # what the build made has run
    typed = [kind for kind, argument, text in _blocks(page) if kind == BUILT or re.search(r"^\$ ", text, re.MULTILINE)]
    assert set(typed) <= {BUILT, MARKED}


def test_a_study_has_a_picture_of_its_intervals(monkeypatch, tmp_path):
    monkeypatch.syspath_prepend(ROOT / "docs")
    from making.coverage import shares_of, with_pictures

    table = "| term | n | coverage |\n| --- | --- | --- |\n| N | 5 | 94.0 % (92.5–95.2) |\n| B | 5 | – |\n| K | 5 | 96.5 % (95–97) |\n"
    shares = shares_of(f"## Records\n\n{table}")
    assert shares.labels == ("N", "K")
    assert shares.series == {"coverage": ((94.0, 92.5, 95.2), (96.5, 95.0, 97.0))}
    assert shares_of(f"## Goals\n\n{table}") is None
    assert shares_of(f"## Speed\n\n{table.replace('coverage', 'share')}") is None
    text = with_pictures(f"A study.\n\n## Records\n\n{table}\n## Goals\n\n{table}", tmp_path, "study")
    assert [path.name for path in tmp_path.iterdir()] == ["study-0.svg"]
    assert text.index("study-0.svg") < text.index("## Goals")
