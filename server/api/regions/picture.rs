//! The picture of `regions`: a heat map of the tile with the linear boundary over it.

use equipoise_physics::surveys::stability_map::{MapAxis, MapQuantity};

use crate::api::formats::Pictured;
use crate::api::regions::answer::{RegionAnswer, code};
use crate::api::regions::request::RegionRequest;
use crate::api::scene::field_text;
use crate::charts::{HeatAxis, HeatMap, heat_map};
use crate::http::Problem;

impl Pictured for RegionAnswer {
    fn to_picture(&self) -> Result<String, Problem> {
        let RegionRequest { map, tile, .. } = &self.request;
        let rows = self.request.rows();
        let side = |axis: &MapAxis, first: usize, count: usize| {
            let (row, text) = (axis.name.row(), field_text(axis.name));
            HeatAxis {
                name: text.title,
                symbol: text.symbol,
                unit: row.unit,
                from: axis.value(first),
                to: axis.value(first + count.max(1) - 1),
                count,
            }
        };
        let (quantity, unit) = match map.quantity {
            MapQuantity::Survival => ("contacts survived", "1"),
            MapQuantity::MaxTheta => ("largest |θ|", "rad"),
            MapQuantity::Residue => ("residue R", "1"),
            MapQuantity::SpectralRadius => ("spectral radius", "1"),
            MapQuantity::Caught => ("caught", "1"),
            MapQuantity::RestTime => ("time to rest", "s"),
        };
        let values: Vec<Option<f64>> = self.cells.iter().map(|cell| cell.value).collect();
        let outcomes: Vec<u8> = self.cells.iter().map(|cell| code(cell, map.quantity) as u8).collect();
        let finite = || values.iter().flatten().copied().filter(|value| value.is_finite());
        let scale = match map.quantity {
            MapQuantity::Survival => (0.0, map.impacts as f64),
            MapQuantity::Caught => (0.0, 1.0),
            MapQuantity::MaxTheta | MapQuantity::Residue | MapQuantity::SpectralRadius | MapQuantity::RestTime => {
                (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max))
            }
        };
        let part = if tile.of > 1 { format!(", tile {} of {}", tile.index + 1, tile.of) } else { String::new() };
        Ok(heat_map(&HeatMap {
            title: &format!("{quantity} over {} and {}", field_text(map.x.name).title, field_text(map.y.name).title),
            subtitle: &match map.quantity.is_of_catches() {
                true => format!("catches, {} s in contact{part}", map.catch.hold),
                false => format!("runs of up to {} contacts{part}", map.impacts),
            },
            x: side(&map.x, 0, map.x.count),
            y: side(&map.y, rows.start, rows.len()),
            values: &values,
            outcomes: &outcomes,
            scale,
            quantity,
            unit,
            boundary: &self.limit_curves,
        }))
    }
}
