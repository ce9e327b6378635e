"""What MuJoCo takes for a vehicle on a chain: simulated seconds per second of processor time.

Ten links of 1 m and 10 g/m between an anchor and a body of 1.5 kg that a constant thrust holds up; 1 kHz, Euler.
Not a test: `cargo xtask speed` runs it where MuJoCo is installed.
"""

import sys
import time

import mujoco

LINKS = 10
LENGTH = 1.0
DENSITY = 0.01
THRUST = 1.5 * 9.81 + 6.0


def link(index):
    """One link, the next one hanging on its end, the vehicle on the last."""
    inner = link(index + 1) if index + 1 < LINKS else VEHICLE
    return f"""
    <body pos="0 0 {LENGTH if index else 0}">
      <joint type="ball" damping="1e-3"/>
      <geom type="capsule" fromto="0 0 0 0 0 {LENGTH}" size="0.002" mass="{DENSITY * LENGTH}" contype="0" conaffinity="0"/>
      {inner}
    </body>"""


VEHICLE = f"""
    <body name="vehicle" pos="0 0 {LENGTH}">
      <joint type="ball"/>
      <inertial pos="0 0 0.05" mass="1.5" diaginertia="0.015 0.015 0.025"/>
    </body>"""

MODEL = f"""
<mujoco>
  <option timestep="0.001" integrator="Euler"/>
  <worldbody>{link(0)}</worldbody>
</mujoco>"""


def main(seconds):
    model = mujoco.MjModel.from_xml_string(MODEL)
    data = mujoco.MjData(model)
    body = model.body("vehicle").id
    data.xfrc_applied[body, 2] = THRUST
    mujoco.mj_step(model, data, nstep=1000)
    began = time.process_time()
    mujoco.mj_step(model, data, nstep=int(seconds * 1000))
    used = time.process_time() - began
    assert data.xpos[body, 2] > 0.9 * LINKS * LENGTH, "the chain fell"
    print(f"{seconds / used:.1f}")


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 20.0)
