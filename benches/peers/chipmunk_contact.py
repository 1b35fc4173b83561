"""Chipmunk (pymunk): a circle at the rod's end on a tilting segment, elasticity 1."""

from scene import HEIGHT, L, RHO, THETA, G, Engine, main, report_steps

RADIUS = 1e-3


def run():
    import pymunk

    class Rod(Engine):
        def __init__(self, dt):
            self.dt = dt
            self.space = pymunk.Space()
            self.space.gravity = (0.0, -G)
            self.space.collision_slop = 1e-6
            self.rod = pymunk.Body(1.0, RHO**2)
            self.rod.position, self.rod.angle = (0.0, HEIGHT), THETA
            end = pymunk.Circle(self.rod, RADIUS, (0.0, -L))
            self.table = pymunk.Body(body_type=pymunk.Body.KINEMATIC)
            # The table's upper side is its line and half its thickness.
            plane = pymunk.Segment(self.table, (-5.0, -0.01 - RADIUS), (5.0, -0.01 - RADIUS), 0.01)
            for shape in (end, plane):
                shape.elasticity, shape.friction = 1.0, 0.0
            self.space.add(self.rod, end, self.table, plane)

        def pose(self):
            rod = self.rod
            return (*rod.position, rod.angle, *rod.velocity, rod.angular_velocity)

        def turn_table(self, x, alpha):
            self.table.position, self.table.angle = (x, 0.0), alpha

        def step(self):
            self.space.step(self.dt)

    report_steps("Chipmunk (pymunk)", pymunk.version, ", driven from Python", Rod)


if __name__ == "__main__":
    main("Chipmunk (pymunk)", run)
