//! Curves from loose segments, which are cut to a frame and joined, since dashes begin anew with each path.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use crate::charts::draw::geometry::{Frame, Point};
use crate::charts::draw::svg::fixed;

/// Resolution at which ends count as the same, places per px.
const FINENESS: f64 = 20.0;

/// Smallest distance of two points of a curve, px.
const NEAR: f64 = 0.5;

/// The path of all segments inside the frame, px. Empty if no segment is inside.
pub(crate) fn path(segments: &[(Point, Point)], frame: Frame) -> String {
    let inside: Vec<_> = segments.iter().filter_map(|segment| cut(*segment, frame)).collect();
    let mut path = String::new();
    for curve in joined(&inside) {
        let mut last = curve[0];
        let _ = write!(path, "M{} {}", fixed(last.0), fixed(last.1));
        for (n, point) in curve.iter().enumerate().skip(1) {
            let far = (point.0 - last.0).abs().max((point.1 - last.1).abs()) >= NEAR;
            if far || n + 1 == curve.len() {
                let _ = write!(path, "L{} {}", fixed(point.0), fixed(point.1));
                last = *point;
            }
        }
    }
    path
}

/// The part of a segment inside the frame, after Liang and Barsky.
fn cut((from, to): (Point, Point), frame: Frame) -> Option<(Point, Point)> {
    if ![from.0, from.1, to.0, to.1].iter().all(|value| value.is_finite()) {
        return None;
    }
    let (mut first, mut last): (f64, f64) = (0.0, 1.0);
    for (start, end, low, wide) in [(from.0, to.0, frame.left, frame.width), (from.1, to.1, frame.top, frame.height)] {
        for (way, room) in [(start - end, start - low), (end - start, low + wide - start)] {
            if way == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if way < 0.0 {
                first = first.max(room / way);
            } else {
                last = last.min(room / way);
            }
        }
    }
    let at = |share: f64| (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
    // A remainder of a far segment by rounding or overflow is no part of it.
    let is_part = first <= last && place(at(first)) != place(at(last)) && at(first).0.is_finite();
    is_part.then(|| (at(first), at(last)))
}

fn place((x, y): Point) -> (i64, i64) {
    ((x * FINENESS).round() as i64, (y * FINENESS).round() as i64)
}

/// Joins segments that share ends into curves: first open curves from their ends, then closed ones.
fn joined(segments: &[(Point, Point)]) -> Vec<Vec<Point>> {
    let mut meeting: BTreeMap<(i64, i64), Vec<usize>> = BTreeMap::new();
    for (n, (from, to)) in segments.iter().enumerate() {
        meeting.entry(place(*from)).or_default().push(n);
        meeting.entry(place(*to)).or_default().push(n);
    }
    let (open, closed): (Vec<_>, Vec<_>) = meeting.keys().partition(|place| meeting[*place].len() % 2 == 1);
    let mut used = vec![false; segments.len()];
    let mut curves = Vec::new();
    for start in open.into_iter().chain(closed) {
        while let Some(first) = meeting[start].iter().find(|n| !used[**n]) {
            let mut curve = Vec::new();
            let (mut here, mut next) = (*start, Some(*first));
            while let Some(n) = next {
                used[n] = true;
                let (from, to) = segments[n];
                let (near, far) = if place(from) == here { (from, to) } else { (to, from) };
                if curve.is_empty() {
                    curve.push(near);
                }
                curve.push(far);
                here = place(far);
                next = meeting[&here].iter().find(|n| !used[**n]).copied();
            }
            curves.push(curve);
        }
    }
    curves
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: Frame = Frame { left: 0.0, top: 0.0, width: 10.0, height: 10.0 };

    #[test]
    fn loose_segments_become_one_curve_in_any_order_and_direction() {
        let segments =
            [((4.0, 4.0), (2.0, 3.0)), ((0.0, 1.0), (2.0, 3.0)), ((6.0, 2.0), (4.0, 4.0)), ((9.0, 9.0), (9.0, 8.0))];
        assert_eq!(path(&segments, FRAME), "M0 1L2 3L4 4L6 2M9 8L9 9");
        let round = [((1.0, 1.0), (2.0, 1.0)), ((2.0, 2.0), (2.0, 1.0)), ((2.0, 2.0), (1.0, 1.0))];
        assert_eq!(path(&round, FRAME).matches('M').count(), 1);
    }

    #[test]
    fn what_is_outside_is_cut_off() {
        assert_eq!(path(&[((-5.0, 5.0), (15.0, 5.0))], FRAME), "M0 5L10 5");
        assert_eq!(path(&[((-5.0, 5.0), (-1.0, 5.0)), ((1.0, f64::NAN), (2.0, 2.0))], FRAME), "");
        assert_eq!(path(&[((3.0, 3.0), (3.0, 3.0))], FRAME), "");
        let _ = path(&[((-1e308, 5.0), (1e308, f64::MAX)), ((f64::MIN, f64::MIN), (f64::MAX, f64::MAX))], FRAME);
    }
}
