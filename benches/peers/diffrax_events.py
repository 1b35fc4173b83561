"""Diffrax: a flight at a time with an event and Newton's method for its time, all flights compiled by JAX."""

from scene import G, HEIGHT, IMPACTS, L, RHO, KAPPA, THETA, TOLERANCES, main, report


def run():
    import jax

    jax.config.update("jax_enable_x64", True)
    import diffrax
    import optimistix
    from jax import numpy

    def motion(t, state, args):
        return numpy.array([state[3], state[4], state[5], 0.0, -G, 0.0])

    def gap(t, y, args, **_):
        return y[1] - L * numpy.cos(y[2])

    def strike(state):
        """The strike of `scene.strike` in operations of JAX."""
        x, y, theta, x_dot, y_dot, theta_dot = state
        alpha = KAPPA * theta
        sin, cos, arm = numpy.sin(alpha), numpy.cos(alpha), L * numpy.sin(theta - alpha)
        impulse = -2 * (cos * y_dot - sin * x_dot + arm * theta_dot) / (1 + (arm / RHO) ** 2)
        return numpy.array([x, y, theta, x_dot - impulse * sin, y_dot + impulse * cos, theta_dot + impulse * arm / RHO**2])

    def compiled(tolerance):
        event = diffrax.Event(gap, optimistix.Newton(1e-14, 1e-14), direction=False)
        steps = diffrax.PIDController(rtol=tolerance, atol=tolerance)

        def bounce(carried, _):
            t, state = carried
            flight = diffrax.diffeqsolve(
                diffrax.ODETerm(motion), diffrax.Dopri8(), 0.0, 10.0, None, state, event=event, stepsize_controller=steps
            )
            t, state = t + flight.ts[-1], flight.ys[-1]
            return (t, strike(state)), numpy.concatenate([t[None], state])

        release = numpy.array([0.0, HEIGHT, THETA, 0.0, 0.0, 0.0])
        return jax.jit(lambda: jax.lax.scan(bounce, (numpy.array(0.0), release), length=IMPACTS)[1])

    for tolerance in TOLERANCES:
        flights = compiled(tolerance)

        def fly():
            return [(t, x, *rest) for t, x, _, *rest in flights().tolist()]

        fly()
        report("Diffrax", diffrax.__version__, f"Dopri8, rtol = atol = {tolerance:g}", fly, rounds=20)


if __name__ == "__main__":
    main("Diffrax", run)
