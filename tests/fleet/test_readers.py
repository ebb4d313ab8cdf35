"""Other programs read the tables, and the examples of the pages run on them."""

import re
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from imuwb.fleet.schemas import TABLES, file_of
from tests.fleet_results import rows_of, write

PAGE = (Path(__file__).resolve().parents[2] / "docs" / "how-to" / "fleet.md").read_text("utf-8")


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    home = tmp_path_factory.mktemp("tables")
    write(home / "results", rows_of(sensors=4, logs=2, damaged=3))
    return home


def test_readme_names_every_column():
    for name, schema in TABLES.items():
        (row,) = re.findall(rf"^\| `{re.escape(file_of(name))}` .*$", PAGE, re.MULTILINE)
        assert row.split("`")[-2].split() == schema.names, name


def test_the_statements_of_readme_run_in_duckdb(results, monkeypatch):
    duckdb = pytest.importorskip("duckdb")
    monkeypatch.chdir(results)
    (text,) = re.findall(r"```sql\n(.*?)```", PAGE, re.DOTALL)
    found = [duckdb.sql(statement).fetchall() for statement in text.split(";") if statement.strip()]
    assert [len(rows) for rows in found] == [8, 3]


def test_the_example_of_readme_runs_in_polars_and_pandas(results, monkeypatch, capsys):
    pytest.importorskip("polars")
    pytest.importorskip("pandas")
    monkeypatch.chdir(results)
    (text,) = re.findall(r"```py\n(.*?)```", PAGE, re.DOTALL)
    exec(compile(text, "fleet.md", "exec"), {})  # noqa: S102 - our own page
    assert "SN00" in (said := capsys.readouterr().out)
    assert "15AV" in said


def test_pandas_reads_what_pyarrow_reads(results):
    pandas = pytest.importorskip("pandas")
    for name in TABLES:
        path = results / "results" / file_of(name)
        table, frame = pq.read_table(path), pandas.read_parquet(path)
        assert list(frame.columns) == table.column_names
        assert len(frame) == table.num_rows
        if "start" in frame and frame["start"].notna().any():
            assert str(frame["start"].dt.tz) == "UTC"
