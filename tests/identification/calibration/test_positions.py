"""Truth is put on by ``imuwb.stochastic.shown``, the same terms as the simulator's."""

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from imuwb.identification.calibration import (
    Means,
    as_printed,
    face_name,
    faces,
    known_attitudes,
    six_position,
    static_gyros,
    without_attitudes,
)
from imuwb.identification.calibration.positions import noise_of
from imuwb.stochastic import AxisModel, ImuErrorModel, shown

G = 9.81
CUBE = np.concatenate([np.eye(3), -np.eye(3)])
ORDER = (3, 0, 5, 1, 4, 2)
SIGMA = 1e-4


@pytest.fixture(scope="module")
def model():
    rng = np.random.default_rng(5)

    def axis(gyro):
        leak = tuple(1e-4 * rng.standard_normal(3)) if gyro else (0.0, 0.0, 0.0)
        return AxisModel(
            bias=float(rng.normal(0, 0.3)), scale_factor=float(rng.normal(0, 0.02)), range=2 * G,
            cross_coupling=tuple(0.01 * rng.standard_normal(2)), g_sensitivity=leak,
        )  # fmt: skip

    return ImuErrorModel("made", {f"{s}_{k}": axis(s == "gyro") for s in ("gyro", "accel") for k in "xyz"})


def spread(count):
    rng = np.random.default_rng(8)
    ups = rng.standard_normal((count, 3))
    return ups / np.linalg.norm(ups, axis=1, keepdims=True)


def exact(values, sigma=SIGMA):
    return Means(np.asarray(values), np.full(np.shape(values), sigma**2), np.full(3, 18.0), (False, False, False))


def measured(model, ups, gravity=G):
    gyro, accel = shown(model, (np.zeros_like(ups), gravity * ups), None)
    return gyro, accel


def check(axes, model, sensor, rel=1e-9):
    for k, c in zip("xyz", axes, strict=True):
        true = model.axes[f"{sensor}_{k}"]
        assert c.bias.value == pytest.approx(true.bias, rel=rel)
        assert c.scale_factor.value == pytest.approx(true.scale_factor, rel=rel, abs=1e-12)
        assert [e.value for e in c.cross_coupling] == pytest.approx(list(true.cross_coupling), rel=rel)


def test_a_cube_in_any_order_gives_all_twelve_parameters(model):
    ups = CUBE[list(ORDER)]
    names = [f"log {i}" for i in range(6)]
    found, standing = six_position(exact(measured(model, ups)[1]), names, G, 0.95)
    check(found.axes, model, "accel")
    assert [face_name(f) for f in standing] == ["x down", "x up", "z down", "y up", "y down", "z up"]
    np.testing.assert_allclose(found.force, G * ups)
    np.testing.assert_allclose(found.residual, 0, atol=1e-12)
    assert all(c.scale_factor_nonlinear is None for c in found.axes)


def test_as_printed_is_hassaballas_equations_five_and_six(model):
    means = exact(measured(model, CUBE)[1])
    fit, standing = six_position(means, list("abcdef"), G, 0.95, misplacement=0.0)
    for k, x in enumerate(as_printed(means, standing, G, 0.95, fit)):
        up, down = means.value[k, k], means.value[3 + k, k]
        assert (x.up, x.down) == (up, down)
        assert x.bias.value == pytest.approx((up + down) / 2)
        assert x.scale_factor.value == pytest.approx((up - down - 2 * G) / (2 * G))
        assert x.bias.sigma == pytest.approx(SIGMA / 2**0.5)
        assert x.scale_factor.sigma == pytest.approx(SIGMA / 2**0.5 / G)


def test_the_printed_intervals_contain_a_tilt_of_the_faces(model):
    rng = np.random.default_rng(2)
    inside = []
    for _ in range(80):
        tilts = rng.normal(0, np.radians(2.4), (6, 3))
        ups = np.stack([Rotation.from_rotvec(t - u * (t @ u)).apply(u) for t, u in zip(tilts, CUBE, strict=True)])
        means = exact(measured(model, ups)[1] + SIGMA * rng.standard_normal((6, 3)))
        fit, standing = six_position(means, list("abcdef"), G, 0.95)
        for k, x in zip("xyz", as_printed(means, standing, G, 0.95, fit), strict=True):
            true = model.axes[f"accel_{k}"]
            inside.append(x.bias.lower < true.bias < x.bias.upper)
            inside.append(x.scale_factor.lower < true.scale_factor < x.scale_factor.upper)
            assert x.bias.sigma > 10 * SIGMA
    assert np.mean(inside) > 0.92


def test_a_wrong_gravity_goes_into_all_scale_factors_alike(model):
    values = measured(model, CUBE)[1]
    right, _ = six_position(exact(values), list("abcdef"), G, 0.95)
    wrong, _ = six_position(exact(values), list("abcdef"), G * 1.003, 0.95)
    for a, b in zip(right.axes, wrong.axes, strict=True):
        assert (1 + a.scale_factor.value) / (1 + b.scale_factor.value) == pytest.approx(1.003)
        assert a.bias.value == pytest.approx(b.bias.value)


def test_counts_with_an_offset_need_no_unit(model):
    values = np.array([300.0, -500.0, 32768.0]) + 1670 * measured(model, CUBE[list(ORDER)])[1]
    found, standing = six_position(exact(values, 0.1), [str(i) for i in range(6)], G, 0.95, raw=True)
    assert [face_name(f) for f in standing] == ["x down", "x up", "z down", "y up", "y down", "z up"]
    for k, c, offset in zip("xyz", found.axes, (300.0, -500.0, 32768.0), strict=True):
        true = model.axes[f"accel_{k}"]
        assert 1 + c.scale_factor.value == pytest.approx(1670 * (1 + true.scale_factor))
        assert c.bias.value == pytest.approx(offset + 1670 * true.bias)


def test_tilted_faces_widen_the_cross_couplings_and_leave_the_scale_factor(model):
    values = measured(model, CUBE)[1]
    rng = np.random.default_rng(1)
    tilted = values + 0.01 * rng.standard_normal((6, 3)) * (CUBE == 0)
    found, _ = six_position(exact(tilted), list("abcdef"), G, 0.95)
    assert found.misplacement == pytest.approx(0.01 / G, rel=0.6)
    c = found.axes[0]
    assert c.cross_coupling[0].sigma == pytest.approx(found.misplacement / 2**0.5, rel=0.05)
    assert c.scale_factor.sigma == pytest.approx(SIGMA / 2**0.5 / G, rel=0.02)
    said, _ = six_position(exact(tilted), list("abcdef"), G, 0.95, misplacement=0.002)
    assert said.axes[0].cross_coupling[0].sigma == pytest.approx(0.002 / 2**0.5, rel=0.05)
    assert said.misplacement == 0.002


@pytest.mark.parametrize(
    ("rows", "message"),
    [
        ([0, 1, 2, 3, 4], "5 positions, .* z down"),
        ([0, 1, 2, 3, 4, 4], "z down; .*y down: 4, 4"),
        ([0, 0], "x down, y up, y down, z up, z down"),
    ],
)
def test_faces_that_are_missing_are_named(rows, message):
    with pytest.raises(ValueError, match=message):
        faces(G * CUBE[rows], [str(r) for r in rows], raw=False)


def test_a_position_on_an_edge_is_named():
    ups = np.concatenate([CUBE, [[2**-0.5, 2**-0.5, 0]]])
    with pytest.raises(ValueError, match=r"edge: .*\+0.71, \+0.71, \+0.00"):
        faces(G * ups, [*"abcdef", "edge"], raw=False)


def bent(model, part):
    from dataclasses import replace

    axes = {k: replace(a, scale_factor_nonlinear=part) if k.startswith("accel") else a for k, a in model.axes.items()}
    return ImuErrorModel("bent", axes)


def test_known_attitudes_part_the_non_linear_scale_factor(model):
    ups = spread(20)
    found = known_attitudes(exact(measured(bent(model, 0.01), ups)[1]), G * ups, 0.95, full_range=2 * G)
    check(found.axes, model, "accel", rel=1e-6)
    assert [c.scale_factor_nonlinear.value for c in found.axes] == pytest.approx([0.01] * 3)
    without = known_attitudes(exact(measured(model, ups)[1]), G * ups, 0.95)
    check(without.axes, model, "accel", rel=1e-9)


def test_a_cube_does_not_part_it():
    values = measured(ImuErrorModel("ideal", {}), CUBE)[1]
    found = known_attitudes(exact(values), G * CUBE, 0.95, full_range=2 * G)
    assert found.axes[0].scale_factor_nonlinear is None


def test_attitudes_in_one_plane_leave_parameters_open():
    angle = np.linspace(0, 6, 12)
    ups = np.stack([np.cos(angle), np.sin(angle), np.zeros(12)], axis=1)
    with pytest.raises(ValueError, match="do not determine"):
        known_attitudes(exact(G * ups), G * ups, 0.95)
    with pytest.raises(ValueError, match="nine parameters"):
        without_attitudes(exact(G * ups), G, 0.95)


def triangular(model):
    whole = np.stack(
        [np.insert(np.array(a.cross_coupling), i, 1 + a.scale_factor) for i, a in enumerate(
            model.axes[f"accel_{k}"] for k in "xyz"
        )]
    )  # fmt: skip
    return np.linalg.cholesky(whole @ whole.T)  # the lower triangular matrix that differs from it by a rotation


@pytest.mark.parametrize("raw", [False, True])
def test_without_attitudes_the_triangular_matrix_comes_back(model, raw):
    values = measured(model, spread(14))[1]
    gain, offset = (1670.0, 4000.0) if raw else (1.0, 0.0)
    found = without_attitudes(exact(gain * values + offset, gain * SIGMA), G, 0.95, raw=raw)
    lower = gain * triangular(model)
    for i, c in enumerate(found.axes):
        true = model.axes[f"accel_{'xyz'[i]}"]
        assert c.bias.value == pytest.approx(gain * true.bias + offset, rel=1e-7)
        assert 1 + c.scale_factor.value == pytest.approx(lower[i, i], rel=1e-9)
        others = [j for j in range(3) if j != i]
        for j, e in zip(others, c.cross_coupling, strict=True):
            assert (e is None) == (j > i)
            if e is not None:
                assert e.value == pytest.approx(lower[i, j], rel=1e-6)
    np.testing.assert_allclose(np.linalg.norm(found.force, axis=1), G)
    np.testing.assert_allclose(found.residual, 0, atol=gain * 1e-8)


@pytest.mark.slow
def test_without_attitudes_the_intervals_hold(model):
    rng = np.random.default_rng(6)
    values, lower = measured(model, spread(12))[1], triangular(model)
    inside = np.zeros(9)
    for _ in range(150):
        sigma = SIGMA * (rng.chisquare(36) / 36) ** 0.5
        found = without_attitudes(exact(values + SIGMA * rng.standard_normal(values.shape), sigma), G, 0.95)
        pairs = [(c.bias, model.axes[f"accel_{k}"].bias) for k, c in zip("xyz", found.axes, strict=True)]
        pairs += [(c.scale_factor, lower[i, i] - 1) for i, c in enumerate(found.axes)]
        pairs += [(found.axes[i].cross_coupling[j], lower[i, j]) for i, j in ((1, 0), (2, 0), (2, 1))]
        inside += [e.lower <= true <= e.upper for e, true in pairs]
    assert 0.93 <= inside.sum() / 1350 <= 0.985
    assert (inside / 150 > 0.88).all()


def test_eight_positions_are_too_few():
    with pytest.raises(ValueError, match="8 positions; .* 9"):
        without_attitudes(exact(G * spread(8)), G, 0.95)


def test_gyros_have_bias_and_g_sensitivity(model):
    values = measured(model, CUBE)[0]
    gyros, residual = static_gyros(exact(values, 1e-7), G * CUBE, G, 0.95, 0.0)
    for k, c in zip("xyz", gyros, strict=True):
        true = model.axes[f"gyro_{k}"]
        assert c.bias.value == pytest.approx(true.bias)
        assert [e.value for e in c.g_sensitivity] == pytest.approx(list(true.g_sensitivity), rel=1e-6)
        assert c.scale_factor is None
    np.testing.assert_allclose(residual, 0, atol=1e-12)


def test_the_earths_vertical_rate_is_no_g_sensitivity(model):
    earth = 7.292115e-5 * np.sin(np.radians(50))
    values = measured(model, CUBE)[0] + earth * CUBE
    known, _ = static_gyros(exact(values, 1e-8), G * CUBE, G, 0.95, np.radians(50))
    unknown, _ = static_gyros(exact(values, 1e-8), G * CUBE, G, 0.95, None)
    true = model.axes["gyro_y"].g_sensitivity[1]
    assert known[1].g_sensitivity[1].value == pytest.approx(true, rel=1e-6)
    assert unknown[1].g_sensitivity[1].value == pytest.approx(true + earth / G, rel=1e-6)
    assert unknown[1].g_sensitivity[1].lower < true < unknown[1].g_sensitivity[1].upper


def test_three_attitudes_leave_gyros_open():
    with pytest.raises(ValueError, match="four"):
        static_gyros(exact(np.zeros((3, 3))), G * np.eye(3), G, 0.95, None)


IDEAL = ImuErrorModel("ideal", {})


def test_a_tilt_shortens_the_vertical_part_by_its_square_and_makes_it_uncertain():
    tilt = 0.02
    found, _ = six_position(exact(measured(IDEAL, CUBE)[1], 1e-9), list("abcdef"), G, 0.95, misplacement=tilt)
    scale = found.axes[0].scale_factor
    assert scale.value == pytest.approx(1 / (1 - tilt**2) - 1)
    assert scale.sigma == pytest.approx(3**0.5 * tilt**2, rel=1e-3)  # six times the fourth power, from two faces


def test_a_known_variance_adds_degrees_of_freedom():
    means = exact(np.zeros((2, 3)))
    np.testing.assert_allclose(noise_of(means).freedom, 18.0)
    np.testing.assert_allclose(noise_of(means, SIGMA**2).freedom, 18.0 * 4)  # half of the variance is known
    np.testing.assert_allclose(noise_of(means, SIGMA**2).variance, 2 * SIGMA**2)


@pytest.mark.parametrize(("degrees", "allowed"), [(15.0, True), (25.0, False)])
def test_a_face_may_lean_by_twenty_degrees(degrees, allowed):
    leaning = CUBE.copy()
    leaning[0] = np.cos(np.radians(degrees)), np.sin(np.radians(degrees)), 0.0
    if allowed:
        assert faces(G * leaning, list("abcdef"), raw=False)[0] == (0, 1)
        return
    with pytest.raises(ValueError, match="a: "):
        faces(G * leaning, list("abcdef"), raw=False)


def test_a_slightly_tilted_cube_does_not_separate_the_non_linear_part():
    ups = np.concatenate([CUBE, CUBE]) + 0.01 * np.random.default_rng(3).standard_normal((12, 3))
    found = known_attitudes(exact(G * ups), G * ups, 0.95, full_range=2 * G)
    assert found.axes[0].scale_factor_nonlinear is None


@pytest.mark.parametrize(("squeezed", "allowed"), [(0.06, True), (0.02, False)])
def test_positions_close_to_one_direction_are_refused(squeezed, allowed):
    ups = spread(14) * [squeezed, squeezed, 1.0]
    ups /= np.linalg.norm(ups, axis=1, keepdims=True)
    if allowed:
        assert without_attitudes(exact(G * ups), G, 0.95).axes[2].bias is not None
        return
    with pytest.raises(ValueError, match="nine parameters"):
        without_attitudes(exact(G * ups), G, 0.95)


def test_the_earths_rate_is_in_the_intervals_of_still_gyros():
    """Headings are random, so the horizontal part has half of its square in each axis; at an unknown latitude, that of 45°."""
    corners = np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)]) / 3**0.5
    still = exact(np.zeros((8, 3)), 1e-12)
    at_equator, _ = static_gyros(still, G * corners, G, 0.95, 0.0)
    assert at_equator[0].bias.sigma == pytest.approx(7.292115e-5 / 24**0.5, rel=1e-3)
    unknown, _ = static_gyros(still, G * corners, G, 0.95, None)
    assert unknown[0].bias.sigma == pytest.approx(7.292115e-5 / 48**0.5, rel=1e-3)
    own, other = unknown[0].g_sensitivity[:2]
    assert own.sigma**2 - other.sigma**2 == pytest.approx((7.292115e-5 / G) ** 2 / 2, rel=1e-3)
