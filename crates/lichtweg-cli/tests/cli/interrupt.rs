//! Ctrl-C, and directories that vanish: no picture is lost.

use std::fs;

use crate::common::{Workplace, files, metadata};

/// More samples than any test takes.
const FOREVER: &str = "4000000000";

#[test]
fn ctrl_c_ends_with_a_valid_image() {
    let place = Workplace::new();
    let running = place.start(&["render", "scene.xml", "--spp", FOREVER, "-o", "a.exr", "--stats", "s.json"]);
    running.interrupt();
    let (code, stderr) = running.end();
    assert_eq!(code, Some(0), "{stderr}");
    let exr = place.exr("a.exr");
    let samples = metadata(&exr, "samplesPerPixel");
    assert!(samples.parse::<u64>().unwrap() >= 1);
    assert_eq!(metadata(&exr, "interrupted"), "true");
    assert!(stderr.contains("stopped early"), "{stderr}");
    let stats = place.json("s.json");
    assert_eq!(stats["result"]["samples_per_pixel"].to_string(), samples);
    assert_eq!(stats["result"]["interrupted"], true);
    // It is the image that this many samples make.
    let again = place.render(&["--spp", samples]);
    assert_eq!(again.channels, exr.channels);
}

#[test]
fn the_default_run_needs_no_arguments() {
    let place = Workplace::new();
    let running = place.start(&[]);
    running.interrupt();
    let (code, stderr) = running.end();
    assert_eq!(code, Some(0), "{stderr}");
    assert_eq!(files(&place.path("")), ["cornell-box.exr", "cornell-box.png", "scene.xml"]);
}

/// Paths that go on for so long that the first pass takes minutes.
const ENDLESS: &str = r#"<scene version="3.0.0">
    <sensor type="perspective"><film type="hdrfilm">
        <integer name="width" value="256"/><integer name="height" value="256"/>
    </film></sensor>
    <shape type="sphere"><boolean name="flip_normals" value="true"/>
        <bsdf type="diffuse"><rgb name="reflectance" value="1"/></bsdf>
    </shape>
    <emitter type="constant"/>
</scene>
"#;

#[test]
fn a_second_ctrl_c_leaves_at_once() {
    let place = Workplace::with(ENDLESS);
    let options = ["--integrator", "path:rr_depth=off", "--max-depth", "1000000", "-o", "a.exr"];
    let mut running = place.start(&[&["render", "scene.xml"], &options[..]].concat());
    running.interrupt();
    running.wait_for("stopping after this pass");
    running.interrupt();
    let (code, _) = running.end();
    assert_eq!(code, Some(130));
    assert_eq!(files(&place.path("")), ["scene.xml"]);
}

#[test]
fn a_picture_whose_directory_has_gone_is_rescued() {
    let place = Workplace::new();
    fs::create_dir(place.path("gone")).unwrap();
    let arguments = ["render", "scene.xml", "--spp", FOREVER, "-o", "gone/a.exr", "-o", "b.png"];
    let running = place.start(&arguments);
    fs::remove_dir(place.path("gone")).unwrap();
    running.interrupt();
    let (code, stderr) = running.end();
    assert_eq!(code, Some(1), "{stderr}");
    assert!(stderr.contains("gone/a.exr") && stderr.contains("instead"), "{stderr}");
    assert_eq!(files(&place.path("")), ["a.exr", "b.png", "scene.xml"]);
    assert_eq!(place.exr("a.exr").width, 32);
}

#[test]
fn nobody_listening_is_no_reason_to_lose_the_picture() {
    let place = Workplace::new();
    let running = place.start(&["render", "scene.xml", "--time", "0.3", "-o", "a.exr"]);
    assert_eq!(running.end_unheard(), Some(0));
    assert_eq!(place.exr("a.exr").width, 32);
}
