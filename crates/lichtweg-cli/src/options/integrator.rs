//! `--integrator NAME[:key=value,...]`.

use lichtweg::scene::description::{
    EstimatorKind, Heuristic, IntegratorDescription, LightChoiceKind, LightStrategy,
};

use super::listed;

/// Names, what they stand for, and the settings each takes.
const ESTIMATORS: [(&str, EstimatorKind, &str); 3] = [
    (
        "path",
        EstimatorKind::Path,
        "light=naive|nee|mis, heuristic=balance|power, lights=auto|uniform|power|tree, rr_depth=N|off, hide_emitters=true|false",
    ),
    ("light", EstimatorKind::Light, "hide_emitters=true|false"),
    (
        "bdpt",
        EstimatorKind::Bidirectional,
        "heuristic=balance|power, lights=auto|uniform|power|tree, rr_depth=N|off, hide_emitters=true|false",
    ),
];

/// Ways to choose the light that a vertex is connected to.
const LIGHT_CHOICES: [(&str, LightChoiceKind); 4] = [
    ("auto", LightChoiceKind::Auto),
    ("uniform", LightChoiceKind::Uniform),
    ("power", LightChoiceKind::Power),
    ("tree", LightChoiceKind::Tree),
];

/// What the user wants of the estimator; what is `None` stays as the scene has it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct IntegratorChoice {
    estimator: Option<EstimatorKind>,
    light: Option<LightStrategy>,
    heuristic: Option<Heuristic>,
    light_choice: Option<LightChoiceKind>,
    rr_depth: Option<Option<u32>>,
    hide_emitters: Option<bool>,
}

impl IntegratorChoice {
    /// Replaces the chosen settings.
    pub fn apply(&self, integrator: &mut IntegratorDescription) {
        integrator.estimator = self.estimator.unwrap_or(integrator.estimator);
        integrator.light = self.light.unwrap_or(integrator.light);
        integrator.heuristic = self.heuristic.unwrap_or(integrator.heuristic);
        integrator.light_choice = self.light_choice.unwrap_or(integrator.light_choice);
        integrator.roulette.start_depth = self.rr_depth.unwrap_or(integrator.roulette.start_depth);
        integrator.hide_emitters = self.hide_emitters.unwrap_or(integrator.hide_emitters);
    }
}

/// An estimator by its name, with settings to change.
pub fn parse_integrator(text: &str) -> Result<IntegratorChoice, String> {
    let (name, settings) = text.split_once(':').unwrap_or((text, ""));
    let Some(&(_, estimator, keys)) = ESTIMATORS.iter().find(|(known, ..)| *known == name) else {
        return Err(format!("no such integrator; there are {}", listed(&ESTIMATORS.map(|(name, ..)| name))));
    };
    let mut choice = IntegratorChoice { estimator: Some(estimator), ..Default::default() };
    for setting in settings.split(',').filter(|s| !s.trim().is_empty()) {
        let (key, value) = setting
            .split_once('=')
            .ok_or_else(|| format!("expected key=value, got \"{setting}\"; {name} takes {keys}"))?;
        let key = key.trim();
        if !keys.split(", ").any(|known| known.split('=').next() == Some(key)) {
            return Err(format!("{name} has no setting \"{key}\"; it takes {keys}"));
        }
        set(&mut choice, key, value.trim())?;
    }
    Ok(choice)
}

fn set(choice: &mut IntegratorChoice, key: &str, value: &str) -> Result<(), String> {
    match key {
        "light" => {
            choice.light = Some(match value {
                "naive" => LightStrategy::Naive,
                "nee" => LightStrategy::Nee,
                "mis" => LightStrategy::Mis,
                _ => return Err(format!("light={value}: expected naive, nee or mis")),
            });
        }
        "heuristic" => {
            choice.heuristic = Some(match value {
                "balance" => Heuristic::Balance,
                "power" => Heuristic::Power,
                _ => return Err(format!("heuristic={value}: expected balance or power")),
            });
        }
        "lights" => {
            let known = LIGHT_CHOICES.iter().find(|(name, _)| *name == value);
            let expected = || listed(&LIGHT_CHOICES.map(|(name, _)| name));
            let (_, kind) = known.ok_or_else(|| format!("lights={value}: there are {}", expected()))?;
            choice.light_choice = Some(*kind);
        }
        "rr_depth" => {
            choice.rr_depth = Some(match value.parse() {
                _ if value == "off" => None,
                Ok(depth @ 1..) => Some(depth),
                _ => {
                    return Err(format!(
                        "rr_depth={value}: expected the first depth, from 1, at which paths may end early, or off"
                    ));
                }
            });
        }
        _ => {
            choice.hide_emitters =
                Some(value.parse().map_err(|_| format!("hide_emitters={value}: expected true or false"))?);
        }
    }
    Ok(())
}

/// An estimator in the words [`parse_integrator`] takes.
pub fn describe_integrator(integrator: &IntegratorDescription) -> String {
    let light = match integrator.light {
        LightStrategy::Naive => "naive",
        LightStrategy::Nee => "nee",
        LightStrategy::Mis => "mis",
    };
    let heuristic = match integrator.heuristic {
        Heuristic::Balance => "balance",
        Heuristic::Power => "power",
    };
    // What is usual goes without saying.
    let lights = match LIGHT_CHOICES.iter().find(|(_, kind)| *kind == integrator.light_choice) {
        Some((name, kind)) if *kind != LightChoiceKind::Auto => format!(",lights={name}"),
        _ => String::new(),
    };
    let rr_depth = integrator.roulette.start_depth.map_or("off".to_owned(), |d| d.to_string());
    let hide_emitters = integrator.hide_emitters;
    match integrator.estimator {
        EstimatorKind::Path => {
            format!(
                "path:light={light},heuristic={heuristic}{lights},rr_depth={rr_depth},hide_emitters={hide_emitters}"
            )
        }
        EstimatorKind::Light => format!("light:hide_emitters={hide_emitters}"),
        EstimatorKind::Bidirectional => {
            format!("bdpt:heuristic={heuristic}{lights},rr_depth={rr_depth},hide_emitters={hide_emitters}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_replace_those_of_the_scene() {
        let mut integrator = IntegratorDescription { hide_emitters: true, ..Default::default() };
        parse_integrator("path:light=nee, rr_depth=off").unwrap().apply(&mut integrator);
        assert_eq!(
            describe_integrator(&integrator),
            "path:light=nee,heuristic=power,rr_depth=off,hide_emitters=true"
        );
        let mut again = IntegratorDescription::default();
        parse_integrator(&describe_integrator(&integrator)).unwrap().apply(&mut again);
        assert_eq!(describe_integrator(&again), describe_integrator(&integrator));
        for text in [
            "light:hide_emitters=true",
            "path:light=mis,heuristic=power,lights=tree,rr_depth=2,hide_emitters=false",
            "bdpt:heuristic=balance,lights=uniform,rr_depth=3,hide_emitters=false",
        ] {
            parse_integrator(text).unwrap().apply(&mut again);
            assert_eq!(describe_integrator(&again), text);
        }
    }

    #[test]
    fn errors_list_what_there_is() {
        for (wrong, listed) in [
            ("path:lights=all", "there are auto, uniform, power and tree"),
            ("photon", "there are path, light and bdpt"),
            ("bdpt:light=nee", "heuristic=balance|power"),
            ("light:rr_depth=3", "hide_emitters"),
            ("path:depth=3", "rr_depth=N|off"),
            ("path:light", "key=value"),
            ("path:light=all", "naive, nee or mis"),
            ("path:heuristic=max", "balance or power"),
            ("path:rr_depth=0", "or off"),
            ("path:hide_emitters=yes", "true or false"),
        ] {
            assert!(parse_integrator(wrong).unwrap_err().contains(listed), "{wrong}");
        }
    }
}
