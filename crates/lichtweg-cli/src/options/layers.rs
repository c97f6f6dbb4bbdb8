//! `--layers variance,albedo,normal,depth`.

use lichtweg::render::LayerSelection;

use super::listed;

const NAMES: [&str; 6] = ["variance", "albedo", "normal", "depth", "all", "none"];

/// Layers by their names, joined by commas; `all` and `none` stand for themselves.
pub fn parse_layers(text: &str) -> Result<LayerSelection, String> {
    let mut layers = LayerSelection::default();
    for name in text.split(',') {
        match name.trim().to_ascii_lowercase().as_str() {
            "variance" => layers.variance = true,
            "albedo" => layers.albedo = true,
            "normal" => layers.normal = true,
            "depth" => layers.depth = true,
            "all" => layers = LayerSelection { variance: true, albedo: true, normal: true, depth: true },
            "none" => {}
            _ => return Err(format!("no layer \"{name}\"; there are {}", listed(&NAMES))),
        }
    }
    Ok(layers)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names() {
        let some = parse_layers("variance, depth").unwrap();
        assert_eq!((some.variance, some.albedo, some.normal, some.depth), (true, false, false, true));
        assert_eq!(parse_layers("all"), parse_layers("depth,normal,albedo,variance"));
        assert_eq!(parse_layers("none"), Ok(LayerSelection::default()));
        assert!(parse_layers("alpha").unwrap_err().contains("variance, albedo"));
    }
}
