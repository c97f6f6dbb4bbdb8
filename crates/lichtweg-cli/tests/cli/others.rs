//! The commands around `render`.

use crate::common::{SCENE, Workplace, files, text};
use serde_json::Value;

#[test]
fn info_tells_what_is_in_a_scene() {
    let place = Workplace::new();
    let output = place.run(&["info", "scene.xml"]);
    let told = text(&output.stdout);
    for expected in ["2 sphere", "1 mesh", "1 area", "diffuse", "32x24", "box:0.5", "bounds", "renders"] {
        assert!(told.contains(expected), "{expected}: {told}");
    }
    let output = place.run(&["info", "scene.xml", "--json", "-D", "spp=17"]);
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["sampler"]["samples_per_pixel"], 17);
    assert_eq!(json["shapes"]["sphere"], 2);
    assert_eq!(json["triangles"], 2);
    assert_eq!(json["verdict"], "renders");
    assert_eq!(json["bounds"][0][0], -5.0);
    assert_eq!(json["diagnostics"].as_array().unwrap().len(), 0);
}

#[test]
fn info_lists_what_is_not_supported() {
    let place = Workplace::with(&SCENE.replace("\"diffuse\"", "\"difuse\""));
    let output = place.run(&["info", "scene.xml", "--json"]);
    assert_eq!(output.status.code(), Some(0));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(json["verdict"], "renders with --lenient only");
    assert_eq!(json["diagnostics"][0]["place"]["line"], 13);
    assert!(place.succeed(&["info", "scene.xml"]).contains("difuse"));
    let broken = Workplace::with("<scene");
    assert!(broken.fail(1, &["info", "scene.xml"]).contains("scene.xml:1"));
}

#[test]
fn builtin_scenes_are_listed() {
    let told = text(&Workplace::new().run(&["scenes"]).stdout);
    assert!(told.starts_with("builtin:cornell-box"), "{told}");
    assert_eq!(told.lines().count(), lichtweg_io::builtin::SCENES.len());
}

#[test]
fn help_comes_with_examples() {
    let place = Workplace::new();
    for arguments in [
        &["--help"][..],
        &["render", "--help"],
        &["info", "--help"],
        &["solve", "--help"],
        &["radiosity", "--help"],
        &["completions", "--help"],
        &["man", "--help"],
    ] {
        let told = text(&place.run(arguments).stdout);
        assert!(told.contains("Examples:"), "{arguments:?}: {told}");
    }
    assert!(text(&place.run(&["-V"]).stdout).contains(env!("CARGO_PKG_VERSION")));
}

#[test]
fn manual_pages_and_completions() {
    let place = Workplace::new();
    assert!(text(&place.run(&["man"]).stdout).contains(".TH lichtweg"));
    place.succeed(&["man", "--dir", "man1"]);
    let pages = files(&place.path("man1"));
    assert!(
        ["lichtweg.1", "lichtweg-render.1", "lichtweg-info.1"]
            .iter()
            .all(|p| pages.contains(&(*p).to_owned())),
        "{pages:?}"
    );
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        assert!(text(&place.run(&["completions", shell]).stdout).contains("lichtweg"), "{shell}");
    }
}
