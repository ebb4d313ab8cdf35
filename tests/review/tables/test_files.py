"""Tables as files: numbers and units for programs, LaTeX that compiles, Markdown that shows each character."""

import csv
import io
import re

import pytest

from imuwb.analysis import Answer, Table
from imuwb.review.tables.columns import Quantity, answer_table, columns_of, quantity
from imuwb.review.tables.files import csv_text, latex_text, markdown_text

NOISE = Table(
    "Noise of a_b", ("axis", "N", "B", "note [1]"),
    (("gyro_x", "2.40 [2.38, 2.43] deg/√h", "< 220 deg/h", "*1*"), ("accel z", "1 298 m/s/√h", "—", "50 % & more"),
     ("z", "—", "3.5e-05 [1e-05, —] deg/h", "[a]|<b>")),
    "A ^ caption $5 # ü σ ⟨ h^1.5",
)  # fmt: skip
ONE_UNIT = Table("t", ("f", "drift"), (("a", "22.8 m [19, 29.6]"), ("b", "1 m [0.5, 2]")))


@pytest.mark.parametrize(
    ("cell", "wanted"),
    [
        ("12", Quantity("12")), ("1 298 m", Quantity("1298", unit="m")), ("−3.5e-05", Quantity("-3.5e-05")), ("—", Quantity()),
        ("2.40 [2.38, 2.43] deg/√h", Quantity("2.40", "2.38", "2.43", "deg/√h")), ("< 220 deg/h", Quantity("", "", "220", "deg/h")),
        ("22.8 m [19, 29.6]", Quantity("22.8", "19", "29.6", "m")), ("> 3", Quantity("", "3")), ("185 [167, 202] m/s/h^1.5", Quantity("185", "167", "202", "m/s/h^1.5")),
        ("5 [—, 3] m", Quantity("5", "", "3", "m")), ("12 of 20", None), ("1 h 3 min", None), ("x", None), (".", None), ("+", None), ("1.0 m at 3 s", None),
    ],
)  # fmt: skip
def test_a_cell_is_read_as_numbers_or_left_as_text(cell, wanted):
    assert quantity(cell) == wanted


def test_csv_has_a_column_for_each_number_and_its_unit():
    rows = list(csv.DictReader(io.StringIO(csv_text(NOISE))))
    assert list(rows[0]) == [
        "axis",
        "N",
        "N lower",
        "N upper",
        "N unit",
        "B [deg/h]",
        "B lower [deg/h]",
        "B upper [deg/h]",
        "note [1]",
    ]
    assert [row["N"] for row in rows] == ["2.40", "1298", ""]
    assert [row["N unit"] for row in rows] == ["deg/√h", "m/s/√h", ""]
    assert [row["B upper [deg/h]"] for row in rows] == ["220", "", ""]
    assert rows[2]["note [1]"] == "[a]|<b>"


def test_a_unit_that_all_cells_share_is_in_the_heading_alone():
    column = columns_of(ONE_UNIT)[1]
    assert (column.heading, column.cells) == ("drift [m]", ("22.8 [19, 29.6]", "1 [0.5, 2]"))
    assert columns_of(NOISE)[1].heading == "N"


def test_latex_has_no_character_that_stops_it():
    text = latex_text(NOISE)
    assert text.count("{") - text.count(r"\{") == text.count("}") - text.count(r"\}")
    body = re.sub(r"\\[&%$#_{}]|\\[a-zA-Z]+\{?|\$[^$]*\$", "", text)
    rows = [line for line in text.splitlines() if line.endswith(r"\\")]
    assert all(len(re.findall(r"(?<!\\)&", row)) == 3 for row in rows)
    assert not set("%#_~") & set(body)
    assert all(ord(letter) < 0x180 for letter in text)
    for said in (
        r"\sqrt{\mathrm{h}}",
        r"gyro\_x",
        r"50 \% \& more",
        "{}[a]",
        r"\$5 \# ü $\sigma$ [U+27E8] h$^{1.5}$",
        r"\end{table}",
    ):
        assert said in text


def test_markdown_shows_each_character():
    lines = markdown_text(NOISE).splitlines()
    assert lines[0] == r"**Noise of a\_b**"
    assert lines[3] == "| --- | ---: | ---: | --- |"
    assert all(len(re.findall(r"(?<!\\)\|", line)) == 5 for line in lines[2:7])
    assert r"\*1\*" in lines[4]
    assert r"\[a\]\|\<b\>" in lines[6]


def test_the_rows_of_an_answer_get_the_units_below_them():
    rows = (("gyro x", "2.40 [2.38, 2.43]", "yes"), ("", "deg/√h"), ("accel x", "0.05", "yes"), ("", "m/s/√h"))
    table = answer_table(Answer("1 h", ("", "N", "trust"), rows), "t")
    assert table.rows == (("gyro x", "2.40 [2.38, 2.43] deg/√h", "yes"), ("accel x", "0.05 m/s/√h", "yes"))
