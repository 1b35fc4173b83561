//! The picture of `ensembles`: the survival curve and the quantiles of the angle.

use equipoise_physics::run::ending::EndingKind;
use equipoise_physics::scene::{Name, Scene, Value};

use crate::api::ensembles::answer::{ContactRow, EnsembleAnswer, Survived, is_noisy};
use crate::api::formats::{Pictured, Watched};
use crate::api::shared::tile::Tile;
use crate::charts::{AnglesAt, SurvivalAt, SurvivalCurve, significant, survival_curve};
use crate::http::Problem;

/// Name of the picture.
pub(super) const PICTURE: &str = "survival";

impl Pictured for EnsembleAnswer<'_> {
    fn to_picture(&self) -> Result<String, Problem> {
        let Survived { runs, share, lower, upper } = self.summary.survived;
        let percent = |share: f64| significant(100.0 * share, 3);
        let counts = EndingKind::ALL.into_iter().zip(self.summary.counts).filter(|(_, count)| *count > 0);
        let counts: Vec<_> = counts.map(|(outcome, count)| format!("{count} {}", outcome.name())).collect();
        let median = match self.summary.median_bounces {
            Some(median) => format!("half have ended by contact {median}"),
            None => "more than half outlast them all".to_owned(),
        };
        let caption = format!(
            "{runs} of {} runs outlast {} contacts: {} %, with 95 % confidence {} to {} % (Wilson, at each contact by \
             itself); {median}. Angles are those of the runs still going.",
            self.tile.runs,
            self.bounces,
            percent(share),
            percent(lower),
            percent(upper),
        );
        let Tile { index, of } = self.tile.tile;
        let part = if of > 1 { format!(", tile {} of {of}", index + 1) } else { String::new() };
        let points = self.rows.iter().map(|ContactRow { at, .. }| SurvivalAt {
            at_risk: at.at_risk,
            share: at.share,
            interval: at.interval,
        });
        let marks = self.rows.iter().filter_map(|row| Some(AnglesAt { n: row.n, quantiles: row.quantiles? }));
        Ok(survival_curve(&SurvivalCurve {
            title: &format!("Survival of {} runs {}", self.tile.runs, noise_in_words(self.scene.0)),
            subtitle: &format!("seed {}{part}; {}", self.seed, counts.join(", ")),
            caption: &caption,
            curve: &points.collect::<Vec<_>>(),
            angles: &marks.collect::<Vec<_>>(),
        }))
    }
}

impl Watched for EnsembleAnswer<'_> {
    fn to_pictures(&self) -> Result<Vec<(&'static str, String)>, Problem> {
        Ok(vec![(PICTURE, self.to_picture()?)])
    }
}

/// Describes the noise of a scene, for a title.
fn noise_in_words(scene: &Scene) -> String {
    let Some(Value::Choice(model)) = scene.value(Name::NoiseModel).filter(|_| is_noisy(scene)) else {
        return "without noise".to_owned();
    };
    let said = |name| scene.number(name).filter(|sd| *sd > 0.0);
    let timing = said(Name::TimingSd).map(|sd| format!(", σ_t = {} ms", significant(1e3 * sd, 3)));
    let angle = said(Name::AngleSd).map(|sd| format!(", σ_θ = {} rad", significant(sd, 3)));
    let further: String = [
        (Name::XSd, "σ_x", " m"),
        (Name::XDotSd, "σ_ẋ", " m/s"),
        (Name::YDotSd, "σ_ẏ", " m/s"),
        (Name::ThetaDotSd, "σ_θ̇", " rad/s"),
        (Name::RestitutionSd, "σ_e", ""),
    ]
    .into_iter()
    .filter_map(|(name, symbol, unit)| said(name).map(|sd| format!(", {symbol} = {}{unit}", significant(sd, 3))))
    .collect();
    format!("with {model} noise{}{}{further}", timing.unwrap_or_default(), angle.unwrap_or_default())
}
