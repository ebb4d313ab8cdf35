"""Messages that rosbag2 packs one by one are unpacked; one that is damaged costs itself."""

import zstandard

from imuwb.readers import read
from tests.readers.repairs import repairs

from .db3_writer import write_db3

T = 1_714_564_800 * 10**9
IMU = "sensor_msgs/msg/Imu"


def test_packed_messages_are_read_like_plain_ones(fresh, ros, mcap):
    plain = [(T + i * 10**7, ros.imu(T + i * 10**7, (i / 100, 0, 0), (0, 0, 9.8))) for i in range(1, 60)]
    packed = [(time, zstandard.compress(payload)) for time, payload in plain]
    wanted = read(write_db3(fresh("log.db3"), {"/imu": (IMU, plain)})).imu()
    for path in (write_db3(fresh("log.db3"), {"/imu": (IMU, packed)}), mcap.write(mcap.Topic(packed))):
        (imu,) = read(path).imus
        assert imu.angular_rate.time.tolist() == wanted.angular_rate.time.tolist()
        assert imu.angular_rate.value.tolist() == wanted.angular_rate.value.tolist()
        assert imu.origin == wanted.origin


def test_a_damaged_message_is_left_out_and_counted(fresh, ros):
    rows = [(T + i, zstandard.compress(ros.imu(T + i, (0.1, 0, 0), (0, 0, 9.8)))) for i in range(40)]
    rows[5] = rows[5][0], rows[5][1][:-9]
    rows[6] = rows[6][0], b"\x28\xb5\x2f\xfd"
    (imu,) = read(write_db3(fresh("log.db3"), {"/imu": (IMU, rows)})).imus
    assert len(imu.angular_rate) == 38
    assert repairs(imu) == {"no_fit": 2}
