"""CVODE of SUNDIALS (scikit-sundae): Adams' methods with a root function, a flight at a time."""

from scene import HEIGHT, IMPACTS, THETA, TOLERANCES, gap, main, motion, report, strike


def run():
    import numpy
    import sksundae
    from sksundae.cvode import CVODE

    def derivatives(_, state, result):
        result[:] = motion(state)

    def height(_, state, result):
        result[0] = gap(state)

    height.terminal, height.direction = [True], [-1]

    def fly(tolerance):
        impacts, t, state = [], 0.0, numpy.array([0.0, HEIGHT, THETA, 0.0, 0.0, 0.0])
        options = {"rtol": tolerance, "atol": tolerance, "max_num_steps": 100_000}
        solver = CVODE(derivatives, method="Adams", eventsfn=height, num_events=1, **options)
        for _ in range(IMPACTS):
            flight = solver.solve(numpy.array([0.0, 10.0]), state)
            t += flight.t[-1]
            x, y, theta, *velocity = flight.y[-1].tolist()
            impacts.append((t, x, theta, *velocity))
            state = numpy.array([x, y, theta, *strike(theta, *velocity)])
        return impacts

    for tolerance in TOLERANCES:
        setting = f"Adams, rtol = atol = {tolerance:g}"
        report("CVODE (scikit-sundae)", sksundae.__version__, setting, lambda: fly(tolerance), rounds=3)


if __name__ == "__main__":
    main("CVODE (scikit-sundae)", run)
