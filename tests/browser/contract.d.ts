// The shapes of requests and answers that the page uses. Written by `node tests/browser/contract.js` from openapi.yaml; not to be edited.

export type paths = Record<string, never>;
export type webhooks = Record<string, never>;
export interface components {
    schemas: {
        AngleQuantiles: {
            n: number[];
            alive: number[];
            q05: components["schemas"]["NumbersOrNull"];
            q25: components["schemas"]["NumbersOrNull"];
            q50: components["schemas"]["NumbersOrNull"];
            q75: components["schemas"]["NumbersOrNull"];
            q95: components["schemas"]["NumbersOrNull"];
        };
        /** @enum {string} */
        AnyOutcomeKind: "completed" | "toppled" | "separating" | "sinking" | "settled" | "diverged" | "other_vertex" | "missed" | "beyond_limits" | "off_table" | "held" | "rests_on_edge" | "fell" | "slipped" | "not_caught";
        Basin: {
            theta: number;
            bounces: number;
            holes: number[][];
            unbroken: number;
            tolerance: number;
            spacing: number;
        };
        BooleansOrNull: (boolean | null)[];
        BounceState: {
            x: number;
            theta: number;
            x_dot: number;
            y_dot: number;
            theta_dot: number;
        };
        Boundary: {
            coefficient: number;
            kind: components["schemas"]["LossKind"];
        };
        BranchChange: {
            kind: components["schemas"]["BranchChangeKind"];
            value: number;
            theta: number;
            residue: number | null;
            detail: string;
        };
        /** @enum {string} */
        BranchChangeKind: "period_doubling" | "fold" | "pitchfork" | "neimark_sacker";
        BranchChangeKinds: (components["schemas"]["BranchChangeKind"] | null)[];
        BriefOutcome: {
            kind: components["schemas"]["OutcomeKind"];
        };
        Budget: {
            verdict: components["schemas"]["Verdict"] | null;
            bounces: number;
            errors: components["schemas"]["BudgetError"][] | null;
            together: components["schemas"]["CommonBudget"] | null;
            present: components["schemas"]["CommonBudget"] | null;
            reason: string;
        };
        BudgetError: {
            field: string;
            unit: string;
            value: number;
            reference: number;
            below: components["schemas"]["BudgetLimit"] | null;
            above: components["schemas"]["BudgetLimit"] | null;
            reason: string | null;
        };
        BudgetLimit: {
            value: number;
            accuracy: number;
            spacing: number;
            decided_by: components["schemas"]["LimitDecidedBy"];
            outcome: components["schemas"]["BriefOutcome"] | null;
            small: number | null;
            detail: string;
        };
        BudgetSize: {
            field: string;
            unit: string;
            value: number;
        };
        ByState: {
            x: number;
            theta: number;
            x_dot: number;
            theta_dot: number;
        };
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
            error_bound: number | null;
            contact_from: number | null;
            upright_within: components["schemas"]["UprightWithin"];
            demand: components["schemas"]["CatchDemand"];
            reach: components["schemas"]["CatchReach"] | null;
            notes: string[];
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
        CatchCounts: {
            held: number;
            rests_on_edge: number;
            fell: number;
            slipped: number;
            beyond_limits: number;
            not_caught: number;
            none: number;
        };
        CatchDemand: {
            tilt: number;
            tilt_rate: number | null;
            speed: number;
            stroke: number | null;
            travel: number;
            normal_force: number;
            friction: number | null;
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
        CatchReach: {
            theta: number;
            limit: number | null;
        };
        CatchReason: {
            name: components["schemas"]["CatchStrategy"];
            reason: string;
        };
        /** @enum {string} */
        CatchStrategy: "bounce_down" | "plan" | "brake";
        CatchUsed: {
            strategy: components["schemas"]["CatchStrategy"];
            ratio: number | null;
            strikes: number | null;
            brake: number | null;
            weights: components["schemas"]["Weights"];
            hold_speed: number;
            hold: number;
            hold_samples: number;
        };
        CellCounts: components["schemas"]["RegionCounts"] | components["schemas"]["CatchCounts"];
        Chaos: {
            indicator: number;
            chaotic: boolean;
            bounces: number;
        };
        /** @enum {string} */
        ClientMessageName: "pause" | "resume" | "step" | "restart" | "speed" | "set" | "kick" | "catch" | "throw";
        CommonBudget: {
            sizes: components["schemas"]["BudgetSize"][];
            factor: components["schemas"]["BudgetLimit"];
        };
        /** @enum {string} */
        ContactLaw: "poisson" | "newton" | "stronge";
        /** @enum {string} */
        ContactMode: "frictionless" | "slide" | "stick" | "reverse_slide" | "slide_through";
        ContactModes: (components["schemas"]["ContactMode"] | null)[];
        Controller: {
            scene: components["schemas"]["Scene"];
            model: components["schemas"]["Model"];
            weights: components["schemas"]["Weights"];
            state_order: components["schemas"]["StateName"][];
            matrices: components["schemas"]["LinearModel"];
            contact: components["schemas"]["LawContact"];
            gain: components["schemas"]["StateGain"];
            stable: boolean;
            eigenvalues: components["schemas"]["Eigenvalue"][];
            spectral_radius: number;
            bounces_per_decade: number | null;
            margins: components["schemas"]["Margin"][];
            residual: number;
            iterations: number;
            fixed_point: components["schemas"]["ControllerFixedPoint"];
            y_dot_change: number | null;
            open_loop: components["schemas"]["Eigenvalue"][];
            energy_eigenvalue: number;
            applied: components["schemas"]["JudgedLaw"] | null;
            given: components["schemas"]["JudgedLaw"] | null;
            regions: components["schemas"]["RegionLinks"];
            notes: string[];
        };
        ControllerFixedPoint: {
            x: number;
            theta: number;
            x_dot: number;
            y_dot: number;
            theta_dot: number;
            flight_time: number;
            apex_height: number;
        };
        CountRange: {
            minimum: number;
            maximum: number;
        };
        Decimal: number | string;
        DecimalOrNull: null | number | string;
        Decimals: components["schemas"]["Decimal"][];
        DecimalsOrNull: components["schemas"]["DecimalOrNull"][];
        Demand: {
            tilt: number;
            tilt_rate: number;
            speed: number;
            stroke: number;
        };
        Derived: {
            gravity_in_plane: number;
            contact_distance: number;
            radius_of_gyration: number | null;
            outline: number[][] | null;
            target: components["schemas"]["EnergyTarget"] | null;
        };
        Eigenvalue: {
            re: number;
            im: number;
            modulus: number;
        };
        EnergyTarget: {
            height: number;
            energy: number;
        };
        Ensemble: {
            scene: components["schemas"]["Scene"];
            model: components["schemas"]["Model"];
            runs: number;
            bounces: number;
            seed: number;
            tile: components["schemas"]["EnsembleTile"];
            survived: components["schemas"]["Survived"];
            mean_bounces: number;
            median_bounces: number | null;
            half_life: number | null;
            counts: components["schemas"]["EnsembleCounts"];
            notes: string[];
            survival: components["schemas"]["SurvivalCurve"];
            quantiles: components["schemas"]["AngleQuantiles"];
            angles: number[][] | null;
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
        EnsembleTile: {
            index: number;
            of: number;
            first_run: number;
            runs: number;
        };
        Failure: {
            name: components["schemas"]["FailureName"];
            title: string;
            method: string;
            why: string;
            scene: components["schemas"]["Scene"];
            bounces: number;
            says: components["schemas"]["FailureClaim"][];
            truth: components["schemas"]["FailureTruth"];
            ask: string;
            picture: string;
        };
        FailureClaim: {
            method: string;
            text: string;
            value: number | null;
            unit: string | null;
            right: boolean;
            detail: string;
        };
        /** @enum {string} */
        FailureName: "double-eigenvalue-soft" | "double-eigenvalue-hard" | "hard-by-feedback" | "parallel-drift" | "order-three" | "wide-start" | "beyond-critical" | "invented-stability" | "destroyed-stability" | "missed-contact" | "finite-differences" | "grazing" | "zeno" | "trivial-root" | "chaos" | "low-target" | "settled-swing" | "contact-gain" | "biased-angle" | "turning-table" | "late-sensing" | "air-drag";
        FailureTruth: {
            text: string;
            detail: string;
        };
        Field: {
            field: string;
            symbol: string;
            group: string;
            title: string;
            about: string;
            unit: string;
            kind: components["schemas"]["FieldKindName"];
            minimum: number | null;
            maximum: number | null;
            default: components["schemas"]["FieldDefault"] | null;
            required: boolean;
            choices: string[] | null;
            count?: components["schemas"]["CountRange"];
            live: boolean;
        };
        FieldDefault: number | string | boolean;
        /** @enum {string} */
        FieldKindName: "number" | "integer" | "boolean" | "choice" | "numbers" | "vertices";
        FieldTolerance: {
            field: string;
            unit: string;
            tolerance: number;
        };
        FieldValue: {
            field: string;
            unit: string;
            value: number;
        };
        Fit: {
            estimates: components["schemas"]["FitEstimate"][];
            correlation: components["schemas"]["NumbersOrNull"][];
            residuals: components["schemas"]["FitResiduals"];
            sd: components["schemas"]["FitDeviations"];
            chi_squared: number;
            degrees_of_freedom: number;
            quality: components["schemas"]["FitQuality"];
            windows: number;
            iterations: number;
            scene: components["schemas"]["Scene"];
            stability: components["schemas"]["FitStability"];
            notes: string[];
        };
        FitDeviations: {
            theta: number | null;
            x_dot: number | null;
            y_dot: number | null;
            theta_dot: number | null;
            x: number | null;
            t: number | null;
        };
        FitEstimate: {
            field: string;
            value: number;
            sd: number | null;
            interval: number[] | null;
            unit: string;
            identifiable: boolean;
            detail: string | null;
        };
        FitProgress: {
            progress: components["schemas"]["FitStep"];
        };
        FitQuality: {
            kind: components["schemas"]["FitQualityKind"];
            detail: string;
        };
        /** @enum {string} */
        FitQualityKind: "good" | "deviations_too_large" | "not_random" | "not_followed" | "not_explained" | "not_converged";
        FitRequest: {
            preset?: components["schemas"]["PresetName"] | null;
            scene?: components["schemas"]["ScenePatch"] | null;
            measured: {
                n?: number[] | null;
                theta?: components["schemas"]["MeasuredValues"] | null;
                x_dot?: components["schemas"]["MeasuredValues"] | null;
                y_dot?: components["schemas"]["MeasuredValues"] | null;
                theta_dot?: components["schemas"]["MeasuredValues"] | null;
                x?: components["schemas"]["MeasuredValues"] | null;
                t: components["schemas"]["MeasuredValues"] | null;
            };
            unknown: string[];
            sd?: {
                theta?: number | null;
                x_dot?: number | null;
                y_dot?: number | null;
                theta_dot?: number | null;
                x?: number | null;
                t?: number | null;
            } | null;
        };
        FitResiduals: {
            n: number[];
            row: number[];
            window: number[];
            theta: components["schemas"]["NumbersOrNull"];
            x_dot: components["schemas"]["NumbersOrNull"];
            y_dot: components["schemas"]["NumbersOrNull"];
            theta_dot: components["schemas"]["NumbersOrNull"];
            x: components["schemas"]["NumbersOrNull"];
            t: components["schemas"]["NumbersOrNull"];
            outlier: components["schemas"]["BooleansOrNull"];
        };
        FitStability: {
            verdict: components["schemas"]["Verdict"];
            nonlinear: components["schemas"]["NonlinearRun"];
            chaos: components["schemas"]["Chaos"] | null;
            margins: components["schemas"]["Margin"][];
            spectral_margin: components["schemas"]["SpectralMargin"] | null;
            holds: boolean | null;
        };
        /** @enum {string} */
        FitStageName: "numbers" | "starts" | "short_windows" | "longer_windows" | "outliers" | "beside" | "verdict";
        FitStep: {
            done: number;
            of: number;
            stage: components["schemas"]["FitStageName"];
            search: number;
            iterations: number;
            residual: number | null;
        };
        FixedPoint: {
            x?: number;
            theta: number;
            x_dot: number;
            y_dot: number;
            theta_dot: number;
            flight_time: number;
            apex_height: number;
        };
        Flights: {
            impact: number[];
            time_ms?: number[];
            t: number[];
            x: number[];
            y: number[];
            theta: components["schemas"]["NumbersOrNull"];
            x_dot: number[];
            y_dot: number[];
            theta_dot: components["schemas"]["NumbersOrNull"];
        };
        Forced: {
            rung: components["schemas"]["Rung"];
            field: string;
            detail: string;
        };
        /** @enum {string} */
        HoldContact: "frictionless" | "matched" | "coulomb";
        HoldEnd: {
            kind: components["schemas"]["HoldEndKind"];
            t: number;
            detail: string;
            contact: components["schemas"]["HoldContact"];
            error_bound: number | null;
            upright_within: components["schemas"]["UprightWithin"];
        };
        /** @enum {string} */
        HoldEndKind: "completed" | "contact_lost" | "slipped" | "toppled" | "other_vertex" | "rests_on_edge" | "beyond_limits" | "off_table" | "too_long";
        HoldSamples: {
            t: number[];
            x: number[];
            theta: number[];
            x_dot: number[];
            theta_dot: number[];
            alpha: number[];
            normal_force: number[];
            tangential_force: number[];
            table_x: number[];
            table_y: number[];
            table_y_dot: number[];
        };
        Impacts: {
            n: number[];
            time_ms?: number[];
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
            impulse_tangential: components["schemas"]["NumbersOrNull"];
            contact_mode: components["schemas"]["ContactModes"];
            energy: components["schemas"]["Decimals"];
            flight_time: components["schemas"]["DecimalsOrNull"];
            contact_velocity: components["schemas"]["Decimals"];
            clearance: number[];
            error_estimate: components["schemas"]["NumbersOrNull"];
        };
        JudgedLaw: {
            contact: components["schemas"]["LawContact"];
            gain: components["schemas"]["StateGain"];
            stable: boolean;
            eigenvalues: components["schemas"]["Eigenvalue"][];
            spectral_radius: number;
            bounces_per_decade: number | null;
            margins: components["schemas"]["Margin"][];
        };
        Ladder: {
            scene: components["schemas"]["Scene"];
            bounces: number;
            tolerance: number;
            rung: components["schemas"]["Rung"];
            enough: components["schemas"]["Rung"];
            reason: string;
            rungs: components["schemas"]["LadderRung"][];
        };
        LadderRung: {
            name: components["schemas"]["Rung"];
            forced: components["schemas"]["Forced"] | null;
            scene: components["schemas"]["Scene"] | null;
            reason: string | null;
            outcome: components["schemas"]["Outcome"] | null;
            demand: components["schemas"]["Demand"] | null;
            cost_ns_per_bounce: number;
            change: components["schemas"]["RungChange"] | null;
            needed: boolean | null;
        };
        LargestDifference: {
            difference: number;
            impact: number | null;
        };
        /** @enum {string} */
        LawContact: "frictionless" | "stick";
        /** @enum {string} */
        LimitDecidedBy: "linear" | "nonlinear" | "boundary" | "lyapunov" | "fixed_point" | "refused" | "range";
        LimitSegment: {
            residue: number;
            x: number[];
            y: number[];
        };
        Linear: {
            kind: components["schemas"]["LinearKind"];
            residue: number | null;
            rotation: number | null;
            spectral_radius: number;
            eigenvalues: components["schemas"]["Eigenvalue"][];
            energy_eigenvalue: number;
        };
        /** @enum {string} */
        LinearKind: "attracting" | "elliptic" | "parabolic" | "hyperbolic";
        LinearModel: {
            a: number[][];
            b: number[];
        };
        LiveAck: {
            /** @constant */
            type: "ack";
            of: components["schemas"]["ClientMessageName"];
            url: string;
            run_time: number;
            now_ms: number;
            speed: number;
            paused: boolean;
            impact: number | null;
            next_strike: components["schemas"]["LiveNextStrike"] | null;
        };
        LiveEnd: {
            /** @constant */
            type: "end";
            outcome: components["schemas"]["Outcome"];
            demand: components["schemas"]["Demand"];
            hold_end?: components["schemas"]["HoldEnd"];
        };
        LiveGap: {
            /** @constant */
            type: "gap";
            from: number;
            to: number;
        };
        LiveHello: {
            /** @constant */
            type: "hello";
            scene: components["schemas"]["Scene"];
            scene_in_force: components["schemas"]["Scene"];
            derived: components["schemas"]["Derived"];
            model: components["schemas"]["Model"];
            epoch_ms: number;
            speed: number;
            paused: boolean;
            now_ms: number;
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
            first_strike: components["schemas"]["LiveNextStrike"] | null;
            build: string;
        };
        LiveHold: {
            /** @constant */
            type: "hold";
            columns: components["schemas"]["HoldSamples"];
        };
        LiveImpact: {
            /** @constant */
            type: "impact";
            /** Format: int64 */
            n: number;
            /** Format: int64 */
            time_ms: number;
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
            contact_velocity: number;
            clearance: number;
            next_strike: components["schemas"]["LiveNextStrike"] | null;
        };
        LiveImpactColumns: {
            n: number[];
            time_ms: number[];
            t: number[];
            x: number[];
            theta: number[];
            x_dot: number[];
            y_dot: number[];
            theta_dot: components["schemas"]["NumbersOrNull"];
            x_dot_after: components["schemas"]["NumbersOrNull"];
            y_dot_after: components["schemas"]["NumbersOrNull"];
            theta_dot_after: components["schemas"]["NumbersOrNull"];
            alpha: number[];
            table_velocity_x: components["schemas"]["NumbersOrNull"];
            table_velocity_y: components["schemas"]["NumbersOrNull"];
            impulse_normal: components["schemas"]["NumbersOrNull"];
            impulse_tangential: components["schemas"]["NumbersOrNull"];
            contact_mode: components["schemas"]["ContactModes"];
            energy: number[];
            flight_time: components["schemas"]["NumbersOrNull"];
            contact_velocity: number[];
            clearance: number[];
        };
        LiveImpacts: {
            /** @constant */
            type: "impacts";
            columns: components["schemas"]["LiveImpactColumns"];
            next_strike: components["schemas"]["LiveNextStrike"] | null;
        };
        LiveNextStrike: {
            n: number;
            t: number;
            x: number;
            y: number;
            alpha: number;
            table_velocity: components["schemas"]["TableVelocity"] | null;
            target: components["schemas"]["EnergyTarget"] | null;
        };
        LiveProblem: {
            /** @constant */
            type: "problem";
            status: number;
            title: string;
            detail: string;
            errors: components["schemas"]["ProblemError"][];
        };
        /** @enum {string} */
        LossBifurcation: "period_doubling" | "fold" | "pitchfork" | "neimark_sacker";
        /** @enum {string} */
        LossField: "table.tilt_gain" | "table.energy_gain" | "table.feedback";
        /** @enum {string} */
        LossKind: "soft" | "hard" | "degenerate";
        LossOfStability: {
            field: components["schemas"]["LossField"];
            value: number;
            bifurcation: components["schemas"]["LossBifurcation"];
            coefficient: number;
            kind: components["schemas"]["LossKind"];
            swing: number | null;
            heights: number[] | null;
        };
        Lyapunov: {
            coefficient: number;
            kind: components["schemas"]["LyapunovKind"];
            escape_bounces: number | null;
            detail: string;
        };
        /** @enum {string} */
        LyapunovKind: "repelling" | "attracting" | "neutral";
        Margin: {
            field: components["schemas"]["MarginField"];
            unit: string;
            of: components["schemas"]["MarginOf"];
            value: number;
            below: components["schemas"]["MarginEnd"] | null;
            above: components["schemas"]["MarginEnd"] | null;
        };
        MarginEnd: {
            limit: number;
            margin: number;
            least: number | null;
            most?: number;
            sd?: number;
            accuracy?: number;
            outcome?: components["schemas"]["BriefOutcome"];
            detail?: string;
        };
        /** @enum {string} */
        MarginField: "table.tilt_gain" | "table.energy_gain" | "table.feedback";
        /** @enum {string} */
        MarginOf: "small" | "release";
        MeasuredValues: (number | null)[];
        MethodChoice: {
            name: components["schemas"]["RunMethodName"];
            reason: string;
        };
        Model: {
            name: components["schemas"]["Rung"];
            reason: string;
            forced: components["schemas"]["Forced"][];
        };
        MovingBounce: {
            state: components["schemas"]["BounceState"];
            change: components["schemas"]["BounceState"];
            flight_time: number;
        };
        NearestVertex: {
            vertex: number;
            clearance: number;
            impact: number;
            t: number;
        };
        /** @enum {string} */
        NoiseModel: "strike" | "plan";
        NonlinearRun: {
            outcome: components["schemas"]["Outcome"];
            max_theta: number | null;
            demand: components["schemas"]["Demand"];
        };
        NothingRepeats: {
            reason: string;
            moves: components["schemas"]["MovingBounce"] | null;
        };
        NumbersOrNull: (number | null)[];
        OrbitBranch: {
            value: number[];
            theta: number[];
            residue: components["schemas"]["NumbersOrNull"];
            stable: components["schemas"]["BooleansOrNull"];
            fold: boolean[];
            change: components["schemas"]["BranchChangeKinds"];
            residual: number[];
            energy: number[];
            flight_time: number[];
            first_theta: number[];
            first_x_dot: number[];
            first_y_dot: number[];
            first_theta_dot: number[];
        };
        OrbitStates: {
            theta: number[];
            x_dot: number[];
            y_dot: number[];
            theta_dot: number[];
            x?: number[];
        };
        OrbitSweep: {
            field: string;
            from: number;
            to: number;
            points: number;
            start: number;
        };
        Outcome: {
            kind: components["schemas"]["AnyOutcomeKind"];
            bounces: number;
            t: number;
            detail: string;
            quantity: string | null;
            value: number | null;
            limit: number | null;
            unit: string | null;
            settle_time: number | null;
            theta_dot?: number;
        };
        /** @enum {string} */
        OutcomeKind: "completed" | "toppled" | "separating" | "sinking" | "settled" | "diverged" | "other_vertex" | "missed" | "beyond_limits" | "off_table";
        OverTolerances: {
            tolerances: components["schemas"]["FieldTolerance"][];
            holds: boolean | null;
            worst: components["schemas"]["FieldValue"][] | null;
            apex_height: components["schemas"]["Span"] | null;
            energy_eigenvalue: components["schemas"]["Span"] | null;
            reason: string;
        };
        PaperCheck: {
            quantity: string;
            symbol: string;
            unit: string;
            printed: number | null;
            computed: number;
            agrees: boolean;
            why: string | null;
        };
        PaperItem: {
            id: string;
            kind: components["schemas"]["PaperItemKind"];
            section: string;
            place: string;
            title: string;
            printed: string;
            agrees: boolean;
            checks: components["schemas"]["PaperCheck"][];
            why: string | null;
            scene: components["schemas"]["Scene"];
            ask: string;
            picture: string | null;
        };
        /** @enum {string} */
        PaperItemKind: "equation" | "table" | "figure" | "claim";
        PeriodicOrbits: {
            scene: components["schemas"]["Scene"];
            model: components["schemas"]["Model"];
            period: number;
            least_period: number | null;
            states: components["schemas"]["OrbitStates"];
            residual: number | null;
            steps: number | null;
            energy: number | null;
            drift: number | null;
            eigenvalues: components["schemas"]["Eigenvalue"][];
            residue: number | null;
            stable: boolean | null;
            flight_time: number | null;
            contact_velocity: number | null;
            nothing_repeats: components["schemas"]["NothingRepeats"] | null;
            sweep: components["schemas"]["OrbitSweep"] | null;
            branch: components["schemas"]["OrbitBranch"] | null;
            changes: components["schemas"]["BranchChange"][] | null;
            notes: string[];
        };
        Precision: {
            scene: components["schemas"]["Scene"];
            model: components["schemas"]["Model"];
            bounces: number;
            reference: components["schemas"]["PrecisionReference"];
            methods: components["schemas"]["PrecisionMethodInWords"][];
            points: components["schemas"]["PrecisionPoint"][];
            notes: string[];
        };
        /** @enum {string} */
        PrecisionMethod: "map" | "map_free" | "linear" | "extended" | "adaptive" | "runge_kutta_bisection" | "runge_kutta_secant" | "runge_kutta_step_end" | "sampling" | "time_stepping" | "penalty";
        PrecisionMethodInWords: {
            name: components["schemas"]["PrecisionMethod"];
            title: string;
            about: string;
        };
        PrecisionOutcome: {
            kind: components["schemas"]["PrecisionOutcomeKind"];
            bounces: number;
            t?: number;
        };
        /** @enum {string} */
        PrecisionOutcomeKind: "completed" | "toppled" | "separating" | "sinking" | "settled" | "diverged" | "other_vertex" | "missed" | "beyond_limits" | "off_table" | "out_of_steps" | "unavailable";
        PrecisionPoint: {
            method: components["schemas"]["PrecisionMethod"];
            setting: components["schemas"]["PrecisionSetting"] | null;
            cost_ns_per_bounce: number | null;
            spread_ns_per_bounce: number[] | null;
            repeats: number;
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
        PrecisionReference: {
            method: components["schemas"]["PrecisionMethod"];
            outcome: components["schemas"]["PrecisionOutcome"];
            rounding: number;
        };
        PrecisionSetting: {
            name: components["schemas"]["SettingName"];
            value: number;
            unit: components["schemas"]["SettingUnit"];
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
        /** @enum {string} */
        PresetName: "case-1" | "case-2" | "case-2-figure" | "case-3" | "case-4" | "case-5" | "critical-soft" | "critical-hard" | "true-triangle" | "triangle-polygon" | "point-mass" | "still-lossy" | "case-1-noise" | "case-4-noise" | "case-4-total" | "air-table" | "juggling" | "rough-matched" | "rough-feedback" | "rough-noise" | "rough-catch" | "rough-juggling";
        ProblemError: {
            pointer: string;
            detail: string;
        };
        Quantity: {
            quantity: components["schemas"]["QuantityName"];
            symbol: string;
            unit: string;
            value: number | null;
            where: string;
            why?: string;
            with?: components["schemas"]["ScenePatch"];
        };
        /** @enum {string} */
        QuantityName: "tilt_gain.critical" | "body.radius_of_gyration" | "fixed_point.y_dot" | "angle_eigenvalue.im" | "jacobian.determinant" | "theta.bounded" | "release.theta_dot" | "energy.target" | "energy_gain.upper" | "energy_gain.eigenvalue" | "gravity.in_plane" | "energy.settled" | "vertical_energy.settled" | "friction.helped" | "theta.growth" | "angle_eigenvalue.critical" | "tilt_gain.bounded" | "angle_eigenvector.second" | "settled.theta_dot";
        Region: {
            scene: components["schemas"]["Scene"];
            bounces: number;
            quantity: components["schemas"]["RegionQuantity"];
            axes: components["schemas"]["RegionAxis"][];
            tile: components["schemas"]["Tile"];
            x: number[];
            y: number[];
            values: components["schemas"]["NumbersOrNull"][];
            outcomes: number[][];
            outcome_names: string[];
            limit_curves: components["schemas"]["LimitSegment"][];
            counts: components["schemas"]["CellCounts"];
            notes: string[];
        };
        RegionAxis: {
            field: string;
            unit: string;
            from: number;
            to: number;
            count: number;
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
        RegionEnd: {
            counts: components["schemas"]["CellCounts"];
        };
        RegionLastLine: {
            end: components["schemas"]["RegionEnd"];
        };
        RegionLine: components["schemas"]["RegionRow"] | components["schemas"]["RegionLastLine"];
        RegionLinks: {
            /** Format: uri-reference */
            designed: string;
            /** Format: uri-reference */
            proportional: string;
        };
        /** @enum {string} */
        RegionQuantity: "survival" | "max_theta" | "residue" | "spectral_radius" | "caught" | "rest_time";
        RegionRow: {
            row: number;
            y: number;
            values: (number | null)[];
            outcomes: number[];
        };
        Resonance: {
            p: number;
            q: number;
            distance: number;
        };
        RotationNumber: {
            measured: number | null;
            small: number;
            resonance: components["schemas"]["Resonance"];
            strong_resonance: components["schemas"]["Resonance"] | null;
        };
        /** @enum {string} */
        RunMethodName: "linear" | "map" | "extended";
        /** @enum {string} */
        Rung: "point" | "linear" | "rod" | "rod_with_x" | "rig_errors" | "turning_table" | "delay" | "drag" | "friction" | "noise" | "polygon";
        RungChange: {
            against: components["schemas"]["Rung"];
            bounces: number;
            same_outcome: boolean;
            t: components["schemas"]["LargestDifference"];
            x: components["schemas"]["LargestDifference"];
            theta: components["schemas"]["LargestDifference"];
            x_dot: components["schemas"]["LargestDifference"];
            y_dot: components["schemas"]["LargestDifference"];
            theta_dot: components["schemas"]["LargestDifference"];
            state: components["schemas"]["LargestDifference"];
        };
        Scene: {
            body: {
                contact_distance: number;
                radius_of_gyration: number;
                offset?: number;
            } | {
                point: boolean;
            } | {
                vertices: number[][];
                contact_vertex: number;
            };
            gravity: number;
            incline: number;
            air?: {
                drag?: number;
                rotation_drag?: number;
                wind?: number;
            };
            contact: {
                restitution: number;
                friction: number;
                law: components["schemas"]["ContactLaw"];
            };
            table: {
                tilt_gain?: number;
                energy_gain: number;
                target_height?: number;
                energy_measure?: components["schemas"]["TableEnergyMeasure"];
                energy_law?: components["schemas"]["TableEnergyLaw"];
                program?: number[];
                strike: components["schemas"]["TableStrike"];
                slide: components["schemas"]["TableSlide"];
                feedback?: {
                    x?: number;
                    theta?: number;
                    x_dot?: number;
                    theta_dot?: number;
                };
                assumed_restitution?: number;
                errors?: {
                    angle_bias?: number;
                    tilt_offset?: number;
                    tilt_gain?: number;
                    speed?: number;
                };
                tilt_rate?: components["schemas"]["TableTiltRate"];
                pivot?: {
                    x?: number;
                    depth?: number;
                };
                delay?: number;
                prediction?: components["schemas"]["TablePrediction"];
                length?: number;
                limits?: {
                    tilt?: number;
                    tilt_rate?: number;
                    speed?: number;
                    stroke?: number;
                };
            };
            release: {
                height: number;
                theta?: number;
                theta_dot?: number;
                x: number;
                x_dot: number;
                y_dot: number;
            };
            topple_angle: number;
            noise?: {
                timing_sd?: number;
                angle_sd?: number;
                x_sd?: number;
                x_dot_sd?: number;
                y_dot_sd?: number;
                theta_dot_sd?: number;
                restitution_sd?: number;
                model?: components["schemas"]["NoiseModel"];
                /** Format: int64 */
                seed?: number;
                /** Format: int64 */
                run?: number;
            };
        };
        ScenePatch: {
            body?: {
                contact_distance?: number | null;
                radius_of_gyration?: number | null;
                point?: boolean | null;
                offset?: number | null;
                vertices?: number[][] | null;
                contact_vertex?: number | null;
            } | null;
            gravity?: number | null;
            incline?: number | null;
            air?: {
                drag?: number | null;
                rotation_drag?: number | null;
                wind?: number | null;
            } | null;
            contact?: {
                restitution?: number | null;
                friction?: number | null;
                law?: components["schemas"]["ContactLaw"] | null;
            } | null;
            table?: {
                tilt_gain?: number | null;
                energy_gain?: number | null;
                target_height?: number | null;
                energy_measure?: components["schemas"]["TableEnergyMeasure"] | null;
                energy_law?: components["schemas"]["TableEnergyLaw"] | null;
                program?: number[] | null;
                strike?: components["schemas"]["TableStrike"] | null;
                slide?: components["schemas"]["TableSlide"] | null;
                feedback?: {
                    x?: number | null;
                    theta?: number | null;
                    x_dot?: number | null;
                    theta_dot?: number | null;
                } | null;
                assumed_restitution?: number | null;
                errors?: {
                    angle_bias?: number | null;
                    tilt_offset?: number | null;
                    tilt_gain?: number | null;
                    speed?: number | null;
                } | null;
                tilt_rate?: components["schemas"]["TableTiltRate"] | null;
                pivot?: {
                    x?: number | null;
                    depth?: number | null;
                } | null;
                delay?: number | null;
                prediction?: components["schemas"]["TablePrediction"] | null;
                length?: number | null;
                limits?: {
                    tilt?: number | null;
                    tilt_rate?: number | null;
                    speed?: number | null;
                    stroke?: number | null;
                } | null;
            } | null;
            release?: {
                height?: number | null;
                theta?: number | null;
                theta_dot?: number | null;
                x?: number | null;
                x_dot?: number | null;
                y_dot?: number | null;
            } | null;
            topple_angle?: number | null;
            noise?: {
                timing_sd?: number | null;
                angle_sd?: number | null;
                x_sd?: number | null;
                x_dot_sd?: number | null;
                y_dot_sd?: number | null;
                theta_dot_sd?: number | null;
                restitution_sd?: number | null;
                model?: components["schemas"]["NoiseModel"] | null;
                /** Format: int64 */
                seed?: number | null;
                /** Format: int64 */
                run?: number | null;
            } | null;
        };
        /** @enum {string} */
        SettingName: "step" | "tolerance";
        /** @enum {string} */
        SettingUnit: "s" | "1";
        Span: {
            least: number;
            most: number;
        };
        SpectralMargin: {
            value: number;
            sd: number;
            least: number;
            most: number;
        };
        Stability: {
            scene: components["schemas"]["Scene"];
            derived: components["schemas"]["Derived"];
            model: components["schemas"]["Model"];
            verdict: components["schemas"]["Verdict"];
            fixed_point: components["schemas"]["FixedPoint"] | null;
            linear: components["schemas"]["Linear"] | null;
            boundary: components["schemas"]["Boundary"] | null;
            loss_of_stability: components["schemas"]["LossOfStability"][] | null;
            lyapunov: components["schemas"]["Lyapunov"] | null;
            nonlinear: components["schemas"]["NonlinearRun"];
            drift_speed: number | null;
            steady_drift?: components["schemas"]["SteadyDrift"];
            swing_pump?: components["schemas"]["SwingPump"];
            agree: boolean | null;
            rotation_number: components["schemas"]["RotationNumber"] | null;
            chaos: components["schemas"]["Chaos"] | null;
            predictable_bounces: number | null;
            basin: components["schemas"]["Basin"] | null;
            no_basin?: string;
            margins: components["schemas"]["Margin"][];
            over_tolerances?: components["schemas"]["OverTolerances"];
            budget?: components["schemas"]["Budget"];
            notes: string[];
        };
        StateGain: {
            x: number;
            theta: number;
            x_dot: number;
            theta_dot: number;
        };
        /** @enum {string} */
        StateName: "x" | "theta" | "x_dot" | "theta_dot";
        SteadyDrift: {
            theta: number | null;
            acceleration: number | null;
            speed: number | null;
            time_on_table: number | null;
        };
        Strikes: {
            n: number[];
            t: number[];
            x: number[];
            theta: number[];
            x_dot: number[];
            y_dot: number[];
            theta_dot: number[];
            x_dot_after: number[];
            y_dot_after: number[];
            theta_dot_after: number[];
            alpha: number[];
            impulse_normal: number[];
            impulse_tangential: number[];
            contact_mode: components["schemas"]["ContactModes"];
            flight_time: components["schemas"]["NumbersOrNull"];
            contact_velocity: number[];
            clearance: number[];
            table_velocity: number[];
            ratio: number[];
        };
        SurvivalCurve: {
            n: number[];
            at_risk: number[];
            ended: number[];
            survival: number[];
            lower: number[];
            upper: number[];
        };
        Survived: {
            runs: number;
            share: number;
            lower: number;
            upper: number;
        };
        SwingPump: {
            swing: number;
            distance: number;
            energy: number;
            critical_bounces: number | null;
        };
        /** @enum {string} */
        TableEnergyLaw: "proportional" | "one_strike";
        /** @enum {string} */
        TableEnergyMeasure: "vertical" | "total";
        /** @enum {string} */
        TablePrediction: "none" | "flight";
        /** @enum {string} */
        TableSlide: "none" | "matched";
        /** @enum {string} */
        TableStrike: "compensated" | "still";
        /** @enum {string} */
        TableTiltRate: "none" | "follows" | "corrected";
        TableVelocity: {
            x: number;
            y: number;
        };
        Tile: {
            index: number;
            of: number;
        };
        Trajectory: {
            scene: components["schemas"]["Scene"];
            derived: components["schemas"]["Derived"];
            model: components["schemas"]["Model"];
            method: components["schemas"]["MethodChoice"];
            outcome: components["schemas"]["Outcome"];
            impacts: components["schemas"]["Impacts"];
            predictable_bounces: number | null;
            flights?: components["schemas"]["Flights"];
            hold?: components["schemas"]["HoldSamples"];
            hold_end?: components["schemas"]["HoldEnd"];
            demand: components["schemas"]["Demand"];
            nearest_vertex?: components["schemas"]["NearestVertex"];
            notes: string[];
        };
        UprightWithin: {
            theta_1mrad: number | null;
            x_1mm: number | null;
        };
        Verdict: {
            code: components["schemas"]["VerdictCode"];
            text: string;
            decided_by: components["schemas"]["VerdictDecidedBy"];
            reason: string;
        };
        /** @enum {string} */
        VerdictCode: "stable_in_place" | "stable_drifting" | "weakly_attracting" | "elliptic" | "bounded_beyond_boundary" | "weakly_unstable" | "random" | "unstable";
        /** @enum {string} */
        VerdictDecidedBy: "linear" | "nonlinear" | "boundary" | "lyapunov" | "fixed_point" | "ensemble";
        Weights: {
            state: components["schemas"]["ByState"];
            input: number;
        };
    };
    responses: never;
    parameters: never;
    requestBodies: never;
    headers: never;
    pathItems: never;
}
export type BranchChange = components['schemas']['BranchChange'];
export type BudgetError = components['schemas']['BudgetError'];
export type Catch = components['schemas']['Catch'];
export type CatchCandidate = components['schemas']['CatchCandidate'];
export type CatchOutcome = components['schemas']['CatchOutcome'];
export type CatchUsed = components['schemas']['CatchUsed'];
export type Controller = components['schemas']['Controller'];
export type Derived = components['schemas']['Derived'];
export type Eigenvalue = components['schemas']['Eigenvalue'];
export type Ensemble = components['schemas']['Ensemble'];
export type Failure = components['schemas']['Failure'];
export type Field = components['schemas']['Field'];
export type Fit = components['schemas']['Fit'];
export type FitEstimate = components['schemas']['FitEstimate'];
export type FitProgress = components['schemas']['FitProgress'];
export type FitRequest = components['schemas']['FitRequest'];
export type HoldEnd = components['schemas']['HoldEnd'];
export type HoldSamples = components['schemas']['HoldSamples'];
export type Ladder = components['schemas']['Ladder'];
export type LiveAck = components['schemas']['LiveAck'];
export type LiveEnd = components['schemas']['LiveEnd'];
export type LiveGap = components['schemas']['LiveGap'];
export type LiveHello = components['schemas']['LiveHello'];
export type LiveHold = components['schemas']['LiveHold'];
export type LiveImpact = components['schemas']['LiveImpact'];
export type LiveImpacts = components['schemas']['LiveImpacts'];
export type LiveNextStrike = components['schemas']['LiveNextStrike'];
export type LiveProblem = components['schemas']['LiveProblem'];
export type Margin = components['schemas']['Margin'];
export type Outcome = components['schemas']['Outcome'];
export type PaperItem = components['schemas']['PaperItem'];
export type PeriodicOrbits = components['schemas']['PeriodicOrbits'];
export type Precision = components['schemas']['Precision'];
export type PrecisionPoint = components['schemas']['PrecisionPoint'];
export type Preset = components['schemas']['Preset'];
export type ProblemError = components['schemas']['ProblemError'];
export type Quantity = components['schemas']['Quantity'];
export type Region = components['schemas']['Region'];
export type RegionLine = components['schemas']['RegionLine'];
export type Stability = components['schemas']['Stability'];
export type Trajectory = components['schemas']['Trajectory'];
export type VerdictCode = components['schemas']['VerdictCode'];
export type $defs = Record<string, never>;
export type operations = Record<string, never>;
