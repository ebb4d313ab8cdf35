"""The preparation of a log for filters."""

from dataclasses import dataclass, replace

import numpy as np

from imuwb.arrays import Floats
from imuwb.conditioning import corrected_log
from imuwb.errors import MissingDataError, UsageError
from imuwb.log import GnssStream, Log
from imuwb.navigation.alignment import Alignment, align
from imuwb.navigation.corrections import Corrections, corrections_of, floor_variance, raised, uncorrelated
from imuwb.navigation.covariance import NAVIGATION
from imuwb.navigation.filter import Solution, solve
from imuwb.navigation.filter_model import FilterModel
from imuwb.navigation.measurement import Measurement, denoised, measurement_of, with_rate
from imuwb.navigation.standstill import standstills
from imuwb.navigation.vibration import with_classes
from imuwb.notes import Note
from imuwb.replay.fixes.degraded import Degradation, degraded
from imuwb.replay.fixes.fix_kinds import consistent
from imuwb.replay.fixes.velocity_spikes import without_spikes


@dataclass(frozen=True, eq=False, slots=True)
class Prepared:
    """A log in the form that filters need."""

    log: Log
    gnss: GnssStream
    measurement: Measurement
    stills: Floats  #: (k, 2) s from the log's start, the standstills
    corrections: Corrections
    alignment: Alignment
    notes: tuple[str, ...]

    @property
    def start_time(self) -> float:
        """Return when filters start, s from the log's start."""
        return float(self.corrections.time[self.alignment.event])

    @property
    def fix_time(self) -> Floats:
        """Return the times of the fixes, s from the log's start."""
        return self.corrections.time[self.corrections.fix >= 0]

    def __repr__(self) -> str:
        """Return the parts, a line each."""
        return f"{self.measurement}\n{self.corrections}\n{self.alignment}"


def prepare(
    log: Log, model: FilterModel, receiver: str | None = None, degradation: Degradation | None = None
) -> Prepared:
    """Return a log in the form that filters need, without the model's deterministic errors; all filters start alike.

    Args:
        log: an IMU and a receiver; a log that is corrected already is not corrected again.
        model: its settings and the deterministic terms of its error model are used; its noise has no effect.
        receiver: name of the receiver; None: the best one.
        degradation: how its fixes are made worse; the reference stays as it is.

    Raises:
        MissingDataError: no IMU, no receiver, too few fixes, no motion.
        UsageError: no receiver of that name; deterministic terms that are too large.
    """
    if not log.gnss:
        raise MissingDataError(
            f"{log.provenance.path}: the log has no GNSS receiver, and an outage replay needs fixes; name a file of fixes "
            "with --gnss"
        )
    gnss = receiver_of(log, receiver)
    several = ()
    if len(log.gnss) > 1 and receiver is None:
        text = f"the log has {len(log.gnss)} receivers: {gnss.name} is used; choose another with --receiver"
        several = (Note("several-receivers", text),)
    gnss, spikes = without_spikes(gnss)
    gnss, contradicting = consistent(gnss)
    if degradation is not None:
        gnss = degraded(gnss, degradation)
    log, corrected = corrected_log(log, model.error_model)
    thermal = any(axis.thermal for axis in model.error_model.axes.values())
    measurement = measurement_of(log, log.imu(), model.installation, thermal=thermal)
    stills = standstills(measurement, log, gnss)
    corrections = corrections_of(log, gnss, measurement, stills, model)
    alignment = align(measurement, corrections, stills, model)
    notes = (*several, *spikes, *contradicting, *corrected, *measurement.notes, *corrections.notes, alignment.note)
    return Prepared(log, gnss, measurement, stills, corrections, alignment, notes)


def with_clocks(prepared: Prepared, model: FilterModel, other: FilterModel) -> Prepared:
    """Return a log prepared for one filter as it is for another one with other delays and another clock rate.

    Raises:
        MissingDataError: too few fixes, or no start.
    """
    ratio = other.installation.clock_rate / model.installation.clock_rate
    measurement = with_rate(prepared.measurement, ratio)
    begin = prepared.measurement.time[0]
    stills = begin + (prepared.stills - begin) * ratio
    corrections = corrections_of(prepared.log, prepared.gnss, measurement, stills, other)
    alignment = align(measurement, corrections, stills, other)
    kept = tuple(note for note in prepared.notes if note not in (*prepared.corrections.notes, prepared.alignment.note))
    notes = (*kept, *corrections.notes, alignment.note)
    return replace(
        prepared, measurement=measurement, stills=stills, corrections=corrections, alignment=alignment, notes=notes
    )


def receiver_of(log: Log, name: str | None) -> GnssStream:
    """Return a receiver by its name, or the best one: with velocities, then with sigmas, then with the most fixes.

    Raises:
        UsageError: no receiver of that name.
    """
    named = [g for g in log.gnss if name in (None, g.name)]
    if not named:
        raise UsageError(f"the log has no receiver {name!r}; choose among {', '.join(g.name for g in log.gnss)}")
    return max(named, key=lambda g: (g.velocity is not None, g.position_sigma is not None, len(g)))


def run(model: FilterModel, prepared: Prepared, *, smooth: bool = False) -> Solution:
    """Return a filter's run over a whole log; with ``smooth``, it has what a smoother needs."""
    measurement, corrections, alignment = prepared.measurement, prepared.corrections, prepared.alignment
    if any(model.wavelet_levels):
        measurement = denoised(measurement, model.wavelet_levels, model.wavelet_scale)
    if any(model.vibration.white):
        measurement = with_classes(measurement, model.vibration)
    if correlated := model.settings.gnss_correlation[0]:
        corrections, more = uncorrelated(corrections, correlated)
        added = np.zeros(NAVIGATION)
        added[:3] = more[alignment.event]
        alignment = replace(alignment, covariance=alignment.covariance + np.diag(added))
    if any(floor := model.settings.sigma_floor):
        corrections = raised(corrections, floor)
        added = np.zeros(NAVIGATION)
        added[:6] = floor_variance(floor)
        alignment = replace(alignment, covariance=alignment.covariance + np.diag(added))
    return solve(model, measurement, corrections, alignment, smooth=smooth)
