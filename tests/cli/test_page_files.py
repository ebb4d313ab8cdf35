"""Where pages, figures and tables go is checked before the work; what is wrong is a sentence."""

import sys

import pytest

from imuwb.cli.page_files import PageFiles
from imuwb.errors import ImuwbError, UsageError


def test_a_format_without_a_folder_and_a_wrong_folder_are_named(tmp_path):
    (tmp_path / "file").touch()
    (tmp_path / "full").mkdir()
    (tmp_path / "full" / "a.png").touch()
    (tmp_path / "empty").mkdir()
    for wrong, match in (
        (PageFiles(figure_format="pdf"), "--figure-format pdf needs --figures"),
        (PageFiles(table_format="md"), "--table-format md needs --tables"),
        (PageFiles(figures=tmp_path / "file"), "--figures .*takes a folder"),
        (PageFiles(tables=tmp_path / "full"), "has files; overwrite them with --force"),
    ):
        with pytest.raises(UsageError, match=match):
            wrong.check(force=False)
    with pytest.raises(ImuwbError, match="does not exist"):
        PageFiles(tables=tmp_path / "no" / "folder").check(force=False)
    PageFiles(tables=tmp_path / "full").check(force=True)
    PageFiles(figures=tmp_path / "empty", tables=tmp_path / "new").check(force=False)
    assert not (tmp_path / "new").exists()


def test_without_the_extra_the_remedy_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "weasyprint", None)
    with pytest.raises(UsageError, match=r'pip install "imuwb\[pdf\]"; or .*browser'):
        PageFiles(pdf="page.pdf").check(force=False)
