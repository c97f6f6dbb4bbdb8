//! `--integrator NAME[:key=value,...]`.

use lichtweg::scene::description::{Heuristic, IntegratorDescription, LightStrategy};

use super::listed;

const NAMES: [&str; 1] = ["path"];

const KEYS: &str = "light=naive|nee|mis, heuristic=balance|power, rr_depth=N|off, hide_emitters=true|false";

/// What the user wants of the estimator; what is `None` stays as the scene has it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct IntegratorChoice {
    light: Option<LightStrategy>,
    heuristic: Option<Heuristic>,
    rr_depth: Option<Option<u32>>,
    hide_emitters: Option<bool>,
}

impl IntegratorChoice {
    /// Replaces the chosen settings.
    pub fn apply(&self, integrator: &mut IntegratorDescription) {
        integrator.light = self.light.unwrap_or(integrator.light);
        integrator.heuristic = self.heuristic.unwrap_or(integrator.heuristic);
        integrator.roulette.start_depth = self.rr_depth.unwrap_or(integrator.roulette.start_depth);
        integrator.hide_emitters = self.hide_emitters.unwrap_or(integrator.hide_emitters);
    }
}

/// An estimator by its name, with settings to change.
pub fn parse_integrator(text: &str) -> Result<IntegratorChoice, String> {
    let (name, settings) = text.split_once(':').unwrap_or((text, ""));
    if !NAMES.contains(&name) {
        return Err(format!("no such integrator; there is {}, with {KEYS}", listed(&NAMES)));
    }
    let mut choice = IntegratorChoice::default();
    for setting in settings.split(',').filter(|s| !s.trim().is_empty()) {
        let (key, value) = setting
            .split_once('=')
            .ok_or_else(|| format!("expected key=value, got \"{setting}\"; {name} takes {KEYS}"))?;
        set(&mut choice, key.trim(), value.trim())?;
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
        "hide_emitters" => {
            choice.hide_emitters =
                Some(value.parse().map_err(|_| format!("hide_emitters={value}: expected true or false"))?);
        }
        _ => return Err(format!("path has no setting \"{key}\"; it takes {KEYS}")),
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
    let rr_depth = integrator.roulette.start_depth.map_or("off".to_owned(), |d| d.to_string());
    format!(
        "path:light={light},heuristic={heuristic},rr_depth={rr_depth},hide_emitters={}",
        integrator.hide_emitters
    )
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
        assert_eq!(parse_integrator("path"), Ok(IntegratorChoice::default()));
    }

    #[test]
    fn errors_list_what_there_is() {
        for (wrong, listed) in [
            ("photon", "there is path"),
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
