"""Random scenes: a rod, and two to four features of the physics with random values."""

# Most rods in these ranges keep bouncing for a while.
BODY = {"contact_distance": (0.12, 0.15), "radius_of_gyration": (0.085, 0.11)}
RELEASE = {"height": (0.04, 0.14), "theta": (-0.05, 0.05), "theta_dot": (-0.05, 0.05), "x_dot": (-0.03, 0.03)}

# Feature: the fields that it sets. A pair is a range to draw from, a list is a choice, null takes a field out.
FEATURES = {
    "angle bias": {"table": {"errors": {"angle_bias": (-0.005, 0.005)}}},
    "gain error": {"table": {"errors": {"tilt_gain": (-0.05, 0.05)}}},
    "speed error": {"contact": {"restitution": (0.6, 0.95)}, "table": {"errors": {"speed": (-0.1, 0.1)}}},
    "offset": {"body": {"offset": (-0.003, 0.003)}},
    "delay": {"table": {"delay": (0.0005, 0.01)}},
    "predicted delay": {"table": {"delay": (0.0005, 0.01), "prediction": "flight"}},
    "turning": {"table": {"tilt_rate": "follows", "pivot": {"depth": (-0.05, 0.05)}}},
    "turning in place": {"table": {"tilt_rate": "follows", "pivot": {"x": (-0.05, 0.05)}}},
    "turning, corrected": {"table": {"tilt_rate": "corrected", "pivot": {"depth": (-0.05, 0.05)}}},
    "air drag": {"air": {"drag": (0.01, 0.1)}},
    "wind": {"air": {"drag": (0.01, 0.1), "wind": (-0.2, 0.2)}},
    "rotation drag": {"air": {"rotation_drag": (0.01, 0.3)}},
    "vertical energy": {"contact": {"restitution": (0.6, 0.95)}, "table": {"energy_gain": (0.05, 0.3), "target_height": (0.15, 0.35)}},
    "total energy": {
        "contact": {"restitution": (0.6, 0.95)},
        "table": {"energy_gain": (0.05, 0.3), "target_height": (0.15, 0.35), "energy_measure": "total"},
    },
    "one strike": {
        "contact": {"restitution": (0.6, 0.95)},
        "table": {"energy_law": "one_strike", "target_height": (0.15, 0.35)},
    },
    "program": {"table": {"energy_law": "one_strike", "program": [[0.2, 0.3], [0.15, 0.25], [0.2, 0.25, 0.3]]}},
    "friction": {"contact": {"friction": (0.02, 0.6), "law": ["poisson", "newton", "stronge"]}},
    "matched friction": {
        "contact": {"friction": (0.02, 0.6), "law": ["poisson", "newton", "stronge"]},
        "table": {"slide": "matched"},
    },
    "feedback": {
        "table": {
            "tilt_gain": None,
            "feedback": {"x": (0.05, 0.07), "theta": (-3.4, -3.0), "x_dot": (1.0, 1.15), "theta_dot": (-0.08, -0.065)},
        }
    },
    "feedback of the angle": {"table": {"tilt_gain": None, "feedback": {"theta": (0.9, 1.4), "theta_dot": (-0.02, 0.02)}}},
    "wrong restitution": {"contact": {"restitution": (0.85, 1.0)}, "table": {"assumed_restitution": (0.9, 0.97)}},
    "still": {"contact": {"restitution": [1, 0.9, 0.5, 0.2]}, "table": {"strike": "still"}},
    "incline": {"incline": (0.3, 1.3)},
    "triangle": {"body": {"contact_distance": None, "radius_of_gyration": None, "contact_vertex": 0, "vertices": [[[0, 0], [0.05, 0.2], [-0.05, 0.2]], [[0, 0], [0.12, 0.2], [-0.12, 0.2]]]}},
    "point mass": {
        "body": {"contact_distance": None, "radius_of_gyration": None, "point": True},
        "table": {"tilt_gain": (0.2, 1.2)},
        "release": {"theta": None, "theta_dot": None, "x_dot": (-0.5, 0.5)},
    },
    "length": {"table": {"length": (0.3, 3.0)}},
    "limits": {"table": {"limits": {"tilt": (0.1, 1.0), "speed": (0.2, 3.0)}}},
    "noise": {"noise": {"timing_sd": (0.0, 0.004), "model": "strike", "seed": [1, 2, 3]}},
    "noise of the plan": {"noise": {"timing_sd": (0.0, 0.004), "model": "plan", "seed": [1, 2, 3]}},
}

# Features without noise, for resources that refuse it.
QUIET = [name for name in FEATURES if not name.startswith("noise")]


def merged(scene, patch):
    """A scene with the fields of a patch; null takes a field out (RFC 7396)."""
    scene = dict(scene)
    for name, value in patch.items():
        if value is None:
            scene.pop(name, None)
        elif isinstance(value, dict):
            scene[name] = merged(scene.get(name, {}), value)
        else:
            scene[name] = value
    return scene


def drawn(random, patch):
    """A patch with values in place of ranges and choices."""
    if isinstance(patch, dict):
        return {name: drawn(random, value) for name, value in patch.items()}
    if isinstance(patch, tuple):
        return round(random.uniform(*patch), 6)
    return random.choice(patch) if isinstance(patch, list) else patch


def mix(random, features=tuple(FEATURES)):
    """A rod and its features: names and scene."""
    names = random.sample(features, random.randint(2, 4))
    scene = {
        "body": BODY,
        "table": {"tilt_gain": (1.0, 1.3)},
        "release": RELEASE,
    }
    scene = drawn(random, scene)
    # Released above the height at which it stands.
    scene["release"]["height"] = round(scene["release"]["height"] + scene["body"]["contact_distance"], 6)
    for name in names:
        scene = merged(scene, drawn(random, FEATURES[name]))
    return names, scene
