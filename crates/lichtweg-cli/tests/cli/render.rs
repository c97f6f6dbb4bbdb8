//! `lichtweg render`: every option does what it says.

use std::fs;

use crate::common::{Workplace, files, metadata};
use serde_json::json;

#[test]
fn default_names_are_those_of_the_scene() {
    let place = Workplace::new();
    let stderr = place.succeed(&["render", "scene.xml"]);
    assert_eq!(files(&place.path("")), ["scene.exr", "scene.png", "scene.xml"]);
    let exr = fs::canonicalize(place.path("scene.exr")).unwrap();
    assert!(stderr.contains(&format!("wrote {}", exr.display())), "{stderr}");
}

#[test]
fn builtin_scenes_render_by_name() {
    let place = Workplace::new();
    place.succeed(&["render", "--size", "16x16", "--spp", "1"]);
    assert!(files(&place.path("")).contains(&"cornell-box.exr".to_owned()));
    for scene in lichtweg_io::builtin::SCENES {
        let name = format!("builtin:{}", scene.name);
        place.succeed(&["render", &name, "--size", "16x9", "--spp", "1", "-o", "a.pfm"]);
    }
}

#[test]
fn default_names_spare_files_that_are_not_ours() {
    let place = Workplace::new();
    fs::write(place.path("scene.png"), "a texture of the scene").unwrap();
    place.succeed(&["render", "scene.xml", "--spp", "1"]);
    assert_eq!(fs::read_to_string(place.path("scene.png")).unwrap(), "a texture of the scene");
    assert!(place.path("scene-render.exr").exists());
    // An own image may be replaced by the next one.
    place.succeed(&["render", "scene.xml", "--spp", "2"]);
    assert_eq!(metadata(&place.exr("scene-render.exr"), "samplesPerPixel"), "2");
    assert_eq!(files(&place.path("")), ["scene-render.exr", "scene-render.png", "scene.png", "scene.xml"]);
}

#[test]
fn every_format_is_written() {
    let place = Workplace::new();
    let names = ["a.exr", "b.png", "c.hdr", "d.pfm", "e.jpg"];
    let outputs: Vec<&str> = names.iter().flat_map(|name| ["-o", *name]).collect();
    place.succeed(&[&["render", "scene.xml", "--quiet"], &outputs[..]].concat());
    for (name, magic) in
        names.iter().zip([&b"\x76\x2f\x31\x01"[..], b"\x89PNG", b"#?RADIANCE", b"PF", b"\xff\xd8\xff"])
    {
        assert!(fs::read(place.path(name)).unwrap().starts_with(magic), "{name}");
    }
}

#[test]
fn quiet_says_nothing() {
    let place = Workplace::new();
    assert_eq!(place.succeed(&["render", "scene.xml", "--spp", "1", "-q"]), "");
}

#[test]
fn film_options() {
    let place = Workplace::new();
    let exr = place.render(&["--size", "20x10", "--spp", "1"]);
    assert_eq!((exr.width, exr.height), (20, 10));
    let box_filter = place.render(&["--spp", "2"]);
    assert_eq!(place.render(&["--spp", "2", "--filter", "box"]).channels, box_filter.channels);
    let wide = place.render(&["--spp", "2", "--filter", "gaussian:3"]);
    assert_ne!(wide.channels, box_filter.channels);
    assert_eq!(metadata(&wide, "filter"), "gaussian:3");
}

#[test]
fn a_crop_is_a_part_of_the_whole() {
    let place = Workplace::new();
    let whole = place.render(&["--layers", "all"]);
    let part = place.render(&["--layers", "all", "--crop", "5,3,18,17"]);
    assert_eq!((part.width, part.height), (18, 17));
    assert_eq!((part.data_offset, part.display_size), ([5, 3], [32, 24]));
    assert_eq!(part.channels.len(), 13);
    for (name, numbers) in &part.channels {
        let all = whole.channel(name).unwrap();
        let expected = (3..20).flat_map(|y| &all[y * 32 + 5..y * 32 + 23]);
        assert!(numbers.iter().zip(expected).all(|(a, b)| a.to_bits() == b.to_bits()), "{name}");
    }
}

#[test]
fn threads_do_not_change_a_bit() {
    let place = Workplace::new();
    let one = place.render(&["--threads", "1", "--spp", "9", "--layers", "all"]);
    for threads in ["2", "7"] {
        let more = place.render(&["--threads", threads, "--spp", "9", "--layers", "all"]);
        assert_eq!(one.channels, more.channels, "{threads} threads");
    }
}

#[test]
fn seeds_and_samplers_change_the_noise() {
    let place = Workplace::new();
    let first = place.render(&["--seed", "1"]);
    assert_eq!(first.channels, place.render(&["--seed", "1"]).channels);
    assert_ne!(first.channels, place.render(&["--seed", "2"]).channels);
    assert_ne!(first.channels, place.render(&["--seed", "1", "--sampler", "sobol"]).channels);
}

#[test]
fn layers_are_those_asked_for() {
    let place = Workplace::new();
    let names = |options: &[&str]| -> Vec<String> {
        place.render(options).channels.into_iter().map(|(name, _)| name).collect()
    };
    assert_eq!(names(&["--layers", "none"]), ["B", "G", "R"]);
    assert_eq!(names(&[]), ["B", "G", "R", "variance.B", "variance.G", "variance.R"]);
    assert_eq!(
        names(&["--layers", "depth,normal"]),
        ["B", "G", "R", "depth.Z", "normal.X", "normal.Y", "normal.Z"]
    );
}

#[test]
fn exposure_brightens_the_png_alone() {
    let place = Workplace::new();
    let brightness = |stops: &str| {
        place.succeed(&["render", "scene.xml", "-o", "a.png", "-o", "a.pfm", "--exposure", stops]);
        let image = lichtweg_io::image::read_image(&place.path("a.png")).unwrap().image;
        let lichtweg::scene::description::Pixels::U8(bytes) = image.pixels else { panic!("8-bit PNG") };
        (bytes.iter().map(|&b| u64::from(b)).sum::<u64>(), fs::read(place.path("a.pfm")).unwrap())
    };
    let (dark, linear) = brightness("-2");
    let (bright, same) = brightness("2");
    assert!(dark < bright && linear == same);
}

#[test]
fn the_estimator_can_be_chosen() {
    let place = Workplace::new();
    let stats = place.stats(&["--integrator", "path:light=naive,rr_depth=off", "--max-depth", "2"]);
    assert_eq!(
        stats["settings"]["integrator"],
        "path:light=naive,heuristic=power,rr_depth=off,hide_emitters=false"
    );
    assert_eq!(stats["settings"]["max_depth"], 2);
    // Nothing is connected: only the last edge of a path asks whether it meets light at all.
    let number = |key: &str| stats["result"][key].as_f64().unwrap();
    let last_edges = (number("mean_path_length") - 1.0) * number("camera_paths");
    assert_eq!(number("occlusion_rays"), last_edges.round());
    let unlimited = place.stats(&["--integrator", "path:light=naive", "--max-depth", "-1"]);
    assert_eq!(unlimited["settings"]["max_depth"], -1);
    assert_eq!(unlimited["result"]["occlusion_rays"], 0);
    // Emitters alone, and those hidden: black.
    let hidden = place.stats(&["--integrator", "path:hide_emitters=true", "--max-depth", "1"]);
    assert_eq!(hidden["result"]["mean_radiance"], json!([0.0, 0.0, 0.0]));
}

#[test]
fn definitions_reach_the_scene() {
    let place = Workplace::new();
    assert_eq!(place.stats(&["-D", "spp=3"])["result"]["samples_per_pixel"], 3);
    assert_eq!(place.stats(&["-D", "spp=3", "--spp", "2"])["result"]["samples_per_pixel"], 2);
    assert!(place.fail(1, &["render", "scene.xml", "-D", "ssp=3"]).contains("ssp"));
}

#[test]
fn time_limits_the_samples() {
    let place = Workplace::new();
    let stats = place.stats(&["--time", "0.3"]);
    assert_eq!(stats["settings"]["time_limit_seconds"], 0.3);
    assert!(stats["settings"]["samples_per_pixel"].is_null());
    assert!(stats["result"]["samples_per_pixel"].as_u64().unwrap() >= 1);
    assert_eq!(stats["result"]["interrupted"], false);
    // Whichever limit comes first.
    assert_eq!(place.stats(&["--time", "1e6", "--spp", "3"])["result"]["samples_per_pixel"], 3);
    let scenes_own = place.render(&[]);
    assert_eq!(metadata(&scenes_own, "samplesPerPixel"), "4");
}

#[test]
fn statistics_are_complete_and_consistent() {
    let place = Workplace::new();
    let stats = place.stats(&["--seed", "5", "--threads", "2"]);
    for key in ["load", "load_parse", "load_meshes", "load_images", "compile", "build", "render"] {
        assert!(stats["seconds"][key].as_f64().unwrap() >= 0.0, "{key}");
    }
    let result = &stats["result"];
    assert_eq!(result["camera_paths"], 32 * 24 * 4);
    let number = |key: &str| result[key].as_f64().unwrap_or_else(|| panic!("{key}: {result}"));
    assert_eq!(number("rays"), number("intersection_rays") + number("occlusion_rays"));
    // The last edge of a path is traced for the nearest hit only where it meets light.
    assert!(number("mean_path_length") > number("intersection_rays") / number("camera_paths"));
    // Every other edge is one ray, as nothing has holes.
    let unlimited = &place.stats(&["--max-depth", "-1"])["result"];
    let number_of = |key: &str| unlimited[key].as_f64().unwrap();
    assert_eq!(number_of("mean_path_length"), number_of("intersection_rays") / number_of("camera_paths"));
    assert!(number("rays_per_second") > 0.0 && number("passes") >= 1.0);
    assert_eq!((number("dropped_samples"), &result["first_dropped_sample"]), (0.0, &json!(null)));
    for key in ["mean_radiance", "mean_radiance_standard_error"] {
        assert!(result[key].as_array().unwrap().iter().all(|v| v.as_f64().unwrap() > 0.0), "{key}");
    }
    assert_eq!(stats["settings"]["seed"], 5);
    assert_eq!(stats["settings"]["threads"], 2);
    assert_eq!(stats["version"], env!("CARGO_PKG_VERSION"));
    assert!(stats["scene"]["hash"].as_str().unwrap().starts_with("sha256:"));
    assert_eq!(stats["outputs"].as_array().unwrap().len(), 1);
    if cfg!(target_os = "linux") {
        assert!(stats["memory"]["peak_bytes"].as_u64().unwrap() > 1 << 20);
    }
}

#[test]
fn images_say_how_they_were_made() {
    let place = Workplace::new();
    let exr = place.render(&["--seed", "7"]);
    assert_eq!(metadata(&exr, "command"), "lichtweg render scene.xml -o out.exr --seed 7");
    assert_eq!(metadata(&exr, "seed"), "7");
    assert_eq!(metadata(&exr, "version"), env!("CARGO_PKG_VERSION"));
    assert_eq!(metadata(&exr, "interrupted"), "false");
    assert!(metadata(&exr, "estimator").starts_with("path:light=mis"));
    assert!(metadata(&exr, "sceneHash").starts_with("sha256:"));
    assert!(metadata(&exr, "seconds").parse::<f64>().unwrap() >= 0.0);
}

/// Registers of sixteen lanes, pairs of eight, and arrays, which go one by one: all give the same bits. A machine that has not all
/// of them takes its best twice.
#[test]
fn instruction_sets_render_the_same_bits() {
    let place = Workplace::new();
    for scene in ["builtin:cornell-box", "builtin:veach-mis"] {
        for integrator in ["path", "light", "bdpt"] {
            let images = ["avx512", "avx2", "portable"].map(|isa| {
                let options = ["render", scene, "--integrator", integrator, "--size", "40x30", "--spp", "4"];
                let mut command = place.command(&[&options[..], &["-o", "isa.pfm"]].concat());
                assert!(command.env("LICHTWEG_ISA", isa).output().unwrap().status.success());
                fs::read(place.path("isa.pfm")).unwrap()
            });
            assert!(images[0] == images[1], "{scene}, {integrator}: AVX2 is not AVX-512");
            assert!(images[0] == images[2], "{scene}, {integrator}: arrays are not AVX-512");
        }
    }
}
