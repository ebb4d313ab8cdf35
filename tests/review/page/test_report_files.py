"""Figures and tables as files: one each, with names that say what they show on every system."""

import re

from imuwb.review.page.report_files import figure_files, table_files


def test_each_figure_and_table_has_a_file_of_its_own_name(report):
    figures = figure_files([report(), report(analysis="psd")], "svg")
    assert list(figures)[:4] == [
        "noise-allan-deviation.svg",
        "noise-overview-rate.svg",
        "noise-track-of-gnss-north-up.svg",
        "noise-spectrum-allan-deviation.svg",
    ]
    assert len(figures) == 8
    tables = table_files([report("../é*"), report()], "latex")
    assert list(tables) == ["noise-answer.tex", "noise-allan.tex", "noise-answer-2.tex", "noise-allan-2.tex"]
    assert all(re.fullmatch(r"[a-z0-9-]+\.(svg|tex)", name) for name in (*figures, *tables))
