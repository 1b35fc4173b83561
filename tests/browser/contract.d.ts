// The shapes of requests and answers. Written by `node tests/browser/contract.js` from openapi.yaml; not to be edited.

export type paths = Record<string, never>;
export type webhooks = Record<string, never>;
export interface components {
    schemas: {
        "scene.body.contact_distance": number;
        "scene.body.radius_of_gyration": number;
        "scene.body.point": boolean;
        "scene.body.offset": number;
        "scene.body.contact_vertex": number;
        "scene.gravity": number;
        "scene.incline": number;
        "scene.air.drag": number;
        "scene.air.rotation_drag": number;
        "scene.air.wind": number;
        "scene.contact.restitution": number;
        "scene.contact.friction": number;
        /** @enum {string} */
        "scene.contact.law": "poisson" | "newton" | "stronge";
        "scene.table.tilt_gain": number;
        "scene.table.energy_gain": number;
        "scene.table.target_height": number;
        /** @enum {string} */
        "scene.table.energy_measure": "vertical" | "total";
        /** @enum {string} */
        "scene.table.energy_law": "proportional" | "one_strike";
        "scene.table.program": number[];
        /** @enum {string} */
        "scene.table.strike": "compensated" | "still";
        /** @enum {string} */
        "scene.table.slide": "none" | "matched";
        "scene.table.feedback.x": number;
        "scene.table.feedback.theta": number;
        "scene.table.feedback.x_dot": number;
        "scene.table.feedback.theta_dot": number;
        "scene.table.assumed_restitution": number;
        "scene.table.errors.angle_bias": number;
        "scene.table.errors.tilt_offset": number;
        "scene.table.errors.tilt_gain": number;
        "scene.table.errors.speed": number;
        /** @enum {string} */
        "scene.table.tilt_rate": "none" | "follows" | "corrected";
        "scene.table.pivot.x": number;
        "scene.table.pivot.depth": number;
        "scene.table.delay": number;
        /** @enum {string} */
        "scene.table.prediction": "none" | "flight";
        "scene.table.length": number;
        "scene.table.limits.tilt": number;
        "scene.table.limits.tilt_rate": number;
        "scene.table.limits.speed": number;
        "scene.table.limits.stroke": number;
        "scene.release.height": number;
        "scene.release.theta": number;
        "scene.release.theta_dot": number;
        "scene.release.x": number;
        "scene.release.x_dot": number;
        "scene.release.y_dot": number;
        "scene.topple_angle": number;
        "scene.noise.timing_sd": number;
        "scene.noise.angle_sd": number;
        "scene.noise.x_sd": number;
        "scene.noise.x_dot_sd": number;
        "scene.noise.y_dot_sd": number;
        "scene.noise.theta_dot_sd": number;
        "scene.noise.restitution_sd": number;
        /** @enum {string} */
        "scene.noise.model": "strike" | "plan";
        /** Format: int64 */
        "scene.noise.seed": number;
        /** Format: int64 */
        "scene.noise.run": number;
        /** @default 100 */
        "ladder.impacts": number;
        /** @default 0.001 */
        "ladder.tolerance": number;
        /** @default 1000 */
        "previews.impacts": number;
        /** @default 100 */
        "trajectories.impacts": number;
        /**
         * @default auto
         * @enum {string}
         */
        "trajectories.method": "auto" | "linear" | "map" | "extended";
        "trajectories.tolerance": number;
        /** Format: int64 */
        "trajectories.epoch": number;
        /** @default 0 */
        "trajectories.hold": number;
        /** @default 0 */
        "trajectories.samples_per_flight": number;
        "state.theta": number;
        "state.x_dot": number;
        "state.y_dot": number;
        "state.theta_dot": number;
        "state.x": number;
        /** @default 1 */
        "jacobians.period": number;
        /** @default 200 */
        "ensemble.runs": number;
        /** @default 400 */
        "ensemble.impacts": number;
        /** Format: int64 */
        "ensemble.seed": number;
        "periodic-orbits.period": number;
        /** @enum {string} */
        "periodic-orbits.family": "symmetric";
        "periodic-orbits.theta": number;
        "periodic-orbits.sweep.parameter": string;
        "periodic-orbits.sweep.from": number;
        "periodic-orbits.sweep.to": number;
        /** @default 200 */
        "periodic-orbits.sweep.points": number;
        /** @default 100 */
        "precision.impacts": number;
        /**
         * @default time
         * @enum {string}
         */
        "precision.axis": "time" | "evaluations" | "steps";
        /** @default 2000 */
        "stability.impacts": number;
        /** @default false */
        "stability.basin": boolean;
        /** @default false */
        "stability.budget": boolean;
        /** @default false */
        "stability.gain_margins": boolean;
        /** @default false */
        "stability.dial": boolean;
        "stability.tolerances.contact_distance": number;
        "stability.tolerances.radius_of_gyration": number;
        "stability.tolerances.restitution": number;
        "stability.tolerances.parameter": string;
        "stability.tolerances.tolerance": number;
        /** @enum {string} */
        "controllers.contact": "frictionless" | "stick";
        /** @default 1 */
        "controllers.weights.state.x": number;
        /** @default 10 */
        "controllers.weights.state.theta": number;
        /** @default 0.1 */
        "controllers.weights.state.x_dot": number;
        /** @default 0.1 */
        "controllers.weights.state.theta_dot": number;
        /** @default 10 */
        "controllers.weights.input": number;
        /**
         * @default auto
         * @enum {string}
         */
        "catches.strategy": "auto" | "bounce_down" | "plan" | "brake";
        "catches.ratio": number;
        "catches.strikes": number;
        "catches.brake": number;
        /** @default 6 */
        "catches.hold": number;
        /** @default 0.005 */
        "catches.hold_speed": number;
        /** @default 200 */
        "catches.hold_samples": number;
        "throws.impact": number;
        "throws.apex.height": number;
        /** @default 0 */
        "throws.apex.theta": number;
        /** @enum {string} */
        PresetName: "case-1" | "case-2" | "case-2-figure" | "case-3" | "case-4" | "case-5" | "critical-soft" | "critical-hard" | "true-triangle" | "triangle-polygon" | "point-mass" | "still-lossy" | "case-1-noise" | "case-4-noise" | "case-4-total" | "air-table" | "juggling" | "rough-matched" | "rough-feedback" | "rough-noise" | "rough-catch" | "rough-juggling";
        Vertices: number[][];
        ScenePatch: {
            body?: {
                contact_distance?: components["schemas"]["scene.body.contact_distance"] | null;
                radius_of_gyration?: components["schemas"]["scene.body.radius_of_gyration"] | null;
                point?: components["schemas"]["scene.body.point"] | null;
                offset?: components["schemas"]["scene.body.offset"] | null;
                vertices?: components["schemas"]["Vertices"] | null;
                contact_vertex?: components["schemas"]["scene.body.contact_vertex"] | null;
            } | null;
            gravity?: components["schemas"]["scene.gravity"] | null;
            incline?: components["schemas"]["scene.incline"] | null;
            air?: {
                drag?: components["schemas"]["scene.air.drag"] | null;
                rotation_drag?: components["schemas"]["scene.air.rotation_drag"] | null;
                wind?: components["schemas"]["scene.air.wind"] | null;
            } | null;
            contact?: {
                restitution?: components["schemas"]["scene.contact.restitution"] | null;
                friction?: components["schemas"]["scene.contact.friction"] | null;
                law?: components["schemas"]["scene.contact.law"] | null;
            } | null;
            table?: {
                tilt_gain?: components["schemas"]["scene.table.tilt_gain"] | null;
                energy_gain?: components["schemas"]["scene.table.energy_gain"] | null;
                target_height?: components["schemas"]["scene.table.target_height"] | null;
                energy_measure?: components["schemas"]["scene.table.energy_measure"] | null;
                energy_law?: components["schemas"]["scene.table.energy_law"] | null;
                program?: components["schemas"]["scene.table.program"] | null;
                strike?: components["schemas"]["scene.table.strike"] | null;
                slide?: components["schemas"]["scene.table.slide"] | null;
                feedback?: {
                    x?: components["schemas"]["scene.table.feedback.x"] | null;
                    theta?: components["schemas"]["scene.table.feedback.theta"] | null;
                    x_dot?: components["schemas"]["scene.table.feedback.x_dot"] | null;
                    theta_dot?: components["schemas"]["scene.table.feedback.theta_dot"] | null;
                } | null;
                assumed_restitution?: components["schemas"]["scene.table.assumed_restitution"] | null;
                errors?: {
                    angle_bias?: components["schemas"]["scene.table.errors.angle_bias"] | null;
                    tilt_offset?: components["schemas"]["scene.table.errors.tilt_offset"] | null;
                    tilt_gain?: components["schemas"]["scene.table.errors.tilt_gain"] | null;
                    speed?: components["schemas"]["scene.table.errors.speed"] | null;
                } | null;
                tilt_rate?: components["schemas"]["scene.table.tilt_rate"] | null;
                pivot?: {
                    x?: components["schemas"]["scene.table.pivot.x"] | null;
                    depth?: components["schemas"]["scene.table.pivot.depth"] | null;
                } | null;
                delay?: components["schemas"]["scene.table.delay"] | null;
                prediction?: components["schemas"]["scene.table.prediction"] | null;
                length?: components["schemas"]["scene.table.length"] | null;
                limits?: {
                    tilt?: components["schemas"]["scene.table.limits.tilt"] | null;
                    tilt_rate?: components["schemas"]["scene.table.limits.tilt_rate"] | null;
                    speed?: components["schemas"]["scene.table.limits.speed"] | null;
                    stroke?: components["schemas"]["scene.table.limits.stroke"] | null;
                } | null;
            } | null;
            release?: {
                height?: components["schemas"]["scene.release.height"] | null;
                theta?: components["schemas"]["scene.release.theta"] | null;
                theta_dot?: components["schemas"]["scene.release.theta_dot"] | null;
                x?: components["schemas"]["scene.release.x"] | null;
                x_dot?: components["schemas"]["scene.release.x_dot"] | null;
                y_dot?: components["schemas"]["scene.release.y_dot"] | null;
            } | null;
            topple_angle?: components["schemas"]["scene.topple_angle"] | null;
            noise?: {
                timing_sd?: components["schemas"]["scene.noise.timing_sd"] | null;
                angle_sd?: components["schemas"]["scene.noise.angle_sd"] | null;
                x_sd?: components["schemas"]["scene.noise.x_sd"] | null;
                x_dot_sd?: components["schemas"]["scene.noise.x_dot_sd"] | null;
                y_dot_sd?: components["schemas"]["scene.noise.y_dot_sd"] | null;
                theta_dot_sd?: components["schemas"]["scene.noise.theta_dot_sd"] | null;
                restitution_sd?: components["schemas"]["scene.noise.restitution_sd"] | null;
                model?: components["schemas"]["scene.noise.model"] | null;
                seed?: components["schemas"]["scene.noise.seed"] | null;
                run?: components["schemas"]["scene.noise.run"] | null;
            } | null;
        };
        Scene: {
            body: {
                contact_distance: components["schemas"]["scene.body.contact_distance"];
                radius_of_gyration: components["schemas"]["scene.body.radius_of_gyration"];
                offset?: components["schemas"]["scene.body.offset"];
            } | {
                point: components["schemas"]["scene.body.point"];
            } | {
                vertices: components["schemas"]["Vertices"];
                contact_vertex: components["schemas"]["scene.body.contact_vertex"];
            };
            gravity: components["schemas"]["scene.gravity"];
            incline: components["schemas"]["scene.incline"];
            air?: {
                drag?: components["schemas"]["scene.air.drag"];
                rotation_drag?: components["schemas"]["scene.air.rotation_drag"];
                wind?: components["schemas"]["scene.air.wind"];
            };
            contact: {
                restitution: components["schemas"]["scene.contact.restitution"];
                friction: components["schemas"]["scene.contact.friction"];
                law: components["schemas"]["scene.contact.law"];
            };
            table: {
                tilt_gain?: components["schemas"]["scene.table.tilt_gain"] | null;
                energy_gain: components["schemas"]["scene.table.energy_gain"];
                target_height?: components["schemas"]["scene.table.target_height"] | null;
                energy_measure?: components["schemas"]["scene.table.energy_measure"];
                energy_law?: components["schemas"]["scene.table.energy_law"];
                program?: components["schemas"]["scene.table.program"];
                strike: components["schemas"]["scene.table.strike"];
                slide: components["schemas"]["scene.table.slide"];
                feedback?: {
                    x?: components["schemas"]["scene.table.feedback.x"];
                    theta?: components["schemas"]["scene.table.feedback.theta"];
                    x_dot?: components["schemas"]["scene.table.feedback.x_dot"];
                    theta_dot?: components["schemas"]["scene.table.feedback.theta_dot"];
                } | null;
                assumed_restitution?: components["schemas"]["scene.table.assumed_restitution"] | null;
                errors?: {
                    angle_bias?: components["schemas"]["scene.table.errors.angle_bias"];
                    tilt_offset?: components["schemas"]["scene.table.errors.tilt_offset"];
                    tilt_gain?: components["schemas"]["scene.table.errors.tilt_gain"];
                    speed?: components["schemas"]["scene.table.errors.speed"];
                };
                tilt_rate?: components["schemas"]["scene.table.tilt_rate"];
                pivot?: {
                    x?: components["schemas"]["scene.table.pivot.x"];
                    depth?: components["schemas"]["scene.table.pivot.depth"];
                };
                delay?: components["schemas"]["scene.table.delay"];
                prediction?: components["schemas"]["scene.table.prediction"];
                length?: components["schemas"]["scene.table.length"];
                limits?: {
                    tilt?: components["schemas"]["scene.table.limits.tilt"];
                    tilt_rate?: components["schemas"]["scene.table.limits.tilt_rate"];
                    speed?: components["schemas"]["scene.table.limits.speed"];
                    stroke?: components["schemas"]["scene.table.limits.stroke"];
                };
            };
            release: {
                height: components["schemas"]["scene.release.height"];
                theta?: components["schemas"]["scene.release.theta"];
                theta_dot?: components["schemas"]["scene.release.theta_dot"];
                x: components["schemas"]["scene.release.x"];
                x_dot: components["schemas"]["scene.release.x_dot"];
                y_dot: components["schemas"]["scene.release.y_dot"];
            };
            topple_angle: components["schemas"]["scene.topple_angle"];
            noise?: {
                timing_sd?: components["schemas"]["scene.noise.timing_sd"];
                angle_sd?: components["schemas"]["scene.noise.angle_sd"];
                x_sd?: components["schemas"]["scene.noise.x_sd"];
                x_dot_sd?: components["schemas"]["scene.noise.x_dot_sd"];
                y_dot_sd?: components["schemas"]["scene.noise.y_dot_sd"];
                theta_dot_sd?: components["schemas"]["scene.noise.theta_dot_sd"];
                restitution_sd?: components["schemas"]["scene.noise.restitution_sd"];
                model?: components["schemas"]["scene.noise.model"];
                seed?: components["schemas"]["scene.noise.seed"];
                run?: components["schemas"]["scene.noise.run"];
            } | null;
        };
        LadderRequest: {
            preset?: components["schemas"]["PresetName"] | null;
            scene?: components["schemas"]["ScenePatch"] | null;
            impacts?: components["schemas"]["ladder.impacts"] | null;
            tolerance?: components["schemas"]["ladder.tolerance"] | null;
        };
        PreviewRequest: {
            preset?: components["schemas"]["PresetName"] | null;
            scene?: components["schemas"]["ScenePatch"] | null;
            impacts?: components["schemas"]["previews.impacts"] | null;
            /** @default [] */
            interventions: components["schemas"]["Intervention"][] | null;
        };
        TrajectoryRequest: {
            preset?: components["schemas"]["PresetName"] | null;
            scene?: components["schemas"]["ScenePatch"] | null;
            impacts?: components["schemas"]["trajectories.impacts"] | null;
            method?: components["schemas"]["trajectories.method"] | null;
            tolerance?: components["schemas"]["trajectories.tolerance"] | null;
            samples_per_flight?: components["schemas"]["trajectories.samples_per_flight"] | null;
            hold?: components["schemas"]["trajectories.hold"] | null;
            epoch?: components["schemas"]["trajectories.epoch"] | null;
            /** @default [] */
            interventions: components["schemas"]["Intervention"][] | null;
        };
        LiveFields: {
            "contact.restitution"?: components["schemas"]["scene.contact.restitution"];
            "contact.friction"?: components["schemas"]["scene.contact.friction"];
            "contact.law"?: components["schemas"]["scene.contact.law"];
            "table.tilt_gain"?: components["schemas"]["scene.table.tilt_gain"];
            "table.energy_gain"?: components["schemas"]["scene.table.energy_gain"];
            "table.target_height"?: components["schemas"]["scene.table.target_height"];
            "table.energy_measure"?: components["schemas"]["scene.table.energy_measure"];
            "table.energy_law"?: components["schemas"]["scene.table.energy_law"];
            "table.program"?: components["schemas"]["scene.table.program"];
            "table.strike"?: components["schemas"]["scene.table.strike"];
            "table.slide"?: components["schemas"]["scene.table.slide"];
            "table.feedback.x"?: components["schemas"]["scene.table.feedback.x"];
            "table.feedback.theta"?: components["schemas"]["scene.table.feedback.theta"];
            "table.feedback.x_dot"?: components["schemas"]["scene.table.feedback.x_dot"];
            "table.feedback.theta_dot"?: components["schemas"]["scene.table.feedback.theta_dot"];
            "table.assumed_restitution"?: components["schemas"]["scene.table.assumed_restitution"];
            "table.errors.angle_bias"?: components["schemas"]["scene.table.errors.angle_bias"];
            "table.errors.tilt_offset"?: components["schemas"]["scene.table.errors.tilt_offset"];
            "table.errors.tilt_gain"?: components["schemas"]["scene.table.errors.tilt_gain"];
            "table.errors.speed"?: components["schemas"]["scene.table.errors.speed"];
            "table.tilt_rate"?: components["schemas"]["scene.table.tilt_rate"];
            "table.pivot.x"?: components["schemas"]["scene.table.pivot.x"];
            "table.pivot.depth"?: components["schemas"]["scene.table.pivot.depth"];
            "table.delay"?: components["schemas"]["scene.table.delay"];
            "table.prediction"?: components["schemas"]["scene.table.prediction"];
            "table.length"?: components["schemas"]["scene.table.length"];
            "table.limits.tilt"?: components["schemas"]["scene.table.limits.tilt"];
            "table.limits.tilt_rate"?: components["schemas"]["scene.table.limits.tilt_rate"];
            "table.limits.speed"?: components["schemas"]["scene.table.limits.speed"];
            "table.limits.stroke"?: components["schemas"]["scene.table.limits.stroke"];
            topple_angle?: components["schemas"]["scene.topple_angle"];
            contact?: {
                restitution?: components["schemas"]["scene.contact.restitution"];
                friction?: components["schemas"]["scene.contact.friction"];
                law?: components["schemas"]["scene.contact.law"];
            };
            table?: {
                tilt_gain?: components["schemas"]["scene.table.tilt_gain"];
                energy_gain?: components["schemas"]["scene.table.energy_gain"];
                target_height?: components["schemas"]["scene.table.target_height"];
                energy_measure?: components["schemas"]["scene.table.energy_measure"];
                energy_law?: components["schemas"]["scene.table.energy_law"];
                program?: components["schemas"]["scene.table.program"];
                strike?: components["schemas"]["scene.table.strike"];
                slide?: components["schemas"]["scene.table.slide"];
                feedback?: {
                    x?: components["schemas"]["scene.table.feedback.x"];
                    theta?: components["schemas"]["scene.table.feedback.theta"];
                    x_dot?: components["schemas"]["scene.table.feedback.x_dot"];
                    theta_dot?: components["schemas"]["scene.table.feedback.theta_dot"];
                };
                assumed_restitution?: components["schemas"]["scene.table.assumed_restitution"];
                errors?: {
                    angle_bias?: components["schemas"]["scene.table.errors.angle_bias"];
                    tilt_offset?: components["schemas"]["scene.table.errors.tilt_offset"];
                    tilt_gain?: components["schemas"]["scene.table.errors.tilt_gain"];
                    speed?: components["schemas"]["scene.table.errors.speed"];
                };
                tilt_rate?: components["schemas"]["scene.table.tilt_rate"];
                pivot?: {
                    x?: components["schemas"]["scene.table.pivot.x"];
                    depth?: components["schemas"]["scene.table.pivot.depth"];
                };
                delay?: components["schemas"]["scene.table.delay"];
                prediction?: components["schemas"]["scene.table.prediction"];
                length?: components["schemas"]["scene.table.length"];
                limits?: {
                    tilt?: components["schemas"]["scene.table.limits.tilt"];
                    tilt_rate?: components["schemas"]["scene.table.limits.tilt_rate"];
                    speed?: components["schemas"]["scene.table.limits.speed"];
                    stroke?: components["schemas"]["scene.table.limits.stroke"];
                };
            };
        };
        JacobianRequest: {
            preset?: components["schemas"]["PresetName"] | null;
            scene?: components["schemas"]["ScenePatch"] | null;
            /** @default fixed_point */
            at: null | "fixed_point" | {
                state: components["schemas"]["PlacedState"];
            } | {
                impact: number;
            };
            period?: components["schemas"]["jacobians.period"] | null;
        };
        /**
         * @default survival
         * @enum {string}
         */
        RegionQuantity: "survival" | "max_theta" | "residue" | "spectral_radius" | "caught" | "rest_time";
        RegionSide: {
            parameter: string;
            from: number;
            to: number;
            count: number;
        };
        RegionRequest: {
            preset?: components["schemas"]["PresetName"] | null;
            scene?: components["schemas"]["ScenePatch"] | null;
            x: components["schemas"]["RegionSide"];
            y: components["schemas"]["RegionSide"];
            impacts?: number | null;
            quantity?: components["schemas"]["RegionQuantity"] | null;
            catch?: components["schemas"]["RegionCatch"] | null;
            tile?: {
                index: number;
                of: number;
            } | null;
        };
        RegionCounts: {
            completed: number;
            toppled: number;
            separating: number;
            sinking: number;
            settled: number;
            diverged: number;
            other_vertex: number;
            missed: number;
            beyond_limits: number;
            off_table: number;
            none: number;
        };
        CellCounts: components["schemas"]["RegionCounts"] | components["schemas"]["CatchCounts"];
        CatchCounts: {
            held: number;
            rests_on_edge: number;
            fell: number;
            slipped: number;
            beyond_limits: number;
            not_caught: number;
            none: number;
        };
        RegionOutcomes: number[];
        Region: {
            scene: components["schemas"]["Scene"];
            impacts: number;
            quantity: components["schemas"]["RegionQuantity"];
            axes: {
                parameter: string;
                unit: string;
                from: number;
                to: number;
                count: number;
            }[];
            tile: {
                index: number;
                of: number;
            };
            x: number[];
            y: number[];
            values: components["schemas"]["NumbersOrNull"][];
            outcomes: components["schemas"]["RegionOutcomes"][];
            outcome_names: string[];
            boundary: {
                residue: number;
                x: number[];
                y: number[];
            }[];
            counts: components["schemas"]["CellCounts"];
            notes: string[];
        };
        RegionLine: {
            row: number;
            y: number;
            values: components["schemas"]["NumbersOrNull"];
            outcomes: components["schemas"]["RegionOutcomes"];
        } | {
            end: {
                counts: components["schemas"]["CellCounts"];
            };
        };
        EnsembleRequest: {
            preset?: components["schemas"]["PresetName"] | null;
            scene?: components["schemas"]["ScenePatch"] | null;
            runs?: components["schemas"]["ensemble.runs"] | null;
            impacts?: components["schemas"]["ensemble.impacts"] | null;
            seed?: components["schemas"]["ensemble.seed"] | null;
            tile?: {
                index: number;
                of: number;
            } | null;
            angles?: boolean | null;
        };
        EnsembleCounts: {
            completed: number;
            toppled: number;
            separating: number;
            sinking: number;
            settled: number;
            diverged: number;
            other_vertex: number;
            missed: number;
            beyond_limits: number;
            off_table: number;
        };
        Ensemble: {
            scene: components["schemas"]["Scene"];
            model: components["schemas"]["Model"];
            runs: number;
            impacts: number;
            /** Format: int64 */
            seed: number;
            tile: {
                index: number;
                of: number;
                first_run: number;
                runs: number;
            };
            survived: {
                runs: number;
                share: number;
                lower: number;
                upper: number;
            };
            mean_impacts: number;
            median_impacts: number | null;
            half_life: number | null;
            counts: components["schemas"]["EnsembleCounts"];
            notes: string[];
            survival: {
                n: number[];
                at_risk: number[];
                ended: number[];
                survival: number[];
                lower: number[];
                upper: number[];
            };
            quantiles: {
                n: number[];
                alive: number[];
                q05: (number | null)[];
                q25: (number | null)[];
                q50: (number | null)[];
                q75: (number | null)[];
                q95: (number | null)[];
            };
            angles: number[][] | null;
        };
        Progress: {
            progress: {
                done: number;
                of: number;
            };
        };
        EnsembleProgressEnd: {
            end: components["schemas"]["Ensemble"];
            pictures: {
                survival: string;
            };
        };
        PrecisionProgressEnd: {
            end: components["schemas"]["Precision"];
            pictures: {
                time: string;
                evaluations: string;
                steps: string;
            };
        };
        EnsembleLine: {
            n: number;
            at_risk: number;
            ended: number;
            survival: number;
            lower: number;
            upper: number;
            theta_q05: number | null;
            theta_q25: number | null;
            theta_q50: number | null;
            theta_q75: number | null;
            theta_q95: number | null;
        } | {
            end: {
                survived: {
                    runs: number;
                    share: number;
                    lower: number;
                    upper: number;
                };
                mean_impacts: number;
                median_impacts: number | null;
                half_life: number | null;
                counts: components["schemas"]["EnsembleCounts"];
                notes: string[];
            };
        };
        /** @enum {string} */
        PrecisionMethod: "map" | "map_free" | "linear" | "extended" | "adaptive" | "runge_kutta_bisection" | "runge_kutta_secant" | "runge_kutta_step_end" | "sampling" | "time_stepping" | "penalty";
        PrecisionRequest: {
            preset?: components["schemas"]["PresetName"] | null;
            scene?: components["schemas"]["ScenePatch"] | null;
            impacts?: components["schemas"]["precision.impacts"] | null;
            methods?: components["schemas"]["PrecisionMethod"][] | null;
            axis?: components["schemas"]["precision.axis"] | null;
        };
        PrecisionReference: {
            /** @constant */
            method: "extended";
            outcome: components["schemas"]["PrecisionOutcome"];
            impacts: number;
            t: number;
            rounding: number;
        };
        /** @enum {string} */
        PrecisionOutcome: "completed" | "toppled" | "separating" | "sinking" | "settled" | "diverged" | "off_table" | "missed" | "out_of_steps" | "unavailable";
        PrecisionPoint: {
            method: components["schemas"]["PrecisionMethod"];
            setting: null | {
                /** @enum {unknown} */
                name: "step" | "tolerance";
                value: number;
                /** @enum {unknown} */
                unit: "s" | "1";
            };
            cost_ns_per_impact: number | null;
            spread_ns_per_impact: null | number[];
            repeats: number;
            impacts: number;
            steps: number;
            evaluations: number | null;
            error: number | null;
            error_at: number | null;
            outcome: components["schemas"]["PrecisionOutcome"];
            completed: boolean;
            reason: string | null;
            pareto: boolean;
            pareto_evaluations: boolean;
        };
        Precision: {
            scene: components["schemas"]["Scene"];
            model: components["schemas"]["Model"];
            impacts: number;
            reference: components["schemas"]["PrecisionReference"];
            methods: {
                name: components["schemas"]["PrecisionMethod"];
                title: string;
                about: string;
            }[];
            points: components["schemas"]["PrecisionPoint"][];
            notes: string[];
        };
        PrecisionLine: {
            method: components["schemas"]["PrecisionMethod"];
            setting: string | null;
            setting_value: number | null;
            setting_unit: string | null;
            cost: number | null;
            cost_lower: number | null;
            cost_upper: number | null;
            repeats: number;
            impacts: number;
            steps: number;
            evaluations: number | null;
            error: number | null;
            error_at: number | null;
            outcome: components["schemas"]["PrecisionOutcome"];
            completed: boolean;
            reason: string | null;
            pareto: boolean;
            pareto_evaluations: boolean;
        } | {
            end: {
                reference: components["schemas"]["PrecisionReference"];
                notes: string[];
            };
        };
        PeriodicOrbitsRequest: {
            preset?: components["schemas"]["PresetName"] | null;
            scene?: components["schemas"]["ScenePatch"] | null;
            period?: components["schemas"]["periodic-orbits.period"] | null;
            guess?: components["schemas"]["ImpactState"] | null;
            family?: components["schemas"]["periodic-orbits.family"] | null;
            theta?: components["schemas"]["periodic-orbits.theta"] | null;
            sweep?: {
                parameter: components["schemas"]["periodic-orbits.sweep.parameter"];
                from: components["schemas"]["periodic-orbits.sweep.from"];
                to: components["schemas"]["periodic-orbits.sweep.to"];
                points?: components["schemas"]["periodic-orbits.sweep.points"] | null;
            } | null;
        };
        ControllerRequest: {
            preset?: components["schemas"]["PresetName"] | null;
            scene?: components["schemas"]["ScenePatch"] | null;
            contact?: components["schemas"]["controllers.contact"] | null;
            weights?: {
                state?: null | {
                    x?: components["schemas"]["controllers.weights.state.x"] | null;
                    theta?: components["schemas"]["controllers.weights.state.theta"] | null;
                    x_dot?: components["schemas"]["controllers.weights.state.x_dot"] | null;
                    theta_dot?: components["schemas"]["controllers.weights.state.theta_dot"] | null;
                } | number[];
                input?: components["schemas"]["controllers.weights.input"] | null;
            } | null;
        };
        CatchRequest: {
            preset?: components["schemas"]["PresetName"] | null;
            scene?: components["schemas"]["ScenePatch"] | null;
            strategy?: components["schemas"]["catches.strategy"] | null;
            ratio?: components["schemas"]["catches.ratio"] | null;
            strikes?: components["schemas"]["catches.strikes"] | null;
            brake?: components["schemas"]["catches.brake"] | null;
            weights?: {
                state?: null | {
                    x?: components["schemas"]["controllers.weights.state.x"] | null;
                    theta?: components["schemas"]["controllers.weights.state.theta"] | null;
                    x_dot?: components["schemas"]["controllers.weights.state.x_dot"] | null;
                    theta_dot?: components["schemas"]["controllers.weights.state.theta_dot"] | null;
                } | number[];
                input?: components["schemas"]["controllers.weights.input"] | null;
            } | null;
            hold?: components["schemas"]["catches.hold"] | null;
            hold_speed?: components["schemas"]["catches.hold_speed"] | null;
            hold_samples?: components["schemas"]["catches.hold_samples"] | null;
        };
        RegionCatch: {
            strategy?: components["schemas"]["catches.strategy"] | null;
            ratio?: components["schemas"]["catches.ratio"] | null;
            strikes?: components["schemas"]["catches.strikes"] | null;
            brake?: components["schemas"]["catches.brake"] | null;
            weights?: {
                state?: null | {
                    x?: components["schemas"]["controllers.weights.state.x"] | null;
                    theta?: components["schemas"]["controllers.weights.state.theta"] | null;
                    x_dot?: components["schemas"]["controllers.weights.state.x_dot"] | null;
                    theta_dot?: components["schemas"]["controllers.weights.state.theta_dot"] | null;
                } | number[];
                input?: components["schemas"]["controllers.weights.input"] | null;
            } | null;
            hold_speed?: components["schemas"]["catches.hold_speed"] | null;
            hold?: components["schemas"]["catches.hold"] | null;
        };
        FitRequest: {
            preset?: components["schemas"]["PresetName"] | null;
            scene?: components["schemas"]["ScenePatch"] | null;
            measured: {
                n?: number[] | null;
                t: components["schemas"]["MeasuredValues"];
                theta?: components["schemas"]["MeasuredValues"] | null;
                x_dot?: components["schemas"]["MeasuredValues"] | null;
                y_dot?: components["schemas"]["MeasuredValues"] | null;
                theta_dot?: components["schemas"]["MeasuredValues"] | null;
                x?: components["schemas"]["MeasuredValues"] | null;
            };
            unknown: string[];
            sd?: {
                t?: number | null;
                theta?: number | null;
                x_dot?: number | null;
                y_dot?: number | null;
                theta_dot?: number | null;
                x?: number | null;
            } | null;
        };
        ThrowRequest: {
            preset?: components["schemas"]["PresetName"] | null;
            scene?: components["schemas"]["ScenePatch"] | null;
            apex: components["schemas"]["ThrowApex"];
            impact?: components["schemas"]["throws.impact"] | null;
            state?: {
                x?: components["schemas"]["state.x"] | null;
                theta?: components["schemas"]["state.theta"] | null;
                x_dot?: components["schemas"]["state.x_dot"] | null;
                y_dot?: components["schemas"]["state.y_dot"] | null;
                theta_dot?: components["schemas"]["state.theta_dot"] | null;
            } | null;
            catch?: {
                strategy?: components["schemas"]["catches.strategy"] | null;
                ratio?: components["schemas"]["catches.ratio"] | null;
                strikes?: components["schemas"]["catches.strikes"] | null;
                brake?: components["schemas"]["catches.brake"] | null;
                weights?: {
                    state?: null | {
                        x?: components["schemas"]["controllers.weights.state.x"] | null;
                        theta?: components["schemas"]["controllers.weights.state.theta"] | null;
                        x_dot?: components["schemas"]["controllers.weights.state.x_dot"] | null;
                        theta_dot?: components["schemas"]["controllers.weights.state.theta_dot"] | null;
                    } | number[];
                    input?: components["schemas"]["controllers.weights.input"] | null;
                } | null;
                hold?: components["schemas"]["catches.hold"] | null;
                hold_speed?: components["schemas"]["catches.hold_speed"] | null;
                hold_samples?: components["schemas"]["catches.hold_samples"] | null;
            } | null;
        };
        Intervention: {
            impact: number;
            set?: components["schemas"]["LiveFields"] | null;
            kick?: {
                x_dot?: number | null;
                y_dot?: number | null;
                theta_dot?: number | null;
            } | null;
            catch?: {
                strategy?: components["schemas"]["catches.strategy"] | null;
                ratio?: components["schemas"]["catches.ratio"] | null;
                strikes?: components["schemas"]["catches.strikes"] | null;
                brake?: components["schemas"]["catches.brake"] | null;
                weights?: {
                    state?: null | {
                        x?: components["schemas"]["controllers.weights.state.x"] | null;
                        theta?: components["schemas"]["controllers.weights.state.theta"] | null;
                        x_dot?: components["schemas"]["controllers.weights.state.x_dot"] | null;
                        theta_dot?: components["schemas"]["controllers.weights.state.theta_dot"] | null;
                    } | number[];
                    input?: components["schemas"]["controllers.weights.input"] | null;
                } | null;
                hold_speed?: components["schemas"]["catches.hold_speed"] | null;
                hold?: components["schemas"]["catches.hold"] | null;
            } | null;
            throw?: {
                apex: components["schemas"]["ThrowApex"];
                t?: number | null;
            } | null;
        };
        ThrowApex: {
            height: components["schemas"]["throws.apex.height"];
            theta?: components["schemas"]["throws.apex.theta"] | null;
        };
        StabilityRequest: {
            preset?: components["schemas"]["PresetName"] | null;
            scene?: components["schemas"]["ScenePatch"] | null;
            impacts?: components["schemas"]["stability.impacts"] | null;
            basin?: components["schemas"]["stability.basin"] | null;
            budget?: components["schemas"]["stability.budget"] | null;
            dial?: components["schemas"]["stability.dial"] | null;
            gain_margins?: components["schemas"]["stability.gain_margins"] | null;
            tolerances?: components["schemas"]["Tolerances"] | null;
        };
        Tolerances: {
            contact_distance?: components["schemas"]["stability.tolerances.contact_distance"] | null;
            radius_of_gyration?: components["schemas"]["stability.tolerances.radius_of_gyration"] | null;
            restitution?: components["schemas"]["stability.tolerances.restitution"] | null;
            parameters?: null | {
                parameter: components["schemas"]["stability.tolerances.parameter"];
                tolerance: components["schemas"]["stability.tolerances.tolerance"];
            }[];
        };
        PlacedState: {
            x?: components["schemas"]["state.x"] | null;
            theta?: components["schemas"]["state.theta"] | null;
            x_dot?: components["schemas"]["state.x_dot"] | null;
            y_dot: components["schemas"]["state.y_dot"];
            theta_dot?: components["schemas"]["state.theta_dot"] | null;
        };
        ImpactState: {
            theta?: components["schemas"]["state.theta"] | null;
            x_dot?: components["schemas"]["state.x_dot"] | null;
            y_dot: components["schemas"]["state.y_dot"];
            theta_dot?: components["schemas"]["state.theta_dot"] | null;
        };
        Presets: {
            scenes: components["schemas"]["Preset"][];
        };
        Preset: {
            name: components["schemas"]["PresetName"];
            title: string;
            shows: string;
            scene: components["schemas"]["Scene"];
            derived: components["schemas"]["Derived"];
            printed: components["schemas"]["Quantity"][];
            computed: components["schemas"]["Quantity"][];
        };
        Paper: {
            items: components["schemas"]["PaperItem"][];
        };
        PaperItem: {
            id: string;
            /** @enum {string} */
            kind: "equation" | "table" | "figure" | "claim";
            place: string;
            title: string;
            printed: string;
            agrees: boolean;
            checks: {
                quantity: string;
                symbol: string;
                unit: string;
                printed: number | null;
                computed: number;
                agrees: boolean;
                why: string | null;
            }[];
            why: string | null;
            scene: components["schemas"]["Scene"];
            ask: string;
            picture: string | null;
        };
        Failures: {
            failures: components["schemas"]["Failure"][];
        };
        /** @enum {string} */
        FailureName: "double-eigenvalue-soft" | "double-eigenvalue-hard" | "hard-by-feedback" | "parallel-drift" | "order-three" | "wide-start" | "beyond-critical" | "invented-stability" | "destroyed-stability" | "missed-contact" | "finite-differences" | "grazing" | "zeno" | "trivial-root" | "chaos" | "low-target" | "settled-swing" | "contact-gain" | "biased-angle" | "turning-table" | "late-sensing" | "air-drag";
        Failure: {
            name: components["schemas"]["FailureName"];
            title: string;
            method: string;
            why: string;
            scene: components["schemas"]["Scene"];
            impacts: number;
            says: {
                method: string;
                verdict: string;
                value: number | null;
                unit: string | null;
                right: boolean;
                detail: string;
            }[];
            truth: {
                verdict: string;
                detail: string;
            };
            ask: string;
            picture: string;
        };
        /** @enum {string} */
        QuantityName: "tilt_gain.critical" | "tilt_gain.bounded" | "theta.bounded" | "theta.growth" | "fixed_point.y_dot" | "gravity.in_plane" | "energy_gain.upper" | "energy_gain.eigenvalue" | "energy.target" | "energy.settled" | "vertical_energy.settled" | "friction.helped" | "body.radius_of_gyration" | "release.theta_dot" | "settled.theta_dot" | "angle_eigenvalue.im" | "angle_eigenvalue.critical" | "angle_eigenvector.second" | "jacobian.determinant";
        Quantity: {
            quantity: components["schemas"]["QuantityName"];
            symbol: string;
            unit: string;
            value: number | null;
            where: string;
            why?: string;
            with?: components["schemas"]["ScenePatch"];
        };
        Fields: {
            fields: components["schemas"]["Field"][];
        };
        Field: {
            path: string;
            symbol: string;
            group: string;
            title: string;
            about: string;
            unit: string;
            /** @enum {string} */
            kind: "number" | "integer" | "boolean" | "choice" | "numbers" | "vertices";
            minimum: number | null;
            maximum: number | null;
            default: number | string | boolean | null;
            required: boolean;
            choices: string[] | null;
            count?: {
                minimum: number;
                maximum: number;
            };
            live: boolean;
        };
        Derived: {
            gravity: number;
            contact_distance: number;
            radius_of_gyration: number | null;
            outline: null | number[][];
            target: components["schemas"]["EnergyTarget"] | null;
        };
        EnergyTarget: {
            height: number;
            energy: number;
        };
        Model: {
            forced: components["schemas"]["Forced"][];
            name: components["schemas"]["Rung"];
            reason: string;
        };
        Notes: string[];
        /** @enum {string} */
        OutcomeKind: "completed" | "toppled" | "separating" | "sinking" | "settled" | "diverged" | "other_vertex" | "missed" | "beyond_limits" | "off_table";
        /** @enum {string} */
        AnyOutcomeKind: "completed" | "toppled" | "separating" | "sinking" | "settled" | "diverged" | "other_vertex" | "missed" | "beyond_limits" | "off_table" | "held" | "rests_on_edge" | "fell" | "slipped" | "not_caught";
        Outcome: {
            kind: components["schemas"]["AnyOutcomeKind"];
            impacts: number;
            t: number;
            detail: string;
            quantity: string | null;
            value: number | null;
            limit: number | null;
            unit: string | null;
            settle_time: number | null;
            theta_dot?: number;
        };
        Eigenvalue: {
            re: number;
            im: number;
            modulus: number;
        };
        Ladder: {
            scene: components["schemas"]["Scene"];
            impacts: number;
            tolerance: number;
            rung: components["schemas"]["Rung"];
            enough: components["schemas"]["Rung"];
            reason: string;
            rungs: {
                name: components["schemas"]["Rung"];
                forced: components["schemas"]["Forced"] | null;
                scene: components["schemas"]["Scene"] | null;
                reason: string | null;
                outcome: components["schemas"]["Outcome"] | null;
                demand: components["schemas"]["Demand"] | null;
                cost_ns_per_impact: number;
                change: components["schemas"]["RungChange"] | null;
                needed: boolean | null;
            }[];
        };
        /** @enum {string} */
        Rung: "point" | "linear" | "rod" | "rod_with_x" | "rig_errors" | "turning_table" | "delay" | "drag" | "friction" | "noise" | "polygon";
        Forced: {
            rung: components["schemas"]["Rung"];
            field: string;
            detail: string;
        };
        RungChange: {
            against: components["schemas"]["Rung"];
            impacts: number;
            same_outcome: boolean;
            t: components["schemas"]["LargestDifference"];
            x: components["schemas"]["LargestDifference"];
            theta: components["schemas"]["LargestDifference"];
            x_dot: components["schemas"]["LargestDifference"];
            y_dot: components["schemas"]["LargestDifference"];
            theta_dot: components["schemas"]["LargestDifference"];
            state: components["schemas"]["LargestDifference"];
        };
        LargestDifference: {
            difference: number;
            impact: number | null;
        };
        BatchLine: {
            line: number;
            answer: Record<string, never>;
        } | {
            line: number;
            problem: components["schemas"]["Problem"];
        } | {
            end: {
                lines: number;
                problems: number;
            };
        };
        LadderLine: {
            rung: components["schemas"]["Rung"];
            field: string | null;
            outcome: components["schemas"]["OutcomeKind"] | null;
            impacts: number | null;
            t: number | null;
            cost: number;
            needed: boolean | null;
            change_t: number | null;
            change_x: number | null;
            change_theta: number | null;
            change_x_dot: number | null;
            change_y_dot: number | null;
            change_theta_dot: number | null;
            reason: string | null;
        } | {
            end: {
                rung: components["schemas"]["Rung"];
                enough: components["schemas"]["Rung"];
                reason: string;
            };
        };
        Preview: {
            scene: components["schemas"]["Scene"];
            title: string;
            text: string;
            outcome: components["schemas"]["Outcome"];
        };
        Trajectory: {
            scene: components["schemas"]["Scene"];
            derived: components["schemas"]["Derived"];
            model: components["schemas"]["Model"];
            method: components["schemas"]["MethodChoice"];
            outcome: components["schemas"]["Outcome"];
            nearest_vertex?: components["schemas"]["NearestVertex"];
            impacts: components["schemas"]["Impacts"];
            predictable_impacts: components["schemas"]["PredictableImpacts"];
            flights?: components["schemas"]["Flights"];
            hold?: components["schemas"]["HoldSamples"];
            hold_end?: components["schemas"]["HoldEnd"];
            demand: components["schemas"]["Demand"];
            notes: components["schemas"]["Notes"];
        };
        Demand: {
            tilt: number;
            tilt_rate: number;
            speed: number;
            stroke: number;
        };
        NearestVertex: {
            vertex: number;
            clearance: number;
            impact: number;
            t: number;
        };
        MethodChoice: {
            /** @enum {string} */
            name: "linear" | "map" | "extended";
            reason: string;
        };
        PredictableImpacts: number | null;
        Decimal: number | string;
        Decimals: components["schemas"]["Decimal"][];
        DecimalOrNull: null | number | string;
        DecimalsOrNull: components["schemas"]["DecimalOrNull"][];
        Numbers: number[];
        Dates: number[];
        NumbersOrNull: (number | null)[];
        MeasuredValues: (number | null)[];
        BooleansOrNull: (boolean | null)[];
        /** @enum {string} */
        ContactMode: "frictionless" | "slide" | "stick" | "reverse_slide" | "slide_through";
        ContactModes: (components["schemas"]["ContactMode"] | null)[];
        Impacts: {
            n: number[];
            time?: components["schemas"]["Dates"];
            t: components["schemas"]["Decimals"];
            x: components["schemas"]["Decimals"];
            theta: components["schemas"]["Decimals"];
            x_dot: components["schemas"]["Decimals"];
            y_dot: components["schemas"]["Decimals"];
            theta_dot: components["schemas"]["DecimalsOrNull"];
            alpha: components["schemas"]["Decimals"];
            table_velocity_x: components["schemas"]["DecimalsOrNull"];
            table_velocity_y: components["schemas"]["DecimalsOrNull"];
            impulse_normal: components["schemas"]["DecimalsOrNull"];
            impulse_tangential: components["schemas"]["DecimalsOrNull"];
            contact_mode: components["schemas"]["ContactModes"];
            energy: components["schemas"]["Decimals"];
            flight_time: components["schemas"]["DecimalsOrNull"];
            contact_speed: components["schemas"]["Decimals"];
            clearance: components["schemas"]["Numbers"];
            error_estimate: components["schemas"]["NumbersOrNull"];
        };
        Flights: {
            impact: number[];
            time?: components["schemas"]["Dates"];
            t: components["schemas"]["Numbers"];
            x: components["schemas"]["Numbers"];
            y: components["schemas"]["Numbers"];
            theta: components["schemas"]["NumbersOrNull"];
            x_dot: components["schemas"]["Numbers"];
            y_dot: components["schemas"]["Numbers"];
            theta_dot: components["schemas"]["NumbersOrNull"];
        };
        TrajectoryLine: {
            n: number;
            /** Format: int64 */
            time?: number;
            t: components["schemas"]["Decimal"];
            x: components["schemas"]["Decimal"];
            theta: components["schemas"]["Decimal"];
            x_dot: components["schemas"]["Decimal"];
            y_dot: components["schemas"]["Decimal"];
            theta_dot: components["schemas"]["Decimal"] | null;
            alpha: components["schemas"]["Decimal"];
            table_velocity_x: components["schemas"]["Decimal"] | null;
            table_velocity_y: components["schemas"]["Decimal"] | null;
            impulse_normal: components["schemas"]["Decimal"] | null;
            impulse_tangential: components["schemas"]["Decimal"] | null;
            contact_mode: components["schemas"]["ContactMode"] | null;
            energy: components["schemas"]["Decimal"];
            flight_time: components["schemas"]["Decimal"] | null;
            contact_speed: components["schemas"]["Decimal"];
            clearance: number;
            error_estimate: number | null;
        } | {
            /** @enum {string} */
            phase: "impact" | "hold";
            n: number | null;
            /** Format: int64 */
            time?: number;
            t: components["schemas"]["Decimal"];
            x: components["schemas"]["Decimal"];
            theta: components["schemas"]["Decimal"];
            x_dot: components["schemas"]["Decimal"];
            y_dot: components["schemas"]["Decimal"] | null;
            theta_dot: components["schemas"]["Decimal"] | null;
            alpha: components["schemas"]["Decimal"];
            table_velocity_x: components["schemas"]["Decimal"] | null;
            table_velocity_y: components["schemas"]["Decimal"] | null;
            impulse_normal: components["schemas"]["Decimal"] | null;
            impulse_tangential: components["schemas"]["Decimal"] | null;
            contact_mode: components["schemas"]["ContactMode"] | null;
            energy: components["schemas"]["Decimal"] | null;
            flight_time: components["schemas"]["Decimal"] | null;
            contact_speed: components["schemas"]["Decimal"] | null;
            clearance: number | null;
            error_estimate: number | null;
            normal_force: number | null;
            tangential_force: number | null;
            table_x: number | null;
            table_y: number | null;
            table_y_dot: number | null;
        } | {
            end: {
                demand: components["schemas"]["Demand"];
                nearest_vertex?: components["schemas"]["NearestVertex"];
                hold_end?: components["schemas"]["HoldEnd"];
                outcome: components["schemas"]["Outcome"];
                method: components["schemas"]["MethodChoice"];
                predictable_impacts: components["schemas"]["PredictableImpacts"];
                notes: string[];
            };
        };
        End: {
            end: Record<string, never>;
        };
        JacobianLine: {
            /** @enum {string} */
            component: "rho_theta" | "x_dot" | "y_dot" | "rho_theta_dot" | "x" | "planned_tilt" | "planned_normal_velocity" | "planned_tangential_velocity";
            x?: number;
            rho_theta?: number;
            x_dot: number;
            y_dot: number;
            rho_theta_dot?: number;
            planned_tilt?: number;
            planned_normal_velocity?: number;
            planned_tangential_velocity?: number;
        } | components["schemas"]["End"];
        StabilityLine: {
            verdict: string | null;
            decided_by: string | null;
            agree: boolean | null;
            class: string | null;
            residue: number | null;
            rotation: number | null;
            spectral_radius: number | null;
            tilt_gain: number | null;
            tilt_gain_lower: number | null;
            tilt_gain_critical: number | null;
            energy_gain: number | null;
            energy_gain_upper: number | null;
            boundary_coefficient: number | null;
            boundary_kind: string | null;
            drift_speed: number | null;
            outcome: string | null;
            impacts: number | null;
            t: number | null;
            max_theta: number | null;
            tilt_gain_margin_below: number | null;
            tilt_gain_margin_above: number | null;
            energy_gain_eigenvalue: number | null;
            energy_gain_margin: number | null;
            fixed_point_y_dot: number | null;
            fixed_point_flight_time: number | null;
            rotation_number_measured: number | null;
            rotation_number_linear: number | null;
            resonance_p: number | null;
            resonance_q: number | null;
            resonance_distance: number | null;
            chaos_indicator: number | null;
            chaotic: boolean | null;
            predictable_impacts: number | null;
            basin_theta: number | null;
            basin_unbroken: number | null;
            lyapunov_coefficient: number | null;
            lyapunov_kind: string | null;
            escape_impacts: number | null;
            verdict_code: components["schemas"]["VerdictCode"] | null;
            margins_holds?: boolean | null;
            margins_tilt_gain_critical_least?: number | null;
            margins_tilt_gain_critical_most?: number | null;
            margins_tilt_gain_margin_above?: number | null;
            margins_apex_height_least?: number | null;
            margins_apex_height_most?: number | null;
            margins_energy_eigenvalue_least?: number | null;
            margins_energy_eigenvalue_most?: number | null;
            margins_worst_contact_distance?: number | null;
            margins_worst_radius_of_gyration?: number | null;
            margins_worst_restitution?: number | null;
            margins_worst_parameters?: number[] | null;
        } | components["schemas"]["End"];
        PeriodicOrbits: {
            scene: components["schemas"]["Scene"];
            model: components["schemas"]["Model"];
            period: number;
            least_period: number;
            states: {
                theta: components["schemas"]["Numbers"];
                x_dot: components["schemas"]["Numbers"];
                y_dot: components["schemas"]["Numbers"];
                theta_dot: components["schemas"]["Numbers"];
                x?: components["schemas"]["Numbers"];
            };
            residual: number;
            steps: number;
            energy: number;
            drift: number;
            eigenvalues: components["schemas"]["Eigenvalue"][];
            residue: number | null;
            stable: boolean | null;
            flight_time: number;
            contact_speed: number;
            sweep: null | {
                parameter: string;
                from: number;
                to: number;
                points: number;
                start: number;
            };
            branch: null | {
                parameter: components["schemas"]["Numbers"];
                theta: components["schemas"]["Numbers"];
                residue: components["schemas"]["NumbersOrNull"];
                stable: components["schemas"]["BooleansOrNull"];
                fold: boolean[];
                change: components["schemas"]["BranchChangeKinds"];
                residual: components["schemas"]["Numbers"];
                energy: components["schemas"]["Numbers"];
                flight_time: components["schemas"]["Numbers"];
                first_theta: components["schemas"]["Numbers"];
                first_x_dot: components["schemas"]["Numbers"];
                first_y_dot: components["schemas"]["Numbers"];
                first_theta_dot: components["schemas"]["Numbers"];
            };
            changes: null | components["schemas"]["BranchChange"][];
            notes: components["schemas"]["Notes"];
        };
        BranchChange: {
            kind: components["schemas"]["BranchChangeKind"];
            parameter: number;
            theta: number;
            residue: number | null;
            detail: string;
        };
        /** @enum {string} */
        BranchChangeKind: "period_doubling" | "fold" | "pitchfork" | "neimark_sacker";
        BranchChangeKinds: (components["schemas"]["BranchChangeKind"] | null)[];
        PeriodicOrbitsLine: {
            theta: number;
            x_dot: number;
            y_dot: number;
            theta_dot: number;
            x?: number;
        } | {
            parameter: number;
            theta: number;
            residue: number | null;
            stable: boolean | null;
            fold: boolean;
            change: components["schemas"]["BranchChangeKind"] | null;
            residual: number;
            energy: number;
            flight_time: number;
            first_theta: number;
            first_x_dot: number;
            first_y_dot: number;
            first_theta_dot: number;
        } | {
            end: {
                changes: components["schemas"]["BranchChange"][] | null;
                notes: components["schemas"]["Notes"];
            };
        };
        Jacobian: {
            scene: components["schemas"]["Scene"];
            model: components["schemas"]["Model"];
            at: {
                /** @enum {string} */
                kind: "fixed_point" | "state" | "impact";
                impact: number | null;
                state: {
                    x?: number;
                    theta: number | null;
                    x_dot: number;
                    y_dot: number;
                    theta_dot: number | null;
                };
            };
            period: number;
            state_order: ("rho_theta" | "x_dot" | "y_dot" | "rho_theta_dot" | "x" | "planned_tilt" | "planned_normal_velocity" | "planned_tangential_velocity")[];
            matrix: components["schemas"]["Numbers"][];
            determinant: number;
            eigenvalues: components["schemas"]["Eigenvalue"][];
            residue: number | null;
            defective: boolean | null;
            flight_time: number;
            contact_speed: number;
            /** @enum {string} */
            contact_mode: "frictionless" | "slide" | "stick" | "reverse_slide" | "slide_through";
            smooth: boolean;
            one_sided: {
                /** @enum {string} */
                contact_mode: "frictionless" | "slide" | "stick" | "reverse_slide" | "slide_through";
                matrix: components["schemas"]["Numbers"][];
                eigenvalues: components["schemas"]["Eigenvalue"][];
            }[];
            notes: components["schemas"]["Notes"];
        };
        Margins: {
            tolerances: components["schemas"]["MarginsBody"];
            holds: boolean | null;
            tilt_gain: null | {
                value: number;
                critical: components["schemas"]["Span"];
                margin_above: number;
                worst: components["schemas"]["MarginsBody"];
            };
            feedback_factor?: {
                lower: components["schemas"]["Span"] | null;
                upper: components["schemas"]["Span"] | null;
            };
            apex_height: components["schemas"]["Span"] | null;
            energy_eigenvalue: components["schemas"]["Span"] | null;
            reason: string;
        };
        MarginsBody: {
            contact_distance: number;
            radius_of_gyration: number;
            restitution: number;
            parameters?: {
                parameter: string;
                unit: string;
                value: number;
            }[];
        };
        Budget: {
            /** @enum {string|null} */
            verdict: "stable in place" | "stable, drifting" | "elliptic" | "weakly attracting" | "weakly unstable" | "bounded beyond the boundary" | null;
            verdict_code: components["schemas"]["VerdictCode"] | null;
            impacts: number;
            errors: null | {
                path: string;
                unit: string;
                value: number;
                reference: number;
                below: components["schemas"]["BudgetLimit"] | null;
                above: components["schemas"]["BudgetLimit"] | null;
                reason: string | null;
            }[];
            together: components["schemas"]["CommonBudget"] | null;
            present: components["schemas"]["CommonBudget"] | null;
            reason: string;
        };
        GainMargin: {
            /** @enum {string} */
            field: "table.tilt_gain" | "table.feedback";
            /** @enum {string} */
            of: "small" | "release";
            value: number;
            below: components["schemas"]["GainEnd"] | null;
            above: components["schemas"]["GainEnd"] | null;
        };
        GainEnd: {
            value: number;
            accuracy: number;
            outcome: string | null;
            detail: string;
        };
        CommonBudget: {
            sizes: {
                path: string;
                unit: string;
                value: number;
            }[];
            factor: components["schemas"]["BudgetLimit"];
        };
        BudgetLimit: {
            value: number;
            accuracy: number;
            spacing: number;
            /** @enum {string} */
            decided_by: "linear" | "nonlinear" | "boundary" | "lyapunov" | "fixed_point" | "refused" | "range";
            outcome: components["schemas"]["OutcomeKind"] | null;
            linear: number | null;
            detail: string;
        };
        Span: {
            least: number;
            most: number;
        };
        StateGain: {
            x: number;
            theta: number;
            x_dot: number;
            theta_dot: number;
        };
        JudgedLaw: {
            /** @enum {string} */
            contact: "frictionless" | "stick";
            gain: components["schemas"]["StateGain"];
            stable: boolean;
            eigenvalues: components["schemas"]["Eigenvalue"][];
            spectral_radius: number;
            bounces_per_decade: number | null;
            gain_margin: null | {
                lower: number | null;
                upper: number | null;
            };
        };
        Strikes: {
            n: number[];
            t: components["schemas"]["Numbers"];
            x: components["schemas"]["Numbers"];
            theta: components["schemas"]["Numbers"];
            x_dot: components["schemas"]["Numbers"];
            y_dot: components["schemas"]["Numbers"];
            theta_dot: components["schemas"]["Numbers"];
            x_dot_after: components["schemas"]["Numbers"];
            y_dot_after: components["schemas"]["Numbers"];
            theta_dot_after: components["schemas"]["Numbers"];
            alpha: components["schemas"]["Numbers"];
            impulse_normal: components["schemas"]["Numbers"];
            impulse_tangential: components["schemas"]["Numbers"];
            contact_mode: components["schemas"]["ContactModes"];
            flight_time: components["schemas"]["NumbersOrNull"];
            contact_speed: components["schemas"]["Numbers"];
            clearance: components["schemas"]["Numbers"];
            table_velocity: components["schemas"]["Numbers"];
            ratio: components["schemas"]["Numbers"];
        };
        HoldEnd: {
            /** @enum {string} */
            kind: "completed" | "contact_lost" | "toppled" | "other_vertex" | "rests_on_edge" | "slipped" | "beyond_limits" | "off_table" | "too_long";
            t: number;
            detail: string;
            /** @enum {string} */
            contact: "frictionless" | "matched" | "coulomb";
            error_bound: number | null;
            upright_within: {
                theta_1mrad: number | null;
                x_1mm: number | null;
            };
        };
        HoldSamples: {
            t: components["schemas"]["Numbers"];
            x: components["schemas"]["Numbers"];
            theta: components["schemas"]["Numbers"];
            x_dot: components["schemas"]["Numbers"];
            theta_dot: components["schemas"]["Numbers"];
            alpha: components["schemas"]["Numbers"];
            normal_force: components["schemas"]["Numbers"];
            tangential_force: components["schemas"]["Numbers"];
            table_x: components["schemas"]["Numbers"];
            table_y: components["schemas"]["Numbers"];
            table_y_dot: components["schemas"]["Numbers"];
        };
        CatchOutcome: {
            kind: components["schemas"]["CatchOutcomeKind"];
            t: number;
            detail: string;
            quantity: string | null;
            value: number | null;
            limit: number | null;
            unit: string | null;
            vertices: number[] | null;
        };
        /** @enum {string} */
        CatchOutcomeKind: "held" | "rests_on_edge" | "fell" | "slipped" | "beyond_limits" | "not_caught";
        /** @enum {string} */
        CatchStrategy: "bounce_down" | "plan" | "brake";
        CatchDemand: {
            tilt: number;
            tilt_rate: number | null;
            speed: number;
            stroke: number | null;
            travel: number;
            normal_force: number;
            friction: number | null;
        };
        CatchCandidate: {
            strategy: components["schemas"]["CatchStrategy"];
            ratio: number | null;
            strikes: number | null;
            brake: number | null;
            taken: boolean;
            outcome: components["schemas"]["CatchOutcome"];
            contact_from: number | null;
            demand: components["schemas"]["CatchDemand"];
        };
        CatchUsed: {
            strategy: components["schemas"]["CatchStrategy"];
            ratio: number | null;
            strikes: number | null;
            brake: number | null;
            weights: {
                state: {
                    x: number;
                    theta: number;
                    x_dot: number;
                    theta_dot: number;
                };
                input: number;
            };
            hold_speed: number;
            hold: number;
            hold_samples: number;
        };
        CatchReason: {
            name: components["schemas"]["CatchStrategy"];
            reason: string;
        };
        UprightWithin: {
            theta_1mrad: number | null;
            x_1mm: number | null;
        };
        CatchReach: {
            theta: number;
            limit: number | null;
        };
        HoldErrorBound: number | null;
        ContactFrom: number | null;
        Catch: {
            scene: components["schemas"]["Scene"];
            derived: components["schemas"]["Derived"];
            model: components["schemas"]["Model"];
            settings: components["schemas"]["CatchUsed"];
            strategy: components["schemas"]["CatchReason"];
            candidates: components["schemas"]["CatchCandidate"][];
            outcome: components["schemas"]["CatchOutcome"];
            strikes: components["schemas"]["Strikes"];
            hold: components["schemas"]["HoldSamples"];
            error_bound: components["schemas"]["HoldErrorBound"];
            contact_from: components["schemas"]["ContactFrom"];
            upright_within: components["schemas"]["UprightWithin"];
            demand: components["schemas"]["CatchDemand"];
            reach: components["schemas"]["CatchReach"] | null;
            notes: components["schemas"]["Notes"];
        };
        CatchLine: {
            /** @enum {string} */
            phase: "strike" | "hold";
            n: number | null;
            t: number | null;
            x: number | null;
            theta: number | null;
            x_dot: number | null;
            y_dot: number | null;
            theta_dot: number | null;
            x_dot_after: number | null;
            y_dot_after: number | null;
            theta_dot_after: number | null;
            alpha: number | null;
            impulse_normal: number | null;
            impulse_tangential: number | null;
            contact_mode: components["schemas"]["ContactMode"] | null;
            flight_time: number | null;
            contact_speed: number | null;
            clearance: number | null;
            table_velocity: number | null;
            ratio: number | null;
            normal_force: number | null;
            tangential_force: number | null;
            table_x: number | null;
            table_y: number | null;
            table_y_dot: number | null;
        } | {
            end: {
                outcome: components["schemas"]["CatchOutcome"];
                settings: components["schemas"]["CatchUsed"];
                strategy: components["schemas"]["CatchReason"];
                error_bound: components["schemas"]["HoldErrorBound"];
                contact_from: components["schemas"]["ContactFrom"];
                upright_within: components["schemas"]["UprightWithin"];
                demand: components["schemas"]["CatchDemand"];
                reach: components["schemas"]["CatchReach"] | null;
                notes: components["schemas"]["Notes"];
            };
        };
        ThrownState: {
            x: number;
            theta: number;
            x_dot: number;
            y_dot: number;
            theta_dot: number;
        };
        ReachedApex: {
            t: number;
            x: number;
            y: number;
            theta: number;
        };
        Throw: {
            scene: components["schemas"]["Scene"];
            derived: components["schemas"]["Derived"];
            model: components["schemas"]["Model"];
            t: number;
            before: components["schemas"]["ThrownState"];
            alpha: number;
            table_velocity: number;
            table_velocity_tangential: number;
            impulse_normal: number;
            impulse_tangential: number;
            /** @enum {string} */
            contact_mode: "frictionless" | "slide" | "stick" | "reverse_slide" | "slide_through";
            after: components["schemas"]["ThrownState"];
            apex: components["schemas"]["ReachedApex"];
            landing: null | {
                t: number;
                x: number;
                theta: number;
                x_dot: number;
                y_dot: number;
                theta_dot: number;
            };
            residual: number;
            iterations: number;
            demand: components["schemas"]["Demand"];
            catch: components["schemas"]["Catch"] | null;
            notes: components["schemas"]["Notes"];
        };
        ThrowLine: {
            t: number;
            x: number;
            theta: number;
            x_dot: number;
            y_dot: number;
            theta_dot: number;
            alpha: number;
            table_velocity: number;
            table_velocity_tangential: number;
            impulse_normal: number;
            impulse_tangential: number;
            /** @enum {string} */
            contact_mode: "frictionless" | "slide" | "stick" | "reverse_slide" | "slide_through";
            x_dot_after: number;
            y_dot_after: number;
            theta_dot_after: number;
            apex_t: number;
            apex_x: number;
            apex_y: number;
            apex_theta: number;
            landing_t: number | null;
            landing_x: number | null;
            landing_theta: number | null;
            residual: number;
            caught: components["schemas"]["CatchOutcomeKind"] | null;
        } | {
            end: {
                scene: components["schemas"]["Scene"];
                demand: components["schemas"]["Demand"];
                notes: components["schemas"]["Notes"];
            };
        };
        Controller: {
            scene: components["schemas"]["Scene"];
            model: components["schemas"]["Model"];
            weights: {
                state: {
                    x: number;
                    theta: number;
                    x_dot: number;
                    theta_dot: number;
                };
                input: number;
            };
            state_order: ("x" | "theta" | "x_dot" | "theta_dot")[];
            linear: {
                a: components["schemas"]["Numbers"][];
                b: components["schemas"]["Numbers"];
            };
            /** @enum {string} */
            contact: "frictionless" | "stick";
            gain: components["schemas"]["StateGain"];
            stable: boolean;
            eigenvalues: components["schemas"]["Eigenvalue"][];
            spectral_radius: number;
            bounces_per_decade: number | null;
            gain_margin: null | {
                lower: number | null;
                upper: number | null;
            };
            residual: number;
            iterations: number;
            fixed_point: {
                x: number;
                theta: number;
                x_dot: number;
                y_dot: number;
                theta_dot: number;
                flight_time: number;
                apex_height: number;
            };
            open_loop: components["schemas"]["Eigenvalue"][];
            energy_eigenvalue: number;
            applied: null | components["schemas"]["JudgedLaw"];
            given: null | components["schemas"]["JudgedLaw"];
            regions: {
                /** Format: uri-reference */
                designed: string;
                /** Format: uri-reference */
                proportional: string;
            };
            notes: components["schemas"]["Notes"];
        };
        ControllerLine: {
            /** @enum {string} */
            contact: "frictionless" | "stick";
            gain_x: number;
            gain_theta: number;
            gain_x_dot: number;
            gain_theta_dot: number;
            spectral_radius: number;
            bounces_per_decade: number | null;
            gain_margin_lower: number | null;
            gain_margin_upper: number | null;
            residual: number;
            iterations: number;
            energy_eigenvalue: number;
            fixed_point_y_dot: number;
            fixed_point_flight_time: number;
            applied_spectral_radius: number | null;
            given_spectral_radius: number | null;
        } | {
            end: {
                scene: components["schemas"]["Scene"];
                notes: components["schemas"]["Notes"];
            };
        };
        /** @enum {string} */
        VerdictCode: "stable_in_place" | "stable_drifting" | "weakly_attracting" | "elliptic" | "bounded_beyond_boundary" | "weakly_unstable" | "random" | "unstable";
        Stability: {
            scene: components["schemas"]["Scene"];
            derived: components["schemas"]["Derived"];
            margins?: components["schemas"]["Margins"];
            budget?: components["schemas"]["Budget"];
            gain_margins?: components["schemas"]["GainMargin"][];
            dial?: string;
            model: components["schemas"]["Model"];
            verdict: string | null;
            verdict_code: components["schemas"]["VerdictCode"] | null;
            /** @enum {string|null} */
            decided_by: "linear" | "nonlinear" | "boundary" | "lyapunov" | "fixed_point" | "ensemble" | null;
            reason: string;
            fixed_point: null | {
                x?: number;
                theta: number | null;
                x_dot: number;
                y_dot: number;
                theta_dot: number | null;
                flight_time: number;
                apex_height: number;
            };
            linear: null | components["schemas"]["Linear"];
            boundary: null | {
                coefficient: number;
                /** @enum {string} */
                kind: "soft" | "hard" | "degenerate";
            };
            loss_of_stability: null | {
                /** @enum {string} */
                parameter: "table.tilt_gain" | "table.energy_gain" | "table.feedback";
                value: number;
                /** @enum {string} */
                bifurcation: "period_doubling" | "fold" | "pitchfork" | "neimark_sacker";
                coefficient: number;
                /** @enum {string} */
                kind: "soft" | "hard" | "degenerate";
                swing: number | null;
                heights: null | number[];
            }[];
            lyapunov: null | {
                coefficient: number;
                /** @enum {string} */
                kind: "repelling" | "attracting" | "neutral";
                escape_impacts: number | null;
                detail: string;
            };
            nonlinear: null | {
                demand: components["schemas"]["Demand"];
                outcome: components["schemas"]["OutcomeKind"];
                impacts: number;
                t: number;
                max_theta: number | null;
                detail: string;
            };
            steady_drift?: {
                theta: number | null;
                acceleration: number | null;
                speed: number | null;
                time_on_table: number | null;
            };
            swing_pump?: {
                swing: number;
                distance: number;
                energy: number;
                critical_impacts: number | null;
            };
            drift_speed: number | null;
            agree: boolean | null;
            rotation_number: null | {
                measured: number | null;
                linear: number;
                resonance: {
                    p: number;
                    q: number;
                    distance: number;
                };
            };
            chaos: null | {
                indicator: number;
                chaotic: boolean;
                impacts: number;
            };
            predictable_impacts: number | null;
            basin: null | {
                theta: number;
                impacts: number;
                holes: components["schemas"]["Numbers"][];
                unbroken: number;
                tolerance: number;
                spacing: number;
            };
            notes: components["schemas"]["Notes"];
        };
        Linear: {
            /** @enum {string} */
            class: "elliptic" | "parabolic" | "hyperbolic" | "attracting";
            residue: number | null;
            rotation: number | null;
            spectral_radius: number;
            eigenvalues: components["schemas"]["Eigenvalue"][];
            tilt_gain: null | {
                value: number;
                lower: number;
                critical: number | null;
                margin_below: number;
                margin_above: number | null;
            };
            energy_gain: null | {
                value: number;
                upper: number | null;
                eigenvalue: number;
                margin: number | null;
            };
        };
        Fit: {
            estimates: components["schemas"]["FitEstimate"][];
            correlation: components["schemas"]["NumbersOrNull"][];
            residuals: {
                n: number[];
                row: number[];
                window: number[];
                theta: components["schemas"]["NumbersOrNull"];
                x_dot: components["schemas"]["NumbersOrNull"];
                y_dot: components["schemas"]["NumbersOrNull"];
                theta_dot: components["schemas"]["NumbersOrNull"];
                x: components["schemas"]["NumbersOrNull"];
                t: components["schemas"]["NumbersOrNull"];
                outlier: boolean[];
            };
            sd: {
                theta: number | null;
                x_dot: number | null;
                y_dot: number | null;
                theta_dot: number | null;
                x: number | null;
                t: number | null;
            };
            chi_squared: number;
            degrees_of_freedom: number;
            quality: components["schemas"]["FitQuality"];
            windows: number;
            iterations: number;
            scene: components["schemas"]["Scene"];
            stability: components["schemas"]["FitStability"];
            notes: string[];
        };
        FitEstimate: {
            path: string;
            value: number;
            sd: number | null;
            interval: number[] | null;
            unit: string;
            identifiable: boolean;
            detail: string | null;
        };
        FitQuality: {
            /** @enum {string} */
            kind: "good" | "deviations_too_large" | "not_random" | "not_followed" | "not_explained" | "not_converged";
            detail: string;
        };
        FitStability: {
            verdict: string | null;
            verdict_code: components["schemas"]["VerdictCode"] | null;
            decided_by: string | null;
            reason: string;
            margins: {
                /** @enum {string} */
                name: "tilt_gain_below" | "tilt_gain_above" | "spectral_radius" | "energy_gain";
                value: number;
                sd: number;
                least: number;
                most: number;
            }[];
            holds: boolean | null;
        };
        FitProgress: {
            progress: {
                done: number;
                of: number;
                /** @enum {string} */
                stage: "numbers" | "starts" | "short_windows" | "longer_windows" | "outliers" | "beside" | "verdict";
                search: number;
                iterations: number;
                residual: number | null;
            };
        };
        FitProgressEnd: {
            end: components["schemas"]["Fit"];
            pictures: {
                residuals: string;
            };
        };
        FitProgressFailure: {
            problem: components["schemas"]["Problem"];
        };
        FitLine: {
            n: number;
            row: number;
            window: number;
            theta: number | null;
            x_dot: number | null;
            y_dot: number | null;
            theta_dot: number | null;
            x: number | null;
            t: number | null;
            outlier: boolean;
        } | {
            end: {
                estimates: components["schemas"]["FitEstimate"][];
                chi_squared: number;
                degrees_of_freedom: number;
                quality: components["schemas"]["FitQuality"];
                scene: components["schemas"]["Scene"];
                stability: components["schemas"]["FitStability"];
                notes: string[];
            };
        };
        Health: {
            /** @constant */
            status: "ok";
            build: string;
            version: string;
        };
        /**
         * @example {
         *       "type": "about:blank",
         *       "title": "Unprocessable Content",
         *       "status": 422,
         *       "detail": "1 field is not valid",
         *       "errors": [
         *         {
         *           "pointer": "/scene/table/tilt_gain",
         *           "detail": "tilt_gain is 5000; it must be from -100 to 100 (no unit)"
         *         }
         *       ]
         *     }
         */
        Problem: {
            /** Format: uri-reference */
            type: string;
            title: string;
            status: number;
            detail: string;
            request_id?: string;
            errors?: components["schemas"]["ProblemError"][];
        };
        ProblemError: {
            pointer: string;
            detail: string;
        };
        "live.hello": {
            /** @constant */
            type: "hello";
            scene: components["schemas"]["Scene"];
            scene_in_force: components["schemas"]["Scene"];
            derived: components["schemas"]["Derived"];
            model: components["schemas"]["Model"];
            epoch: number;
            speed: number;
            paused: boolean;
            now: number;
            run_time: number;
            url: string;
            release: {
                t: number;
                x: number;
                y: number;
                theta: number | null;
                x_dot: number;
                y_dot: number;
                theta_dot: number | null;
            };
            flight_time: number | null;
            first_strike: components["schemas"]["live.next_strike"];
            build: string;
        };
        "live.impact": {
            /** @constant */
            type: "impact";
            n: number;
            /** Format: int64 */
            time: number;
            t: number;
            x: number;
            theta: number;
            x_dot: number;
            y_dot: number;
            theta_dot: number | null;
            x_dot_after: number | null;
            y_dot_after: number | null;
            theta_dot_after: number | null;
            alpha: number;
            table_velocity_x: number | null;
            table_velocity_y: number | null;
            impulse_normal: number | null;
            impulse_tangential: number | null;
            contact_mode: components["schemas"]["ContactMode"] | null;
            energy: number;
            flight_time: number | null;
            contact_speed: number;
            clearance: number;
            before: {
                x: number;
                theta: number;
                x_dot: number;
                y_dot: number;
                theta_dot: number | null;
            };
            after: null | {
                x_dot: number;
                y_dot: number;
                theta_dot: number | null;
            };
            table_velocity: null | {
                x: number;
                y: number;
            };
            next_strike: components["schemas"]["live.next_strike"];
        };
        "live.flat_impact": {
            /** @constant */
            type: "impact";
            n: number;
            /** Format: int64 */
            time: number;
            t: number;
            x: number;
            theta: number;
            x_dot: number;
            y_dot: number;
            theta_dot: number | null;
            x_dot_after: number | null;
            y_dot_after: number | null;
            theta_dot_after: number | null;
            alpha: number;
            table_velocity_x: number | null;
            table_velocity_y: number | null;
            impulse_normal: number | null;
            impulse_tangential: number | null;
            contact_mode: components["schemas"]["ContactMode"] | null;
            energy: number;
            flight_time: number | null;
            contact_speed: number;
            clearance: number;
        };
        "live.impacts": {
            /** @constant */
            type: "impacts";
            next_strike: components["schemas"]["live.next_strike"];
            columns: {
                n: number[];
                time: number[];
                t: components["schemas"]["Numbers"];
                x: components["schemas"]["Numbers"];
                theta: components["schemas"]["Numbers"];
                x_dot: components["schemas"]["Numbers"];
                y_dot: components["schemas"]["Numbers"];
                theta_dot: components["schemas"]["NumbersOrNull"];
                x_dot_after: components["schemas"]["NumbersOrNull"];
                y_dot_after: components["schemas"]["NumbersOrNull"];
                theta_dot_after: components["schemas"]["NumbersOrNull"];
                alpha: components["schemas"]["Numbers"];
                table_velocity_x: components["schemas"]["NumbersOrNull"];
                table_velocity_y: components["schemas"]["NumbersOrNull"];
                impulse_normal: components["schemas"]["NumbersOrNull"];
                impulse_tangential: components["schemas"]["NumbersOrNull"];
                contact_mode: components["schemas"]["ContactModes"];
                energy: components["schemas"]["Numbers"];
                flight_time: components["schemas"]["NumbersOrNull"];
                contact_speed: components["schemas"]["Numbers"];
                clearance: components["schemas"]["Numbers"];
            };
        };
        "live.hold": {
            /** @constant */
            type: "hold";
            columns: components["schemas"]["HoldSamples"];
        };
        "live.gap": {
            /** @constant */
            type: "gap";
            from: number;
            to: number;
        };
        "live.end": {
            /** @constant */
            type: "end";
            outcome: components["schemas"]["Outcome"];
            demand: components["schemas"]["Demand"];
            hold_end?: components["schemas"]["HoldEnd"];
        };
        "live.ack": {
            /** @constant */
            type: "ack";
            /** @enum {string} */
            of: "pause" | "resume" | "step" | "speed" | "set" | "kick" | "catch" | "throw" | "restart";
            url: string;
            run_time: number;
            now: number;
            speed: number;
            paused: boolean;
            impact: number | null;
            next_strike: components["schemas"]["live.next_strike"];
        };
        "live.next_strike": null | {
            n: number;
            t: number;
            x: number;
            y: number;
            alpha: number;
            table_velocity: null | {
                x: number;
                y: number;
            };
            target: components["schemas"]["EnergyTarget"] | null;
        };
        "live.problem": {
            /** @constant */
            type: "problem";
            status: number;
            title: string;
            detail: string;
            errors?: components["schemas"]["ProblemError"][];
        };
        "live.pause": {
            /** @constant */
            type: "pause";
        };
        "live.resume": {
            /** @constant */
            type: "resume";
        };
        "live.step": {
            /** @constant */
            type: "step";
        };
        "live.restart": {
            /** @constant */
            type: "restart";
        };
        "live.speed": {
            /** @constant */
            type: "speed";
            value: number;
        };
        /**
         * @example {
         *       "type": "set",
         *       "table.tilt_gain": 1.3
         *     }
         */
        "live.set": {
            /** @constant */
            type: "set";
            "contact.restitution"?: components["schemas"]["scene.contact.restitution"];
            "contact.friction"?: components["schemas"]["scene.contact.friction"];
            "contact.law"?: components["schemas"]["scene.contact.law"];
            "table.tilt_gain"?: components["schemas"]["scene.table.tilt_gain"];
            "table.energy_gain"?: components["schemas"]["scene.table.energy_gain"];
            "table.target_height"?: components["schemas"]["scene.table.target_height"];
            "table.energy_measure"?: components["schemas"]["scene.table.energy_measure"];
            "table.energy_law"?: components["schemas"]["scene.table.energy_law"];
            "table.program"?: components["schemas"]["scene.table.program"];
            "table.strike"?: components["schemas"]["scene.table.strike"];
            "table.slide"?: components["schemas"]["scene.table.slide"];
            "table.feedback.x"?: components["schemas"]["scene.table.feedback.x"];
            "table.feedback.theta"?: components["schemas"]["scene.table.feedback.theta"];
            "table.feedback.x_dot"?: components["schemas"]["scene.table.feedback.x_dot"];
            "table.feedback.theta_dot"?: components["schemas"]["scene.table.feedback.theta_dot"];
            "table.assumed_restitution"?: components["schemas"]["scene.table.assumed_restitution"];
            "table.errors.angle_bias"?: components["schemas"]["scene.table.errors.angle_bias"];
            "table.errors.tilt_offset"?: components["schemas"]["scene.table.errors.tilt_offset"];
            "table.errors.tilt_gain"?: components["schemas"]["scene.table.errors.tilt_gain"];
            "table.errors.speed"?: components["schemas"]["scene.table.errors.speed"];
            "table.tilt_rate"?: components["schemas"]["scene.table.tilt_rate"];
            "table.pivot.x"?: components["schemas"]["scene.table.pivot.x"];
            "table.pivot.depth"?: components["schemas"]["scene.table.pivot.depth"];
            "table.delay"?: components["schemas"]["scene.table.delay"];
            "table.prediction"?: components["schemas"]["scene.table.prediction"];
            "table.length"?: components["schemas"]["scene.table.length"];
            "table.limits.tilt"?: components["schemas"]["scene.table.limits.tilt"];
            "table.limits.tilt_rate"?: components["schemas"]["scene.table.limits.tilt_rate"];
            "table.limits.speed"?: components["schemas"]["scene.table.limits.speed"];
            "table.limits.stroke"?: components["schemas"]["scene.table.limits.stroke"];
            topple_angle?: components["schemas"]["scene.topple_angle"];
        };
        /**
         * @example {
         *       "type": "kick",
         *       "theta_dot": 0.5
         *     }
         */
        "live.kick": {
            /** @constant */
            type: "kick";
            /** @default 0 */
            theta_dot: components["schemas"]["scene.release.theta_dot"];
            /** @default 0 */
            x_dot: components["schemas"]["scene.release.x_dot"];
            /** @default 0 */
            y_dot: components["schemas"]["scene.release.y_dot"];
        };
        /**
         * @example {
         *       "type": "catch"
         *     }
         * @example {
         *       "type": "catch",
         *       "strategy": "bounce_down",
         *       "ratio": 0.7
         *     }
         */
        "live.catch": {
            /** @constant */
            type: "catch";
            strategy?: components["schemas"]["catches.strategy"] | null;
            ratio?: components["schemas"]["catches.ratio"] | null;
            strikes?: components["schemas"]["catches.strikes"] | null;
            brake?: components["schemas"]["catches.brake"] | null;
            weights?: {
                state?: null | {
                    x?: components["schemas"]["controllers.weights.state.x"] | null;
                    theta?: components["schemas"]["controllers.weights.state.theta"] | null;
                    x_dot?: components["schemas"]["controllers.weights.state.x_dot"] | null;
                    theta_dot?: components["schemas"]["controllers.weights.state.theta_dot"] | null;
                } | number[];
                input?: components["schemas"]["controllers.weights.input"] | null;
            } | null;
            hold_speed?: components["schemas"]["catches.hold_speed"] | null;
            hold?: components["schemas"]["catches.hold"] | null;
        };
        /**
         * @example {
         *       "type": "throw",
         *       "apex": {
         *         "height": 0.3
         *       }
         *     }
         */
        "live.throw": {
            /** @constant */
            type: "throw";
            apex: components["schemas"]["ThrowApex"];
        };
    };
    responses: never;
    parameters: never;
    requestBodies: never;
    headers: never;
    pathItems: never;
}
export type SceneBodyContactDistance = components['schemas']['scene.body.contact_distance'];
export type SceneBodyRadiusOfGyration = components['schemas']['scene.body.radius_of_gyration'];
export type SceneBodyPoint = components['schemas']['scene.body.point'];
export type SceneBodyOffset = components['schemas']['scene.body.offset'];
export type SceneBodyContactVertex = components['schemas']['scene.body.contact_vertex'];
export type SceneGravity = components['schemas']['scene.gravity'];
export type SceneIncline = components['schemas']['scene.incline'];
export type SceneAirDrag = components['schemas']['scene.air.drag'];
export type SceneAirRotationDrag = components['schemas']['scene.air.rotation_drag'];
export type SceneAirWind = components['schemas']['scene.air.wind'];
export type SceneContactRestitution = components['schemas']['scene.contact.restitution'];
export type SceneContactFriction = components['schemas']['scene.contact.friction'];
export type SceneContactLaw = components['schemas']['scene.contact.law'];
export type SceneTableTiltGain = components['schemas']['scene.table.tilt_gain'];
export type SceneTableEnergyGain = components['schemas']['scene.table.energy_gain'];
export type SceneTableTargetHeight = components['schemas']['scene.table.target_height'];
export type SceneTableEnergyMeasure = components['schemas']['scene.table.energy_measure'];
export type SceneTableEnergyLaw = components['schemas']['scene.table.energy_law'];
export type SceneTableProgram = components['schemas']['scene.table.program'];
export type SceneTableStrike = components['schemas']['scene.table.strike'];
export type SceneTableSlide = components['schemas']['scene.table.slide'];
export type SceneTableFeedbackX = components['schemas']['scene.table.feedback.x'];
export type SceneTableFeedbackTheta = components['schemas']['scene.table.feedback.theta'];
export type SceneTableFeedbackXDot = components['schemas']['scene.table.feedback.x_dot'];
export type SceneTableFeedbackThetaDot = components['schemas']['scene.table.feedback.theta_dot'];
export type SceneTableAssumedRestitution = components['schemas']['scene.table.assumed_restitution'];
export type SceneTableErrorsAngleBias = components['schemas']['scene.table.errors.angle_bias'];
export type SceneTableErrorsTiltOffset = components['schemas']['scene.table.errors.tilt_offset'];
export type SceneTableErrorsTiltGain = components['schemas']['scene.table.errors.tilt_gain'];
export type SceneTableErrorsSpeed = components['schemas']['scene.table.errors.speed'];
export type SceneTableTiltRate = components['schemas']['scene.table.tilt_rate'];
export type SceneTablePivotX = components['schemas']['scene.table.pivot.x'];
export type SceneTablePivotDepth = components['schemas']['scene.table.pivot.depth'];
export type SceneTableDelay = components['schemas']['scene.table.delay'];
export type SceneTablePrediction = components['schemas']['scene.table.prediction'];
export type SceneTableLength = components['schemas']['scene.table.length'];
export type SceneTableLimitsTilt = components['schemas']['scene.table.limits.tilt'];
export type SceneTableLimitsTiltRate = components['schemas']['scene.table.limits.tilt_rate'];
export type SceneTableLimitsSpeed = components['schemas']['scene.table.limits.speed'];
export type SceneTableLimitsStroke = components['schemas']['scene.table.limits.stroke'];
export type SceneReleaseHeight = components['schemas']['scene.release.height'];
export type SceneReleaseTheta = components['schemas']['scene.release.theta'];
export type SceneReleaseThetaDot = components['schemas']['scene.release.theta_dot'];
export type SceneReleaseX = components['schemas']['scene.release.x'];
export type SceneReleaseXDot = components['schemas']['scene.release.x_dot'];
export type SceneReleaseYDot = components['schemas']['scene.release.y_dot'];
export type SceneToppleAngle = components['schemas']['scene.topple_angle'];
export type SceneNoiseTimingSd = components['schemas']['scene.noise.timing_sd'];
export type SceneNoiseAngleSd = components['schemas']['scene.noise.angle_sd'];
export type SceneNoiseXSd = components['schemas']['scene.noise.x_sd'];
export type SceneNoiseXDotSd = components['schemas']['scene.noise.x_dot_sd'];
export type SceneNoiseYDotSd = components['schemas']['scene.noise.y_dot_sd'];
export type SceneNoiseThetaDotSd = components['schemas']['scene.noise.theta_dot_sd'];
export type SceneNoiseRestitutionSd = components['schemas']['scene.noise.restitution_sd'];
export type SceneNoiseModel = components['schemas']['scene.noise.model'];
export type SceneNoiseSeed = components['schemas']['scene.noise.seed'];
export type SceneNoiseRun = components['schemas']['scene.noise.run'];
export type LadderImpacts = components['schemas']['ladder.impacts'];
export type LadderTolerance = components['schemas']['ladder.tolerance'];
export type PreviewsImpacts = components['schemas']['previews.impacts'];
export type TrajectoriesImpacts = components['schemas']['trajectories.impacts'];
export type TrajectoriesMethod = components['schemas']['trajectories.method'];
export type TrajectoriesTolerance = components['schemas']['trajectories.tolerance'];
export type TrajectoriesEpoch = components['schemas']['trajectories.epoch'];
export type TrajectoriesHold = components['schemas']['trajectories.hold'];
export type TrajectoriesSamplesPerFlight = components['schemas']['trajectories.samples_per_flight'];
export type StateTheta = components['schemas']['state.theta'];
export type StateXDot = components['schemas']['state.x_dot'];
export type StateYDot = components['schemas']['state.y_dot'];
export type StateThetaDot = components['schemas']['state.theta_dot'];
export type StateX = components['schemas']['state.x'];
export type JacobiansPeriod = components['schemas']['jacobians.period'];
export type EnsembleRuns = components['schemas']['ensemble.runs'];
export type EnsembleImpacts = components['schemas']['ensemble.impacts'];
export type EnsembleSeed = components['schemas']['ensemble.seed'];
export type PeriodicOrbitsPeriod = components['schemas']['periodic-orbits.period'];
export type PeriodicOrbitsFamily = components['schemas']['periodic-orbits.family'];
export type PeriodicOrbitsTheta = components['schemas']['periodic-orbits.theta'];
export type PeriodicOrbitsSweepParameter = components['schemas']['periodic-orbits.sweep.parameter'];
export type PeriodicOrbitsSweepFrom = components['schemas']['periodic-orbits.sweep.from'];
export type PeriodicOrbitsSweepTo = components['schemas']['periodic-orbits.sweep.to'];
export type PeriodicOrbitsSweepPoints = components['schemas']['periodic-orbits.sweep.points'];
export type PrecisionImpacts = components['schemas']['precision.impacts'];
export type PrecisionAxis = components['schemas']['precision.axis'];
export type StabilityImpacts = components['schemas']['stability.impacts'];
export type StabilityBasin = components['schemas']['stability.basin'];
export type StabilityBudget = components['schemas']['stability.budget'];
export type StabilityGainMargins = components['schemas']['stability.gain_margins'];
export type StabilityDial = components['schemas']['stability.dial'];
export type StabilityTolerancesContactDistance = components['schemas']['stability.tolerances.contact_distance'];
export type StabilityTolerancesRadiusOfGyration = components['schemas']['stability.tolerances.radius_of_gyration'];
export type StabilityTolerancesRestitution = components['schemas']['stability.tolerances.restitution'];
export type StabilityTolerancesParameter = components['schemas']['stability.tolerances.parameter'];
export type StabilityTolerancesTolerance = components['schemas']['stability.tolerances.tolerance'];
export type ControllersContact = components['schemas']['controllers.contact'];
export type ControllersWeightsStateX = components['schemas']['controllers.weights.state.x'];
export type ControllersWeightsStateTheta = components['schemas']['controllers.weights.state.theta'];
export type ControllersWeightsStateXDot = components['schemas']['controllers.weights.state.x_dot'];
export type ControllersWeightsStateThetaDot = components['schemas']['controllers.weights.state.theta_dot'];
export type ControllersWeightsInput = components['schemas']['controllers.weights.input'];
export type CatchesStrategy = components['schemas']['catches.strategy'];
export type CatchesRatio = components['schemas']['catches.ratio'];
export type CatchesStrikes = components['schemas']['catches.strikes'];
export type CatchesBrake = components['schemas']['catches.brake'];
export type CatchesHold = components['schemas']['catches.hold'];
export type CatchesHoldSpeed = components['schemas']['catches.hold_speed'];
export type CatchesHoldSamples = components['schemas']['catches.hold_samples'];
export type ThrowsImpact = components['schemas']['throws.impact'];
export type ThrowsApexHeight = components['schemas']['throws.apex.height'];
export type ThrowsApexTheta = components['schemas']['throws.apex.theta'];
export type PresetName = components['schemas']['PresetName'];
export type Vertices = components['schemas']['Vertices'];
export type ScenePatch = components['schemas']['ScenePatch'];
export type Scene = components['schemas']['Scene'];
export type LadderRequest = components['schemas']['LadderRequest'];
export type PreviewRequest = components['schemas']['PreviewRequest'];
export type TrajectoryRequest = components['schemas']['TrajectoryRequest'];
export type LiveFields = components['schemas']['LiveFields'];
export type JacobianRequest = components['schemas']['JacobianRequest'];
export type RegionQuantity = components['schemas']['RegionQuantity'];
export type RegionSide = components['schemas']['RegionSide'];
export type RegionRequest = components['schemas']['RegionRequest'];
export type RegionCounts = components['schemas']['RegionCounts'];
export type CellCounts = components['schemas']['CellCounts'];
export type CatchCounts = components['schemas']['CatchCounts'];
export type RegionOutcomes = components['schemas']['RegionOutcomes'];
export type Region = components['schemas']['Region'];
export type RegionLine = components['schemas']['RegionLine'];
export type EnsembleRequest = components['schemas']['EnsembleRequest'];
export type EnsembleCounts = components['schemas']['EnsembleCounts'];
export type Ensemble = components['schemas']['Ensemble'];
export type Progress = components['schemas']['Progress'];
export type EnsembleProgressEnd = components['schemas']['EnsembleProgressEnd'];
export type PrecisionProgressEnd = components['schemas']['PrecisionProgressEnd'];
export type EnsembleLine = components['schemas']['EnsembleLine'];
export type PrecisionMethod = components['schemas']['PrecisionMethod'];
export type PrecisionRequest = components['schemas']['PrecisionRequest'];
export type PrecisionReference = components['schemas']['PrecisionReference'];
export type PrecisionOutcome = components['schemas']['PrecisionOutcome'];
export type PrecisionPoint = components['schemas']['PrecisionPoint'];
export type Precision = components['schemas']['Precision'];
export type PrecisionLine = components['schemas']['PrecisionLine'];
export type PeriodicOrbitsRequest = components['schemas']['PeriodicOrbitsRequest'];
export type ControllerRequest = components['schemas']['ControllerRequest'];
export type CatchRequest = components['schemas']['CatchRequest'];
export type RegionCatch = components['schemas']['RegionCatch'];
export type FitRequest = components['schemas']['FitRequest'];
export type ThrowRequest = components['schemas']['ThrowRequest'];
export type Intervention = components['schemas']['Intervention'];
export type ThrowApex = components['schemas']['ThrowApex'];
export type StabilityRequest = components['schemas']['StabilityRequest'];
export type Tolerances = components['schemas']['Tolerances'];
export type PlacedState = components['schemas']['PlacedState'];
export type ImpactState = components['schemas']['ImpactState'];
export type Presets = components['schemas']['Presets'];
export type Preset = components['schemas']['Preset'];
export type Paper = components['schemas']['Paper'];
export type PaperItem = components['schemas']['PaperItem'];
export type Failures = components['schemas']['Failures'];
export type FailureName = components['schemas']['FailureName'];
export type Failure = components['schemas']['Failure'];
export type QuantityName = components['schemas']['QuantityName'];
export type Quantity = components['schemas']['Quantity'];
export type Fields = components['schemas']['Fields'];
export type Field = components['schemas']['Field'];
export type Derived = components['schemas']['Derived'];
export type EnergyTarget = components['schemas']['EnergyTarget'];
export type Model = components['schemas']['Model'];
export type Notes = components['schemas']['Notes'];
export type OutcomeKind = components['schemas']['OutcomeKind'];
export type AnyOutcomeKind = components['schemas']['AnyOutcomeKind'];
export type Outcome = components['schemas']['Outcome'];
export type Eigenvalue = components['schemas']['Eigenvalue'];
export type Ladder = components['schemas']['Ladder'];
export type Rung = components['schemas']['Rung'];
export type Forced = components['schemas']['Forced'];
export type RungChange = components['schemas']['RungChange'];
export type LargestDifference = components['schemas']['LargestDifference'];
export type BatchLine = components['schemas']['BatchLine'];
export type LadderLine = components['schemas']['LadderLine'];
export type Preview = components['schemas']['Preview'];
export type Trajectory = components['schemas']['Trajectory'];
export type Demand = components['schemas']['Demand'];
export type NearestVertex = components['schemas']['NearestVertex'];
export type MethodChoice = components['schemas']['MethodChoice'];
export type PredictableImpacts = components['schemas']['PredictableImpacts'];
export type Decimal = components['schemas']['Decimal'];
export type Decimals = components['schemas']['Decimals'];
export type DecimalOrNull = components['schemas']['DecimalOrNull'];
export type DecimalsOrNull = components['schemas']['DecimalsOrNull'];
export type Numbers = components['schemas']['Numbers'];
export type Dates = components['schemas']['Dates'];
export type NumbersOrNull = components['schemas']['NumbersOrNull'];
export type MeasuredValues = components['schemas']['MeasuredValues'];
export type BooleansOrNull = components['schemas']['BooleansOrNull'];
export type ContactMode = components['schemas']['ContactMode'];
export type ContactModes = components['schemas']['ContactModes'];
export type Impacts = components['schemas']['Impacts'];
export type Flights = components['schemas']['Flights'];
export type TrajectoryLine = components['schemas']['TrajectoryLine'];
export type End = components['schemas']['End'];
export type JacobianLine = components['schemas']['JacobianLine'];
export type StabilityLine = components['schemas']['StabilityLine'];
export type PeriodicOrbits = components['schemas']['PeriodicOrbits'];
export type BranchChange = components['schemas']['BranchChange'];
export type BranchChangeKind = components['schemas']['BranchChangeKind'];
export type BranchChangeKinds = components['schemas']['BranchChangeKinds'];
export type PeriodicOrbitsLine = components['schemas']['PeriodicOrbitsLine'];
export type Jacobian = components['schemas']['Jacobian'];
export type Margins = components['schemas']['Margins'];
export type MarginsBody = components['schemas']['MarginsBody'];
export type Budget = components['schemas']['Budget'];
export type GainMargin = components['schemas']['GainMargin'];
export type GainEnd = components['schemas']['GainEnd'];
export type CommonBudget = components['schemas']['CommonBudget'];
export type BudgetLimit = components['schemas']['BudgetLimit'];
export type Span = components['schemas']['Span'];
export type StateGain = components['schemas']['StateGain'];
export type JudgedLaw = components['schemas']['JudgedLaw'];
export type Strikes = components['schemas']['Strikes'];
export type HoldEnd = components['schemas']['HoldEnd'];
export type HoldSamples = components['schemas']['HoldSamples'];
export type CatchOutcome = components['schemas']['CatchOutcome'];
export type CatchOutcomeKind = components['schemas']['CatchOutcomeKind'];
export type CatchStrategy = components['schemas']['CatchStrategy'];
export type CatchDemand = components['schemas']['CatchDemand'];
export type CatchCandidate = components['schemas']['CatchCandidate'];
export type CatchUsed = components['schemas']['CatchUsed'];
export type CatchReason = components['schemas']['CatchReason'];
export type UprightWithin = components['schemas']['UprightWithin'];
export type CatchReach = components['schemas']['CatchReach'];
export type HoldErrorBound = components['schemas']['HoldErrorBound'];
export type ContactFrom = components['schemas']['ContactFrom'];
export type Catch = components['schemas']['Catch'];
export type CatchLine = components['schemas']['CatchLine'];
export type ThrownState = components['schemas']['ThrownState'];
export type ReachedApex = components['schemas']['ReachedApex'];
export type Throw = components['schemas']['Throw'];
export type ThrowLine = components['schemas']['ThrowLine'];
export type Controller = components['schemas']['Controller'];
export type ControllerLine = components['schemas']['ControllerLine'];
export type VerdictCode = components['schemas']['VerdictCode'];
export type Stability = components['schemas']['Stability'];
export type Linear = components['schemas']['Linear'];
export type Fit = components['schemas']['Fit'];
export type FitEstimate = components['schemas']['FitEstimate'];
export type FitQuality = components['schemas']['FitQuality'];
export type FitStability = components['schemas']['FitStability'];
export type FitProgress = components['schemas']['FitProgress'];
export type FitProgressEnd = components['schemas']['FitProgressEnd'];
export type FitProgressFailure = components['schemas']['FitProgressFailure'];
export type FitLine = components['schemas']['FitLine'];
export type Health = components['schemas']['Health'];
export type Problem = components['schemas']['Problem'];
export type ProblemError = components['schemas']['ProblemError'];
export type LiveHello = components['schemas']['live.hello'];
export type LiveImpact = components['schemas']['live.impact'];
export type LiveFlatImpact = components['schemas']['live.flat_impact'];
export type LiveImpacts = components['schemas']['live.impacts'];
export type LiveHold = components['schemas']['live.hold'];
export type LiveGap = components['schemas']['live.gap'];
export type LiveEnd = components['schemas']['live.end'];
export type LiveAck = components['schemas']['live.ack'];
export type LiveNextStrike = components['schemas']['live.next_strike'];
export type LiveProblem = components['schemas']['live.problem'];
export type LivePause = components['schemas']['live.pause'];
export type LiveResume = components['schemas']['live.resume'];
export type LiveStep = components['schemas']['live.step'];
export type LiveRestart = components['schemas']['live.restart'];
export type LiveSpeed = components['schemas']['live.speed'];
export type LiveSet = components['schemas']['live.set'];
export type LiveKick = components['schemas']['live.kick'];
export type LiveCatch = components['schemas']['live.catch'];
export type LiveThrow = components['schemas']['live.throw'];
export type $defs = Record<string, never>;
export type operations = Record<string, never>;
