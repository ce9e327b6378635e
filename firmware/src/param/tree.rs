//! All parameters. One line each: field, name, kind, unit, default, range.
//! It is a table: that its lines look alike is meant.

use super::params;

params! {
    Vehicle "Vehicle" {
        /// Take-off mass, battery included, tether not.
        mass: "VEH_MASS" Real ["kg"] = 1.5 in 0.1 ..= 50.0;
        /// Moment of inertia about the nose axis.
        inertia_x: "VEH_IXX" Real ["kg m^2"] = 0.016 in 0.0001 ..= 10.0;
        /// Moment of inertia about the right-hand axis.
        inertia_y: "VEH_IYY" Real ["kg m^2"] = 0.016 in 0.0001 ..= 10.0;
        /// Moment of inertia about the down axis.
        inertia_z: "VEH_IZZ" Real ["kg m^2"] = 0.029 in 0.0001 ..= 10.0;
        /// Rotors: 0 quad X, 1 quad +, 2 hexa X, 3 hexa +, 4 octo X, 5 octo +, 6 coaxial octo X, numbered as PX4 and ArduPilot do.
        frame: "VEH_FRAME" Int [""] = 0.0 in 0.0 ..= 6.0;
        /// Distance of each rotor from the centre of mass: along the nose axis and the right-hand axis (quad X and coaxial octo), else straight.
        arm: "VEH_ARM" Real ["m"] = 0.177 in 0.03 ..= 2.0;
        /// Rotor drag torque per thrust.
        torque_ratio: "VEH_CQ" Real ["m"] = 0.0167 in 0.001 ..= 0.2;
        /// Tether attachment below the centre of mass.
        attachment: "VEH_ATT_Z" Real ["m"] = 0.05 in -0.5 ..= 0.5;
        /// Drag force over mass and speed.
        drag: "VEH_DRAG" Real ["1/s"] = 0.12 in 0.0 ..= 5.0;
        /// Height of the centre of mass above the ground when landed.
        ground_height: "VEH_H_GND" Real ["m"] = 0.15 in 0.0 ..= 2.0;
    }
    Motors "Motors" {
        /// Thrust of one rotor at full throttle and nominal voltage.
        rotor_thrust_max: "MOT_THR_MAX" Real ["N"] = 8.1 in 0.1 ..= 500.0;
        /// Lowest thrust of one rotor in flight; keeps the motors turning.
        rotor_thrust_min: "MOT_THR_MIN" Real ["N"] = 0.05 in 0.0 ..= 10.0;
        /// Duration of the thrust calibration in slack hover; 0 = off.
        thrust_calibration_time: "THR_CAL_T" Real ["s"] = 2.0 in 0.0 ..= 20.0;
        /// Share of the square law in throttle to thrust: thrust = f u^2 + (1-f) u.
        thrust_factor: "THR_MDL_FAC" Real [""] = 0.55 in 0.0 ..= 1.0;
        /// True thrust per commanded thrust, as identified in slack hover or by a thrust stand.
        thrust_scale: "THR_SCALE" Real [""] = 1.0 in 0.5 ..= 1.5;
        /// Battery voltage at which MOT_THR_MAX holds; 0 turns the compensation off.
        nominal_voltage: "MOT_V_NOM" Real ["V"] = 15.2 in 0.0 ..= 60.0;
        /// Time constant of a rotor's thrust.
        motor_tau: "MOT_TAU" Real ["s"] = 0.03 in 0.001 ..= 0.5;
        /// Motor output: 0 = 400 Hz PWM, 1 = OneShot125.
        output_protocol: "MOT_PROTO" Int [""] = 0.0 in 0.0 ..= 1.0;
    }
    Sensors "Sensors" {
        /// Orientation of the inertial sensor, as MAVLink and PX4 number them; right angles only, or the vehicle does not arm.
        board_rotation: "SENS_BOARD_ROT" Int [""] = 10.0 in 0.0 ..= 40.0;
        /// Accelerometer offset, nose axis.
        accel_bias_x: "CAL_ACC_XOFF" Real ["m/s^2"] = 0.0 in -3.0 ..= 3.0;
        /// Accelerometer offset, right-hand axis.
        accel_bias_y: "CAL_ACC_YOFF" Real ["m/s^2"] = 0.0 in -3.0 ..= 3.0;
        /// Accelerometer offset, down axis.
        accel_bias_z: "CAL_ACC_ZOFF" Real ["m/s^2"] = 0.0 in -3.0 ..= 3.0;
        /// Accelerometer scale, nose axis.
        accel_scale_x: "CAL_ACC_XSCALE" Real [""] = 1.0 in 0.8 ..= 1.2;
        /// Accelerometer scale, right-hand axis.
        accel_scale_y: "CAL_ACC_YSCALE" Real [""] = 1.0 in 0.8 ..= 1.2;
        /// Accelerometer scale, down axis.
        accel_scale_z: "CAL_ACC_ZSCALE" Real [""] = 1.0 in 0.8 ..= 1.2;
        /// Accelerometer low-pass (Butterworth, 2nd order); 0 = off.
        accel_cutoff: "IMU_ACCEL_CUTOFF" Real ["Hz"] = 80.0 in 0.0 ..= 400.0;
        /// Gyro low-pass (Butterworth, 2nd order); 0 = off.
        gyro_cutoff: "IMU_GYRO_CUTOFF" Real ["Hz"] = 150.0 in 0.0 ..= 400.0;
        /// Centre of the gyro and accelerometer notch; 0 = off.
        notch_freq: "IMU_NF_FREQ" Real ["Hz"] = 0.0 in 0.0 ..= 400.0;
        /// Bandwidth of the notch.
        notch_bandwidth: "IMU_NF_BW" Real ["Hz"] = 20.0 in 1.0 ..= 200.0;
        /// Line's angle at the vehicle, about the nose axis: reading of its encoder when the line hangs straight down.
        line_angle_zero_x: "LNK_ANG_X0" Real ["rad"] = 0.0 in -6.3 ..= 6.3;
        /// The same about the right-hand axis.
        line_angle_zero_y: "LNK_ANG_Y0" Real ["rad"] = 0.0 in -6.3 ..= 6.3;
        /// Sense of the encoder about the nose axis: 1 right-handed, -1 left-handed.
        line_angle_sign_x: "LNK_ANG_X_SGN" Real [""] = 1.0 in -1.0 ..= 1.0;
        /// The same about the right-hand axis.
        line_angle_sign_y: "LNK_ANG_Y_SGN" Real [""] = 1.0 in -1.0 ..= 1.0;
        /// Load cell at the vehicle, per count; 0 = none.
        line_cell_scale: "LNK_CELL_SCALE" Real ["N"] = 0.0 in -1.0 ..= 1.0;
        /// Counts of the load cell without load.
        line_cell_zero: "LNK_CELL_OFF" Real [""] = 0.0 in -8388608.0 ..= 8388607.0;
        /// Azimuth that the station's encoder shows where the line leaves to the North.
        station_azimuth_zero: "STN_AZ_OFF" Real ["rad"] = 0.0 in -6.3 ..= 6.3;
        /// Elevation that the station's encoder shows where the line leaves level.
        station_elevation_zero: "STN_EL_OFF" Real ["rad"] = 0.0 in -1.6 ..= 1.6;
        /// Magnetometer offset (hard iron), nose axis.
        mag_bias_x: "CAL_MAG0_XOFF" Real ["gauss"] = 0.0 in -5.0 ..= 5.0;
        /// Magnetometer offset (hard iron), right-hand axis.
        mag_bias_y: "CAL_MAG0_YOFF" Real ["gauss"] = 0.0 in -5.0 ..= 5.0;
        /// Magnetometer offset (hard iron), down axis.
        mag_bias_z: "CAL_MAG0_ZOFF" Real ["gauss"] = 0.0 in -5.0 ..= 5.0;
        /// Magnetometer scale (soft iron), nose axis.
        mag_scale_x: "CAL_MAG0_XSCALE" Real [""] = 1.0 in 0.5 ..= 2.0;
        /// Magnetometer scale (soft iron), right-hand axis.
        mag_scale_y: "CAL_MAG0_YSCALE" Real [""] = 1.0 in 0.5 ..= 2.0;
        /// Magnetometer scale (soft iron), down axis.
        mag_scale_z: "CAL_MAG0_ZSCALE" Real [""] = 1.0 in 0.5 ..= 2.0;
        /// Field of the current that the vehicle draws, nose axis.
        mag_current_x: "CAL_MAG0_XCOMP" Real ["G/kA"] = 0.0 in -100.0 ..= 100.0;
        /// Field of the current that the vehicle draws, right-hand axis.
        mag_current_y: "CAL_MAG0_YCOMP" Real ["G/kA"] = 0.0 in -100.0 ..= 100.0;
        /// Field of the current that the vehicle draws, down axis.
        mag_current_z: "CAL_MAG0_ZCOMP" Real ["G/kA"] = 0.0 in -100.0 ..= 100.0;
        /// Rangefinder below the centre of mass.
        range_offset: "RNG_POS_Z" Real ["m"] = 0.03 in -0.5 ..= 0.5;
        /// Rangefinder distance beyond which the barometer takes over.
        range_max: "RNG_MAX" Real ["m"] = 11.0 in 0.5 ..= 100.0;
        /// Voltage divider from battery to ADC pin.
        battery_divider: "BAT1_V_DIV" Real [""] = 11.0 in 1.0 ..= 100.0;
        /// Current per volt at the ADC pin.
        battery_amps_per_volt: "BAT1_A_PER_V" Real ["A/V"] = 25.0 in 0.0 ..= 1000.0;
        /// Cells in series.
        battery_cells: "BAT1_N_CELLS" Int [""] = 4.0 in 1.0 ..= 14.0;
        /// Voltage of a full cell.
        cell_full: "BAT1_V_CHARGED" Real ["V"] = 4.15 in 3.0 ..= 4.5;
        /// Voltage of an empty cell.
        cell_empty: "BAT1_V_EMPTY" Real ["V"] = 3.4 in 2.5 ..= 4.0;
    }
    Tether "Tether" {
        /// Link: 0 = cable of fixed length, 1 = cable on a constant-tension winch, 2 = strut (pushes), 3 = bar (pulls and pushes), 4 = none (flies free under motion capture).
        tether_kind: "TET_KIND" Int [""] = 1.0 in 0.0 ..= 4.0;
        /// Length of a fixed tether; with a winch, length paid out after take-off.
        tether_length: "TET_LENGTH" Real ["m"] = 10.0 in 1.0 ..= 200.0;
        /// Tension set-point in flight.
        tension: "TET_TENSION" Real ["N"] = 6.5 in 1.0 ..= 100.0;
        /// Winch tension on the ground, during take-off near the anchor and at landing.
        tension_low: "TET_TENSION_LOW" Real ["N"] = 3.0 in 0.5 ..= 100.0;
        /// Distance of the vehicle from the anchor before take-off with a winch, along its nose.
        start_distance: "TET_START_DIST" Real ["m"] = 0.8 in 0.2 ..= 5.0;
        /// Fixed link: how much closer to the anchor than its length the vehicle stands before take-off. From 0.5 on it first climbs slack and calibrates its thrust.
        start_slack: "TET_START_SLK" Real ["m"] = 0.0 in 0.0 ..= 50.0;
        /// Heading of the nose at start-up, from North. Azimuth and all world axes follow from it.
        start_heading: "TET_HDG0" Real ["rad"] = 0.0 in -6.3 ..= 6.3;
        /// Tether mass per length.
        line_density: "TET_LIN_DENS" Real ["kg/m"] = 0.002 in 0.0 ..= 1.0;
        /// Tether stiffness: tension over strain. If unsure, the softer.
        line_stiffness: "TET_STIFF" Real ["N"] = 3000.0 in 50.0 ..= 1000000.0;
        /// Amplitude by which the tension set-point moves to and fro, so that the full-state filter sees where the tether points; 0 = off.
        dither: "TET_DITHER" Real ["N"] = 2.5 in 0.0 ..= 20.0;
        /// Period of that movement.
        dither_period: "TET_DITHER_T" Real ["s"] = 1.5 in 0.5 ..= 20.0;
        /// Lowest elevation that a set-point may have.
        elevation_min: "TET_EL_MIN" Real ["rad"] = 0.2 in 0.0 ..= 1.5;
        /// Highest elevation that a set-point may have.
        elevation_max: "TET_EL_MAX" Real ["rad"] = 1.55 in 0.1 ..= 1.569;
        /// Longest tether a set-point may ask of the winch.
        length_max: "TET_LEN_MAX" Real ["m"] = 30.0 in 1.0 ..= 200.0;
    }
    Estimator "Estimator" {
        /// Attitude: pull towards the accelerometer's vertical.
        mahony_kp: "ATT_W_ACC" Real ["rad/s"] = 0.2 in 0.0 ..= 5.0;
        /// Attitude: gyro bias gain.
        mahony_ki: "ATT_W_GYRO_BIAS" Real ["rad/s^2"] = 0.01 in 0.0 ..= 1.0;
        /// Position: process noise of each coordinate, variance per 4 ms step.
        ekf_q_position: "EKF4_Q_POS" Real ["m^2"] = 0.004 in 0.000001 ..= 1.0;
        /// Tension: process noise, variance per 4 ms step.
        ekf_q_tension: "EKF4_Q_TEN" Real ["N^2"] = 0.004 in 0.000001 ..= 10.0;
        /// Accelerometer noise, variance of the specific force in units of g.
        ekf_r_accel: "EKF4_R_ACC" Real [""] = 0.01 in 0.000001 ..= 10.0;
        /// Altitude noise, variance.
        ekf_r_altitude: "EKF4_R_ALT" Real ["m^2"] = 0.1 in 0.000001 ..= 10.0;
        /// Tether length noise, variance.
        ekf_r_length: "EKF4_R_LEN" Real ["m^2"] = 0.01 in 0.000001 ..= 10.0;
        /// Velocity: gain towards the position estimate.
        velocity_gain: "VEL_K_POS" Real ["1/s"] = 2.5 in 0.1 ..= 20.0;
        /// Position filter on a cable: 0 = four states behind the attitude filter, 1 = full state.
        estimator_kind: "EST_KIND" Int [""] = 1.0 in 0.0 ..= 1.0;
        /// Full state: low-pass of accelerometer and thrust (Butterworth, 2nd order); 0 = off.
        full_cutoff: "EST_CUTOFF" Real ["Hz"] = 30.0 in 0.0 ..= 100.0;
        /// Full state: accelerometer noise behind the low-pass, standard deviation.
        full_accel_sd: "EST_ACC_SD" Real ["m/s^2"] = 0.5 in 0.05 ..= 5.0;
        /// Full state: altitude noise, standard deviation.
        full_altimeter_sd: "EST_ALT_SD" Real ["m"] = 0.08 in 0.01 ..= 2.0;
        /// Full state: velocity noise density; 0.15 over a moving anchor.
        full_velocity_noise: "EST_VEL_NOISE" Real ["m/s/sqrt(s)"] = 0.02 in 0.001 ..= 2.0;
        /// Full state: sensors that count, each by its bit: 0 line angles at the vehicle, 1 line direction at the station (before bit 0), 2 load cell, 3 compass, 4 position and 5 velocity by ODOMETRY. With bit 3 the start heading is the compass'.
        aids: "EST_AIDS" Int [""] = 0.0 in 0.0 ..= 63.0;
        /// Full state: noise of the line's direction, standard deviation, at 60 Hz.
        direction_sd: "EST_DIR_SD" Real ["rad"] = 0.04 in 0.001 ..= 0.2;
        /// Full state: share of the wind's force on the vehicle that comes through the line, which it bends.
        line_bow: "EST_BOW" Real [""] = 0.1 in 0.0 ..= 0.5;
        /// Full state: noise of a position by ODOMETRY, standard deviation.
        place_sd: "EST_POS_SD" Real ["m"] = 0.03 in 0.001 ..= 5.0;
        /// Full state: noise of a velocity by ODOMETRY, standard deviation.
        flow_sd: "EST_ODO_SD" Real ["m/s"] = 0.13 in 0.01 ..= 2.0;
        /// Declination: by how much the earth's field points East of North.
        declination: "EST_MAG_DECL" Real ["rad"] = 0.0 in -3.2 ..= 3.2;
        /// Rest before the gyro bias and the level are taken.
        levelling_time: "EST_LEVEL_T" Real ["s"] = 3.0 in 0.5 ..= 30.0;
        /// Low-passed innovation test ratio beyond which the estimate counts as diverged.
        divergence_ratio: "EST_DIV_RATIO" Real [""] = 9.0 in 1.0 ..= 1000.0;
    }
    PositionControl "Position control" {
        /// Tangential position gain.
        position_p: "TPC_P" Real ["1/s^2"] = 1.2 in 0.05 ..= 20.0;
        /// Tangential velocity gain.
        position_d: "TPC_D" Real ["1/s"] = 2.0 in 0.05 ..= 20.0;
        /// Tangential integral gain.
        position_i: "TPC_I" Real ["1/s^3"] = 0.15 in 0.0 ..= 10.0;
        /// Largest integral.
        position_i_max: "TPC_I_MAX" Real ["m/s^2"] = 1.0 in 0.0 ..= 10.0;
        /// Largest integral along the line of a winch: it may have to carry a payload or weak rotors.
        radial_i_max: "TPC_RAD_I_MAX" Real ["m/s^2"] = 2.5 in 0.0 ..= 10.0;
        /// Largest acceleration asked by the position loop.
        accel_max: "TPC_ACC_MAX" Real ["m/s^2"] = 3.0 in 0.1 ..= 20.0;
        /// Radial position gain (winch).
        radial_p: "TPC_RAD_P" Real ["1/s^2"] = 1.5 in 0.05 ..= 20.0;
        /// Radial velocity gain (winch).
        radial_d: "TPC_RAD_D" Real ["1/s"] = 2.2 in 0.05 ..= 20.0;
        /// Braking of outward motion on a fixed length.
        brake: "TPC_BRAKE" Real ["1/s"] = 6.0 in 0.0 ..= 50.0;
        /// Share of the estimated wind force that is fed forward.
        wind_feed_forward: "TPC_WIND_FF" Real [""] = 1.0 in 0.0 ..= 1.0;
        /// Lowest tension the guard allows on a fixed length.
        tension_min: "TPC_TEN_MIN" Real ["N"] = 1.5 in 0.0 ..= 50.0;
        /// Highest tension the guard allows on a fixed length.
        tension_max: "TPC_TEN_MAX" Real ["N"] = 14.0 in 1.0 ..= 500.0;
        /// Lowest total thrust in flight.
        thrust_min: "TPC_THR_MIN" Real ["N"] = 2.0 in 0.1 ..= 100.0;
        /// Highest total thrust asked by the position loop.
        thrust_max: "TPC_THR_MAX" Real ["N"] = 28.0 in 1.0 ..= 2000.0;
        /// Largest tilt.
        tilt_max: "TPC_TILT_MAX" Real ["rad"] = 0.78 in 0.1 ..= 1.2;
        /// Speed of moves to a new set-point.
        cruise_speed: "TPC_XY_CRUISE" Real ["m/s"] = 1.0 in 0.1 ..= 5.0;
    }
    AttitudeRateControl "Attitude and rate control" {
        /// Tilt error to rate.
        attitude_p: "ATC_TILT_P" Real ["1/s"] = 7.0 in 0.5 ..= 30.0;
        /// Yaw error to rate.
        yaw_p: "ATC_YAW_P" Real ["1/s"] = 2.0 in 0.0 ..= 10.0;
        /// Largest tilt rate.
        tilt_rate_max: "ATC_RATE_MAX" Real ["rad/s"] = 4.0 in 0.5 ..= 20.0;
        /// Largest yaw rate.
        yaw_rate_max: "ATC_YAWRATE_MAX" Real ["rad/s"] = 1.0 in 0.1 ..= 10.0;
        /// Rate error to angular acceleration.
        rate_p: "RATE_P" Real ["1/s"] = 20.0 in 1.0 ..= 200.0;
        /// Integral of the rate error.
        rate_i: "RATE_I" Real ["1/s^2"] = 30.0 in 0.0 ..= 500.0;
        /// Derivative of the rate error, on a low-passed gyro; 0 = off.
        rate_d: "RATE_D" Real [""] = 0.0 in 0.0 ..= 5.0;
        /// Largest integral of the rate loop.
        rate_i_max: "RATE_I_MAX" Real ["rad/s^2"] = 20.0 in 0.0 ..= 200.0;
        /// Largest roll and pitch angle asked by the sticks.
        stick_tilt_max: "MAN_TILT_MAX" Real ["rad"] = 0.5 in 0.1 ..= 1.0;
        /// Largest yaw rate asked by the sticks.
        stick_yaw_rate: "MAN_YAW_RATE" Real ["rad/s"] = 1.0 in 0.1 ..= 5.0;
        /// Largest climb and sink rate asked by the sticks in Altitude.
        stick_climb_rate: "MAN_CLIMB_RATE" Real ["m/s"] = 1.0 in 0.1 ..= 5.0;
    }
    TautLink "Taut link" {
        /// Observer speed in Taut Force: larger is slower and quieter. About 2 at 5 m, growing as length^0.3.
        taut_epsilon_force: "TLK_EPS_FRC" Real [""] = 2.0 in 0.3 ..= 10.0;
        /// Observer speed in Taut Attitude.
        taut_epsilon_attitude: "TLK_EPS_ATT" Real [""] = 3.0 in 0.3 ..= 10.0;
        /// Observer speed on a strut or bar.
        taut_epsilon_bar: "TLK_EPS_BAR" Real [""] = 3.2 in 0.3 ..= 10.0;
        /// Bandwidth of Taut Force: the elevation poles are this times (1, 1.5, 2, 2.5), the force poles (1, 1.5).
        taut_force_bandwidth: "TLK_FRC_BW" Real ["rad/s"] = 1.5 in 0.2 ..= 6.0;
        /// Bandwidth of Taut Attitude: the elevation poles are this times (0.75, 1.1, 1.5), the pitch poles (1, 1.5).
        taut_attitude_bandwidth: "TLK_ATT_BW" Real ["rad/s"] = 1.0 in 0.2 ..= 4.0;
        /// Bandwidth of the out-of-plane loop; 0.8 suits a bar.
        taut_out_of_plane_bandwidth: "TLK_LAT_BW" Real ["rad/s"] = 1.2 in 0.1 ..= 4.0;
        /// Out-of-plane filter: noise of the specific force, in units of 0.5 m/s^2; 3 suits a bar.
        taut_out_of_plane_noise: "TLK_LAT_NOISE" Real [""] = 1.5 in 0.1 ..= 20.0;
        /// Lowest thrust in the taut-link modes.
        taut_thrust_min: "TLK_THR_MIN" Real ["N"] = 3.0 in 0.1 ..= 100.0;
        /// Highest thrust in the taut-link modes, as a share of what the rotors give.
        taut_thrust_share: "TLK_THR_SHARE" Real [""] = 0.92 in 0.3 ..= 1.0;
        /// Lowest magnitude of the link force that a reference may ask; below, the inertial reading has no direction.
        taut_force_min: "TLK_FRC_MIN" Real ["N"] = 2.0 in 0.1 ..= 100.0;
        /// Time constant with which the altimeter corrects the elevation; 0 = by inertia alone.
        taut_altimeter_tau: "TLK_ALT_TAU" Real ["s"] = 1.5 in 0.0 ..= 60.0;
    }
    TetherAngle "Tether angle" {
        /// Thrust over mass in Tether Angle: more tension, and so a better estimate, the higher it is.
        angle_thrust: "TAG_THR_ACC" Real ["m/s^2"] = 16.0 in 10.5 ..= 40.0;
        /// Time constant of the tether angle.
        angle_tether_time: "TAG_TAU" Real ["s"] = 1.2 in 0.2 ..= 10.0;
        /// Damping ratio of the tether angle.
        angle_damping: "TAG_ZETA" Real [""] = 0.8 in 0.1 ..= 3.0;
        /// Time constant of the tilt.
        angle_tilt_time: "TAG_TILT_TAU" Real ["s"] = 0.16 in 0.05 ..= 2.0;
        /// Tension over mass that every asked tilt keeps at rest.
        angle_tension_min: "TAG_TEN_MIN" Real ["m/s^2"] = 1.5 in 0.0 ..= 20.0;
        /// Low-pass of specific force and thrust before the filter.
        angle_accel_tau: "TAG_ACC_TAU" Real ["s"] = 0.06 in 0.0 ..= 1.0;
        /// Process noise of the filter; 0.02 and more is unstable in two planes.
        angle_sigma: "TAG_SIGMA" Real ["rad/s^2"] = 0.005 in 0.0001 ..= 0.5;
    }
    MotionCapture "Motion capture" {
        /// Age of a sample when it arrives.
        capture_delay: "CAP_DELAY" Real ["s"] = 0.02 in 0.0 ..= 0.12;
        /// Bandwidth with which samples hold position and velocity.
        capture_bandwidth: "CAP_BW" Real ["rad/s"] = 12.0 in 0.5 ..= 30.0;
        /// Silence after which there is no position.
        capture_timeout: "CAP_TIMEOUT" Real ["s"] = 0.2 in 0.03 ..= 2.0;
    }
    Pendulum "Pendulum" {
        /// Mass of the load on the rod.
        pendulum_load: "PND_LOAD" Real ["kg"] = 0.03 in 0.001 ..= 10.0;
        /// Length of the rod, joint to load.
        pendulum_length: "PND_LENGTH" Real ["m"] = 0.7 in 0.1 ..= 5.0;
        /// Kp of the load's position.
        pendulum_kp: "PND_KP" Real ["1/s^2"] = 10.0 in 0.5 ..= 50.0;
        /// Kv of the load's velocity.
        pendulum_kv: "PND_KV" Real ["1/s"] = 3.0 in 0.2 ..= 20.0;
        /// Coupling of position and velocity; must stay below sqrt(Kp) and 4 Kp Kv/(4 Kp + Kv^2).
        pendulum_beta: "PND_BETA" Real ["1/s"] = 0.2 in 0.0 ..= 5.0;
        /// kq of the rod's direction.
        pendulum_kq: "PND_KQ" Real [""] = 12.0 in 0.1 ..= 200.0;
        /// k-omega of the rod's rate.
        pendulum_kw: "PND_KW" Real [""] = 2.7 in 0.1 ..= 100.0;
        /// kr of the vehicle's attitude.
        pendulum_kr: "PND_KR" Real [""] = 350.0 in 1.0 ..= 5000.0;
        /// hq, weight of the rod's direction.
        pendulum_hq: "PND_HQ" Real [""] = 12.0 in 0.1 ..= 200.0;
        /// h-omega, weight of the rod's rate.
        pendulum_hw: "PND_HW" Real [""] = 0.6 in 0.05 ..= 50.0;
        /// hr, weight of the attitude.
        pendulum_hr: "PND_HR" Real [""] = 45.0 in 1.0 ..= 1000.0;
        /// Noise intensity of the measured direction: variance times sample period.
        pendulum_noise: "PND_R" Real ["s"] = 0.000001 in 0.00000001 ..= 0.001;
        /// Bandwidth of the vertical disturbance observer.
        pendulum_vertical: "PND_VERT_BW" Real ["rad/s"] = 3.0 in 0.2 ..= 10.0;
        /// Largest thrust, in weights of vehicle and load.
        pendulum_thrust_max: "PND_THR_MAX" Real [""] = 2.0 in 1.1 ..= 5.0;
        /// Largest roll and pitch rate.
        pendulum_rate_max: "PND_RATE_MAX" Real ["rad/s"] = 10.0 in 1.0 ..= 30.0;
        /// Largest tilt of the rod at which the mode is entered.
        pendulum_cone: "PND_CONE" Real ["rad"] = 0.26 in 0.02 ..= 0.7;
        /// Tilt of the rod that ends the mode.
        pendulum_tilt_max: "PND_TILT_MAX" Real ["rad"] = 1.31 in 0.3 ..= 1.5;
        /// Distance of the load from its reference that ends the mode, after the soft start.
        pendulum_error_max: "PND_ERR_MAX" Real ["m"] = 1.0 in 0.1 ..= 10.0;
        /// Silence of the rod's direction that ends the mode.
        pendulum_timeout: "PND_TIMEOUT" Real ["s"] = 0.15 in 0.02 ..= 1.0;
        /// Speed along a tilted circle around the place of entry; 0 = stay there. Counts at entry.
        pendulum_speed: "PND_SPEED" Real ["m/s"] = 0.0 in 0.0 ..= 3.0;
        /// Radius of that circle.
        pendulum_radius: "PND_RADIUS" Real ["m"] = 0.8 in 0.1 ..= 10.0;
        /// How far that circle rises and falls.
        pendulum_rise: "PND_RISE" Real ["m"] = 0.5 in 0.0 ..= 5.0;
        /// Duration of the soft start.
        pendulum_soft_start: "PND_SOFT" Real ["s"] = 4.0 in 0.5 ..= 20.0;
    }
    TakeoffLanding "Take-off and landing" {
        /// Altitude reached when the ground station names none.
        takeoff_altitude: "MIS_TAKEOFF_ALT" Real ["m"] = 5.0 in 1.0 ..= 100.0;
        /// Altitude of the vertical climb near the anchor (winch).
        climb_altitude: "TKO_CLIMB_ALT" Real ["m"] = 3.0 in 0.5 ..= 20.0;
        /// Duration of the thrust ramp on the ground.
        spool_time: "TKO_SPOOL_T" Real ["s"] = 0.8 in 0.2 ..= 5.0;
        /// Thrust at the end of that ramp, in weights of the vehicle, tether pull on top.
        spool_thrust: "TKO_SPOOL_THR" Real [""] = 1.25 in 1.02 ..= 2.0;
        /// Sink rate below 1 m.
        land_speed: "LND_SPEED" Real ["m/s"] = 0.35 in 0.1 ..= 1.0;
        /// Sink rate above 1 m.
        descend_speed: "LND_SPEED_HIGH" Real ["m/s"] = 0.7 in 0.1 ..= 3.0;
        /// Time on the ground before the motors stop by themselves.
        disarm_delay: "COM_DISARM_LAND" Real ["s"] = 1.0 in 0.2 ..= 20.0;
        /// Time armed on the ground without take-off before the motors stop by themselves.
        preflight_disarm: "COM_DISARM_PRFLT" Real ["s"] = 15.0 in 2.0 ..= 120.0;
    }
    Failsafes "Failsafes" {
        /// Silence of the ground station before its action.
        link_loss_time: "FS_LINK_T" Real ["s"] = 5.0 in 0.5 ..= 600.0;
        /// On link loss: 1 = hold, 2 = land, 3 = flat-attitude descent.
        link_loss_action: "FS_LINK_ACT" Int [""] = 2.0 in 1.0 ..= 3.0;
        /// Silence of the sticks, radio's or joystick's, after which they are not there.
        stick_loss_time: "COM_RC_LOSS_T" Real ["s"] = 1.0 in 0.2 ..= 35.0;
        /// No sticks any more where a radio had them: 0 = what each mode does itself, 1 = hold, 2 = return and land, 3 = land in place, 5 or 6 = motors off.
        radio_loss_action: "NAV_RCL_ACT" Int [""] = 0.0 in 0.0 ..= 6.0;
        /// Beyond the fence: 0 = nothing, 1 = warn, 2 = hold, 3 = return and land, 4 = motors off, 5 = land in place.
        fence_action: "GF_ACTION" Int [""] = 0.0 in 0.0 ..= 5.0;
        /// Radius of the fence around the anchor; 0 = none.
        fence_radius: "GF_MAX_HOR_DIST" Real ["m"] = 0.0 in 0.0 ..= 10000.0;
        /// Height of the fence over the anchor; 0 = none.
        fence_height: "GF_MAX_VER_DIST" Real ["m"] = 0.0 in 0.0 ..= 10000.0;
        /// Time with a slack tether before its action.
        slack_time: "FS_SLACK_T" Real ["s"] = 3.0 in 0.2 ..= 60.0;
        /// Tension below which the tether counts as slack.
        slack_tension: "FS_SLACK_TEN" Real ["N"] = 0.4 in 0.0 ..= 10.0;
        /// Time in a level hover without motion capture before the descent.
        capture_loss_time: "FS_CAP_T" Real ["s"] = 3.0 in 0.2 ..= 60.0;
        /// Time without a new inertial sample, missing, late or repeated, until the sensor counts as lost. Till then
        /// motors and estimators go on with the last one.
        imu_timeout: "FS_IMU_T" Real ["s"] = 0.3 in 0.02 ..= 1.0;
        /// Age at which the altitude counts as lost.
        altimeter_timeout: "FS_ALT_T" Real ["s"] = 1.0 in 0.1 ..= 10.0;
        /// Time of failed innovation tests before the estimate counts as diverged.
        divergence_time: "FS_EST_T" Real ["s"] = 1.0 in 0.1 ..= 10.0;
        /// Cell voltage at which the vehicle lands.
        battery_low: "BAT_LOW_V" Real ["V"] = 3.5 in 2.5 ..= 4.2;
        /// Cell voltage at which it descends at once where it is.
        battery_critical: "BAT_CRIT_V" Real ["V"] = 3.3 in 2.5 ..= 4.2;
    }
    Radio "Radio control" {
        /// Whose sticks fly: 0 = the radio's, 1 = a joystick's over MAVLink, 2 = the radio's, and a joystick's while no pilot is heard.
        rc_mode: "COM_RC_IN_MODE" Int [""] = 2.0 in 0.0 ..= 2.0;
        /// Channel of the roll stick; 0 = none, and then no stick of the radio counts.
        radio_roll: "RC_MAP_ROLL" Int [""] = 1.0 in 0.0 ..= 16.0;
        /// Channel of the pitch stick.
        radio_pitch: "RC_MAP_PITCH" Int [""] = 2.0 in 0.0 ..= 16.0;
        /// Channel of the throttle stick.
        radio_throttle: "RC_MAP_THROTTLE" Int [""] = 3.0 in 0.0 ..= 16.0;
        /// Channel of the yaw stick.
        radio_yaw: "RC_MAP_YAW" Int [""] = 4.0 in 0.0 ..= 16.0;
        /// Channel of the mode switch; 0 = none.
        radio_mode_switch: "RC_MAP_FLTMODE" Int [""] = 0.0 in 0.0 ..= 16.0;
        /// Channel of the arm switch: on in the last quarter of its way; 0 = none.
        radio_arm_switch: "RC_MAP_ARM_SW" Int [""] = 0.0 in 0.0 ..= 16.0;
        /// Channel of the kill switch: motors off at once, also in the air; 0 = none.
        radio_kill_switch: "RC_MAP_KILL_SW" Int [""] = 0.0 in 0.0 ..= 16.0;
        /// Lowest pulse of every channel.
        radio_min: "RC_MIN" Real ["us"] = 1000.0 in 800.0 ..= 1200.0;
        /// Pulse of every stick in its middle.
        radio_trim: "RC_TRIM" Real ["us"] = 1500.0 in 1400.0 ..= 1600.0;
        /// Highest pulse of every channel.
        radio_max: "RC_MAX" Real ["us"] = 2000.0 in 1800.0 ..= 2200.0;
        /// Half of the band about the middle in which a stick counts as still.
        radio_dead_band: "RC_DZ" Real ["us"] = 10.0 in 0.0 ..= 100.0;
        /// Below 0: channel 1 is turned round.
        radio_1_sign: "RC1_REV" Real [""] = 1.0 in -1.0 ..= 1.0;
        /// Below 0: channel 2 is turned round.
        radio_2_sign: "RC2_REV" Real [""] = 1.0 in -1.0 ..= 1.0;
        /// Below 0: channel 3 is turned round.
        radio_3_sign: "RC3_REV" Real [""] = 1.0 in -1.0 ..= 1.0;
        /// Below 0: channel 4 is turned round.
        radio_4_sign: "RC4_REV" Real [""] = 1.0 in -1.0 ..= 1.0;
        /// Below 0: channel 5 is turned round.
        radio_5_sign: "RC5_REV" Real [""] = 1.0 in -1.0 ..= 1.0;
        /// Below 0: channel 6 is turned round.
        radio_6_sign: "RC6_REV" Real [""] = 1.0 in -1.0 ..= 1.0;
        /// Below 0: channel 7 is turned round.
        radio_7_sign: "RC7_REV" Real [""] = 1.0 in -1.0 ..= 1.0;
        /// Below 0: channel 8 is turned round.
        radio_8_sign: "RC8_REV" Real [""] = 1.0 in -1.0 ..= 1.0;
        /// Mode in position 1 of the mode switch, as PX4 counts: -1 = none, 1 Altitude, 2 Position, 4 Tether Hold, 5 Return, 7 Offboard, 8 Stabilize, 10 Takeoff, 11 Land, 100 Descent, 101 to 104 Taut Force, Taut Attitude, Tether Angle, Pendulum.
        flight_mode_1: "COM_FLTMODE1" Int [""] = -1.0 in -1.0 ..= 104.0;
        /// Mode in position 2.
        flight_mode_2: "COM_FLTMODE2" Int [""] = -1.0 in -1.0 ..= 104.0;
        /// Mode in position 3.
        flight_mode_3: "COM_FLTMODE3" Int [""] = -1.0 in -1.0 ..= 104.0;
        /// Mode in position 4.
        flight_mode_4: "COM_FLTMODE4" Int [""] = -1.0 in -1.0 ..= 104.0;
        /// Mode in position 5.
        flight_mode_5: "COM_FLTMODE5" Int [""] = -1.0 in -1.0 ..= 104.0;
        /// Mode in position 6.
        flight_mode_6: "COM_FLTMODE6" Int [""] = -1.0 in -1.0 ..= 104.0;
    }
    GroundStation "Ground station" {
        /// MAVLink system id.
        system_id: "MAV_SYS_ID" Int [""] = 1.0 in 1.0 ..= 255.0;
        /// Autopilot type in the heartbeat: 12 = PX4 (modes and guided actions work in QGroundControl), 0 = generic.
        autopilot_type: "MAV_AUTOPILOT" Int [""] = 12.0 in 0.0 ..= 12.0;
        /// MAVLink system whose measurements are taken: winch, motion capture, station. 0 = the vehicle's own.
        aid_system: "MAV_AID_SYS" Int [""] = 0.0 in 0.0 ..= 255.0;
        /// Component of that system whose measurements are taken. 0 = any.
        aid_component: "MAV_AID_COMP" Int [""] = 0.0 in 0.0 ..= 255.0;
        /// Airframe; QGroundControl wants it not zero.
        airframe: "SYS_AUTOSTART" Int [""] = 4001.0 in 1.0 ..= 99999.0;
        /// Whether a magnetometer is fitted; none is used.
        has_magnetometer: "SYS_HAS_MAG" Int [""] = 0.0 in 0.0 ..= 0.0;
        /// 1 = the log at the rates that identification needs, at twice the size.
        log_full: "LOG_FULL" Int [""] = 0.0 in 0.0 ..= 1.0;
        /// Identity of the calibrated gyro.
        gyro_id: "CAL_GYRO0_ID" Int [""] = 42688.0 in 1.0 ..= 16777215.0;
        /// Identity of the calibrated accelerometer.
        accel_id: "CAL_ACC0_ID" Int [""] = 42688.0 in 1.0 ..= 16777215.0;
        /// Latitude of the anchor, for the synthetic global position.
        home_latitude: "HOME_LAT" Real ["deg"] = 47.397742 in -90.0 ..= 90.0;
        /// Longitude of the anchor.
        home_longitude: "HOME_LON" Real ["deg"] = 8.545594 in -180.0 ..= 180.0;
        /// Height of the anchor above mean sea level.
        home_altitude: "HOME_ALT" Real ["m"] = 488.0 in -500.0 ..= 9000.0;
    }
}
