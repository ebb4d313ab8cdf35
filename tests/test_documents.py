"""TOML documents are read by one body, whose messages name the file, the key, the rule and what is found."""

import pytest

from imuwb import documents
from imuwb.errors import UsageError
from imuwb.navigation.filter_document import read_filter
from imuwb.readers import ReadOptions
from imuwb.readers.text.sidecar import with_sidecar
from imuwb.stochastic import ImuErrorModel
from imuwb.stochastic.model_check import limits

READERS = {
    "filter": read_filter,
    "error model": ImuErrorModel.read,
    "limits": limits,
    "sidecar": lambda path: with_sidecar(path.with_suffix(".csv"), ReadOptions()),
}
ODD = {
    "deep list": f"[gyro_x]\nprocesses = {'[' * 3000}{']' * 3000}\n",
    "deep table": "[gyro_x" + ".x" * 500 + "]\n",
    "deep in a key": "filter" + ".x" * 300 + " = 1\n",
    "long number": f"rate = {'9' * 5000}\n",
    "large number": f"rate = {'9' * 400}\n",
    "no UTF-8": b"name = '\xff'\n",
    "control": "name = '\x1b[2J'\n",
    "list for a table": "gyro_x = [1]\nerror_model = [1]\nunits = [1]\n",
    "date for a number": "rate = 2024-01-01\n[gyro_x]\nbias = 2024-01-01\n[gyro]\nN = 2024-01-01\n",
    "table for a text": "filter = { a = 1 }\nschema = 1\nname = { a = 1 }\nframe = { a = 1 }\n[error_model.gyro_x]\n",
    "truth for a number": "rate = true\n[gyro_x]\nbias = true\n",
}


@pytest.mark.parametrize("reader", READERS)
@pytest.mark.parametrize("odd", ODD)
def test_an_odd_document_is_refused_in_a_short_message(reader, odd, tmp_path):
    path = tmp_path / "odd.toml"
    path.write_bytes(text if isinstance(text := ODD[odd], bytes) else text.encode())
    (tmp_path / "odd.csv").write_text("1\n", "utf-8")
    with pytest.raises(UsageError) as error:
        READERS[reader](path)
    assert "odd.toml" in str(error.value)
    assert len(str(error.value)) < 600
    assert str(error.value).isprintable()


def test_a_document_that_is_too_long_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(documents, "LARGEST", 10)
    (tmp_path / "long.toml").write_text("name = 'abcdef'", "utf-8")
    with pytest.raises(UsageError, match="long.toml: cannot be read as a filter: it has more than"):
        read_filter(tmp_path / "long.toml")


@pytest.mark.parametrize(
    ("check", "value", "says"),
    [
        (documents.table, [1], "it must be a table"),
        (documents.rows, {"a": 1}, "it must be a list"),
        (documents.words, 5, "it must be a text"),
        (documents.number, "1", "it must be a finite number"),
        (documents.number, float("nan"), "it must be a finite number"),
        (lambda value, where: documents.numbers(value, 2, where), [1, True], "it must be 2 finite numbers"),
        (lambda value, where: documents.whole(value, where, 0, 9), 10, "a whole number from 0 to 9"),
    ],
)
def test_a_message_names_place_rule_and_what_is_found(check, value, says):
    with pytest.raises(UsageError) as error:
        check(value, "a.toml, key")
    assert str(error.value).startswith(
        f"a.toml, key is {documents.shown(value)}; {'' if says[:2] == 'it' else 'it must be '}{says}"
    )
