import numpy as np
import pytest

from imuwb.identification.correlation.burg import burg
from imuwb.identification.lssa import Constituents, Noise, adjust, least_squares_spectrum
from imuwb.identification.lssa.whitening import dense

DT = 0.01
KNOWN = {
    "nothing": Constituents("none"),
    "all": Constituents("quadratic", (0.5, 1.1), (3.3, 11.0), (0.2,)),
}


def covariance_of(kind, adjusted, time, given):
    """Return C of the structure, written out; of a random walk that of its steps."""
    n, fit = time.size, adjusted.noise
    apart = np.abs(time[:, None] - time)
    return {
        "white": lambda: np.eye(n),
        "weights": lambda: np.diag(1 / given),
        "AR(1)": lambda: (-float(fit.alpha[0])) ** np.rint(apart / DT),
        "Gauss-Markov": lambda: np.exp(-apart / fit.correlation_time),
        "random walk": lambda: np.diag(np.diff(time)),
        "dense": lambda: given,
    }[kind]()


@pytest.mark.slow
@pytest.mark.parametrize("known", KNOWN)
@pytest.mark.parametrize("kind", ["white", "weights", "AR(1)", "Gauss-Markov", "random walk", "dense"])
@pytest.mark.parametrize("spacing", ["even", "gaps", "uneven"])
def test_a_spectrum_is_the_direct_formulas(spacing, kind, known, stamps, direct):
    if (spacing, kind) == ("uneven", "AR(1)"):
        pytest.skip("AR noise is of even samples; it is refused elsewhere")
    rng = np.random.default_rng(2)
    time = stamps[spacing]
    n = time.size
    values = 100 + rng.standard_normal(n).cumsum() + 3 * np.cos(2 * np.pi * 7.3 * time + 1)
    mixing = rng.standard_normal((n, n))
    given = {"weights": rng.uniform(0.2, 3, n), "dense": mixing @ mixing.T + n * np.eye(n)}.get(kind)
    noise = {
        "white": Noise(), "weights": Noise(), "AR(1)": Noise("autoregressive", 1), "Gauss-Markov": Noise("gauss-markov"),
        "random walk": Noise("random-walk"), "dense": Noise("covariance", covariance=given if kind == "dense" else None)
        if kind == "dense" else Noise(),
    }[kind]  # fmt: skip
    adjusted = adjust(time, values, KNOWN[known], noise, interval=DT, weights=given if kind == "weights" else None)
    columns, difference = KNOWN[known].columns(time), None
    if kind == "random walk":  # its level is not known: the steps are all there is
        difference = np.diff(np.eye(n), axis=0)
        columns = columns[:, 1:] if known == "all" else columns
    for oversampling in (1, 2, 3):
        found = least_squares_spectrum(adjusted, oversampling=oversampling)
        told = np.flatnonzero(
            (found.frequency * time[-1] > 1.2) & (np.abs(found.frequency[:, None] - (3.3, 11.0)).min(axis=1) > 0.1)
        )
        pick = rng.choice(told, 12, replace=False)
        rest, reduction, amplitude = direct(
            covariance_of(kind, adjusted, time, given), columns, time, values, found.frequency[pick], difference
        )
        assert adjusted.rest == pytest.approx(rest, rel=1e-9)
        assert found.reduction[pick] == pytest.approx(reduction, rel=2e-8)
        assert found.share[pick] == pytest.approx(reduction / rest, rel=2e-8)
        assert np.abs(found.complex_amplitude[pick] / amplitude - 1).max() < 2e-8


def test_a_negative_first_order_coefficient_carries_over_gaps(direct):
    rng = np.random.default_rng(4)
    index = np.sort(rng.permutation(400)[:300])
    x = np.zeros(400)
    for k in range(1, 400):
        x[k] = -0.7 * x[k - 1] + rng.standard_normal()
    time = (index - index[0]) * DT
    adjusted = adjust(time, x[index], Constituents("constant"), Noise("autoregressive", 1), interval=DT)
    (alpha,) = adjusted.noise.alpha
    assert alpha == pytest.approx(0.7, abs=0.15)
    found = least_squares_spectrum(adjusted)
    pick = np.arange(3, 200, 17)
    powers = (-alpha) ** np.abs(index[:, None] - index)
    _, reduction, amplitude = direct(powers, np.ones((300, 1)), time, x[index], found.frequency[pick])
    assert found.reduction[pick] / (1 - alpha**2) == pytest.approx(reduction / (1 - alpha**2), rel=1e-9)
    assert np.abs(found.complex_amplitude[pick] / amplitude - 1).max() < 1e-8


def test_third_order_noise_is_conditional_on_the_samples_before(direct):
    rng = np.random.default_rng(5)
    x = np.zeros(300)
    for k in range(3, 300):
        x[k] = 1.1 * x[k - 1] - 0.5 * x[k - 2] + 0.2 * x[k - 3] + rng.standard_normal()
    keep = np.delete(np.arange(300), np.r_[100:104, 200])
    time = keep * DT
    adjusted = adjust(time, x[keep], Constituents("linear"), Noise("autoregressive", 3), interval=DT)
    alpha = adjusted.noise.alpha
    difference = np.array(
        [
            np.eye(keep.size)[i] + sum(alpha[k] * np.eye(keep.size)[i - k - 1] for k in range(3))
            for i in range(3, keep.size)
            if keep[i] - keep[i - 3] == 3
        ]
    )
    found = least_squares_spectrum(adjusted)
    pick = np.arange(4, 280, 23)
    rest, reduction, amplitude = direct(
        np.eye(len(difference)), Constituents("linear").columns(time), time, x[keep], found.frequency[pick], difference
    )
    assert adjusted.rest == pytest.approx(rest, rel=1e-10)
    assert found.reduction[pick] == pytest.approx(reduction, rel=1e-8)
    assert np.abs(found.complex_amplitude[pick] / amplitude - 1).max() < 1e-8
    assert alpha == pytest.approx((-1.1, 0.5, -0.2), abs=0.25)
    assert alpha == pytest.approx(burg(x[keep], 3, [100, 196]).alpha[3], abs=0.03)


def test_density_is_fouriers_and_the_printed_scales_are_the_papers():
    rng = np.random.default_rng(6)
    n = 256
    time, values = np.arange(n) * DT, rng.standard_normal(n)
    found = least_squares_spectrum(adjust(time, values, Constituents("constant")), oversampling=1)
    transform = np.fft.rfft(values - values.mean())[1 : n // 2]
    assert found.frequency == pytest.approx(np.fft.rfftfreq(n, DT)[1 : n // 2])
    assert found.density == pytest.approx(2 * DT / n * np.abs(transform) ** 2, rel=1e-9)
    assert found.amplitude == pytest.approx(2 / n * np.abs(transform), rel=1e-9)
    assert np.angle(found.complex_amplitude) == pytest.approx(np.angle(transform), abs=1e-9)
    share = np.abs(transform) ** 2 * 2 / n / np.sum((values - values.mean()) ** 2)
    assert found.percent == pytest.approx(100 * share, rel=1e-9)
    assert found.decibels == pytest.approx(10 * np.log10(share / (1 - share)), abs=1e-8)
    assert found.printed_density == pytest.approx(2 / n * np.abs(transform) ** 2 / found.frequency, rel=1e-9)


def test_constituents_and_their_errors_are_least_squares():
    rng = np.random.default_rng(7)
    time = np.arange(500) * DT
    known = Constituents("linear", (2.0,), (1.7,), (0.5,))
    values = known.columns(time) @ (5, -1, 2, 3, 0.4, -0.2) + rng.standard_normal(500)
    found = adjust(time, values, known)
    columns = known.columns(time)
    best, rest, *_ = np.linalg.lstsq(columns, values, rcond=None)
    errors = np.sqrt(np.diagonal(np.linalg.inv(columns.T @ columns)) * rest[0] / 494)
    assert found.names == (
        "constant", "trend", "jump at 2 s", "transient of 0.5 s", "cosine of 1.7 Hz", "sine of 1.7 Hz"
    )  # fmt: skip
    assert found.coefficients == pytest.approx(best, rel=1e-9)
    assert found.sigma == pytest.approx(errors, rel=1e-9)
    assert found.freedom == 494


@pytest.mark.parametrize("kind", ["white", "local"])
def test_a_forced_line_says_nothing_at_its_own_frequency(kind):
    time = np.arange(1000) * DT
    values = 3 * np.cos(2 * np.pi * 7.0 * time) + np.random.default_rng(8).standard_normal(1000)
    found = least_squares_spectrum(adjust(time, values, Constituents("constant", forced=(7.0,)), Noise(kind)))
    at = int(np.argmin(np.abs(found.frequency - 7.0)))
    assert found.frequency[at] == pytest.approx(7.0)
    for said in (found.reduction, found.percent, found.density, found.amplitude):
        assert said[at] == 0
        assert np.isfinite(said).all()
    assert np.isfinite(found.decibels).all()


def test_weights_of_nothing_leave_samples_out():
    rng = np.random.default_rng(9)
    time, values, weights = np.arange(300) * DT, rng.standard_normal(300), np.ones(300)
    weights[50:80] = 0
    keep = weights > 0
    values[50:80] = 1e6
    whole = adjust(time, values, Constituents("linear"), weights=weights)
    part = adjust(time[keep], values[keep], Constituents("linear"), interval=DT)
    assert whole.freedom == part.freedom
    assert whole.rest == pytest.approx(part.rest, rel=1e-9)
    shares = [least_squares_spectrum(a).percent for a in (whole, part)]
    assert shares[0] == pytest.approx(shares[1], rel=1e-6)


def test_large_offsets_and_late_stamps_change_nothing():
    rng = np.random.default_rng(10)
    time, values = np.arange(512) / 128, rng.standard_normal(512)
    plain, late = (least_squares_spectrum(adjust(t, v, Constituents("linear"))) for t, v in (
        (time, values), (time + 2**30, values + 1e6),
    ))  # fmt: skip
    assert late.frequency == pytest.approx(plain.frequency, rel=1e-12)
    assert late.reduction == pytest.approx(plain.reduction, rel=1e-5, abs=1e-7)


@pytest.mark.parametrize(("rate", "noise"), [(819.2, Noise("autoregressive", 2)), (1024.0, Noise("autoregressive", 1))])
def test_stamps_rounded_to_nanoseconds_are_even(rate, noise):
    time = np.rint(np.arange(2000) * 1e9 / rate) / 1e9
    found = adjust(time, np.random.default_rng(11).standard_normal(2000), Constituents(), noise, interval=1 / rate)
    assert found.lattice.interval == pytest.approx(1 / rate, rel=1e-9)


def test_autoregressive_noise_takes_stamps_for_rounded():
    rng = np.random.default_rng(12)
    time = np.arange(2000) * DT + rng.uniform(-1, 1, 2000) * 1e-4
    values = rng.standard_normal(2000)
    assert adjust(time, values, Constituents()).lattice is None
    found = adjust(time, values, Constituents(), Noise("autoregressive", 2))
    assert found.noise.alpha == pytest.approx(burg(values, 2).alpha[2], abs=0.01)


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"time": np.r_[0:50, 49:99] * DT}, "must rise"),
        ({"values": np.r_[np.nan, np.ones(99)]}, "finite"),
        ({"time": np.arange(99) * DT}, "one length"),
        ({"known": Constituents(jumps=(5.0,))}, "jump at 5 s"),
        ({"known": Constituents(forced=(2.0, 2.0))}, "cosine of 2 Hz"),
        ({"noise": Noise("random-walk"), "known": Constituents(jumps=(0.0,))}, "jump at 0 s"),
        ({"noise": Noise("covariance", covariance=np.eye(99))}, "99 samples for a series of 100"),
        ({"noise": Noise("covariance", covariance=np.ones((100, 100)))}, "covariance is"),
        ({"noise": Noise("covariance", covariance=np.triu(np.ones((100, 100))))}, "symmetric"),
        ({"noise": Noise("covariance", covariance=np.ones((100, 2)))}, "square"),
        ({"noise": Noise("autoregressive", 3), "time": np.cumsum(np.tile((1, 1, 1, 1, 2), 20)) * DT}, "gaps leave"),
        (
            {"noise": Noise("autoregressive", 3), "time": np.cumsum(np.linspace(0.5, 1.5, 100)) * DT},
            "evenly spaced",
        ),
        ({"weights": -np.ones(100)}, "weights"),
        ({"weights": np.ones(100), "noise": Noise("random-walk")}, "weights"),
    ],
)
def test_what_cannot_be_says_why(change, named):
    rng = np.random.default_rng(13)
    use = {"time": np.arange(100) * DT, "values": rng.standard_normal(100), "known": Constituents(), "noise": Noise()}
    use |= change
    with pytest.raises(ValueError, match=named):
        adjust(use["time"], use["values"], use["known"], use["noise"], interval=DT, weights=change.get("weights"))


def test_a_record_without_a_cycle_says_so():
    adjusted = adjust(np.arange(100) * DT, np.random.default_rng(1).standard_normal(100), Constituents())
    with pytest.raises(ValueError, match="0.5 Hz; .* 0.99 s"):
        least_squares_spectrum(adjusted, highest=0.5)


def test_frequencies_next_to_a_forced_line_are_separable_from_it():
    time = np.arange(1000) * DT
    values = np.random.default_rng(8).standard_normal(1000)
    adjusted = adjust(time, values, Constituents("constant", forced=(7.0,)))
    found = least_squares_spectrum(adjusted, oversampling=8)
    at = int(np.argmin(np.abs(found.frequency - 7.0)))
    assert (found.reduction[[at - 1, at + 1]] > 0).all()


def test_correlation_times_reach_from_white_noise_to_a_random_walk():
    time, w = np.arange(2000) * DT, np.random.default_rng(10).standard_normal(2000)
    white, walk = (
        adjust(time, x, Constituents("none"), Noise("gauss-markov"), interval=DT) for x in (w, w.cumsum() - w.sum())
    )
    assert white.noise.correlation_time < 0.4 * DT
    assert walk.noise.correlation_time > time[-1]


@pytest.mark.parametrize(("own", "tenable"), [(1e-9, True), (1e-13, False)])
def test_a_covariance_that_is_nearly_singular_is_refused(own, tenable):
    covariance = np.ones((50, 50)) + own * np.eye(50)
    if tenable:
        assert dense(covariance).count == 50
        return
    with pytest.raises(ValueError, match="singular"):
        dense(covariance)


def test_a_transient_as_long_as_the_record_is_separable_from_a_trend():
    time = np.arange(1000) * DT
    values = 3 * np.exp(-time / 10) + 0.01 * np.random.default_rng(11).standard_normal(1000)
    found = adjust(time, values, Constituents("linear", exponentials=(10.0,)))
    assert found.coefficients[-1] == pytest.approx(3, abs=4 * found.sigma[-1])


def test_stamps_rounded_to_nanoseconds_at_five_kilohertz_lie_on_a_lattice():
    time = np.rint(np.arange(2000) * 1e9 / 4938.3) / 1e9
    assert adjust(time, np.random.default_rng(12).standard_normal(2000), Constituents()).lattice is not None


def test_autoregressive_noise_needs_more_than_about_even_stamps():
    rng = np.random.default_rng(12)
    time = np.arange(2000) * DT + rng.uniform(-0.1, 0.1, 2000) * DT
    with pytest.raises(ValueError, match="evenly spaced"):
        adjust(time, rng.standard_normal(2000), Constituents(), Noise("autoregressive", 2))


@pytest.mark.parametrize("law", ["uniform", "exponential", "missing"])
def test_the_density_of_white_noise_at_uneven_times_is_that_of_its_samples(law):
    rng = np.random.default_rng(5)
    steps = {
        "uniform": rng.uniform(0.002, 0.018, 6000), "exponential": rng.exponential(0.01, 6000),
        "missing": 0.01 * rng.geometric(0.8, 6000),
    }  # fmt: skip
    time, values = np.cumsum(steps[law]), rng.normal(0, 1, 6000)
    found = least_squares_spectrum(adjust(time, values, Constituents()), highest=20.0, oversampling=1)
    assert found.density.mean() == pytest.approx(2 * 0.01, rel=0.06)
