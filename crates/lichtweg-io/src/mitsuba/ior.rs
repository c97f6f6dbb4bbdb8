//! Indices of refraction by name: Mitsuba's table (`include/mitsuba/render/ior.h`), mostly from Hecht, Optics, 4th edition,
//! at about 589 nm; and the names of its measured conductors (`src/bsdfs/conductor.cpp`).

use lichtweg::scene::description::Diagnostic;

use super::number::shortened;
use super::suggest::hint;
use super::translate::Translator;
use super::tree::{Object, Value};

const DIELECTRICS: [(&str, f32); 23] = [
    ("vacuum", 1.0),
    ("helium", 1.000_036),
    ("hydrogen", 1.000_132),
    ("air", 1.000_277),
    ("carbon dioxide", 1.000_45),
    ("water", 1.333),
    ("acetone", 1.36),
    ("ethanol", 1.361),
    ("carbon tetrachloride", 1.461),
    ("glycerol", 1.4729),
    ("benzene", 1.501),
    ("silicone oil", 1.520_45),
    ("bromine", 1.661),
    ("water ice", 1.31),
    ("fused quartz", 1.458),
    ("pyrex", 1.47),
    ("acrylic glass", 1.49),
    ("polypropylene", 1.49),
    ("bk7", 1.5046),
    ("sodium chloride", 1.544),
    ("amber", 1.55),
    ("pet", 1.575),
    ("diamond", 2.419),
];

/// The presets of measured conductors, besides `none`.
pub(super) const CONDUCTORS: [&str; 64] = [
    "a-C",
    "Ag",
    "Al",
    "AlAs",
    "AlAs_palik",
    "AlSb",
    "AlSb_palik",
    "Au",
    "Be",
    "Be_palik",
    "Cr",
    "CsI",
    "CsI_palik",
    "Cu",
    "Cu2O",
    "Cu2O_palik",
    "CuO",
    "CuO_palik",
    "Cu_palik",
    "Hg",
    "HgTe",
    "HgTe_palik",
    "Hg_palik",
    "Ir",
    "Ir_palik",
    "K",
    "K_palik",
    "Li",
    "Li_palik",
    "MgO",
    "MgO_palik",
    "Mo",
    "Mo_palik",
    "Na_palik",
    "Nb",
    "Nb_palik",
    "Ni_palik",
    "Rh",
    "Rh_palik",
    "Se",
    "Se_palik",
    "SiC",
    "SiC_palik",
    "SnTe",
    "SnTe_palik",
    "Ta",
    "Ta_palik",
    "Te",
    "Te_palik",
    "ThF4",
    "ThF4_palik",
    "TiC",
    "TiC_palik",
    "TiN",
    "TiN_palik",
    "TiO2",
    "TiO2_palik",
    "VC",
    "VC_palik",
    "VN",
    "VN_palik",
    "V_palik",
    "W",
    "d-C",
];

impl<'a> Translator<'a> {
    /// The index inside over that outside, from `int_ior` and `ext_ior`, which are numbers or names.
    pub fn relative_ior(&mut self, object: &'a Object, inside: &str) -> f32 {
        let inside = self.ior(object, "int_ior", inside);
        inside / self.ior(object, "ext_ior", "air")
    }

    /// An index of refraction.
    pub fn ior(&mut self, object: &'a Object, name: &'static str, default: &str) -> f32 {
        let default = lookup(default).unwrap_or(1.0);
        if !matches!(object.property(name).map(|p| &p.value), Some(Value::Text(_))) {
            return self.float_in(object, name, default, "greater than 0", |v| v > 0.0);
        }
        let Some((text, span)) = self.text(object, name) else { return default };
        lookup(text).unwrap_or_else(|| {
            let names: Vec<&str> = DIELECTRICS.iter().map(|d| d.0).collect();
            let message = format!("no index of refraction is known for '{}'", shortened(text));
            let mut diagnostic = Diagnostic::error("unknown-value", message).at(span, "");
            diagnostic.help.extend(hint(text, "known", &names));
            self.diagnostics.push(diagnostic);
            default
        })
    }
}

fn lookup(name: &str) -> Option<f32> {
    DIELECTRICS.iter().find(|(known, _)| known.eq_ignore_ascii_case(name.trim())).map(|d| d.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn knows_materials_in_any_case() {
        assert_eq!(lookup("BK7"), Some(1.5046));
        assert_eq!(lookup("water ice"), Some(1.31));
        assert_eq!(lookup("glas"), None);
    }
}
