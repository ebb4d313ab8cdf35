"""The structure of text files: delimiters, decimal marks, encodings, line ends, headers."""

import codecs
import gzip

import numpy as np
import pytest

from imuwb.readers import ReadOptions, read
from imuwb.readers.text.layout import layout_of
from tests.readers.repairs import repairs

NAMES = ("time_s", "gyro_x_rad_s", "gyro_y_rad_s", "gyro_z_rad_s", "accel_x_m_s2", "accel_y_m_s2", "accel_z_m_s2")
ROWS = 120
RNG = np.random.default_rng(7)
VALUES = np.round(RNG.normal((0, 0, 0, 0, 0, -9.8), 0.01, (ROWS, 6)), 6)
TIMES = np.arange(ROWS) * 5_000_000


def cells(row, form="{:.6f}"):
    return [f"{TIMES[row] / 1e9:.3f}", *(form.format(value) for value in VALUES[row])]


def text(mark=",", decimal=".", quote="", header=NAMES, end="\n", form="{:.6f}"):
    """Return the same log in one of many ways to write it."""

    def line(parts):
        return mark.join(f"{quote}{part}{quote}" for part in parts) + end

    rows = [[cell.replace(".", decimal) for cell in cells(row, form)] for row in range(ROWS)]
    return "".join(map(line, ([header] if header else []) + rows))


def assert_all(log):
    (imu,) = log.imus
    assert imu.angular_rate.time.tolist() == TIMES.tolist()
    np.testing.assert_array_equal(imu.angular_rate.value, VALUES[:, :3])
    np.testing.assert_array_equal(imu.specific_force.value, VALUES[:, 3:])
    assert repairs(imu) == {}


@pytest.mark.parametrize("form", ["{:.6f}", "{:.9E}"])
@pytest.mark.parametrize(
    ("mark", "decimal", "quote"),
    [
        (",", ".", ""), (", ", ".", ""), (";", ".", ""), ("\t", ".", ""), ("|", ".", ""), (" ", ".", ""), ("   ", ".", ""),
        (";", ",", ""), ("; ", ",", ""), ("\t", ",", ""), (" ", ",", ""), (",", ",", '"'), (";", ",", '"'), (",", ".", '"'),
        (" , ", ".", ""),
    ],
)  # fmt: skip
def test_delimiters_decimal_marks_and_quotes(text_log, mark, decimal, quote, form):
    assert_all(read(text_log(text(mark, decimal, quote, form=form))))


@pytest.mark.parametrize("decimal", [".", ","])
@pytest.mark.parametrize("end", ["\n", "\r\n", "\r"])
@pytest.mark.parametrize(
    ("mark", "encoding"),
    [
        (b"", "utf-8"), (codecs.BOM_UTF8, "utf-8"), (codecs.BOM_UTF16_LE, "utf-16-le"), (codecs.BOM_UTF16_BE, "utf-16-be"),
        (b"", "utf-16-le"), (b"", "utf-16-be"),
    ],
)  # fmt: skip
def test_encodings_and_line_ends(text_log, mark, encoding, end, decimal):
    content = mark + text(";", decimal, end=end).encode(encoding)
    assert_all(read(text_log(content)))
    assert_all(read(text_log(gzip.compress(content), "log.csv.gz")))


@pytest.mark.parametrize("end", ["\n", "\r"])
def test_names_in_iso_8859_1_have_their_units(text_log, end):
    header = ["t [s]", *(f"g{axis} [°/s]" for axis in "xyz"), *(f"a{axis} [m/s²]" for axis in "xyz")]
    (imu,) = read(text_log(text(header=header, end=end).encode("iso-8859-1"))).imus
    np.testing.assert_allclose(imu.angular_rate.value, np.radians(VALUES[:, :3]), atol=1e-12)
    np.testing.assert_array_equal(imu.specific_force.value, VALUES[:, 3:])


def test_a_character_of_two_bytes_may_lie_across_two_pieces(text_log, monkeypatch):
    monkeypatch.setattr("imuwb.readers.bytes.source.PIECE", 1001)
    assert_all(read(text_log(codecs.BOM_UTF16_LE + text().encode("utf-16-le"))))


@pytest.mark.parametrize("mark", [",", ";", "\t", " "])
@pytest.mark.parametrize("sign", ["#", "# ", "%", "//", "## "])
def test_a_comment_of_as_many_names_as_the_rows_have_cells_is_the_header(text_log, sign, mark):
    before = "# made by a test\n% on a rig, at rest\n"
    assert_all(read(text_log(before + sign + text(mark))))
    assert_all(read(text_log(sign + mark.join(NAMES) + "\n" + before + text(mark, header=()))))


def test_a_header_goes_before_a_comment_of_as_many_words(text_log):
    sentence = "# this is the log of seven words\n"
    assert_all(read(text_log(text(" ").replace("\n", f"\n{sentence}", 1))))
    found = layout_of(text_log(sentence + text(" ", header=())))
    assert (found.names, found.comments) == ((), (sentence.strip(),))


@pytest.mark.parametrize("sign", ["#", "% "])
def test_every_row_may_have_the_mark_of_a_comment(text_log, sign):
    assert_all(read(text_log("".join(f"{sign}{line}\n" for line in text().splitlines()))))


@pytest.mark.parametrize(
    "units",
    [
        ("(s)", *["(deg.s^-1)"] * 3, *["(m.s^-2)"] * 3), ("[s]", *["[deg/s]"] * 3, *["[m/s^2]"] * 3),
        ("s", *["deg/s"] * 3, *["m/s²"] * 3), ("seconds", *["degrees per second"] * 3, *["m/s2"] * 3),
    ],
)  # fmt: skip
@pytest.mark.parametrize("sign", ["", "#"])
def test_a_second_header_row_states_the_units(text_log, units, sign):
    names = ("time", "gyroX", "gyroY", "gyroZ", "accelX", "accelY", "accelZ")
    header = f"{sign}{';'.join(names)}\n{sign}{';'.join(units)}\n"
    (imu,) = read(text_log(header + text(";", header=()))).imus
    np.testing.assert_allclose(imu.angular_rate.value, np.radians(VALUES[:, :3]), rtol=1e-14)
    np.testing.assert_array_equal(imu.specific_force.value, VALUES[:, 3:])


@pytest.mark.parametrize("mark", [";", ",", "\t"])
def test_a_first_line_that_names_the_separator(text_log, mark):
    assert_all(read(text_log(f"sep={mark}\n" + text(mark))))


def test_lines_of_another_kind_before_the_header_cost_nothing(text_log):
    before = "Device,Rig 7\nSerial,1234\nRate,200\n\n"
    assert_all(read(text_log(before + text())))


def test_a_first_row_with_a_text_in_it_is_counted(text_log):
    lines = text().splitlines()
    lines[1] = lines[1].replace(cells(0)[2], "none", 1)
    (imu,) = read(text_log("\n".join([*lines, ""]))).imus
    assert len(imu.angular_rate) == ROWS - 1
    assert repairs(imu) == {"not_a_number": 1, "not_finite": 1}


def test_a_delimiter_at_the_end_of_each_row_is_no_column(text_log):
    rows = text(header=()).replace("\n", ",\n")
    assert_all(read(text_log(",".join(NAMES) + "\n" + rows)))
    assert_all(read(text_log(",".join(NAMES) + ",\n" + rows)))
    assert_all(read(text_log(",".join(NAMES) + ",\n" + text(header=()))))


def test_a_column_of_row_numbers_without_a_name(text_log):
    lines = text().splitlines()
    numbered = [f",{lines[0]}", *(f"{i},{line}" for i, line in enumerate(lines[1:]))]
    assert_all(read(text_log("\n".join([*numbered, ""]))))


@pytest.mark.parametrize(
    ("name", "decimal"),
    [("gyro_x_rad_s", "."), ("gyro_x_rad_s", ","), ("# gyro_x_rad_s", "."), ('"gyro x (rad/s)"', ".")],
)
def test_one_column_alone_is_a_log(text_log, name, decimal):
    rows = "".join(f"{value:.6f}\n".replace(".", decimal) for value in VALUES[:, 0])
    (imu,) = read(text_log(f"{name}\n{rows}"), ReadOptions(rate=100)).imus
    np.testing.assert_array_equal(imu.angular_rate.value[:, 0], VALUES[:, 0])
    assert imu.angular_rate.axes == "x"
    assert imu.angular_rate.time[-1] == (ROWS - 1) * 10**7


def test_one_column_without_a_header_is_named_by_option(text_log):
    rows = "".join(f"{value:.6f}\n" for value in VALUES[:, 5])
    options = ReadOptions(rate=100, columns=("accel_z",), units={"accel": "m/s²"})
    (imu,) = read(text_log(rows), options).imus
    assert imu.specific_force.axes == "z"
    np.testing.assert_array_equal(imu.specific_force.value[:, 2], VALUES[:, 5])


def test_empty_cells_and_nan_are_missing_numbers(text_log):
    lines = text(";", ",").splitlines()
    lines[20] = lines[20].rpartition(";")[0] + ";"
    lines[30] = lines[30].rpartition(";")[0] + ";NaN"
    (imu,) = read(text_log("\n".join([*lines, ""]))).imus
    assert len(imu.specific_force) == ROWS - 2
    assert repairs(imu) == {"not_finite": 2}


def test_text_columns_among_numbers_are_not_used_and_named(text_log):
    lines = text().splitlines()
    mixed = [f"frame,{lines[0]},note", *(f"imu_link,{line},so it is" for line in lines[1:])]
    log = read(text_log("\n".join([*mixed, ""])))
    assert_all(log)
    (note,) = (note for note in log.notes if note.id == "unused")
    assert "frame" in note
    assert "note" in note


@pytest.mark.parametrize(
    ("name", "factor"),
    [
        ("gyro_deg_h", np.radians(1 / 3600)), ("Rate [deg/h]", np.radians(1 / 3600)), ("omega (rad/s)", 1), ("FOG_rad_s", 1),
        ("Angular rate [deg/s]", np.radians(1)), ("gyro", 1),
    ],
)  # fmt: skip
def test_a_sensor_of_one_axis_needs_no_letter(text_log, name, factor):
    rows = "".join(f"{t / 1e9:.3f},{value:.6f}\n" for t, value in zip(TIMES, VALUES[:, 0], strict=True))
    options = ReadOptions(units={"gyro": "rad/s"} if name == "gyro" else {})
    (imu,) = read(text_log(f"time_s,{name}\n{rows}"), options).imus
    assert imu.angular_rate.axes == "x"
    np.testing.assert_allclose(imu.angular_rate.value[:, 0], VALUES[:, 0] * factor, rtol=1e-12)
