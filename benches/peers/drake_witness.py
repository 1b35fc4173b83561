"""Drake: a hybrid system with a witness function for the gap and an update for the strike."""

from scene import HEIGHT, IMPACTS, THETA, TOLERANCES, gap, main, motion, report, strike

STEP = 1e-2


def run():
    from importlib.metadata import version

    from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
    from pydrake.systems.framework import LeafSystem, UnrestrictedUpdateEvent, WitnessFunctionDirection

    class Rod(LeafSystem):
        def __init__(self):
            super().__init__()
            self.impacts = []
            self.DeclareContinuousState(3, 3, 0)
            self.gap = self.MakeWitnessFunction(
                "gap",
                WitnessFunctionDirection.kPositiveThenNonPositive,
                lambda context: gap(context.get_continuous_state_vector()),
                UnrestrictedUpdateEvent(self.strike),
            )

        def DoCalcTimeDerivatives(self, context, derivatives):
            state = context.get_continuous_state_vector()
            derivatives.get_mutable_vector().SetFromVector(motion(state))

        def DoGetWitnessFunctions(self, context):
            return [self.gap]

        def strike(self, context, event, state):
            x, y, theta, *velocity = context.get_continuous_state_vector().CopyToVector()
            self.impacts.append((context.get_time(), x, theta, *velocity))
            after = [x, y, theta, *strike(theta, *velocity)]
            state.get_mutable_continuous_state().get_mutable_vector().SetFromVector(after)

    def fly(accuracy):
        rod = Rod()
        simulator = Simulator(rod)
        ResetIntegratorFromFlags(simulator, "runge_kutta3", STEP)
        integrator = simulator.get_mutable_integrator()
        integrator.set_target_accuracy(accuracy)
        context = simulator.get_mutable_context()
        # Witness functions are isolated to the context's accuracy.
        context.SetAccuracy(accuracy)
        context.SetContinuousState([0.0, HEIGHT, THETA, 0.0, 0.0, 0.0])
        simulator.Initialize()
        while len(rod.impacts) < IMPACTS and context.get_time() < 40.0:
            simulator.AdvanceTo(context.get_time() + 0.5)
        return rod.impacts[:IMPACTS]

    for accuracy in TOLERANCES:
        setting = f"Runge-Kutta 3, steps to {STEP:g} s, accuracy {accuracy:g}"
        report("Drake, hybrid system", version("drake"), setting, lambda: fly(accuracy))


if __name__ == "__main__":
    main("Drake, hybrid system", run)
