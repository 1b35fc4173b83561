"""Box2D: a circle at the rod's end on a tilting box, restitution 1."""

from scene import HEIGHT, L, RHO, THETA, G, Engine, main, report_steps

# Below 1 m/s Box2D gives nothing back, and it tolerates 0.005 m: the rod is built 20 times as long, where both are less.
SCALE = 20.0
RADIUS = 0.02  # of the circle at the rod's end, scaled metres


def run():
    import Box2D

    class Rod(Engine):
        def __init__(self, dt):
            self.dt = dt
            self.world = Box2D.b2World(gravity=(0.0, -G * SCALE))
            end = Box2D.b2CircleShape(pos=(0.0, -L * SCALE), radius=RADIUS)
            fixture = Box2D.b2FixtureDef(shape=end, density=1.0, restitution=1.0, friction=0.0)
            place = (0.0, HEIGHT * SCALE)
            self.rod = self.world.CreateDynamicBody(position=place, angle=THETA, fixtures=fixture, bullet=True)
            self.rod.massData = Box2D.b2MassData(mass=1.0, center=(0.0, 0.0), I=(RHO * SCALE) ** 2)
            self.rod.sleepingAllowed = False
            # Polygons have a skin, at which contacts happen.
            top = -RADIUS - Box2D.b2_polygonRadius
            box = Box2D.b2PolygonShape(box=(50.0, 5.0, (0.0, top - 5.0), 0.0))
            fixture = Box2D.b2FixtureDef(shape=box, restitution=1.0, friction=0.0)
            self.table = self.world.CreateKinematicBody(fixtures=fixture)

        def pose(self):
            (x, y), (x_dot, y_dot) = self.rod.position, self.rod.linearVelocity
            return (x / SCALE, y / SCALE, self.rod.angle, x_dot / SCALE, y_dot / SCALE, self.rod.angularVelocity)

        def turn_table(self, x, alpha):
            self.table.transform = ((x * SCALE, 0.0), alpha)

        def step(self):
            self.world.Step(self.dt, 8, 3)

    setting = f", single precision, driven from Python, {SCALE:g} times the size"
    report_steps("Box2D", Box2D.__version__, setting, Rod)


if __name__ == "__main__":
    main("Box2D", run)
