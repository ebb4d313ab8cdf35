"""Options of an outage replay."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal

from imuwb.options import NOT_NEGATIVE, Between, Form, Group, Level, check, text_of
from imuwb_plugins.outage.outage_list import OutageFile, given

PAPER = ("none", "15AV", "18AV", "18AVWD", "15AR", "27AR", "full")  #: filters of Quinchia, and one with all processes
MODELS = (*PAPER, "motion", "paper", "table6")
#: words for several filters
GROUPS = {"paper": ",".join(PAPER), "table6": "filters without biases after 0, 3 and 7 levels of denoising"}
REFERENCES = ("best", "truth", "fixed", "smoothed", "own", "ekf")
USUAL = ("15AV", "full", "motion")
DURATION = Between(2.0, 600.0)  #: s, of an outage
TURN_ON = Between(0.0, 1000.0), Between(0.0, 100.0)  #: deg/s and m/s²
COMPARED, OUTAGES, TRUTH = Group("What to compare"), Group("The outages"), Group("The reference")
GEOMETRY, FIXES, AIDS = Group("Geometry and clocks"), Group("The fixes"), Group("Aids")
ENGINES, WRITTEN = Group("Other engines"), Group("Output")
EVERY = Between(5.0)  #: s between the starts of jumps, each of which lasts 5 s


@dataclass(frozen=True)
class Parameters:
    """Options of ``imuwb outage``."""

    error_model: Annotated[
        Path | None,
        "Error model of the IMU (TOML), as imuwb noise writes it, or the name of a published sensor.",
        COMPARED,
    ] = None
    models: Annotated[
        tuple[str, ...],
        f"Filters to compare, among {','.join(MODELS)}; motion estimates the noise in motion, paper: Quinchia's filters, table6: filters "
        "without biases after 0, 3 and 7 levels of denoising.",
        Form("NAME,...", "15AV,full,motion", MODELS), COMPARED,
    ] = USUAL  # fmt: skip
    static: Annotated[
        Path | None,
        "Static record of the IMU, to which the AR processes of 15AR and 27AR are fitted; default: those that the error model keeps, or "
        "those that follow from it.", Form("LOG"), COMPARED,
    ] = None  # fmt: skip
    wavelet: Annotated[
        tuple[int, ...],
        "Levels of denoising to compare, such as 3..8 or 4,6; each level adds one 18AVWD filter; default: the paper's levels only.",
        Between(1, 12), Form("LEVELS", "3..8"), COMPARED,
    ] = ()  # fmt: skip
    durations: Annotated[
        tuple[float, ...], "Durations of the outages of a sweep (s).", DURATION, Form("S,...", "30,60"), OUTAGES
    ] = (30.0, 60.0)
    at: Annotated[
        Literal["own"] | tuple[tuple[float, float], ...] | OutageFile,
        "Start, from the log's start, and duration of each outage (s); or a file of named outages (CSV or TOML: name, start, duration, "
        "log, table); or own: the outages of the log itself; by default a sweep.",
        Between(), Form("START:DURATION,...|FILE|own", "200:30,430:60"), OUTAGES,
    ] = ()  # fmt: skip
    random: Annotated[
        int, "Number of outages that are drawn at random from a sweep, for each duration; 0: all.", Between(0), OUTAGES
    ] = 0
    seed: Annotated[int, "Seed of the random numbers.", OUTAGES] = 0
    reference: Annotated[
        str,
        "Reference of the drift: truth (of the log or --truth), RTK-fixed positions, a filter's smoothed run over all fixes, its own "
        "run, or the best of these (--truth, if it is given); or ekf, the estimate of the vehicle's own filter; or a reference's name in imuwb info.",
        Form("best|truth|fixed|smoothed|own|ekf|NAME", words=REFERENCES, streams="reference"),
        TRUTH,
    ] = "best"
    truth: Annotated[
        Path | None,
        "File with the true trajectory: CSV, RTKLIB .pos, a log (MCAP, ...), KF-GINS .nav, TUM, or poses of KITTI.", Form("FILE"), TRUTH,
    ] = None  # fmt: skip
    truth_delay: Annotated[
        Literal["gnss"] | float, "Time by which the stamps of --truth, or of the log's own truth, are late (s), or gnss: the same as those of the fixes.",
        Between(-1e10, 1e10), Form("SECONDS|gnss", "0.2"), TRUTH,
    ] = 0.0  # fmt: skip
    truth_lever: Annotated[
        tuple[float, float, float], "Lever arm from the IMU to the point of --truth, or of the log's own truth: forward, right, down (m).",
        Between(-500, 500), Form("F,R,D", "0.4,0,-1.2"), TRUTH,
    ] = (0.0, 0.0, 0.0)  # fmt: skip
    truth_times: Annotated[Path | None, "File with one time (s) for each pose of KITTI.", Form("FILE"), TRUTH] = None
    truth_origin: Annotated[
        tuple[float, float, float] | None,
        "Origin of a --truth in a local frame: latitude, longitude (deg), height (m); default: the frame is fitted to the fixes.",
        Between(), Form("LAT,LON,HEIGHT", "45.07,7.69,240"), TRUTH,
    ] = None  # fmt: skip
    truth_axes: Annotated[
        Literal["enu", "ned"],
        "Axes of that local frame: east-north-up or north-east-down; only with --truth-origin.",
        TRUTH,
    ] = "enu"
    filter: Annotated[
        Path | None, "Filter of --save-filter, run besides the others; its settings apply to all filters.", COMPARED
    ] = None
    save_filter: Annotated[Path | None, "Write the last filter as TOML to this file.", WRITTEN] = None
    solution: Annotated[
        dict[str, Path],
        "Solutions of other engines (KF-GINS .nav, RTKLIB .pos, TUM, CSV, MCAP, ...), scored in the same outages: one run without the "
        "fixes of all outages, or files with {outage} or {start} in the name. whole:FILE: over the whole run.",
        Form("NAME=FILE,...", "kf=kf.nav"), ENGINES,
    ] = field(default_factory=dict[str, Path])  # fmt: skip
    solution_delay: Annotated[
        float, "Time by which the stamps of --solution are late (s).", Between(-1e10, 1e10), ENGINES
    ] = 0.0  # fmt: skip
    filter_command: Annotated[
        str | None,
        "Engine to run with the fixes removed, outage by outage: a command that reads the CSV tables {imu} and {gnss}, and writes a "
        "trajectory to {output}.", Form("COMMAND", "./mine {imu} {gnss} {output}"), ENGINES,
    ] = None  # fmt: skip
    filter_runs: Annotated[
        int, "Largest number of outages of each duration for which the engine is run.", Between(1, 1000), ENGINES
    ] = 20
    filter_timeout: Annotated[
        float, "Time after which a run of the engine is stopped (s).", Between(0.1, 86400), ENGINES
    ] = 120.0
    filter_parallel: Annotated[int, "Runs of the engine at the same time; 0: up to 2.", Between(0, 64), ENGINES] = 0
    degrade: Annotated[
        dict[str, float],
        "Make fixes worse: noise=, sigma of added noise (m); jump=, length of jumps (m); every=, mean time between jumps (s; each lasts 5 s).",
        NOT_NEGATIVE, Form("noise=M,jump=M,every=S", "noise=2,jump=10,every=60"), FIXES,
    ] = field(default_factory=dict[str, float])  # fmt: skip
    reading: Annotated[
        Literal["corrected", "printed-variances", "printed-densities"],
        "Reading of Quinchia's formulas: corrected, or word for word with the quantities of eqs. 27 to 36 as variances of a sample or as densities.",
        COMPARED,
    ] = "corrected"
    receiver: Annotated[
        str | None,
        "Name of the GNSS receiver, as imuwb info shows it; default: the best one.",
        Form("NAME", streams="gnss"),
        FIXES,
    ] = None
    mounting: Annotated[
        Literal["auto"] | tuple[float, float, float],
        "Roll, pitch and heading that turn vectors from the vehicle's axes to the IMU's (deg), or auto: estimated from the log.",
        Between(), Form("ROLL,PITCH,HEADING", "180,0,90"), GEOMETRY,
    ] = "auto"  # fmt: skip
    lever_arm: Annotated[
        tuple[float, float, float], "Lever arm from the IMU to the antenna: forward, right, down (m).", Between(-500, 500),
        Form("F,R,D", "0.4,0,-1.2"), GEOMETRY,
    ] = (0.0, 0.0, 0.0)  # fmt: skip
    vehicle_arm: Annotated[
        tuple[float, float, float],
        "Lever arm from the IMU to the point of the vehicle that --straight and --speed hold for: forward, right, down (m); in a car, "
        "the middle of the rear axle.",
        Between(-500, 500), Form("F,R,D", "-1.5,0,0.3"), GEOMETRY,
    ] = (0.0, 0.0, 0.0)  # fmt: skip
    heading: Annotated[
        Literal["auto", "search", "course", "log"] | float,
        "Heading of the vehicle at the start (deg), or where it comes from: a spread of starts (search), the course over a straight "
        "baseline, the attitude or the orientation of the IMU in the log (log); auto: the velocity of a fast fix, or else the first of these that gives one.",
        Between(-360, 360), Form("DEG|auto|search|course|log", "75"), GEOMETRY,
    ] = "auto"  # fmt: skip
    heading_sigma: Annotated[
        float | None, "Sigma of a heading that is stated with --heading (deg); default: 3.", Between(0.01, 180), Form("DEG", "5"), GEOMETRY
    ] = None  # fmt: skip
    start_speed: Annotated[
        float | None, "Speed above which the velocity gives the heading at the start (m/s); default: 3.", Between(0.01, 100),
        Form("M/S", "1"), GEOMETRY,
    ] = None  # fmt: skip
    gnss_delay: Annotated[
        Literal["auto"] | float, "Time by which the stamp of a fix is late (s), or auto: estimated from the log.", Between(-10, 10),
        Form("SECONDS", "0.15"), GEOMETRY,
    ] = "auto"  # fmt: skip
    velocity_delay: Annotated[
        float, "Time by which a fix's velocity is older than its position (s); --gnss-delay auto estimates it too.", Between(-10, 10), GEOMETRY
    ] = 0.0  # fmt: skip
    clock_rate: Annotated[
        Literal["auto"] | float, "True seconds in a second of the IMU's clock, or auto: estimated from the log.",
        Between(0.9, 1.1, open_least=True, open_most=True), Form("RATE", "1.0002"), GEOMETRY,
    ] = "auto"  # fmt: skip
    gnss_sigma: Annotated[
        tuple[float, float], "Sigmas of positions (m) and velocities (m/s) in place of the receiver's own; 0: its own.",
        NOT_NEGATIVE, Form("M,M/S", "0.5,0.1"), FIXES,
    ] = (0.0, 0.0)  # fmt: skip
    gnss_scale: Annotated[
        tuple[float, float], "Factors of the receiver's own sigmas of positions and velocities.",
        Between(0, 1000, open_least=True), Form("POSITION,VELOCITY", "3,1"), FIXES,
    ] = (1.0, 1.0)  # fmt: skip
    gnss_floor: Annotated[
        tuple[float, float], "Sigmas added in squares to those of positions (m) and velocities (m/s).",
        NOT_NEGATIVE, Form("M,M/S", "0.3,0.05"), FIXES,
    ] = (0.0, 0.0)  # fmt: skip
    gnss_correlation: Annotated[
        Literal["auto"] | tuple[float, float],
        "Sigma (m, horizontal) and correlation time (s) of a Gauss-Markov error that is part of the fixes' positions, or auto: from "
        "the log; a height's sigma is twice as large; 0,0: none.", Between(0, 1e6), Form("M,S|auto", "1.5,60"), FIXES,
    ] = (0.0, 0.0)  # fmt: skip
    spacing: Annotated[
        float, "Time between two fixes that are used, at least (s); errors of nearer fixes are alike. 0: all are used.",
        Between(0, 60), FIXES,
    ] = 1.0  # fmt: skip
    skew: Annotated[
        float, "Time by which the accelerometer's stamps are later than the gyro's (s).", Between(-1, 1), GEOMETRY
    ] = 0.0
    scale_factor: Annotated[
        tuple[float, float], "Sigmas of the scale factors of gyros and accelerometers (%); 0: no state.", Between(0, 50),
        Form("GYRO,ACCEL", "1,1"), COMPARED,
    ] = (0.0, 0.0)  # fmt: skip
    tune: Annotated[
        bool, "Fit the noise to outages in the first half of the log, and judge it in the second.", COMPARED
    ] = False
    turn_on: Annotated[
        Literal["auto"] | tuple[float, float],
        "Sigmas of the turn-on biases of gyros (deg/s) and accelerometers (m/s²) for every filter, or auto: usual ones; with "
        "--models paper, for full only.",
        NOT_NEGATIVE, Form("GYRO,ACCEL", "0.2,0.1"), COMPARED,
    ] = "auto"  # fmt: skip
    settling: Annotated[float, "Time of fixes before the first outage of a sweep (s).", NOT_NEGATIVE, OUTAGES] = 60.0
    every: Annotated[int, "Samples between two propagations of the covariance.", Between(1, 100), COMPARED] = 10
    straight: Annotated[
        float,
        "Sigma of the velocity across and down (m/s), a non-holonomic constraint; 0: not used.",
        NOT_NEGATIVE,
        AIDS,
    ] = 0.0
    still: Annotated[
        float, "Sigma of the velocity in a standstill (m/s), a zero-velocity update; 0: not used.", NOT_NEGATIVE, AIDS
    ] = 0.0
    speed: Annotated[
        float, "Sigma of the log's own forward speed (m/s), an odometer; 0: not used.", NOT_NEGATIVE, AIDS
    ] = 0.0
    map: Annotated[bool, "Draw the tracks on a map too; the viewer loads it from the network.", WRITTEN] = False
    navigation: Annotated[
        Path | None, "Write the last filter's run over all fixes to this file: .csv, .tum, .kml or .mcap.", WRITTEN
    ] = None
    smoothed: Annotated[
        Path | None,
        "Write the last filter's smoothed run at the rate of the IMU, with sigmas and, beside it, the forward and the backward run and "
        "their separation, to this file: .csv, .mcap, .kml, or .tum (smoothed only).",
        WRITTEN,
    ] = None
    level: Annotated[Level, "Level of all intervals.", COMPARED] = 0.95

    def __post_init__(self) -> None:
        """Check the values."""
        check(self)
        unknown = [name for name in self.models if name not in MODELS]
        if unknown or not self.models or len(set(self.models)) < len(self.models):
            raise ValueError(
                f"models is {text_of(self.models)!r}; it must have one or more of {','.join(MODELS)}, each once"
            )
        word = next((name for name in GROUPS if name in self.models and len(self.models) > 1), None)
        if word is not None:
            raise ValueError(f"models is {text_of(self.models)!r}; {word} stands for {GROUPS[word]}; give it alone")
        self._check_truth()
        self._check_correlation()
        if not self.durations:
            raise ValueError("durations is empty; it must have one or more durations, such as 30,60")
        for outage in given(self.at):
            if outage.duration not in DURATION:
                raise ValueError(
                    f"at: an outage lasts {outage.duration:g} s, from {outage.start:g} s; it must last {DURATION}"
                )
        if unknown := [name for name in self.degrade if name not in ("noise", "jump", "every")]:
            raise ValueError(f"degrade has {unknown[0]}; it must be noise=M,jump=M,every=S")
        if self.degrade.get("every", EVERY.least) not in EVERY:
            raise ValueError(f"degrade: every is {self.degrade['every']:g} s; it must be {EVERY}")
        for value, between, unit in (
            () if self.turn_on == "auto" else zip(self.turn_on, TURN_ON, ("deg/s", "m/s²"), strict=True)
        ):
            if value not in between:
                raise ValueError(f"turn_on is {value:g} {unit}; it must be {between}")

    @property
    def wanted_reference(self) -> str:
        """The reference that the user wants: a file of --truth is no suggestion, so that no other reference takes its place unsaid."""
        return "truth" if self.truth is not None and self.reference == "best" else self.reference

    def _check_correlation(self) -> None:
        """Raise ValueError if only one of the sigma and the correlation time is 0."""
        if self.gnss_correlation != "auto" and (self.gnss_correlation[0] > 0) != (self.gnss_correlation[1] > 0):
            raise ValueError(
                f"gnss_correlation is {text_of(self.gnss_correlation)}; sigma and correlation time must both be above 0, or both 0"
            )

    def _check_truth(self) -> None:
        """Raise ValueError if an option of --truth is given without --truth."""
        if self.truth is None and (self.truth_times is not None or self.truth_origin is not None):
            raise ValueError(f"{'truth_times' if self.truth_times is not None else 'truth_origin'} needs --truth FILE")
