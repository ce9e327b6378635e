"""The same mass on the same line in MuJoCo: how far apart are the paths?

Reads what `cargo sitl experiment line-path --plot DIR` wrote, and pushes a mass at the end of a chain of rigid links
with the same thrusts. Not a test: `cargo xtask speed` runs it where MuJoCo is installed.
"""

import csv
import sys

import mujoco
import numpy as np

LINKS = 20
STEP = 0.0005


def model(length, density, mass):
    """Links up from the anchor, the mass on the last."""
    each = length / LINKS
    body = f'<body name="mass" pos="0 0 {each}"><geom type="sphere" size="0.05" mass="{mass}" contype="0" conaffinity="0"/></body>'
    for index in reversed(range(LINKS)):
        body = f"""
        <body pos="0 0 {each if index else 0}">
          <joint type="ball" damping="1e-5"/>
          <geom type="capsule" fromto="0 0 0 0 0 {each}" size="0.002" mass="{density * each}" contype="0" conaffinity="0"/>
          {body}
        </body>"""
    option = f'<option timestep="{STEP}" integrator="implicitfast" gravity="0 0 -9.81"/>'
    return mujoco.MjModel.from_xml_string(f"<mujoco>{option}<worldbody>{body}</worldbody></mujoco>")


def main(path):
    with open(path) as file:
        settings = dict(word.split("=") for word in file.readline().lstrip("# ").split())
        rows = np.array([[float(x) for x in row] for row in list(csv.reader(file))[1:]])
    length, density, mass = (float(settings[k]) for k in ("length_m", "density_kgpm", "mass_kg"))
    m = model(length, density, mass)
    data = mujoco.MjData(m)
    body = m.body("mass").id
    mujoco.mj_forward(m, data)
    start = data.xpos[body].copy()
    times, theirs = rows[:, 0], []
    for time, place in zip(times, rows[:, 4:7] - rows[0, 4:7]):
        while data.time < time - 0.5 * STEP:
            thrust = [np.interp(data.time, times, rows[:, k]) for k in (1, 2, 3)]
            # North, east, down against x, y, z.
            data.xfrc_applied[body, :3] = [thrust[0], -thrust[1], -thrust[2]]
            mujoco.mj_step(m, data)
        x, y, z = data.xpos[body] - start
        theirs.append(np.linalg.norm(place - np.array([x, -y, -z])))
    rms = float(np.sqrt(np.mean(np.square(theirs))))
    print(f"{rms:.4f} m rms, {max(theirs):.4f} m at most, {100 * rms / length:.3f} % of the length")
    return 0 if rms <= 0.02 * length else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1]))
