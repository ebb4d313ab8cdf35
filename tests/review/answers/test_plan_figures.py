from imuwb.identification.likelihood.record_plan import Need, RecordPlan
from imuwb.review.answers.plan_answer import by_length


def test_the_sensor_that_needs_the_longest_record_is_shown_first():
    def need(axis, hours, *, at_limit=False):
        return Need(axis, "K", 0.3, hours, at_limit, known=True, at_length=None)

    needs = (need("gyro_x", 2.0), need("gyro_z", 20.0, at_limit=True), need("accel_x", None), need("accel_z", 3.0))
    plan = RecordPlan("m", 100.0, 0.95, needs, 3.0, stated=False, slowest=None)
    assert by_length(plan, ("gyro", "accel")) == ["accel", "gyro"]
