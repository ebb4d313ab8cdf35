"""Noise and bias by temperature: N, B, K, AR(1) at each set-point, tests of dependence, and an error model by temperature.

Give one log for each set-point, or logs with plateaus or ramps. The result has the coefficients at each temperature with
intervals, a test of each whether it depends on temperature, and a function of temperature chosen by cross-validation.

Example: imuwb temperature cold.mcap room.mcap hot.mcap --function quadratic -o chamber.rrd
"""

import lazy_loader

LOGS = (1, None)
IMUS_OF_LOGS = True
LEAVES_MODEL = True

__getattr__, __dir__, __all__ = lazy_loader.attach(
    __name__,
    submod_attrs={
        "parameters": ["Parameters"],
        "log_checks": ["imu_of"],
        "compute": ["error_model", "objections", "run"],
        "show": ["draw", "draw_study"],
        "setting_study": ["study"],
        "answer": ["answer"],
        "imus": ["answer_imus", "compare_imus", "draw_imus"],
    },
)
