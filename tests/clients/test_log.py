"""A flight's log through pyulog, as Flight Review reads it: the plots that it draws of a vehicle without GPS."""

import subprocess

import numpy as np
from conftest import sitl_binary
from flightlog import HOLD, LAND, TAKEOFF, FlightLog
from pyulog.px4 import PX4ULog

RATE, ACCELERATION = "vehicle_angular_velocity", "vehicle_angular_acceleration"
POSITION, SETPOINT = "vehicle_local_position", "vehicle_local_position_setpoint"
# Its plots, each with the topics and fields that its graphs read.
PLOTS = {
    "Position": {POSITION: "x y", SETPOINT: "x y", f"{POSITION}_groundtruth": "x y"},
    "Altitude Estimate": {"vehicle_air_data": "baro_alt_meter"},
    "Roll, Pitch, Yaw Angle": {"vehicle_attitude": "roll pitch yaw", "vehicle_attitude_groundtruth": "roll pitch yaw"},
    "Roll, Pitch, Yaw Angular Rate": {
        RATE: "xyz[0] xyz[1] xyz[2]",
        "vehicle_rates_setpoint": "roll pitch yaw",
        f"{RATE}_groundtruth": "xyz[0] xyz[1] xyz[2]",
    },
    "Local Position X, Y, Z": {POSITION: "x y z", SETPOINT: "x y z"},
    "Velocity": {POSITION: "vx vy vz", SETPOINT: "vx vy vz"},
    "Actuator Controls, FFT": {"vehicle_torque_setpoint": "xyz[0] xyz[1] xyz[2]", "vehicle_thrust_setpoint": "xyz[2]"},
    "Angular Velocity FFT, Spectrogram": {RATE: "xyz[0] xyz[1] xyz[2]"},
    "Angular Acceleration FFT, Spectrogram": {ACCELERATION: "xyz[0] xyz[1] xyz[2]"},
    "Motor Outputs": {"actuator_motors": "control[0] control[3]"},
    "Actuator Outputs": {"actuator_outputs": "noutputs output[0] output[3]"},
    "Raw Acceleration, Spectrogram": {"sensor_combined": "accelerometer_m_s2[0] accelerometer_m_s2[2]"},
    "Vibration Metrics": {"vehicle_imu_status": "accel_vibration_metric"},
    "Raw Angular Speed": {"sensor_combined": "gyro_rad[0] gyro_rad[2]"},
    "Distance Sensor": {"distance_sensor": "current_distance variance", POSITION: "dist_bottom dist_bottom_valid"},
    "Power": {"battery_status": "voltage_v current_a discharged_mah remaining"},
    "Temperature": {"sensor_baro": "temperature"},
    "Estimator Flags": {"estimator_status": "health_flags timeout_flags innovation_check_flags"},
    "Failsafe Flags": {
        "vehicle_status": "failsafe failsafe_and_user_took_over",
        "failsafe_flags": "gcs_connection_lost battery_warning geofence_breached",
    },
    "Info table": {POSITION: "xy_valid z_valid v_xy_valid v_z_valid", "vehicle_land_detected": "landed"},
}


def test_flight_review_finds_its_topics_fields_and_numbers(tmp_path):
    subprocess.run([sitl_binary(), "--headless", "--log-dir", tmp_path], check=True, capture_output=True)
    log = FlightLog(tmp_path / "flight-0001.ulg")
    assert log.is_whole()
    px4 = PX4ULog(log.ulog)
    px4.add_roll_pitch_yaw()
    for plot, topics in PLOTS.items():
        for topic, fields in topics.items():
            for field in fields.split():
                values = log.topics[topic][field]
                assert len(values) > 100 and np.all(np.isfinite(values)), f"{plot}: {topic}.{field}"
    assert log.modes() == [HOLD, TAKEOFF, HOLD, LAND, HOLD]
    assert px4.get_mav_type() == "Quadrotor"
    parameters = log.ulog.initial_parameters
    assert isinstance(parameters["SYS_AUTOSTART"], int) and isinstance(parameters["VEH_MASS"], float)
    assert parameters["COM_LOW_BAT_ACT"] == 3
    assert log.ulog.msg_info_dict["sys_name"] == "Tautline" and log.ulog.get_version_info_str()

    # The acceleration is the rate's derivative, a sample later for its low-pass.
    t = log.time(ACCELERATION)
    derivative = np.gradient(log.at(RATE, ["xyz[0]"], t)[:, 0], t)
    assert np.corrcoef(log.at(ACCELERATION, ["xyz[0]"], t)[1:, 0], derivative[:-1])[0, 1] > 0.5
