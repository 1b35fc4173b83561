"""SciPy: solve_ivp with an event, a flight at a time."""

import math

from scene import G, HEIGHT, IMPACTS, L, THETA, main, report, strike


def run():
    import scipy
    from scipy.integrate import solve_ivp

    def motion(_, state):
        return (state[3], state[4], state[5], 0.0, -G, 0.0)

    def gap(_, state):
        return state[1] - L * math.cos(state[2])

    gap.terminal, gap.direction = True, -1

    def fly(method, tolerance):
        impacts, t, state = [], 0.0, [0.0, HEIGHT, THETA, 0.0, 0.0, 0.0]
        for _ in range(IMPACTS):
            flight = solve_ivp(motion, (0.0, 10.0), state, method, events=gap, rtol=tolerance, atol=tolerance)
            t += flight.t_events[0][0]
            x, y, theta, *velocity = flight.y_events[0][0]
            impacts.append((t, x, theta, *velocity))
            state = [x, y, theta, *strike(theta, *velocity)]
        return impacts

    report("SciPy solve_ivp", scipy.__version__, "DOP853, rtol = atol = 1e-12", lambda: fly("DOP853", 1e-12), rounds=3)


if __name__ == "__main__":
    main("SciPy solve_ivp", run)
