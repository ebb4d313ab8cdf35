"""Logs of sentences that are damaged, refused, or lack a fact."""

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError, UsageError
from imuwb.notes import ids
from imuwb.readers import ReadOptions, read, reader_of
from imuwb.readers.text.sentence_lines import crc32
from imuwb.readers.text.sentence_rows import exact
from tests.readers.repairs import repairs
from tests.readers.text.shapes.sentence_writers import flysight, novatel, raw_imu_increments, vn_imu, vn_qmr
from tests.readers.text.shapes.truth import GYRO, STEP, TIME, gps


def test_the_checksum_of_novatel_is_that_of_its_own_receivers():
    # Two sentences as receivers sent them; each states its own checksum.
    assert (
        crc32(b"RAWIMUSXA,2075,507495.165;00,13,2075,507495.165000000,00000000,32068,-1612,-1320,256,1536,-255")
        == 0xDD88585C
    )
    assert (
        crc32(b"RAWIMUSA,1537,361705.645;1537,361705.644826900,00000000,30387,415,-5398,-23039,-18100736,-5117")
        == 0xC01B540C
    )


def test_sentences_with_a_wrong_checksum_are_left_out_and_counted(text_log):
    lines = raw_imu_increments().text.split("\r\n")
    lines[40] = lines[40].replace(",04,", ",05,").replace(";04,", ";05,")
    lines[50] = lines[50][:-3]
    imu = read(text_log("\r\n".join(lines))).imus[0]
    assert len(imu.angular_rate) == len(GYRO) - 2
    assert repairs(imu) == {"bad_checksum": 1}


def test_corrected_increments_are_no_specific_force(text_log):
    week, tow = gps(TIME)
    heads = [f"CORRIMUDATASA,{week[i]},{tow[i] / 1e9:.3f}" for i in range(50)]
    lines = [novatel("%", head, f"{week[0]},{tow[0] / 1e9:.9f},1e-7,1e-7,1e-7,1e-5,1e-5,1e-5") for head in heads]
    with pytest.raises(UnreadableLogError, match="CORRIMUDATASA.*no specific force"):
        read(text_log("\r\n".join([*lines, ""])))
    log = read(text_log("\r\n".join([*lines, raw_imu_increments().text])))
    assert len(log.imus) == 1
    assert any(note.id == "unused" and "CORRIMUDATASA (50)" in note for note in log.notes)


@pytest.mark.parametrize(("device", "message"), [("99", "type 99")])
def test_an_unknown_type_of_imu_is_named(text_log, device, message):
    week, tow = gps(TIME)
    lines = [
        novatel(
            "%",
            f"RAWIMUSXA,{week[i]},{tow[i] / 1e9:.3f}",
            f"00,{device},{week[i]},{tow[i] / 1e9:.9f},00000000,1,2,3,4,5,6",
        )
        for i in range(5)
    ]
    with pytest.raises(UnreadableLogError, match=message):
        read(text_log("\r\n".join([*lines, ""])))


def test_counts_without_the_type_of_the_imu_are_refused(text_log):
    week, tow = gps(TIME)
    lines = [
        novatel("%", f"RAWIMUSA,{week[i]},{tow[i] / 1e9:.3f}", f"{week[i]},{tow[i] / 1e9:.9f},00000000,1,2,3,4,5,6")
        for i in range(5)
    ]
    with pytest.raises(UsageError, match="RAWIMUSX"):
        read(text_log("\r\n".join([*lines, ""])))


def test_a_sensor_without_a_time_asks_for_the_rate(text_log):
    with pytest.raises(UsageError, match="--rate HZ"):
        read(text_log(vn_imu().text))


def test_a_file_that_describes_itself_without_units_asks_for_them(text_log):
    text = "\n".join(line for line in flysight().text.split("\n") if not line.startswith("$UNIT,IMU"))
    with pytest.raises(UsageError, match="--units gyro=UNIT"):
        read(text_log(text))


def test_the_described_clock_without_a_time_of_week_counts_from_power_up(text_log):
    text = "\n".join(line for line in flysight().text.split("\n") if not line.startswith("$TIME"))
    imu = read(text_log(text)).imus[0]
    assert imu.origin.epoch == "boot"
    assert imu.angular_rate.time.tolist() == (5_000_000_000 + STEP * np.arange(len(GYRO))).tolist()


def test_other_sentences_are_named_with_their_number(text_log):
    log = read(text_log("$GPXYZ,1,2\n" * 7 + vn_imu().text), ReadOptions(rate=100))
    assert any(note.id == "unused" and "$GPXYZ (7)" in note for note in log.notes)
    assert "shape" in ids(log.notes)


def test_lines_with_such_words_alone_are_no_log_of_sentences(text_log):
    path = text_log("Gyro,1,2,3\nAccel,1,2,3\nFix,GPS,1,2,3\nACCE;1;2;3\n" * 20)
    assert reader_of(path).format == "csv"


def test_two_imus_of_one_log_have_their_names(text_log):
    lines = [line for pair in zip(vn_imu().text.split("\r\n"), vn_qmr().text.split("\n"), strict=True) for line in pair]
    log = read(text_log("\n".join(lines)), ReadOptions(rate=100))
    assert {imu.name for imu in log.imus} == {"imu", "compensated"}
    assert all(len(imu.angular_rate) == len(GYRO) for imu in log.imus)


@pytest.mark.parametrize(
    ("cell", "digits", "value"),
    [
        ("1.5", 9, 1_500_000_000), ("-0.25", 3, -250), (".5", 0, 0), ("12", 0, 12), ("1e3", 3, 1_000_000), ("+2.0000000019", 9, 2_000_000_001),
        ("", 9, None), ("x", 9, None), ("nan", 9, None), ("inf", 9, None), ("1e400", 9, None), ("9" * 30, 0, None), ("1.2.3", 9, None),
    ],
)  # fmt: skip
def test_decimal_numbers_are_exact(cell, digits, value):
    assert exact(cell, digits) == value
