"""Numba: the map written by hand, with Newton's iteration for the contact time."""

import math

from scene import G, HEIGHT, IMPACTS, L, THETA, main, report, strike


def run():
    import numba

    bounce = numba.njit(strike)

    @numba.njit
    def fly(n):
        impacts = []
        t, x, h = 0.0, 0.0, HEIGHT - L * math.cos(THETA)
        theta, x_dot, y_dot, theta_dot = THETA, 0.0, 0.0, 0.0
        for _ in range(n):
            # The rod cannot be higher than this time allows: Newton comes down from the right.
            part = (y_dot + math.sqrt(y_dot * y_dot + 2 * G * (h + 2 * L))) / G
            cos = math.cos(theta)
            for _ in range(100):
                angle = theta + theta_dot * part
                gap = h + y_dot * part - 0.5 * G * part * part + L * (cos - math.cos(angle))
                step = gap / (y_dot - G * part + L * theta_dot * math.sin(angle))
                part -= step
                if abs(step) <= 1e-15 * part:
                    break
            t, x, h = t + part, x + x_dot * part, 0.0
            theta, y_dot = theta + theta_dot * part, y_dot - G * part
            impacts.append((t, x, theta, x_dot, y_dot, theta_dot))
            x_dot, y_dot, theta_dot = bounce(theta, x_dot, y_dot, theta_dot)
        return impacts

    report("Numba, map by hand", numba.__version__, "njit, Newton", lambda: fly(IMPACTS), rounds=200)


if __name__ == "__main__":
    main("Numba, map by hand", run)
