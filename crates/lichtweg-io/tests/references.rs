//! Renders of real scenes against reference images by another renderer, with the variance of their means.
//!
//! The scenes and references lie in `../shared`, beside the checkout; where that is absent the tests say so and pass.
//!
//! A render passes when z = (m - ref) / sqrt(var m + var ref) over blocks of 4x4 pixels has a p-value above alpha = 0.01
//! (Sidak over blocks and channels) in at least 99.75 % of them, and when the mean of the whole image differs by less than
//! 3.5 standard errors. The two pull in different directions: the first sees errors that are local, the second those that
//! are everywhere but small.

mod shared;

use lichtweg_montecarlo::hypothesis::{sidak, z_test};
use shared::{Estimate, Reference, read_pbrt_text, render, render_description, shared_folder};

/// Side of a block in pixels.
const BLOCK: usize = 4;

/// Rounding floor, relative.
const ROUNDING: f64 = 1e-5;

/// What a comparison found.
#[derive(Debug)]
struct Verdict {
    /// Fraction of blocks and channels whose p-value is above alpha.
    agreeing: f64,
    /// Difference of the means of the whole image in standard errors, the largest of the channels.
    aggregate: f64,
}

impl Verdict {
    fn passes(&self) -> bool {
        self.agreeing >= 0.9975 && self.aggregate < 3.5
    }
}

fn compare(ours: &Estimate, reference: &Estimate) -> Verdict {
    let [width, height] = ours.size;
    assert_eq!(ours.size, reference.size);
    let (columns, rows) = (width.div_ceil(BLOCK), height.div_ceil(BLOCK));
    let alpha = sidak(0.01, 3 * columns * rows);
    let (mut agreeing, mut aggregate) = (0, 0.0f64);
    for channel in 0..3 {
        let mut whole = (0.0, 0.0);
        for block in 0..columns * rows {
            let (bx, by) = (block % columns * BLOCK, block / columns * BLOCK);
            let (mut difference, mut variance, mut magnitude) = (0.0, 0.0, 0.0);
            for y in by..(by + BLOCK).min(height) {
                for x in bx..(bx + BLOCK).min(width) {
                    let i = y * width + x;
                    difference += ours.mean[i][channel] - reference.mean[i][channel];
                    variance += ours.variance[i][channel] + reference.variance[i][channel];
                    magnitude += reference.mean[i][channel];
                }
            }
            let floor = (ROUNDING * magnitude).powi(2);
            agreeing += usize::from(z_test(difference, variance + floor).p_value > alpha);
            whole = (whole.0 + difference, whole.1 + variance);
        }
        aggregate = aggregate.max(whole.0.abs() / whole.1.sqrt());
    }
    Verdict { agreeing: agreeing as f64 / (3 * columns * rows) as f64, aggregate }
}

/// Renders `scene` with `samples` a pixel and compares; `wrong_depth` instead of the right one must not pass.
fn check(scene: &str, samples: u32, wrong_depth: Option<u32>) {
    let Some(folder) = shared_folder() else { return };
    let reference = Reference::read(&folder, scene);
    let file = folder.join("scenes").join(scene).join("scene.xml");
    let verdict = compare(&render(&file, &reference, samples, reference.max_depth), &reference.estimate);
    println!("{scene}: {verdict:?}");
    assert!(verdict.passes(), "{scene}: {verdict:?}");
    if let Some(depth) = wrong_depth {
        let verdict = compare(&render(&file, &reference, samples, depth), &reference.estimate);
        println!("{scene} at depth {depth}: {verdict:?}");
        assert!(!verdict.passes(), "{scene} at depth {depth} passes, and should not: {verdict:?}");
    }
}

#[test]
fn cornell_box_agrees_and_a_depth_too_small_does_not() {
    check("cornell-box", 256, Some(7));
}

#[test]
fn veach_mis_agrees() {
    check("veach-mis", 1024, Some(2));
}

#[test]
fn veach_bidir_agrees() {
    check("veach-bidir", 2048, None);
}

#[test]
fn veach_ajar_agrees() {
    check("veach-ajar", 512, None);
}

/// The pbrt file of the Cornell box differs from the XML one in its view and its lights; with those made equal, in the text, it
/// must give the same image.
#[test]
fn cornell_box_in_pbrt_agrees() {
    let Some(folder) = shared_folder() else { return };
    let reference = Reference::read(&folder, "cornell-box");
    let file = folder.join("scenes/cornell-box/scene-v4.pbrt");
    let text = std::fs::read_to_string(&file).unwrap();
    let (walls, _lights) =
        text.split_once("AttributeBegin").expect("the file's lights are in attribute blocks");
    let light = r#"
        AttributeBegin
        AreaLightSource "diffuse" "rgb L" [ 17 12 4 ]
        NamedMaterial "Light"
        Shape "trianglemesh"
            "point3 P" [ -0.24 1.98 -0.22 0.23 1.98 -0.22 0.23 1.98 0.16 -0.24 1.98 0.16 ]
            "normal N" [ 0 -1 0 0 -1 0 0 -1 0 0 -1 0 ]
            "integer indices" [ 0 1 2 0 2 3 ]
        AttributeEnd
        "#;
    let field_of_view = r#""float fov" [ 20 ]"#;
    assert!(walls.contains(field_of_view));
    let same_view = walls.replace(field_of_view, r#""float fov" [ 19.5 ]"#);
    let render = |text: &str| {
        let description = read_pbrt_text(text, &file);
        render_description(description, reference.estimate.size, 256, reference.max_depth)
    };
    let verdict = compare(&render(&(same_view + light)), &reference.estimate);
    println!("cornell-box in pbrt: {verdict:?}");
    assert!(verdict.passes(), "{verdict:?}");
    let verdict = compare(&render(&(walls.to_owned() + light)), &reference.estimate);
    assert!(!verdict.passes(), "the wider view passes, and should not: {verdict:?}");
}
