import numpy as np
import pytest

from imuwb.identification import allan, deviation
from imuwb.identification.allan_variance.relatives import _freedom
from imuwb.stochastic import FlickerNoise, Quantization, RandomWalk, WhiteNoise

FILES = {"modified": "mdev", "hadamard": "ohdev", "total": "totdev"}
#: NIST SP 1065, table 31, at tau = 1, 10 and 100
NBS14 = {
    "allan": [2.922319e-01, 9.159953e-02, 3.241343e-02],
    "hadamard": [2.943883e-01, 9.581083e-02, 3.237638e-02],
    "total": [2.922319e-01, 9.134743e-02, 3.406530e-02],
}


def stable32(shared, kind):
    folder = shared / "vectors/stable32/phasedat"
    lines = (folder / f"phase_dat_{FILES[kind]}_octave.txt").read_text().splitlines()
    table = np.array([[float(cell) for cell in line.split()] for line in lines if line.strip() and line[0] != "#"])
    values = np.diff(np.loadtxt(folder / "PHASE.DAT", comments="#"))
    return table, deviation(values, 1.0, kind, list(table[:, 1]), level=0.683)


@pytest.mark.parametrize("kind", ["hadamard", "total"])
def test_phase_dat_to_the_printed_digits(shared, kind):
    table, curve = stable32(shared, kind)
    assert curve.factor.tolist() == table[:, 0].tolist()
    assert curve.terms.tolist() == table[:, 2].tolist()
    np.testing.assert_allclose(curve.deviation, table[:, 5], rtol=5e-5)


@pytest.mark.parametrize("kind", FILES)
def test_phase_dat_intervals(shared, kind):
    table, curve = stable32(shared, kind)
    np.testing.assert_allclose(curve.lower / curve.deviation, table[:, 4] / table[:, 5], rtol=1e-2)
    np.testing.assert_allclose(curve.upper / curve.deviation, table[:, 6] / table[:, 5], rtol=1e-2)


@pytest.mark.parametrize("kind", NBS14)
def test_nbs14_to_the_printed_digits(shared, kind):
    values = np.loadtxt(shared / "vectors/nbs14/nbs14_1000_freq.txt")
    np.testing.assert_allclose(deviation(values, 1.0, kind, [1, 10, 100]).deviation, NBS14[kind], rtol=3e-7)


def test_the_plain_kind_is_the_allan_deviation():
    values = WhiteNoise(1.0).sample(1000, 0.1, np.random.default_rng(0))
    plain, curve = allan(values, 0.1), deviation(values, 0.1)
    np.testing.assert_array_equal(plain.deviation, curve.deviation)
    np.testing.assert_array_equal(plain.upper, curve.upper)


def test_hadamard_is_blind_to_a_ramp_and_allan_is_not():
    values = WhiteNoise(1.0).sample(3000, 0.1, np.random.default_rng(1))
    sloping = values + 3.0 * np.arange(3000) * 0.1
    np.testing.assert_allclose(
        deviation(sloping, 0.1, "hadamard").deviation, deviation(values, 0.1, "hadamard").deviation, rtol=1e-6
    )
    assert deviation(sloping, 0.1).deviation[-1] > 10 * deviation(values, 0.1).deviation[-1]


def test_only_the_modified_kind_separates_quantization_from_flicker_of_the_angle():
    factors = np.array([4.0, 16, 64])
    slopes = {}
    for kind in ("allan", "modified"):
        draws = [
            deviation(Quantization(1.0).sample(4096, 1.0, np.random.default_rng(seed)), 1.0, kind, factors).deviation
            for seed in range(10)
        ]
        slopes[kind] = np.polyfit(np.log(factors), np.log(np.mean(draws, axis=0)), 1)[0]
    assert slopes["allan"] == pytest.approx(-1.0, abs=0.05)
    assert slopes["modified"] == pytest.approx(-1.5, abs=0.1)


@pytest.mark.parametrize("process", [WhiteNoise(1.0), RandomWalk(1.0), FlickerNoise(1.0)], ids=repr)
def test_total_is_the_allan_deviation_without_bias_and_surer_at_the_end(process):
    factors = [4, 256, 500]
    draws = {
        kind: np.array([
            deviation(process.sample(1001, 1.0, np.random.default_rng(seed)), 1.0, kind, factors).deviation
            for seed in range(300)
        ]) ** 2
        for kind in ("allan", "total")
    }  # fmt: skip
    expected = process.allan_variance(np.array(factors, dtype=float), 1.0)
    error = draws["total"].std(axis=0) / expected / 300**0.5
    assert (np.abs(draws["total"].mean(axis=0) / expected - 1) < 4 * error + 0.1).all()
    assert draws["total"][:, 2].std() < 0.9 * draws["allan"][:, 2].std()


@pytest.mark.parametrize(
    ("process", "alpha"), [(WhiteNoise(1.0), 0), (Quantization(1.0), 2), (FlickerNoise(1.0), -1), (RandomWalk(1.0), -2)]
)
@pytest.mark.parametrize("kind", ["modified", "hadamard"])
def test_degrees_of_freedom_are_those_of_the_scatter(kind, process, alpha):
    n, factors = 1000, [1, 8, 60] if alpha < 2 else [1, 8, 16]
    draws = np.array([
        deviation(process.sample(n, 1.0, np.random.default_rng(seed)), 1.0, kind, factors).deviation ** 2
        for seed in range(300)
    ])  # fmt: skip
    seen = 2 * draws.mean(axis=0) ** 2 / draws.var(axis=0)
    said = [_freedom(kind, m, n, alpha) for m in factors]
    np.testing.assert_allclose(said, seen, rtol=5 * np.sqrt(2 / 300))


def test_degrees_of_freedom_do_not_jump_where_they_are_scaled():
    for kind in ("modified", "hadamard"):
        for alpha in (2, 0, -1, -2):
            found = [_freedom(kind, 1, n, alpha) for n in (240, 256, 257, 512)]
            assert found[2] / found[1] == pytest.approx(257 / 256, rel=0.01)
            assert found[3] / found[1] == pytest.approx(2, rel=0.03)


def test_a_kind_that_needs_thirds_ends_there():
    values = np.random.default_rng(0).standard_normal(100)
    for kind, longest in (("modified", 33), ("hadamard", 33), ("total", 50)):
        assert deviation(values, 1.0, kind, "all").factor[-1] == longest
    with pytest.raises(ValueError, match="have no hadamard deviation"):
        deviation(values, 1.0, "hadamard", [40.0])
