"""The option --gnss-correlation: a receiver's correlated error, stated or from the log."""

import pytest

from imuwb.simulation import GnssErrors, Receiver, drive, mixed_route
from imuwb_plugins import outage

from .made import sensor, stated

AT = "150:10,180:10"


def ids(result):
    return {getattr(note, "id", None) for note in result.notes}


@pytest.mark.parametrize(("sigma", "note"), [(1.5, "gnss-correlated"), (0.0, "gnss-uncorrelated")])
def test_the_error_comes_from_the_log(toml, sigma, note):
    errors = GnssErrors(position_sigma=(sigma, sigma, 2 * sigma), position_time=30.0)
    receiver = Receiver(position_sigma=(0.5, 0.5, 1.0), errors=errors)
    log = drive(sensor(), mixed_route(240, 3), 1, rate=50.0, receiver=receiver)
    result = outage.run([log], stated(error_model=toml, models="full", at=AT, gnss_correlation="auto"))
    assert note in ids(result)
    model = result.replay.runs["full"].solution.model
    found = result.gnss_correlation
    if sigma:
        assert found.sigma.value == pytest.approx(sigma, rel=0.1)
        assert model.settings.gnss_correlation == (found.sigma.value, found.time.value)
    else:
        assert found is None
        assert model.settings.gnss_correlation == (0.0, 0.0)


def test_a_stated_error_gets_states_in_all_filters(log, toml):
    result = outage.run([log], stated(error_model=toml, models="none,full", at=AT, gnss_correlation=(0.5, 60.0)))
    assert result.gnss_correlation is None
    for run in result.replay.runs.values():
        assert run.solution.tables.receiver.all()
