//! The text beside the chart: tables of all methods and of other software, and the conclusions with measured numbers.

use std::fmt::Write;

use equipoise::comparison::METHODS;

use crate::{MeasuredPeer, Measurement, Point, Precision, Setting, names, others, own};

/// Values of settings in the table of methods; the chart has all of them.
const KEPT: [f64; 5] = [1e-2, 1e-3, 1e-4, 3e-5, 1e-12];

/// Largest error at impact 100 of software that counts as accurate.
const ACCURATE: f64 = 1e-9;

/// Writes the text.
pub(crate) fn write(precision: &Precision, measurement: &Measurement, load: &str) -> String {
    let machine = &measurement.machine;
    let mut text = format!(
        "Time per bounce of this program's methods and of common software, and their errors after 100 bounces, on the paper's case 1 (0.3 rad \
         at\nrelease).\n\n\
         ![Error over time per bounce, for all methods and for common software](speed-and-accuracy.svg)\n\n\
         Written by `benches/run peers accuracy` on {}, {} cores, build {}. Load averages before\nthe start: \
         {:.2} and {load}.\n\n\
         The error is the largest of |ρδθ| in metres and |δẋ|, |δẏ|, |ρδθ̇| in metres per second just before impact 100. θ is the angle, (ẋ, ẏ) \
         the\nvelocity of the centre of gravity, and ρ the radius of gyration. δ is the difference from the map with 31 digits for methods, and \
         from a\nreference with 60 digits for other software.\n\n",
        machine.processor,
        machine.cores,
        equipoise::BUILD,
        machine.load_average,
    );
    write_conclusions(precision, measurement, &mut text);
    write_peers(measurement, &mut text);
    write_methods(precision, &mut text);
    text
}

fn write_conclusions(precision: &Precision, measurement: &Measurement, text: &mut String) {
    let method = |name: &str| precision.points.iter().find(|point| point.method == name);
    let (Some(map), Some(free), Some(linear)) = (method("map"), method("map_free"), method("linear")) else { return };
    let is_general = |point: &&Point| !["map", "map_free", "linear", "extended"].contains(&point.method.as_str());
    let general = || precision.points.iter().filter(is_general).filter_map(|point| Some((point, point.error?)));
    let time = |point: &Point| point.cost_ns_per_bounce / map.cost_ns_per_bounce;
    let map_error = map.error.unwrap_or(f64::NAN);
    text.push_str("Conclusions:\n\n");
    let _ = writeln!(
        text,
        "- The return map (\"map\") takes {} ns per bounce, with an error of {}. Its variant without the energy correction (\"energy left free\") takes\n  \
         {} ns, with an error of {} on this run; the correction pays off on long runs. The linear solution takes {} ns, but its error at this\n  \
         angle is {}. Its set-up time of some 40 µs is left out.",
        three_digits(map.cost_ns_per_bounce),
        scientific(map.error),
        three_digits(free.cost_ns_per_bounce),
        scientific(free.error),
        three_digits(linear.cost_ns_per_bounce),
        scientific(linear.error),
    );
    let located: Vec<_> = general().filter(|(point, _)| !is_coarse(point)).collect();
    let errors = range(located.iter().map(|(_, error)| error / map_error));
    let cheapest = located.iter().map(|(point, _)| time(point)).fold(f64::INFINITY, f64::min);
    let _ = writeln!(
        text,
        "- General methods that locate the contact to the last digit have {errors} times the error of the map, and take at least {} times its time.\n  \
         Smaller steps make the error larger: a free flight is a parabola, which these methods follow without error, so more steps only add\n  \
         rounding.",
        three_digits(cheapest),
    );
    let best = general().filter(|(point, _)| is_coarse(point)).min_by(|one, other| one.1.total_cmp(&other.1));
    if let Some((point, error)) = best {
        let _ = writeln!(
            text,
            "- Methods that do not locate the contact are far less accurate: the best has an error of {}, at {} times the map's time.",
            scientific(Some(error)),
            three_digits(time(point)),
        );
    }
    let is_accurate = |peer: &&MeasuredPeer| peer.error_at_100.is_some_and(|error| error <= ACCURATE);
    let of_engines = || others(measurement).filter(|peer| peer.setting.starts_with("step"));
    if let Some(map) = own(measurement) {
        let times: Vec<String> = names(measurement)
            .into_iter()
            .filter_map(|name| {
                let same = others(measurement).filter(is_accurate).filter(|peer| peer.name == name);
                let least = same.map(|peer| peer.ns_per_bounce).min_by(f64::total_cmp)?;
                Some(format!("  - {name}: {}\n", three_digits(least / map.ns_per_bounce)))
            })
            .collect();
        let _ = write!(
            text,
            "- Common software with an error of at most {ACCURATE:e} takes these multiples of the map's time, each at its fastest such setting:\n{}",
            times.concat(),
        );
    }
    let early = range(of_engines().filter_map(|peer| peer.error_at_10));
    let late = range(of_engines().filter_map(|peer| peer.error_at_100));
    let _ = writeln!(
        text,
        "- Physics engines with fixed steps have errors of {early} after only ten impacts, and of {late} at impact 100, as far as they get \
         there.",
    );
    let ended = precision.points.iter().filter(|point| point.method == "penalty");
    if ended.clone().all(|point| point.error.is_none()) {
        text.push_str(
            "- A spring-damper contact does not survive case 1 at any of these steps: its run ends too early.\n",
        );
    }
    text.push('\n');
}

/// True if the method does not search for the time of a contact.
fn is_coarse(point: &Point) -> bool {
    ["runge_kutta_secant", "runge_kutta_step_end", "time_stepping"].contains(&point.method.as_str())
}

fn write_peers(measurement: &Measurement, text: &mut String) {
    text.push_str(
        "### Common software\n\n\
         `benches/peers/run` installs the software and runs the same case as a user of it would: event solvers flight by flight with the \
         paper's\nstrike, engines with a contact of their own on a table that is tilted before each step. Times are CPU time, the best of some rounds.\n\n\
         | | version | setting | ns per bounce | error at impact 10 | error at impact 100 |\n|---|---|---|---|---|---|\n",
    );
    let mut rows: Vec<&MeasuredPeer> = own(measurement).into_iter().collect();
    for name in names(measurement) {
        rows.extend(others(measurement).filter(|peer| peer.name == name));
    }
    for MeasuredPeer { name, version, setting, ns_per_bounce, impacts, error_at_10, error_at_100 } in rows {
        let last = match error_at_100 {
            Some(error) => scientific(Some(*error)),
            None => format!("lost the rod after {impacts} impacts"),
        };
        let (ns, tenth) = (grouped(*ns_per_bounce), scientific(*error_at_10));
        let _ = writeln!(text, "| {name} | {version} | {setting} | {ns} | {tenth} | {last} |");
    }
    text.push('\n');
}

fn write_methods(precision: &Precision, text: &mut String) {
    text.push_str(
        "### Methods of this program\n\n\
         `/v1/precision?preset=case-1` measures them in turns, here and on any server. `axis=evaluations` draws the errors over work counts, \
         which are\nthe same on every machine. An evaluation is one\ncomputation of the equations of motion, or of the gap between rod and table. The table has a selection of \
         the settings.\n\n\
         | method | setting | ns per bounce, median | quartiles | evaluations per bounce | error at impact 100 |\n|---|---|---|---|---|---|\n",
    );
    for method in METHODS {
        for point in precision.points.iter().filter(|point| point.method == method.name) {
            let setting = match &point.setting {
                Some(setting) if !KEPT.contains(&setting.value) => continue,
                Some(Setting { name, value, unit }) if unit == "1" => format!("{name} {value}"),
                Some(Setting { name, value, unit }) => format!("{name} {value} {unit}"),
                None => String::new(),
            };
            let [low, high] = point.spread_ns_per_bounce.map(grouped);
            let evaluations = point
                .evaluations
                .map_or(String::new(), |count| three_digits(count as f64 / point.outcome.bounces as f64));
            let error = match point.error {
                Some(error) => scientific(Some(error)),
                None if method.name == "extended" => "the reference".to_owned(),
                None => format!("{} at impact {}", point.outcome.kind, point.outcome.bounces),
            };
            let ns = grouped(point.cost_ns_per_bounce);
            let _ =
                writeln!(text, "| {} | {setting} | {ns} | {low} to {high} | {evaluations} | {error} |", method.title);
        }
    }
}

/// Least and largest value, in words.
fn range(values: impl Iterator<Item = f64>) -> String {
    let (low, high) =
        values.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| (low.min(value), high.max(value)));
    format!("{} to {}", three_digits(low), three_digits(high))
}

fn scientific(number: Option<f64>) -> String {
    number.map_or("–".to_owned(), |number| format!("{number:.1e}"))
}

/// A number with three significant digits or all digits before the point.
fn three_digits(number: f64) -> String {
    let places = (2.0 - number.abs().log10().floor()).clamp(0.0, 6.0) as usize;
    if places > 0 { format!("{number:.places$}") } else { grouped(number) }
}

/// Whole number with thousands separated by commas; three significant digits below 100.
fn grouped(number: f64) -> String {
    if number.abs() < 100.0 {
        return three_digits(number);
    }
    let digits = format!("{number:.0}");
    let mut text = String::new();
    for (place, digit) in digits.chars().enumerate() {
        if place > 0 && (digits.len() - place).is_multiple_of(3) {
            text.push(',');
        }
        text.push(digit);
    }
    text
}
