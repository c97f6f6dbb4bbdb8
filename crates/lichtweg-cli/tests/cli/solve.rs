//! `lichtweg solve` and `lichtweg radiosity`.

use crate::common::{Workplace, text};
use lichtweg_io::image::read_exr_layers;
use serde_json::Value;

/// 4 on the diagonal, -1 beside it; with the right side of x = (1, 2, 3).
const MATRIX: &str =
    "%%MatrixMarket matrix coordinate real symmetric\n3 3 5\n1 1 4\n2 1 -1\n2 2 4\n3 2 -1\n3 3 4\n";
const RIGHT_SIDE: &str = "2\n4\n10\n";

fn place() -> Workplace {
    let place = Workplace::new();
    for (name, content) in
        [("A.mtx", MATRIX), ("b.txt", RIGHT_SIDE), ("graph.txt", "# graph\n10 20\n20 10\n20 30\n")]
    {
        std::fs::write(place.path(name), content).unwrap();
    }
    place
}

fn answers(place: &Workplace, arguments: &[&str]) -> Vec<Value> {
    let output = place.run(&[&["solve", "--json"], arguments].concat());
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let json: Value = serde_json::from_slice(&output.stdout).unwrap();
    json["answers"].as_array().unwrap().clone()
}

#[test]
fn every_method_finds_the_unknowns() {
    let place = place();
    for method in
        ["auto", "adjoint", "forward", "push", "bidirectional", "push-walk", "sequential", "deterministic"]
    {
        let found = answers(
            &place,
            &["A.mtx", "-b", "b.txt", "-u", "1,3", "--confidence", "99.99%", "--method", method],
        );
        for (answer, exact) in found.iter().zip([1.0, 3.0]) {
            let [value, half_width] = ["value", "half_width"].map(|key| answer[key].as_f64().unwrap());
            assert!((value - exact).abs() <= half_width + 1e-9, "{method}: {answer}");
        }
    }
}

#[test]
fn the_answer_is_told_with_its_interval_and_reason() {
    let place = place();
    let told = text(
        &place.run(&["solve", "A.mtx", "-b", "b.txt", "-u", "2", "--method", "adjoint", "--neumann"]).stdout,
    );
    let unsaid = text(&place.run(&["solve", "A.mtx", "-b", "b.txt", "-u", "2", "--neumann"]).stdout);
    assert!(unsaid.contains("Neumann"), "{unsaid}");
    for expected in
        ["x[2] = ", " +- ", "(95 %)", "adjoint: as asked for", "walks", "steps", "rho(|M|) <=", "Neumann"]
    {
        assert!(told.contains(expected), "{expected}: {told}");
    }
}

/// Forward walks, and solutions for all unknowns, serve all that are asked for.
#[test]
fn several_unknowns_share_what_they_can() {
    let place = place();
    for (method, shared) in [("forward", 3), ("deterministic", 3), ("sequential", 3), ("adjoint", 1)] {
        let found = answers(&place, &["A.mtx", "-b", "b.txt", "-u", "1,2,3", "--method", method]);
        assert!(found.iter().all(|answer| answer["shared_by"] == shared), "{method}: {found:?}");
    }
    let told =
        text(&place.run(&["solve", "A.mtx", "-b", "b.txt", "-u", "1,2", "--method", "forward"]).stdout);
    assert!(told.contains("shared by 2") && told.contains("95 % for all 2 together"), "{told}");
}

#[test]
fn without_a_factorisation_it_is_told() {
    let place = place();
    let run = place.run(&["solve", "A.mtx", "-b", "b.txt", "-u", "1", "--method", "direct"]);
    if cfg!(feature = "faer") {
        assert!(text(&run.stdout).contains("sparse Cholesky"), "{}", text(&run.stdout));
    } else {
        assert_eq!(run.status.code(), Some(1));
        assert!(text(&run.stderr).contains("--features faer"), "{}", text(&run.stderr));
    }
}

#[test]
fn all_unknowns_are_written() {
    let place = place();
    let told =
        place.succeed(&["solve", "A.mtx", "-b", "b.txt", "--all", "--tolerance", "1e-9", "--write", "x.mtx"]);
    assert!(told.contains("right tool"), "{told}");
    let x = std::fs::read_to_string(place.path("x.mtx")).unwrap();
    let numbers: Vec<f64> = x.lines().skip(2).map(|line| line.parse().unwrap()).collect();
    assert!(numbers.iter().zip([1.0, 2.0, 3.0]).all(|(x, exact)| (x - exact).abs() < 1e-7), "{x}");
}

#[test]
fn graphs_go_by_their_ids() {
    let place = place();
    let found = answers(&place, &["graph.txt", "--start", "20", "-u", "30", "--tolerance", "1e-4"]);
    // x20 = 0.15 + 0.85 (x10 + x30), x10 = x30 = 0.425 x20.
    let exact = 0.425 * 0.15 / (1.0 - 0.85 * 0.85);
    assert!((found[0]["value"].as_f64().unwrap() / exact - 1.0).abs() < 3e-4, "{found:?} {exact}");
    assert!(place.fail(2, &["solve", "graph.txt", "-u", "11"]).contains("no unknown 11 in the graph"));
}

#[test]
fn what_cannot_be_solved_is_told() {
    let place = place();
    std::fs::write(place.path("bad.mtx"), "%%MatrixMarket matrix coordinate real general\n1 1 1\n2 1 1\n")
        .unwrap();
    std::fs::write(
        place.path("large.mtx"),
        "%%MatrixMarket matrix coordinate real general\n2 2 4\n1 1 1\n1 2 2\n2 1 3\n2 2 1\n",
    )
    .unwrap();
    std::fs::write(
        place.path("closed.mtx"),
        "%%MatrixMarket matrix coordinate real general\n2 2 2\n1 2 1\n2 1 1\n",
    )
    .unwrap();
    for (code, arguments, expected) in [
        (2, &["A.mtx", "-u", "1"][..], "the right side is missing"),
        (2, &["A.mtx", "-b", "b.txt"], "which unknown?"),
        (2, &["A.mtx", "-b", "b.txt", "-u", "4"], "counted from 1 to 3"),
        (2, &["A.mtx", "-b", "b.txt", "-u", "1", "--method", "magic"], "one of auto, adjoint"),
        (1, &["bad.mtx", "-b", "ones", "-u", "1"], "bad.mtx:3: row 2 is not in 1 to 1"),
        (1, &["none.mtx", "-b", "ones", "-u", "1"], "none.mtx"),
        (1, &["large.mtx", "-b", "ones", "-u", "1"], "rho(|M|)"),
        (2, &["A.mtx", "-b", "b.txt", "--all", "--method", "adjoint"], "one number at a time"),
        (2, &["A.mtx", "-b", "b.txt", "-u", "1", "--start", "1"], "--start has no meaning"),
        (2, &["graph.txt", "-b", "b.txt", "-u", "10"], "--rhs has no meaning"),
        (2, &["graph.txt", "--splitting", "jacobi", "-u", "10"], "--splitting has no meaning"),
        (1, &["A.mtx", "-b", "b.txt", "-u", "1", "--splitting", "richardson"], "--splitting jacobi"),
        (1, &["closed.mtx", "--problem", "chain", "-u", "1"], "particles never end"),
        (1, &["closed.mtx", "-b", "ones", "-u", "1"], "at row 1 cannot be divided by"),
        (1, &["large.mtx", "--problem", "chain", "-u", "1"], "state 1: the probabilities"),
    ] {
        let told = place.fail(code, &[&["solve"], arguments].concat());
        assert!(told.contains(expected), "{arguments:?}: {told}");
    }
}

#[test]
fn particles_are_shown_on_a_page() {
    let place = place();
    let told = place.succeed(&["solve", "A.mtx", "-b", "b.txt", "--animate", "page.html"]);
    assert!(told.contains("wrote page.html"), "{told}");
    let page = std::fs::read_to_string(place.path("page.html")).unwrap();
    assert!(page.contains("\"equilibrium\":[") && !page.contains("\"DATA\""));
}

/// What reflects half.
const GREY: &str = r#"<bsdf type="diffuse"><rgb name="reflectance" value="0.5"/></bsdf>"#;

/// Shapes, seen from one point towards another in 8 x 8 pixels.
fn seen(from: &str, towards: &str, shapes: &str) -> String {
    format!(
        r#"<scene version="3.0.0">
        <sensor type="perspective">
            <transform name="to_world"><lookat origin="{from}" target="{towards}" up="0,1,0"/></transform>
            <film type="hdrfilm"><integer name="width" value="8"/><integer name="height" value="8"/></film>
        </sensor>
        {shapes}
    </scene>"#
    )
}

/// A ball that shines.
fn lamp(centre: &str) -> String {
    format!(
        r#"<shape type="sphere">
            <transform name="to_world"><scale value="0.3"/><translate value="{centre}"/></transform>
            <emitter type="area"><rgb name="radiance" value="5"/></emitter>
        </shape>"#
    )
}

/// A closed surface of albedo 1/2 that glows inside, seen from within; and whatever else.
fn glowing(shape: &str, more: &str) -> String {
    let glow = r#"<emitter type="area"><rgb name="radiance" value="1"/></emitter>"#;
    let turned = r#"<boolean name="flip_normals" value="true"/>"#;
    seen("0,0,0", "0.3,0.2,1", &format!(r#"<shape type="{shape}">{turned}{GREY}{glow}</shape>{more}"#))
}

/// Its radiance is Le / (1 - 1/2) wherever one looks.
#[test]
fn radiosity_of_an_enclosure_is_known() {
    for (shape, method) in [
        ("cube", "deterministic"),
        ("cube", "sequential"),
        ("cube", "adjoint"),
        ("cube", "forward"),
        ("cube", "push"),
        ("cube", "bidirectional"),
        ("cube", "push-walk"),
        ("cube", "auto"),
        ("sphere", "deterministic"),
    ] {
        let place = Workplace::with(&glowing(shape, ""));
        place.succeed(&[
            "radiosity",
            "scene.xml",
            "-o",
            "out.exr",
            "--patch",
            "0.2",
            "--rays",
            "256",
            "--tolerance",
            "0.04",
            "--method",
            method,
        ]);
        let image = read_exr_layers(&place.path("out.exr")).unwrap();
        for (name, data) in &image.channels {
            assert!(data.iter().all(|l| (l - 2.0).abs() < 0.2), "{shape} {method} {name}: {data:?}");
        }
    }
}

/// Walls that turn their backs and reflect on both sides look like walls that face the room; those that reflect in front alone
/// are black from behind.
#[test]
fn radiosity_has_two_sides() {
    let room = |walls: &str| {
        seen("0,0,0.9", "0,0,-1", &format!(r#"<shape type="cube">{walls}</shape>{}"#, lamp("0,0.6,0.4")))
    };
    let images = [
        format!(r#"<boolean name="flip_normals" value="true"/>{GREY}"#),
        format!(r#"<bsdf type="twosided">{GREY}</bsdf>"#),
        GREY.to_owned(),
    ]
    .map(|walls| {
        let place = Workplace::with(&room(&walls));
        place.succeed(&["radiosity", "scene.xml", "-o", "out.exr", "--patch", "0.1", "--rays", "256"]);
        let image = read_exr_layers(&place.path("out.exr")).unwrap();
        image.channels[0].1.iter().sum::<f32>()
    });
    assert!(images[0] > 1.0 && (images[1] / images[0] - 1.0).abs() < 0.05, "{images:?}");
    assert_eq!(images[2], 0.0);
}

/// Half of the patches are out of sight of all light: the outsides of walls that reflect on both sides, and what looks on from
/// there. They are black, whatever the method, and none of them stops the others.
#[test]
fn radiosity_is_zero_where_no_light_comes() {
    let walls = format!(r#"<shape type="cube"><bsdf type="twosided">{GREY}</bsdf></shape>"#);
    let place = Workplace::with(&seen("0,0,5", "0,0,0", &(walls + &lamp("0,0,0"))));
    for method in
        ["auto", "adjoint", "forward", "push", "bidirectional", "push-walk", "sequential", "deterministic"]
    {
        let arguments = ["radiosity", "scene.xml", "-o", "out.exr", "--patch", "0.2", "--rays", "64"];
        let told = place.succeed(&[&arguments[..], &["--method", method]].concat());
        let one_by_one = ["adjoint", "forward", "push", "bidirectional", "push-walk"].contains(&method);
        assert_eq!(told.contains("the right tool"), one_by_one, "{method}: {told}");
        let image = read_exr_layers(&place.path("out.exr")).unwrap();
        assert!(image.channels.iter().all(|(_, data)| data.iter().all(|&l| l == 0.0)), "{method}");
    }
}

#[test]
fn radiosity_tells_what_it_does_not_know() {
    for (more, expected) in [
        (
            r#"<emitter type="point"><point name="position" x="0" y="0" z="0"/></emitter>"#,
            "emitting surfaces only",
        ),
        (
            r#"<shape type="shapegroup" id="g"><shape type="sphere"/></shape>
               <shape type="instance"><ref id="g"/></shape>"#,
            "no instances",
        ),
    ] {
        let place = Workplace::with(&glowing("cube", more));
        let told = place.fail(1, &["radiosity", "scene.xml", "-o", "out.exr"]);
        assert!(told.contains(expected), "{told}");
    }
}
