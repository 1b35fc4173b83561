"""The features of the matrix, each as the fields that it sets on the base; null takes a field out."""

from mixes import merged

BASE = {
    "body": {"contact_distance": 0.1333, "radius_of_gyration": 0.0943},
    "table": {"tilt_gain": 1.1},
    "release": {"height": 0.2, "theta": 0.02},
}

FEATURES = {
    "angle bias": {"table": {"errors": {"angle_bias": 1e-3}}},
    "gain error": {"table": {"errors": {"tilt_gain": 0.02}}},
    "speed error": {"contact": {"restitution": 0.8}, "table": {"errors": {"speed": 0.05}}},
    "offset": {"body": {"offset": 1e-3}},
    "delay": {"table": {"delay": 0.003}},
    "predicted delay": {"table": {"delay": 0.003, "prediction": "flight"}},
    "turning": {"table": {"tilt_rate": "follows", "pivot": {"depth": 0.03}}},
    "turning in place": {"table": {"tilt_rate": "follows", "pivot": {"x": 0.02, "depth": 0.03}}},
    "turning, corrected": {"table": {"tilt_rate": "corrected", "pivot": {"x": 0.02, "depth": 0.03}}},
    "air drag": {"air": {"drag": 0.05}},
    "wind": {"air": {"drag": 0.05, "wind": 0.1}},
    "rotation drag": {"air": {"rotation_drag": 0.05}},
    "vertical energy": {"contact": {"restitution": 0.8}, "table": {"energy_gain": 0.2, "target_height": 0.25}},
    "total energy": {"contact": {"restitution": 0.8}, "table": {"energy_gain": 0.2, "target_height": 0.25, "energy_measure": "total"}},
    "one strike": {"contact": {"restitution": 0.8}, "table": {"energy_law": "one_strike", "target_height": 0.25}},
    "program": {"contact": {"restitution": 0.8}, "table": {"energy_law": "one_strike", "target_height": None, "program": [0.22, 0.25]}},
    "friction": {"contact": {"friction": 0.3}},
    "matched friction": {"contact": {"friction": 0.3}, "table": {"slide": "matched"}},
    "feedback": {"table": {"tilt_gain": None, "feedback": {"x": 0.06, "theta": -3.2, "x_dot": 1.08, "theta_dot": -0.07}}},
    "feedback of the angle": {"table": {"tilt_gain": None, "feedback": {"theta": -1.1, "theta_dot": 0.002}}},
    "wrong restitution": {"contact": {"restitution": 0.9}, "table": {"assumed_restitution": 0.95}},
    "still": {"table": {"strike": "still"}},
    "incline": {"incline": 0.7},
    "triangle": {"body": {"contact_distance": None, "radius_of_gyration": None, "contact_vertex": 0, "vertices": [[0, 0], [0.05, 0.2], [-0.05, 0.2]]}},
    "point mass": {"body": {"contact_distance": None, "radius_of_gyration": None, "point": True}, "release": {"theta": None, "x_dot": 0.02}},
    "length": {"table": {"length": 2}},
    "limits": {"table": {"limits": {"tilt": 1.0, "speed": 3.0}}},
    "noise": {"noise": {"timing_sd": 1e-3, "model": "strike", "seed": 1}},
    "noise of the plan": {"noise": {"timing_sd": 1e-3, "model": "plan", "seed": 1}},
}  # fmt: skip

# Fields of which a scene has one value: two such features are not a pair.
ALTERNATIVES = [
    {"air drag", "wind"},
    {"delay", "predicted delay"},
    {"turning", "turning in place", "turning, corrected"},
    {"vertical energy", "total energy", "one strike", "program"},
    {"friction", "matched friction"},
    {"feedback", "feedback of the angle"},
    {"noise", "noise of the plan"},
]


def is_pair(one, other):
    """True if two features can be in one scene as they are."""
    return not any({one, other} <= group for group in ALTERNATIVES)


def scene_of(*names):
    """The base with these features. A field that one of them takes out stays out."""
    scene = BASE
    for name in names:
        scene = merged(scene, FEATURES[name])
    for name in names:
        removed = {part: {key: None for key, value in fields.items() if value is None} for part, fields in FEATURES[name].items() if isinstance(fields, dict)}
        scene = merged(scene, removed)
    return scene
