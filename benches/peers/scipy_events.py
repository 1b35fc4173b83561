"""SciPy: solve_ivp with an event, a flight at a time."""

from scene import HEIGHT, IMPACTS, THETA, TOLERANCES, gap, main, motion, report, strike


def run():
    import scipy
    from scipy.integrate import solve_ivp

    def height(_, state):
        return gap(state)

    height.terminal, height.direction = True, -1

    def fly(tolerance):
        impacts, t, state = [], 0.0, [0.0, HEIGHT, THETA, 0.0, 0.0, 0.0]
        for _ in range(IMPACTS):
            flight = solve_ivp(
                lambda _, state: motion(state), (0.0, 10.0), state, "DOP853", events=height, rtol=tolerance, atol=tolerance
            )
            t += flight.t_events[0][0]
            x, y, theta, *velocity = flight.y_events[0][0]
            impacts.append((t, x, theta, *velocity))
            state = [x, y, theta, *strike(theta, *velocity)]
        return impacts

    for tolerance in TOLERANCES:
        setting = f"DOP853, rtol = atol = {tolerance:g}"
        report("SciPy solve_ivp", scipy.__version__, setting, lambda: fly(tolerance), rounds=3)


if __name__ == "__main__":
    main("SciPy solve_ivp", run)
