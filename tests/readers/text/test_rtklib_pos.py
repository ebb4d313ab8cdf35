import gzip

import numpy as np
import pytest

from imuwb.errors import UnreadableLogError
from imuwb.notes import ids
from imuwb.readers import read
from tests.readers.repairs import repairs

DEG = np.pi / 180
NOON = 1_714_564_800 * 10**9  # 2024-05-01T12:00:00Z
HEADER = "%  {} latitude(deg) longitude(deg)  height(m)   Q  ns   sdn(m)   sde(m)   sdu(m)  sdne(m)  sdeu(m)  sdun(m) age(s)  ratio"
CELLS = "  47.5   -122.25   101.5   {}   9   0.1   0.2   0.3   0.0   0.0   0.0   1.0   5.0"


def pos(*stamps, scale="GPST", flags=None):
    flags = flags or [1] * len(stamps)
    rows = [stamp + CELLS.format(flag) for stamp, flag in zip(stamps, flags, strict=True)]
    return "\n".join(["% program   : RTKPOST", HEADER.format(scale), *rows]) + "\n"


@pytest.fixture
def fix_of(text_log):
    def fix(text):
        (found,) = read(text_log(text, "log.pos")).gnss
        return found

    return fix


def test_positions_are_radians_and_sigmas_north_east_down(fix_of):
    fix = fix_of(pos("2024/05/01 12:00:00.000", scale="UTC"))
    np.testing.assert_allclose(fix.position, [[47.5 * DEG, -122.25 * DEG, 101.5]], rtol=1e-15)
    assert fix.position_sigma.tolist() == [[0.1, 0.2, 0.3]]
    assert fix.velocity is None


@pytest.mark.parametrize(
    ("scale", "stamp"),
    [
        ("UTC", "2024/05/01 12:00:00.125"),
        ("GPST", "2024/05/01 12:00:18.125"),
        ("JST", "2024/05/01 21:00:00.125"),
        ("GPST", "2312 302418.125"),
    ],
)
def test_every_time_scale_becomes_utc(fix_of, scale, stamp):
    fix = fix_of(pos(stamp, scale=scale))
    assert fix.time.tolist() == [NOON + 125_000_000]
    assert fix.origin.epoch == "unix"


@pytest.mark.parametrize(
    ("date", "ahead"),
    [
        ("2016/06/01", 17),
        ("2014/06/01", 16),
        ("2010/06/01", 15),
        ("2008/06/01", 14),
        ("1993/06/30", 8),
        ("1993/07/01", 9),
        ("1993/12/01", 9),
        ("1981/08/01", 1),
        ("1981/06/01", 0),
    ],
)
def test_leap_seconds_are_those_of_the_date(fix_of, date, ahead):
    gps, utc = (fix_of(pos(f"{date} 12:00:30.000", scale=scale)).time[0] for scale in ("GPST", "UTC"))
    assert utc - gps == ahead * 10**9


@pytest.mark.parametrize(
    ("gps", "utc"),
    [
        ("2016/12/31 23:59:50.000", "2016/12/31 23:59:33.000"),
        ("2017/01/01 00:00:05.000", "2016/12/31 23:59:48.000"),
        ("2017/01/01 00:00:16.500", "2016/12/31 23:59:59.500"),
        ("2017/01/01 00:00:18.000", "2017/01/01 00:00:00.000"),
    ],
)
def test_a_leap_second_counts_from_utcs_midnight(fix_of, gps, utc):
    assert fix_of(pos(gps)).time.tolist() == fix_of(pos(utc, scale="UTC")).time.tolist()


def test_quality_flags_become_fix_types(fix_of):
    stamps = [f"2024/05/01 12:00:{i:02d}.000" for i in range(7)]
    assert fix_of(pos(*stamps, flags=[1, 2, 3, 4, 5, 6, 9])).fix_type.tolist() == [6, 5, 4, 4, 3, 8, 0]


def test_velocity_up_becomes_down(fix_of):
    text = (
        "%  UTC latitude(deg) longitude(deg) height(m) Q vn(m/s) ve(m/s) vu(m/s) sdvn sdve sdvu\n"
        "2024/05/01 12:00:00.000 47 8 400 1 1.0 2.0 3.0 0.1 0.2 0.3\n"
    )
    fix = fix_of(text)
    assert fix.velocity.tolist() == [[1.0, 2.0, -3.0]]
    assert fix.velocity_sigma.tolist() == [[0.1, 0.2, 0.3]]


def test_lines_that_are_cut_or_no_numbers_are_left_out_and_counted(fix_of):
    stamps = [f"2024/05/01 12:00:{i:02d}.000" for i in range(3)]
    text = (
        pos(*stamps)
        + "garbage here\n\n2024/13/01 12:00:05.000"
        + CELLS.format(1)
        + "\n2024/05/01 12:00:09.000 47.5 -12"
    )
    fix = fix_of(text)
    assert len(fix) == 3
    assert repairs(fix) == {"bad_line": 3}


@pytest.mark.parametrize("flag", ["nan", "inf", "x"])
def test_a_flag_that_is_no_number_costs_its_row(fix_of, flag):
    fix = fix_of(pos(*(f"2024/05/01 12:00:0{i}.000" for i in range(3)), flags=[1, flag, 2]))
    assert fix.fix_type.tolist() == [6, 5]
    assert [r.count for r in fix.origin.repairs] == [1]


@pytest.mark.parametrize("scale", ["GPST", "UTC", "JST"])
def test_dates_no_receiver_says_cost_their_row(fix_of, scale):
    dates = ("1/1/1 00:00:00", "9999/12/31 23:59:59.9", "2024/05/01 12:00:00", "99999999 5", "2312 nan")
    fix = fix_of(pos(*dates, scale=scale))
    assert len(fix) == 1
    assert [r.count for r in fix.origin.repairs] == [4]


def test_a_second_header_may_have_other_columns(text_log):
    second = (
        "%  UTC latitude(deg) longitude(deg) height(m) Q vn(m/s) ve(m/s) vu(m/s) sdvn sdve sdvu\n"
        "2024/05/01 12:00:01.000 47 8 400 1 1.0 2.0 3.0 0.1 0.2 0.3\n"
    )
    fixes = read(text_log(pos("2024/05/01 12:00:18.000") + second, "log.pos")).gnss
    assert [(fix.time - NOON).tolist() for fix in fixes] == [[0], [10**9]]
    assert fixes[0].velocity is None
    assert fixes[1].velocity.tolist() == [[1.0, 2.0, -3.0]]


def test_of_a_gzip_file_that_is_cut_what_unpacks_is_used(text_log):
    stamps = (f"2024/05/01 12:{i // 60:02d}:{i % 60:02d}.000" for i in range(600))
    log = read(text_log(gzip.compress(pos(*stamps).encode())[:-200], "log.pos.gz"))
    assert 300 < len(log.gnss[0]) < 600
    assert "packed_cut" in ids(log.notes)


def test_a_header_without_a_solution_is_refused(text_log):
    with pytest.raises(UnreadableLogError, match="no solution"):
        read(text_log(pos(), "log.pos"))


def test_the_header_decides_not_the_suffix(text_log):
    assert read(text_log(pos("2024/05/01 12:00:00.000"), "log.csv")).provenance.format == "rtklib"


def test_that_gps_time_was_made_utc_is_noted(text_log):
    notes = [read(text_log(pos("2024/05/01 12:00:30.000", scale=scale), "log.pos")).notes for scale in ("GPST", "UTC")]
    assert list(map(ids, notes)) == [("gps_time",), ()]


def test_a_real_drive(shared):
    (fix,) = read(shared / "drive" / "gnss_1934_sf.pos").gnss
    assert len(fix) == 2197
    assert np.count_nonzero(fix.fix_type == 6) == 2189
    assert np.median(np.diff(fix.time)) == 250_000_000
    moved = np.cumsum(np.linalg.norm(fix.velocity[:, :2], axis=1))[-1] * 0.25
    assert moved == pytest.approx(4050, rel=0.02)


def test_a_last_line_that_was_cut_inside_its_last_cell_is_left_out(fix_of):
    text = pos(*(f"2024/05/01 12:00:0{i}.000" for i in range(3)))
    assert len(fix_of(text[:-1])) == 3  # without its end, but whole
    fix = fix_of(text[:-2])
    assert len(fix) == 2
    assert repairs(fix) == {"bad_line": 1}


def test_of_a_damaged_packed_file_nothing_behind_the_damage_is_used(text_log):
    rng = np.random.default_rng(0)
    rows = [f"2024/05/01 12:{i // 60:02d}:{i % 60:02d}.000 47 8 {rng.uniform(400, 500):.9f} 1" for i in range(3000)]
    text = "%  UTC latitude(deg) longitude(deg) height(m) Q\n" + "\n".join([*rows, ""])
    packed = bytearray(gzip.compress(text.encode()))
    packed[len(packed) // 2] ^= 0xFF
    log = read(text_log(bytes(packed), "log.pos.gz"))
    whole = [float(row.split()[4]) for row in rows]
    assert 100 < len(log.gnss[0]) < 2900
    assert log.gnss[0].position[:, 2].tolist() == whole[: len(log.gnss[0])]
    assert "packed_damaged" in ids(log.notes)


def test_every_quality_flag_has_its_fix_type(fix_of):
    stamps = [f"2024/05/01 12:00:{i:02d}.000" for i in range(8)]
    fix = fix_of(pos(*stamps, scale="UTC", flags=range(8)))
    assert fix.fix_type.tolist() == [6, 5, 4, 4, 3, 8, 0]  # fixed, float, SBAS, DGPS, single, PPP; 0 is no solution
    assert [(r.what.id, r.count) for r in fix.origin.repairs] == [("no_fix", 1)]


@pytest.mark.parametrize(("year", "used"), [(1979, False), (1980, True), (2115, True), (2200, False), (2250, False)])
def test_a_year_before_gps_or_after_2199_is_damage(fix_of, year, used):
    fix = fix_of(pos(f"{year}/05/01 12:00:00.000", "2024/05/01 12:00:00.000", scale="UTC"))
    assert repairs(fix).get("bad_line", 0) == (not used)
