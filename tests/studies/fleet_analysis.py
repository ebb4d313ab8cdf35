"""Spectra of a fleet's logs, by an analysis of imuwb, but two logs are planted that no analysis survives: one hangs, one takes memory.

Example: imuwb fleet fleet_analysis.py 'logs/**/*.mcap' -o results/
"""

import time
from dataclasses import replace
from importlib import import_module

HANGS, GREEDY = 1001, 1003  #: rows of the planted logs
_own = import_module("imuwb_plugins.psd")
Parameters, draw = _own.Parameters, _own.draw


def findings(result):
    """Return the findings of the spectra as those that the judgement takes: no other estimator is asked."""
    return [replace(one, headline=True) for one in _own.findings(result)]


def run(logs, parameters):
    """Return the spectra."""
    rows = len(logs[0].imu().angular_rate)
    if rows == HANGS:
        time.sleep(10**6)
    if rows == GREEDY:
        return [bytearray(10**8) for _ in range(10**6)]
    return _own.run(logs, parameters)
