"""A rigid body in the plane, struck and held by a table: a simulation from the equations of motion, for tests/oracle/catches.py.

Written from mechanics, not from the server's code: Newton's and Euler's equations, the law of restitution, and a constraint force
that is solved for at every step. Only the standard library. Units m, s, rad; unit mass.
"""

from dataclasses import dataclass, replace
from math import copysign, cos, sin, sqrt


@dataclass(frozen=True)
class Body:
    """A body with one contact point, l below its centre of gravity (CG) when upright."""

    l: float
    rho: float
    gravity: float
    restitution: float
    friction: float = 0.0


@dataclass(frozen=True)
class State:
    """Place and velocity of the CG, angle and spin, at time t."""

    t: float
    x: float
    y: float
    theta: float
    x_dot: float
    y_dot: float
    theta_dot: float


def contact_velocity(body, s):
    """Horizontal and vertical velocity of the contact point."""
    turn = body.l * s.theta_dot
    return s.x_dot + turn * cos(s.theta), s.y_dot + turn * sin(s.theta)


def gap(body, s):
    """Height of the contact point."""
    return s.y - body.l * cos(s.theta)


def fly(body, s, dt):
    g = body.gravity
    return replace(
        s,
        t=s.t + dt,
        x=s.x + s.x_dot * dt,
        y=s.y + s.y_dot * dt - g * dt * dt / 2,
        theta=s.theta + s.theta_dot * dt,
        y_dot=s.y_dot - g * dt,
    )


def fall(body, s, longest=10.0):
    """The state at which the contact point next comes down to height 0, or None if it does not rise.

    The gap's second derivative is at least −(G + lθ̇²), so a step that would bring a parabola of that curvature to 0 cannot pass a
    contact. Bisection finds the contact within the last step.
    """
    curvature = body.gravity + body.l * s.theta_dot**2
    dt, before = 0.0, 0.0
    height, speed = gap(body, s), contact_velocity(body, s)[1]
    if abs(height) < 1e-12 * body.l:
        height = 0.0
        if speed <= 0:
            return None
    while True:
        step = (speed + sqrt(speed * speed + 2 * curvature * height)) / curvature
        before, dt = dt, dt + 0.9 * step + 1e-7
        s_then = fly(body, s, dt)
        height, speed = gap(body, s_then), contact_velocity(body, s_then)[1]
        if height <= 0:
            break
        if dt > longest:
            return None
    low, high = before, dt
    for _ in range(200):
        middle = (low + high) / 2
        if middle in (low, high):
            break
        if gap(body, fly(body, s, middle)) > 0:
            low = middle
        else:
            high = middle
    return fly(body, s, high)


def push(body, s, alpha, normal, tangential):
    """The state after an impulse at the contact point, along the normal of a table at angle alpha and along the table."""
    x = tangential * cos(alpha) - normal * sin(alpha)
    y = tangential * sin(alpha) + normal * cos(alpha)
    # Moment of the impulse about the CG; the contact point is (l sin θ, −l cos θ) from it.
    moment = body.l * sin(s.theta) * y + body.l * cos(s.theta) * x
    return replace(s, x_dot=s.x_dot + x, y_dot=s.y_dot + y, theta_dot=s.theta_dot + moment / body.rho**2)


def along(body, s, alpha):
    """Velocity of the contact point along the table's normal, and along the table."""
    x, y = contact_velocity(body, s)
    return y * cos(alpha) - x * sin(alpha), x * cos(alpha) + y * sin(alpha)


def responses(body, s, alpha):
    """Change of the contact point's velocity along normal and table by a unit impulse along the normal, and by one along the table."""
    before = along(body, s, alpha)
    pushes = push(body, s, alpha, 1.0, 0.0), push(body, s, alpha, 0.0, 1.0)
    return [[b - a for a, b in zip(before, along(body, pushed, alpha))] for pushed in pushes]


def strike(body, s, alpha, table_velocity, table_tangential=None):
    """The state after a strike of a table that moves at `table_velocity` along its normal, and the two impulses; None if it pulls.

    The law of restitution is Poisson's. Along itself the table moves at `table_tangential`, or with the contact point. The tangential
    impulse follows the normal one: sliding with ∓μ until the contact point is at rest on the table, then sticking or sliding.
    """
    normal, tangential = along(body, s, alpha)
    approach = normal - table_velocity
    if approach >= 0:
        return None
    by_normal, by_tangential = responses(body, s, alpha)
    slip = 0.0 if table_tangential is None else tangential - table_tangential
    mu = body.friction
    # The slope of the tangential impulse at rest on the table: that of sticking, if friction allows it.
    rest = max(-mu, min(mu, -by_normal[1] / by_tangential[1]))
    # Pieces (slope, length in normal impulse); the last has no end.
    pieces = [(rest, float("inf"))]
    if mu > 0 and slip != 0:
        slope = -mu if slip > 0 else mu
        rate = by_normal[1] + slope * by_tangential[1]
        stops = -slip / rate if slip * rate < 0 else float("inf")
        pieces = [(slope, stops), (rest, float("inf"))]
    compressed = velocity = 0.0
    for slope, length in pieces:
        rate = by_normal[0] + slope * by_tangential[0]
        if velocity + rate * length >= -approach:
            compressed += (-approach - velocity) / rate
            break
        compressed, velocity = compressed + length, velocity + rate * length
    impulse = (1 + body.restitution) * compressed
    along_table, left = 0.0, impulse
    for slope, length in pieces:
        along_table, left = along_table + slope * min(left, length), left - min(left, length)
    return push(body, s, alpha, impulse, along_table), impulse, along_table


def contact_accelerations(body, s, alpha, normal, tangential):
    """Accelerations of x and θ, and of the contact point along x and y, under forces of the table."""
    force_x = tangential * cos(alpha) - normal * sin(alpha)
    force_y = tangential * sin(alpha) + normal * cos(alpha)
    spin = (body.l * sin(s.theta) * force_y + body.l * cos(s.theta) * force_x) / body.rho**2
    centripetal = body.l * s.theta_dot**2
    contact_x = force_x + body.l * spin * cos(s.theta) - centripetal * sin(s.theta)
    contact_y = force_y - body.gravity + body.l * spin * sin(s.theta) + centripetal * cos(s.theta)
    return force_x, spin, contact_x, contact_y


def touch(body, s, alpha, lift, slide=None, share=0.0):
    """Force of the table and accelerations (N, F, ẍ, θ̈) that give the contact point the vertical acceleration `lift`.

    Without `slide` the force along the table is `share` of the normal force; with it the contact point accelerates along x at
    `slide`, and the table is level.
    """
    zero = contact_accelerations(body, s, alpha, 0.0, 0.0)
    if slide is None:
        one = contact_accelerations(body, s, alpha, 1.0, share)
        normal = (lift - zero[3]) / (one[3] - zero[3])
        tangential = share * normal
    else:
        one, other = contact_accelerations(body, s, alpha, 1.0, 0.0), contact_accelerations(body, s, alpha, 0.0, 1.0)
        a, b, c = one[2] - zero[2], other[2] - zero[2], slide - zero[2]
        d, e, f = one[3] - zero[3], other[3] - zero[3], lift - zero[3]
        normal, tangential = (c * e - b * f) / (a * e - b * d), (a * f - c * d) / (a * e - b * d)
    x_ddot, theta_ddot, _, _ = contact_accelerations(body, s, alpha, normal, tangential)
    return normal, tangential, x_ddot, theta_ddot


@dataclass
class Held:
    """A motion in contact up to its end."""

    reason: str
    s: State
    least_friction: float
    # States at the times that were asked for, and tilts of the table.
    states: list
    tilts: list


def hold(body, s, laws, times, speed=0.0, brake=0.0, step=1e-3, topple=1.5707963267948966, tilt=None):
    """Follows the body in contact up to the last of `times`, by Runge-Kutta steps of order 4.

    The table's surface moves vertically at `speed` at first and is brought to rest by `brake`; `laws` are the law until then and the one
    after it: a pair of "tilt" (rad) or "cart" (m/s²) and K of −K·(x, θ, ẋ, θ̇). A table tilts about the contact point. A cart stays level
    and accelerates along x. The contact begins with the table at `tilt`, or with that of its law. Where the law asks for another one, the table
    goes there by 1 rad in the time in which a lean grows e-fold.
    """
    stands = s.t + (abs(speed) / brake if speed else 0.0)
    lift = -brake if speed > 0 else brake
    least, states, tilts = 0.0, [], []
    growth = (body.gravity * body.l) ** 0.5 / body.rho

    def asked(s, law):
        kind, gain = law
        return kind == "cart", -(gain[0] * s.x + gain[1] * s.theta + gain[2] * s.x_dot + gain[3] * s.theta_dot)

    def law_tilt(s, law):
        cart, value = asked(s, law)
        return 0.0 if cart else value

    def begun(s, law, tilt):
        """The way of the table from a tilt to its law: time, tilt and rate at its beginning."""
        change = law_tilt(s, law) - tilt
        return (s.t, tilt, copysign(growth, change)) if abs(change) > 1e-9 else None

    def tilted(s, law, way):
        return way[1] + way[2] * (s.t - way[0]) if way else law_tilt(s, law)

    def rates(s, law, lift, way):
        cart, value = asked(s, law)
        normal, tangential, x_ddot, theta_ddot = touch(body, s, tilted(s, law, way), lift, slide=value if cart else None)
        return (s.x_dot, s.theta_dot, x_ddot, theta_ddot), normal, tangential

    def moved(s, rate, h):
        x, theta, x_dot, theta_dot = s.x + h * rate[0], s.theta + h * rate[1], s.x_dot + h * rate[2], s.theta_dot + h * rate[3]
        return State(s.t + h, x, s.y, theta, x_dot, s.y_dot, theta_dot)

    def stepped(s, law, lift, way, h):
        first = rates(s, law, lift, way)[0]
        second = rates(moved(s, first, h / 2), law, lift, way)[0]
        third = rates(moved(s, second, h / 2), law, lift, way)[0]
        fourth = rates(moved(s, third, h), law, lift, way)[0]
        return moved(s, [(a + 2 * b + 2 * c + d) / 6 for a, b, c, d in zip(first, second, third, fourth)], h)

    def arrived(s, law, way):
        return (law_tilt(s, law) - tilted(s, law, way)) * way[2] <= 0

    way, before = None, None
    for time in times:
        while s.t < time - 1e-12:
            braking = s.t < stands - 1e-12
            law, up = (laws[0], lift) if braking else (laws[1], 0.0)
            if before is None:
                way = None if tilt is None else begun(s, law, tilt)
            elif law is not before:
                way = begun(s, law, tilted(s, before, way))
            before = law
            _, normal, tangential = rates(s, law, up, way)
            if normal <= 0:
                return Held("contact lost", s, least, states, tilts)
            # A strong push changes fast.
            longest = (step / 4 if braking else step) * min(1.0, body.gravity / normal)
            h = min(longest, time - s.t, stands - s.t if braking else longest)
            if abs(s.theta) >= topple:
                return Held("toppled", s, least, states, tilts)
            least = max(least, abs(tangential) / normal)
            after = stepped(s, law, up, way, h)
            if way and arrived(after, law, way):
                low, high = 0.0, h
                for _ in range(50):
                    middle = (low + high) / 2
                    low, high = (low, middle) if arrived(stepped(s, law, up, way, middle), law, way) else (middle, high)
                after, way = stepped(s, law, up, way, high), None
            s = after
        states.append(s)
        tilts.append(tilted(s, before, way) if before else None)
    return Held("completed", s, least, states, tilts)


def solved(a, b):
    """X of AX = B, by Gauss and Jordan's elimination with pivots."""
    n = len(a)
    rows = [list(map(float, a[i])) + list(map(float, b[i])) for i in range(n)]
    for i in range(n):
        pivot = max(range(i, n), key=lambda k: abs(rows[k][i]))
        rows[i], rows[pivot] = rows[pivot], rows[i]
        rows[i] = [value / rows[i][i] for value in rows[i]]
        for k in range(n):
            if k != i and rows[k][i]:
                factor = rows[k][i]
                rows[k] = [x - factor * y for x, y in zip(rows[k], rows[i])]
    return [row[n:] for row in rows]


def optimal_gain(a, b, state_weights, input_weight):
    """K of the linear-quadratic regulator of s' = As + Bu, u = −Ks, by the sign of the Hamiltonian matrix (Roberts, 1971)."""
    n = len(a)
    unit = [[float(i == j) for j in range(2 * n)] for i in range(2 * n)]
    z = [list(map(float, row)) + [-b[i] * v / input_weight for v in b] for i, row in enumerate(a)]
    z += [[-state_weights[i] * (i == j) for j in range(n)] + [-a[j][i] for j in range(n)] for i in range(n)]
    for _ in range(100):
        inverse = solved(z, unit)
        size, other = (sum(v * v for row in m for v in row) for m in (z, inverse))
        c = (other / size) ** 0.25
        moved = [[(c * x + y / c) / 2 for x, y in zip(*rows)] for rows in zip(z, inverse)]
        change = max(abs(x - y) for rows in zip(z, moved) for x, y in zip(*rows))
        z = moved
        if change < 1e-13 * max(abs(v) for row in z for v in row):
            break
    # (W + 1) (1, P) = 0: eight equations for each column of P, of which the normal equations are solved.
    left = [[z[i][n + j] + (i == n + j) for j in range(n)] for i in range(2 * n)]
    right = [[-z[i][j] - (i == j) for j in range(n)] for i in range(2 * n)]

    def normal(m):
        return [[sum(left[k][i] * m[k][j] for k in range(2 * n)) for j in range(n)] for i in range(n)]

    p = solved(normal(left), normal(right))
    return [sum(b[k] * p[k][j] for k in range(n)) / input_weight for j in range(n)]


def contact_law(body, push, state_weights, input_weight):
    """The law that holds the body upright on a table that pushes with `push` (m/s²): G at rest, G + a while it brakes.

    Without friction the table tilts. With friction it is a cart, whose acceleration a costs as much as a tilt of a/push.
    """
    if body.friction == 0:
        stiffness = push * body.l / body.rho**2
        a = [[0, 0, 1, 0], [0, 0, 0, 1], [0, 0, 0, 0], [0, stiffness, 0, 0]]
        return "tilt", optimal_gain(a, [0, 0, -push, -stiffness], state_weights, input_weight)
    turning = body.l / (body.l**2 + body.rho**2)
    # (l² + ρ²)θ̈ = l(push θ + a), ẍ = a − lθ̈.
    a = [[0, 0, 1, 0], [0, 0, 0, 1], [0, -body.l * turning * push, 0, 0], [0, turning * push, 0, 0]]
    b = [0, 0, 1 - body.l * turning, turning]
    return "cart", optimal_gain(a, b, state_weights, input_weight / push**2)
