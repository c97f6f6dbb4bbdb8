//! Both directions, and the commands that look at paths.

use serde_json::Value;

use crate::common::{Workplace, files};

#[test]
fn both_directions_render() {
    let place = Workplace::new();
    for integrator in ["light", "bdpt", "bdpt:heuristic=balance,rr_depth=3"] {
        place.succeed(&[
            "render",
            "scene.xml",
            "--integrator",
            integrator,
            "-o",
            "a.exr",
            "--stats",
            "a.json",
        ]);
        let stats: Value = serde_json::from_slice(&std::fs::read(place.path("a.json")).unwrap()).unwrap();
        assert!(stats["settings"]["integrator"].as_str().unwrap().starts_with(integrator), "{stats}");
        assert!(stats["result"]["mean_radiance"][0].as_f64().unwrap() > 0.0);
    }
    assert!(
        place.fail(2, &["render", "scene.xml", "--integrator", "light:rr_depth=3"]).contains("hide_emitters")
    );
}

#[test]
fn the_pyramid_is_complete() {
    let place = Workplace::new();
    place.succeed(&["pyramid", "scene.xml", "-o", "p", "--size", "8x6", "--spp", "4", "--length", "3"]);
    // 3 + 4 + 5 strategies: an EXR and two PNGs each; two sheets and the page.
    assert_eq!(files(&place.path("p")).len(), 12 * 3 + 3);
    let page = std::fs::read_to_string(place.path("p/index.html")).unwrap();
    assert!(page.contains("s = 1, t = 2") && page.contains("s02t02"), "{page}");
    assert!(place.fail(2, &["pyramid", "scene.xml", "-o", "p", "--length", "0"]).contains("length"));
}

/// The product of the printed factors is the printed estimate.
#[test]
fn paths_can_be_computed_once_more() {
    let place = Workplace::new();
    let output = place.run(&["path", "scene.xml", "--pixel", "20,18", "--sample", "2", "--json"]);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    let number = |v: &Value| v.as_f64().unwrap();
    let product = |v: &Value| v.as_array().unwrap().iter().map(number).product::<f64>();
    let paths = json["paths"].as_array().unwrap();
    assert!(paths.len() > 2, "{json}");
    for path in paths {
        let factors = &path["factors"];
        let scattering: f64 =
            path["vertices"].as_array().unwrap().iter().map(|v| number(&v["scattering"][0])).product();
        let strategies = path["strategies"].as_array().unwrap();
        let strategy = &strategies[path["s"].as_u64().unwrap() as usize];
        let value = number(&factors["emission"][0])
            * product(&factors["geometry"])
            * scattering
            * number(&factors["response"])
            / (number(&strategy["pdf"]) * number(&factors["survival"]));
        assert!((value / number(&path["estimate"][0]) - 1.0).abs() < 1e-5, "{path}");
        let weights: f64 = strategies.iter().map(|s| number(&s["weight"])).sum();
        assert!((weights - 1.0).abs() < 1e-9);
    }
    assert!(place.fail(2, &["path", "scene.xml", "--pixel", "32,0"]).contains("32x24"));
}

#[test]
fn maps_are_made_of_what_is_lit() {
    let place = Workplace::new();
    let arguments = ["bake", "scene.xml", "--walks", "20000", "--resolution", "4"];
    for deposit in ["hit", "absorption"] {
        let output = format!("maps-{deposit}");
        place.succeed(&[&arguments[..], &["--deposit", deposit, "-o", &output]].concat());
        // The floor, the ball, and the lamp, at which these shine back.
        assert_eq!(files(&place.path(&output)).len(), 3, "{deposit}");
    }
    assert!(place.fail(2, &["bake", "scene.xml", "-o", "m", "--resolution", "0"]).contains("resolution"));
}
