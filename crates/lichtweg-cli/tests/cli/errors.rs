//! What cannot be done is refused with a reason and the right exit code, before anything is rendered.

use std::fs;

use crate::common::{SCENE, Workplace, files};

#[test]
fn bad_values_say_what_was_expected() {
    let place = Workplace::new();
    for (option, value, said) in [
        ("--size", "100", "640x480"),
        ("--size", "0x5", "no pixels"),
        ("--size", "70000x5", "65536"),
        ("--crop", "1,2,3", "X,Y,WIDTH,HEIGHT"),
        ("--crop", "0,0,33,24", "32x24"),
        ("--spp", "0", "at least 1 sample"),
        ("--spp", "many", "256"),
        ("--spp", "-4", "256"),
        ("--threads", "0", "at least 1 thread"),
        ("--time", "0", "more than 0"),
        ("--time", "soon", "90"),
        ("--max-depth", "0", "emitters"),
        ("--max-depth", "-7", "-1"),
        ("--integrator", "photons", "path"),
        ("--integrator", "path:foo=1", "rr_depth"),
        ("--integrator", "path:light=all", "naive, nee or mis"),
        ("--filter", "sinc", "lanczos"),
        ("--filter", "box:-1", "above 0"),
        ("--sampler", "halton", "sobol"),
        ("--seed", "-1", "whole number"),
        ("--layers", "alpha", "variance"),
        ("--exposure", "bright", "stops"),
        ("-o", "image.gif", ".exr"),
        ("-o", "image", ".exr"),
        ("-D", "spp", "NAME=VALUE"),
    ] {
        let stderr = place.fail(2, &["render", "scene.xml", option, value]);
        assert!(stderr.contains(said), "{option} {value}: {stderr}");
    }
    assert_eq!(files(&place.path("")), ["scene.xml"]);
}

#[test]
fn unknown_scenes_and_commands() {
    let place = Workplace::new();
    assert!(place.fail(2, &["render", "builtin:nothing"]).contains("builtin:cornell-box"));
    assert!(place.fail(1, &["render", "absent.xml"]).contains("there is no file absent.xml"));
    assert!(place.fail(1, &["render", "."]).contains("scene.xml"));
    assert!(place.fail(1, &["render", "scene.blend"]).contains(".pbrt"));
    assert!(place.fail(2, &["scene.xml"]).contains("lichtweg render scene.xml"));
    assert!(place.fail(2, &["rendr"]).contains("render"));
    assert!(place.fail(2, &["--spp"]).contains("--spp"));
}

#[test]
fn parameters_of_the_generated_scene() {
    let place = Workplace::new();
    let fail = |define| place.fail(1, &["render", "builtin:street", "-D", define]);
    for wrong in ["detail=0", "detail=33", "detail=NaN", "detail=many"] {
        assert!(fail(wrong).contains("a number from 0.05 to 32 expected"), "{wrong}");
    }
    assert!(fail("seed=-1").contains("a whole number"));
    assert!(fail("details=1").contains("it has: detail, seed"));
}

#[test]
fn scene_errors_point_at_the_line() {
    let place = Workplace::with(&SCENE.replace("\"diffuse\"", "\"difuse\""));
    let stderr = place.fail(1, &["render", "scene.xml"]);
    assert!(stderr.contains("scene.xml:13:") && stderr.contains("difuse"), "{stderr}");
    assert!(stderr.contains("--lenient"), "{stderr}");
    assert_eq!(files(&place.path("")), ["scene.xml"]);
    let stderr = place.succeed(&["render", "scene.xml", "--lenient", "--spp", "1", "--quiet"]);
    assert!(stderr.contains("warning"), "{stderr}");
}

#[test]
fn unwritable_outputs_are_found_before_rendering() {
    let place = Workplace::new();
    fs::create_dir(place.path("folder.exr")).unwrap();
    for (option, path, said) in [
        ("-o", "absent/a.exr", "make it first"),
        ("-o", "folder.exr", "is a directory"),
        ("-o", "scene.xml/a.png", "no directory"),
        ("--stats", "absent/s.json", "make it first"),
    ] {
        let stderr = place.fail(1, &["render", "scene.xml", option, path]);
        assert!(stderr.contains(said), "{path}: {stderr}");
        assert!(!stderr.contains("rendering"), "{stderr}");
    }
    if cfg!(target_os = "linux") {
        place.fail(1, &["render", "scene.xml", "-o", "/proc/a.exr"]);
    }
    assert_eq!(files(&place.path("")), ["folder.exr", "scene.xml"]);
}

#[cfg(unix)]
#[test]
fn read_only_directories_are_found_before_rendering() {
    use std::os::unix::fs::PermissionsExt;
    let place = Workplace::new();
    let directory = place.path("locked");
    fs::create_dir(&directory).unwrap();
    fs::set_permissions(&directory, fs::Permissions::from_mode(0o555)).unwrap();
    if fs::write(directory.join("probe"), "").is_ok() {
        eprintln!("skipped: the superuser may write anywhere");
        return;
    }
    let stderr = place.fail(1, &["render", "scene.xml", "-o", "locked/a.exr"]);
    assert!(stderr.contains("writable") && !stderr.contains("rendering"), "{stderr}");
    let output = place.command(&["render", "../scene.xml"]).current_dir(&directory).output().unwrap();
    assert_eq!(output.status.code(), Some(1));
}

#[test]
fn images_larger_than_memory_are_refused() {
    if !cfg!(target_os = "linux") {
        return;
    }
    let place = Workplace::new();
    let stderr = place.fail(1, &["render", "scene.xml", "--size", "65536x65536"]);
    assert!(stderr.contains("large") || stderr.contains("memory"), "{stderr}");
}
