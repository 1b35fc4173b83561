"""heyoka: Taylor's method compiled with LLVM, the strike in the callback of a terminal event."""

from scene import G, HEIGHT, IMPACTS, L, THETA, main, report, strike


def run():
    import heyoka

    x, y, theta, x_dot, y_dot, theta_dot = heyoka.make_vars("x", "y", "theta", "x_dot", "y_dot", "theta_dot")
    zero = heyoka.expression(0.0)
    motion = [(x, x_dot), (y, y_dot), (theta, theta_dot), (x_dot, zero), (y_dot, zero - G), (theta_dot, zero)]
    release = [0.0, HEIGHT, THETA, 0.0, 0.0, 0.0]
    impacts = []

    def bounce(integrator, _):
        x, _, theta, *velocity = integrator.state.tolist()
        impacts.append((integrator.time, x, theta, *velocity))
        integrator.state[3:] = strike(theta, *velocity)
        return len(impacts) < IMPACTS

    falls = heyoka.event_direction.negative
    contact = heyoka.t_event(y - L * heyoka.cos(theta), callback=bounce, direction=falls)
    flight = heyoka.taylor_adaptive(motion, release, t_events=[contact])

    def fly():
        impacts.clear()
        flight.reset_cooldowns()
        flight.time = 0.0
        flight.state[:] = release
        flight.propagate_until(40.0)
        return list(impacts)

    report("heyoka, Taylor events", heyoka.__version__, "compiled by LLVM, strike in Python", fly, rounds=20)


if __name__ == "__main__":
    main("heyoka, Taylor events", run)
