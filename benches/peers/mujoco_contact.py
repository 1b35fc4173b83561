"""MuJoCo: a sphere at the rod's end on a tilting plane, a stiff undamped contact."""

import math

from scene import HEIGHT, L, RHO, THETA, G, Engine, main, report_steps

RADIUS = 1e-3  # of the sphere, whose centre is the contact point: the table is that much lower


def model(dt):
    # The contact lasts some 16 steps.
    stiffness = (math.pi / (16 * dt)) ** 2
    return f"""
<mujoco>
  <option timestep="{dt}" gravity="0 0 -{G}" cone="elliptic"/>
  <worldbody>
    <body name="table" mocap="true"><geom name="table" type="plane" size="9 9 1" condim="1"
      solref="-{stiffness} 0" solimp="0.9999 0.9999 0.001 0.5 2" priority="1"/></body>
    <body name="rod">
      <joint type="slide" axis="1 0 0"/><joint type="slide" axis="0 0 1"/><joint type="hinge" axis="0 -1 0"/>
      <inertial pos="0 0 0" mass="1" diaginertia="{RHO**2} {RHO**2} {RHO**2}"/>
      <geom type="sphere" size="{RADIUS}" pos="0 0 -{L}" condim="1"/>
    </body>
  </worldbody>
</mujoco>
"""


def run():
    import mujoco

    class Rod(Engine):
        def __init__(self, dt):
            self.dt = dt
            self.model = mujoco.MjModel.from_xml_string(model(dt))
            self.data = mujoco.MjData(self.model)
            self.data.qpos[:] = [0.0, HEIGHT, THETA]

        def pose(self):
            return (*self.data.qpos.tolist(), *self.data.qvel.tolist())

        def turn_table(self, x, alpha):
            sin, cos = math.sin(alpha), math.cos(alpha)
            self.data.mocap_pos[0] = [x + RADIUS * sin, 0.0, -RADIUS * cos]
            # About −y, as the rod's hinge.
            self.data.mocap_quat[0] = [math.cos(alpha / 2), 0.0, -math.sin(alpha / 2), 0.0]

        def step(self):
            mujoco.mj_step(self.model, self.data)

    report_steps("MuJoCo", mujoco.__version__, ", driven from Python", Rod)


if __name__ == "__main__":
    main("MuJoCo", run)
