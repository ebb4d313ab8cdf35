"""Addresses: which texts are some, what of them may be shown, and what lies beside them."""

from pathlib import Path

import pytest

from imuwb.errors import UsageError
from imuwb.readers.bytes.address import Address, is_address, place_of, without_secrets


@pytest.mark.parametrize(
    "text",
    ["log.csv", "a/b.mcap", "C:\\logs\\a.csv", "C:/logs/a.csv", "s3:/b/k", "odd:name.csv", "/a//b", "./http:/x", ""],
)
def test_paths_are_no_addresses(text):
    assert not is_address(text)
    assert place_of(text) == Path(text)


def test_a_file_address_is_a_path(tmp_path):
    path = tmp_path / "a log+ü.csv"
    assert place_of(path.as_uri()) == path
    assert place_of(path.as_uri().replace("file:///", "FILE://localhost/")) == path


@pytest.mark.parametrize(
    ("text", "shown", "name"),
    [
        ("s3://bucket/a/log.mcap", "s3://bucket/a/log.mcap", "log.mcap"),
        ("S3://bucket/a b?c#d%20.csv", "s3://bucket/a b?c#d%20.csv", "a b?c#d%20.csv"),
        ("gs://bucket/log.bin", "gs://bucket/log.bin", "log.bin"),
        ("az://container/x/log.ulg", "az://container/x/log.ulg", "log.ulg"),
        ("https://host/a%20b.csv", "https://host/a%20b.csv", "a b.csv"),
        ("https://user:SECRET@host:8443/log.csv?sig=SECRET#SECRET", "https://host:8443/log.csv", "log.csv"),
        ("https://SECRET@host/d/log.csv?next=/SECRET/x@y", "https://host/d/log.csv", "log.csv"),
        ("http://host?sig=SECRET", "http://host/", "host"),
        ("http://[::1]:80/log.csv", "http://[::1]:80/log.csv", "log.csv"),
    ],
)
def test_what_is_shown_of_an_address(text, shown, name):
    place = place_of(text)
    assert (str(place), place.name) == (shown, name)
    assert "SECRET" not in repr(place)


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("s3://bucket", "one object"),
        ("s3://bucket/", "one object"),
        ("s3://bucket/folder/", "one object"),
        ("gs://bucket/folder/", "one object"),
        ("s3://SECRET:SECRET@bucket/log.csv", "environment"),
        ("s3:///log.csv", "no valid host"),
        ("https:///log.csv", "no valid host"),
        ("https://user:SEC/RET@host/log.csv", "%2F"),
        ("http://host name/log.csv", "no valid host"),
        ("ftp://user:SECRET@host/log.csv", "ftp://"),
        ("file://server/share/SECRET.csv", "host"),
    ],
)
def test_addresses_that_are_not_read(text, match):
    with pytest.raises(UsageError, match=match) as raised:
        place_of(text)
    assert "SECRET" not in str(raised.value) or text.startswith("file")


@pytest.mark.parametrize(
    ("text", "beside"),
    [
        ("s3://bucket/a/log.csv", "s3://bucket/a/log #1.toml"),
        ("s3://bucket/log.csv", "s3://bucket/log #1.toml"),
        ("https://u:p@host/a/log.csv?sig=1", "https://u:p@host/a/log%20%231.toml"),
    ],
)
def test_what_lies_beside_an_address(text, beside):
    assert Address.from_text(text).beside("log #1.toml").url == beside


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("no file https:/u:SECRET@host/a.csv", "no file https:/host/a.csv"),
        ("https://h/a.csv?X-Amz-Signature=SECRET&b=SECRET: no", "https://h/a.csv no"),
        ("'s3://SECRET@b/k' and 'http://SECRET:SECRET@h'", "'s3://b/k' and 'http://h'"),
        ("is this a log? yes=no", "is this a log? yes=no"),
        ("mail a@b about /x/y@z", "mail a@b about /x/y@z"),
    ],
)
def test_messages_without_secrets(text, shown):
    assert without_secrets(text) == shown


def test_the_name_of_a_copy_is_one_of_every_file_system():
    assert Address.from_text('s3://bucket/a:b*"<c>?.csv').file_name == "a_b___c__.csv"
    assert Address.from_text("https://host/..%2F..%2Fx.csv").file_name == "_.._x.csv"
    assert len(Address.from_text(f"s3://bucket/{'x' * 500}.mcap").file_name) <= 100
