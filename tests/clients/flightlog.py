"""What a log says of a flight, against the simulator's truth; read with pyulog."""

import numpy as np
from pyulog import ULog

# PX4's `nav_state`.
HOLD, TAKEOFF, LAND = 4, 17, 18


class FlightLog:
    def __init__(self, path):
        self.ulog = ULog(str(path))
        self.topics = {dataset.name: dataset.data for dataset in self.ulog.data_list}

    def is_whole(self):
        return not self.ulog.file_corruption

    def time(self, topic):
        return self.topics[topic]["timestamp"] * 1e-6

    def at(self, topic, fields, times):
        """Fields interpolated to these times."""
        data = self.topics[topic]
        return np.column_stack([np.interp(times, self.time(topic), data[field]) for field in fields])

    def quaternions(self, topic):
        return np.column_stack([self.topics[topic][f"q[{i}]"] for i in range(4)])

    def attitude_rms_deg(self):
        """Angle between estimate and truth while armed."""
        estimate, truth = self.quaternions("vehicle_attitude"), self.quaternions("vehicle_attitude_groundtruth")
        t, t_true = self.time("vehicle_attitude"), self.time("vehicle_attitude_groundtruth")
        nearest = np.clip(np.searchsorted(t_true, t), 0, len(t_true) - 1)
        assert np.max(np.abs(t - t_true[nearest])) < 0.011
        cosine = np.abs(np.sum(estimate * truth[nearest], axis=1)).clip(0.0, 1.0)
        angle = np.degrees(2.0 * np.arccos(cosine))
        status, ts = self.topics["vehicle_status"], self.time("vehicle_status")
        armed = status["arming_state"][np.clip(np.searchsorted(ts, t, side="right") - 1, 0, None)] == 2
        return float(np.sqrt(np.mean(angle[armed] ** 2)))

    def hold_rms(self, begin, end):
        """Horizontal and vertical distance of the truth from the set-point, m."""
        topic = "vehicle_local_position_groundtruth"
        t = self.time(topic)
        t = t[(t >= begin) & (t <= end)]
        error = self.at(topic, "xyz", t) - self.at("vehicle_local_position_setpoint", "xyz", t)
        horizontal = np.hypot(error[:, 0], error[:, 1])
        return float(np.sqrt(np.mean(horizontal**2))), float(np.sqrt(np.mean(error[:, 2] ** 2)))

    def touch_down_speed(self):
        """Largest sink rate of the truth in the last half metre before the feet touch, m/s."""
        truth = self.topics["vehicle_local_position_groundtruth"]
        height, sink = -truth["z"], truth["vz"]
        flying = np.nonzero(height > 1.0)[0][-1]
        low = (np.arange(len(height)) > flying) & (height > 0.155) & (height < 0.5)
        return float(np.max(sink[low]))

    def modes(self):
        """PX4's numbers, in the order flown."""
        nav = self.topics["vehicle_status"]["nav_state"]
        return [int(n) for i, n in enumerate(nav) if i == 0 or n != nav[i - 1]]

    def is_disarmed_at_end(self):
        return self.topics["vehicle_status"]["arming_state"][-1] == 1
