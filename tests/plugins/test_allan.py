from dataclasses import replace

import numpy as np
import pytest

from imuwb.errors import MissingDataError
from imuwb.log import SECOND, Conditioning, ImuStream, Log, Provenance, Triad
from imuwb.notes import ids
from imuwb.simulation import preset, static
from imuwb_plugins import allan, bandwidth, kaiser


@pytest.fixture(scope="module")
def log():
    return static(preset("3dm-gx3-25"), 1200, 50, 4)


def run(log, **options):
    return allan.run([log], allan.Parameters(**options))


@pytest.mark.slow
def test_finds_the_sensor_that_was_simulated(log):
    truth = preset("3dm-gx3-25")
    result = run(log)
    for axis, found in result.axes.items():
        white = truth.axes[axis].processes.terms[0].N
        assert found.coefficients["N"].value == pytest.approx(white, rel=0.03)
        assert found.fit.probability > 1e-6
    model = allan.error_model(result)
    assert set(model.axes) == set(truth.axes)
    assert log.provenance.hash in model.provenance["log"]


@pytest.mark.slow
def test_the_longer_grid_gives_the_same_fit(log):
    octave, dense = run(log), run(log, averaging_times="log:40")
    assert len(dense.axes["gyro_x"].averaging_time) > len(octave.axes["gyro_x"].averaging_time)
    assert octave.axes["gyro_x"].coefficients == dense.axes["gyro_x"].coefficients


def rows_of(log, keep):
    """Return the log with some of its gyros' rows, and no accelerometers."""
    triad = log.imus[0].angular_rate
    left = Triad(triad.time[keep], triad.value[keep])
    return replace(log, imus=(replace(log.imus[0], angular_rate=left, specific_force=None),))


@pytest.mark.slow
def test_a_gap_is_noted_and_leaves_the_figures_as_they_are(log):
    n = len(log.imus[0].angular_rate)
    result = run(rows_of(log, np.r_[0:20_000, 30_000:n]))
    (gaps,) = (note for note in result.notes if note.id == "gaps")
    assert gaps.startswith("gyro: 1 gap, 200 s")
    assert result.axes["gyro_x"].coefficients["N"].value == pytest.approx(7.04e-4, rel=0.03)
    alone = run(rows_of(log, np.r_[30_000:n]))
    for axis, found in result.axes.items():
        assert set(found.estimates.by) == {"allan", "likelihood", "wavelet"}
        for name in ("likelihood", "wavelet"):
            a, b = found.estimates.by[name]["N"], alone.axes[axis].estimates.by[name]["N"]
            assert (a.value, a.lower, a.upper) == pytest.approx((b.value, b.lower, b.upper), rel=1e-6)


@pytest.mark.slow
def test_a_missing_sample_switches_nothing_off(short):
    """Lines, other deviations and estimates are of the longest part without gaps, here 6000 samples of 9999."""
    cut = rows_of(short, np.r_[0:4000, 4001:10_000])
    result, alone = (run(x, deviation="total") for x in (cut, rows_of(short, np.r_[4001:10_000])))
    for axis, found in result.axes.items():
        assert found.estimates.headline == "likelihood"
        assert found.estimates.by["likelihood"]["N"].value == pytest.approx(0.01 / 50**0.5, rel=0.05)
        assert found.lines == alone.axes[axis].lines
        np.testing.assert_array_equal(found.other.deviation, alone.axes[axis].other.deviation)
    assert [line.frequency for line in result.axes["gyro_y"].lines] == pytest.approx([3.7], abs=0.01)


@pytest.mark.slow
def test_a_record_in_pieces_of_less_than_half_has_allan_deviations_only(short):
    found = run(rows_of(short, np.r_[0:3000, 3100:6000, 6100:9000]), deviation="total").axes["gyro_y"]
    assert (found.estimates, found.other, found.lines) == (None, None, ())
    assert found.coefficients["N"].upper > 0.01 / 50**0.5


def filtered(log, kind):
    if kind == "kaiser":
        return kaiser.condition(log, kaiser.Parameters(f_pass=12.0, f_stop=15.0))[0]
    return bandwidth.condition(log, bandwidth.Parameters(15.0))[0]


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["kaiser", "bandwidth"])
def test_what_a_filter_took_away_is_not_missing_from_the_white_noise(kind):
    """Of 21 white records: the fits are of what lies below the filter's band, where it does not show."""
    inside, limits, sizes = 0, 0, []
    for seed in range(7):
        log = filtered(made(0.01 * np.random.default_rng(seed).standard_normal((20_000, 3)), None, 50.0), kind)
        for found in run(log).axes.values():
            assert set(found.estimates.by) == {"allan", "likelihood"}
            assert ids(found.estimates.notes) == ("no-wavelet",)
            assert found.lines == ()
            assert found.fit.from_averaging_time > 10 / log.band
            n = found.estimates.by["likelihood"]["N"]
            inside += n.lower < 0.01 / 50**0.5 < n.upper
            limits += found.coefficients["N"].upper > 0.01 / 50**0.5
            sizes.append(n.value / (0.01 / 50**0.5))
    assert inside >= 18
    assert limits >= 18
    assert np.median(sizes) == pytest.approx(1, abs=0.015)


@pytest.mark.slow
def test_lines_above_a_filters_band_are_not_reported(short):
    """In a stop band, what a tone leaves stands out from what the noise leaves."""
    n = 10_000
    values = short.imus[0].angular_rate.value.copy()
    values[:, 1] += 0.01 * np.sin(2 * np.pi * 19.3 * np.arange(n) / 50)
    log = made(values, None, 50.0)
    there = [x.frequency for x in run(log, estimators=False).axes["gyro_y"].lines]
    assert sorted(there) == pytest.approx([3.7, 19.3], abs=0.01)
    left = run(filtered(log, "kaiser"), estimators=False).axes["gyro_y"].lines
    assert [x.frequency for x in left] == pytest.approx([3.7], abs=0.01)


def test_a_record_too_short_for_its_filter_has_no_fit_and_a_note(gyros):
    low = bandwidth.condition(gyros, bandwidth.Parameters(0.5, order=1))[0]
    found = run(low)
    assert all(f.processes is None for f in found.axes.values())
    assert any(note.startswith("gyro_x: no fit") for note in found.notes if note.id == "no-fit")
    assert "no-likelihood" in ids(found.axes["gyro_x"].estimates.notes)


@pytest.mark.slow
def test_triads_may_have_clocks_of_their_own(log):
    imu = log.imus[0]
    slow = Triad(imu.specific_force.time[::2], imu.specific_force.value[::2])
    result = run(replace(log, imus=(replace(imu, specific_force=slow),)))
    assert result.rate_hz["gyro"] == pytest.approx(50)
    assert result.rate_hz["accel"] == pytest.approx(25)
    assert result.axes["accel_x"].averaging_time[0] == pytest.approx(0.04)


@pytest.mark.slow
def test_one_triad_is_enough(log):
    result = run(replace(log, imus=(replace(log.imus[0], specific_force=None),)))
    assert list(result.axes) == ["gyro_x", "gyro_y", "gyro_z"]


@pytest.mark.slow
def test_a_shock_is_noted_with_the_quiet_part(log):
    imu = log.imus[0]
    value = imu.specific_force.value.copy()
    value[10_000:10_100] += 3.0
    result = run(replace(log, imus=(replace(imu, specific_force=Triad(imu.specific_force.time, value)),)))
    (note,) = (note for note in result.notes if note.id == "disturbances")
    assert "--start 2" in note


@pytest.mark.slow
def test_a_record_too_short_to_be_still_or_moving_has_a_note(log):
    imu = log.imus[0]
    parts = (Triad(t.time[:150], t.value[:150]) for t in (imu.angular_rate, imu.specific_force))
    result = run(replace(log, imus=(ImuStream(imu.name, *parts),)))
    assert (result.moving, result.quiet) == (None, None)
    assert "stillness-unknown" in ids(result.notes)


def test_too_few_samples_and_no_imu_are_missing_data():
    time = np.arange(10) * SECOND
    imu = ImuStream("imu", Triad(time, np.random.default_rng(0).standard_normal((10, 3))), None)
    where = Provenance("x.csv", "csv", "sha256:", 0)
    with pytest.raises(MissingDataError, match="10 samples"):
        run(Log(where, imus=(imu,)))
    with pytest.raises(MissingDataError, match="x.csv: .* IMU"):
        run(Log(where))


@pytest.fixture(scope="module")
def short():
    """Return 200 s of white noise with a random walk on accel_z, and a line on gyro_y."""
    n, rate = 10_000, 50.0
    rng = np.random.default_rng(21)
    gyro, accel = 0.01 * rng.standard_normal((n, 3)), 0.02 * rng.standard_normal((n, 3))
    gyro[:, 1] += 0.01 * np.sin(2 * np.pi * 3.7 * np.arange(n) / rate)
    accel[:, 2] += 0.02 * rng.standard_normal(n).cumsum() / rate**0.5
    return made(gyro, accel, rate)


def made(gyro, accel, rate):
    time = np.rint(np.arange(len(gyro)) * (SECOND / rate)).astype(np.int64)
    imu = ImuStream("/imu", Triad(time, gyro), None if accel is None else Triad(time, accel))
    return Log(Provenance("x.csv", "csv", "sha256:abc", 0), imus=(imu,))


@pytest.fixture(scope="module")
def chosen(short):
    return run(short, choose=True, model="headline")


@pytest.mark.slow
def test_every_estimator_finds_the_white_noise(chosen):
    for axis, true in (("gyro_x", 0.01 / 50**0.5), ("gyro_y", 0.01 / 50**0.5), ("accel_x", 0.02 / 50**0.5)):
        estimates = chosen.axes[axis].estimates
        assert set(estimates.by) == {"allan", "likelihood", "wavelet"}
        assert estimates.headline == "likelihood"
        for name, coefficients in estimates.by.items():
            assert coefficients["N"].value == pytest.approx(true, rel=0.08), name
            assert coefficients["N"].lower < true * 1.03
            assert coefficients["N"].upper > true * 0.97
        assert estimates.by["allan"]["N"].value == chosen.axes[axis].coefficients["N"].value


def test_differences_are_reported_where_intervals_do_not_meet(chosen):
    for found in chosen.axes.values():
        by = found.estimates.by
        names = list(by)
        apart = {
            f"{letter}: {a} and {b}"
            for i, a in enumerate(names)
            for b in names[i + 1 :]
            for letter in by[a].keys() & by[b].keys()
            if by[a][letter].upper is not None
            and by[b][letter].upper is not None
            and (by[a][letter].upper < (by[b][letter].lower or 0) or by[b][letter].upper < (by[a][letter].lower or 0))
        }
        assert set(found.estimates.disagreements) == apart
        assert found.estimates.agree == (not apart)


@pytest.mark.slow
def test_sums_are_compared_only_when_asked_for(chosen, gyros):
    alone = run(gyros, estimators=False).axes["gyro_x"]
    assert (alone.estimates, alone.other) == (None, None)
    assert chosen.axes["gyro_x"].estimates.choice.best.name == "N"
    walk = chosen.axes["accel_z"].estimates.choice
    assert "N" in walk.best.name
    assert walk.best.name != "N"
    assert run(gyros).axes["gyro_x"].estimates.choice is None


@pytest.mark.parametrize("whose", ["allan", "headline"])
def test_the_model_has_one_estimators_terms_and_their_own_intervals(chosen, whose):
    model = allan.error_model(replace(chosen, model=whose))
    terms = {type(t).__name__: t for t in model.axes["accel_z"].processes.terms}
    if "RandomWalk" in terms:
        assert pytest.approx(0.02, rel=0.3) == terms["RandomWalk"].K
    for axis, content in model.axes.items():
        estimates = chosen.axes[axis].estimates
        headline = estimates.by["allan" if whose == "allan" else estimates.headline]
        for place, ends in content.intervals.items():
            i, _, letter = place.partition(".")
            assert getattr(content.processes.terms[int(i)], letter) == headline[letter].value
            assert ends == (headline[letter].lower, headline[letter].upper)
            assert ends[0] > 0
        for letter, limit in content.limits.items():
            assert not headline[letter].lower
            assert limit == headline[letter].upper


def test_a_line_is_found_named_and_kept_in_the_model(chosen):
    (line,) = chosen.axes["gyro_y"].lines
    assert line.frequency == pytest.approx(3.7, abs=0.005)
    assert line.amplitude.value == pytest.approx(0.01, rel=0.05)
    terms = allan.error_model(chosen).axes["gyro_y"].processes.terms
    assert [t.frequency for t in terms if t.name == "sinusoid"] == [line.frequency]
    assert chosen.axes["gyro_x"].lines == ()


@pytest.mark.slow
def test_noise_that_grows_is_not_stationary():
    n = 12_000
    rng = np.random.default_rng(22)
    gyro = 0.01 * rng.standard_normal((n, 3))
    gyro[9000:10_000, 2] *= 2
    found = run(made(gyro, None, 50.0))
    steady, growing = found.axes["gyro_x"].estimates.stationarity, found.axes["gyro_z"].estimates.stationarity
    assert steady.stationary
    assert not growing.stationary
    assert growing.start[growing.worst_part] == pytest.approx(180)
    assert growing.worst_ratio == pytest.approx(2 / (15 / 12) ** 0.5, rel=0.1)
    remarks = {f.axis: f.remarks for f in allan.findings(found) if f.headline}
    (unsteady,) = (r for r in remarks["gyro_z"] if r.id == "not-stationary")
    assert unsteady.startswith("SUSPICIOUS")
    assert "180 s" in unsteady
    assert "not-stationary" not in ids(remarks["gyro_x"])


def test_findings_have_one_headline_for_each_axis(chosen):
    found = allan.findings(chosen)
    for axis in chosen.axes:
        of_axis = [f for f in found if f.axis == axis]
        assert [f.source for f in of_axis if f.headline] == ["likelihood"]
        assert all(f.headline or not f.remarks for f in of_axis)
        assert next(f for f in of_axis if f.headline).remarks[0].id == "dominant"
    (best,) = (r for f in found if f.axis == "gyro_x" for r in f.remarks if r.id == "best-sum")
    assert best.endswith(": N")


def test_remarks_say_when_a_sensor_drifts_and_when_it_is_quantized():
    n, rate = 10_000, 50.0
    rng = np.random.default_rng(23)
    time = np.arange(n) / rate
    gyro = 1e-4 * rng.standard_normal((n, 3))
    gyro[:, 0] += 1e-3 * time
    gyro[:, 1] += np.diff(rng.standard_normal(n + 1)) * 1e-3 * rate
    found = run(made(gyro, None, rate))
    remarks = {f.axis: {r.id: r for r in f.remarks} for f in allan.findings(found) if f.headline}
    assert "0.001 rad/s²" in remarks["gyro_x"]["ramp"]
    assert "quantization" in remarks["gyro_y"]
    assert "ramp" not in remarks["gyro_z"]


def test_a_constant_axis_is_suspicious_and_the_others_are_analysed(gyros):
    imu = gyros.imus[0]
    value = imu.angular_rate.value.copy()
    value[:, 2] = 0.5
    found = run(replace(gyros, imus=(replace(imu, angular_rate=Triad(imu.angular_rate.time, value)),)))
    (finding,) = (f for f in allan.findings(found) if f.axis == "gyro_z")
    assert ids(finding.remarks) == ("no-fit",)
    assert finding.remarks[0].startswith("SUSPICIOUS")
    assert any(note.startswith("gyro_z: ") for note in found.notes if note.id == "no-fit")
    assert "gyro_z" not in allan.error_model(found).axes
    assert found.axes["gyro_x"].coefficients["N"].value == pytest.approx(0.01 / 50**0.5, rel=0.05)


@pytest.fixture(scope="module")
def gyros(short):
    """Return its first 60 s, gyros only."""
    triad = short.imus[0].angular_rate
    return replace(
        short,
        imus=(replace(short.imus[0], angular_rate=Triad(triad.time[:3000], triad.value[:3000]), specific_force=None),),
    )


@pytest.mark.slow
def test_fast_is_the_same_within_a_fraction_of_the_intervals(gyros):
    usual, fast = (run(gyros, averaging_times="all", fast=f, lines=False, estimators=False) for f in (False, True))
    for axis, found in usual.axes.items():
        thin = fast.axes[axis]
        _, a, b = np.intersect1d(
            np.round(found.averaging_time, 9), np.round(thin.averaging_time, 9), return_indices=True
        )
        assert a.size > 30
        half = (found.upper - found.lower)[a] / 2
        assert (np.abs(thin.allan_deviation[b] - found.allan_deviation[a]) <= 0.2 * half).all()
        assert thin.coefficients == found.coefficients  # the fit is of octaves


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["modified", "hadamard", "total"])
def test_another_deviation_is_drawn_beside(gyros, kind):
    from imuwb.identification import deviation

    other = run(gyros, deviation=kind, lines=False, estimators=False).axes["gyro_x"].other
    values = np.ascontiguousarray(gyros.imus[0].angular_rate.value[:, 0])
    assert other.kind == kind
    np.testing.assert_array_equal(other.deviation, deviation(values, 0.02, kind).deviation)


def test_conditioning_is_part_of_the_provenance(gyros):
    step = Conditioning("bandwidth", "cutoff=20", causal=True, delay=0.01)
    model = allan.error_model(run(replace(gyros, conditioning=(step,)), estimators=False))
    assert model.provenance["log"] == "x.csv sha256:abc through bandwidth:cutoff=20"


@pytest.mark.parametrize(("whose", "named"), [("allan", "by Allan variance, 95 %"), ("headline", "by likelihood")])
def test_the_provenance_names_the_estimator_and_the_rate(chosen, whose, named):
    provenance = allan.error_model(replace(chosen, model=whose)).provenance
    assert named in provenance["analysis"]
    assert provenance["rate"] == "gyro 50 Hz, accel 50 Hz"


def test_all_is_drawn(chosen, shown):
    allan.draw(chosen, shown)
    assert shown.figures
    assert any("deg/√h" in cell for table in shown.tables for row in table.rows for cell in row)


@pytest.mark.parametrize(
    "wrong", [{"level": 1.0}, {"level": 0.2}, {"averaging_times": "often"}, {"averaging_times": "-1,2"}]
)
def test_wrong_parameters_say_why(wrong):
    with pytest.raises(ValueError, match="must be"):
        allan.Parameters(**wrong)
