//! Mitsuba's text files of curves: a control point a line, as position and radius, and an empty line between curves
//! (Mitsuba 3 `src/shapes/linearcurve.cpp`, `bsplinecurve.cpp`).

use std::path::Path;

use lichtweg::scene::description::CurvesDescription;
use lichtweg_ray::math::Vec3;
use lichtweg_ray::{CurveBasis, CurvePoint, CurveStyle};

use super::text::Cursor;
use super::{MeshError, Place, read_regular_file};

/// Reads a file of round curves.
///
/// # Errors
/// The file cannot be read, has no curves, or one of too few control points, or a line of it is wrong.
pub fn read_curves(path: &Path, basis: CurveBasis) -> Result<CurvesDescription, MeshError> {
    read_regular_file(path)
        .map_err(|(found, help)| MeshError::new(Place::File, "a readable file", found, help))
        .and_then(|bytes| parse_curves(&bytes, basis))
        .map_err(|error| error.in_file(path))
}

/// As [`read_curves`], from the bytes of a file.
///
/// # Errors
/// As [`read_curves`].
pub fn parse_curves(bytes: &[u8], basis: CurveBasis) -> Result<CurvesDescription, MeshError> {
    let mut cursor = Cursor::new(bytes, 1);
    let (mut points, mut counts) = (Vec::new(), Vec::new());
    let mut begin = 0;
    loop {
        cursor.skip_blanks();
        if cursor.take(b'#') {
            let help = "the format has no comments: take this line out";
            return Err(MeshError::new(Place::Line(cursor.line()), "a number", "\"#\"", help));
        }
        if !cursor.at_line_end() {
            points.push(control_point(&mut cursor)?);
        } else if points.len() > begin {
            counts.push(curve_length(points.len() - begin, basis, cursor.line())?);
            begin = points.len();
        }
        if cursor.at_end() && points.len() == begin {
            break;
        }
        cursor.next_line();
    }
    if counts.is_empty() {
        let help = "write a control point a line: x, y, z and radius";
        return Err(MeshError::new(Place::File, "curves", "no control points", help));
    }
    let style = CurveStyle::Round;
    Ok(CurvesDescription { style, basis, points, counts, normals: Vec::new(), scales_radii: false })
}

fn control_point(cursor: &mut Cursor) -> Result<CurvePoint, MeshError> {
    let line = cursor.line();
    let mut values = [0.0; 4];
    for value in &mut values {
        cursor.skip_blanks();
        *value = cursor.float()?;
    }
    cursor.skip_blanks();
    if !cursor.at_line_end() {
        return Err(cursor.expected("the end of the line after x, y, z and radius"));
    }
    let [x, y, z, radius] = values;
    let at_line = |expected: &str, found: f32| {
        MeshError::new(Place::Line(line), expected, found.to_string(), "correct this line")
    };
    if let Some(found) = values.iter().find(|v| !v.is_finite()) {
        return Err(at_line("finite numbers", *found));
    }
    if radius < 0.0 {
        return Err(at_line("a radius that is not negative", radius));
    }
    Ok(CurvePoint { position: Vec3::new(x, y, z), radius })
}

fn curve_length(points: usize, basis: CurveBasis, line: u64) -> Result<usize, MeshError> {
    let needed = basis.order();
    if points >= needed {
        return Ok(points);
    }
    let expected = format!("at least {needed} control points before this line");
    let help = "add control points, or take out empty lines between them";
    Err(MeshError::new(Place::Line(line), expected, points.to_string(), help))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(text: &str, basis: CurveBasis) -> Result<Vec<usize>, String> {
        parse_curves(text.as_bytes(), basis).map(|c| c.counts).map_err(|e| e.to_string())
    }

    #[test]
    fn curves_are_divided_by_empty_lines() {
        let text = "\n -1.0 0.1 0.1 0.5\r\n\t1 1.4 1.2 0.5\n\n \n0 0 0 1\n0 1 0 2e0\n0 2 0 0";
        assert_eq!(counts(text, CurveBasis::Linear), Ok(vec![2, 3]));
        let curves = parse_curves(text.as_bytes(), CurveBasis::Linear).unwrap();
        let last = CurvePoint { position: Vec3::new(0.0, 1.0, 0.0), radius: 2.0 };
        assert_eq!((curves.points.len(), curves.points[3]), (5, last));
    }

    #[test]
    fn what_is_wrong_is_told_with_its_line() {
        let linear = |text| counts(text, CurveBasis::Linear).unwrap_err();
        assert_eq!(linear(""), "expected curves, found no control points");
        assert_eq!(
            linear("0 0 0 1\n\n1 0 0 1"),
            "line 2: expected at least 2 control points before this line, found 1"
        );
        assert_eq!(linear("0 0 0 1\n0 0 0"), "line 2: expected a number, found the end of the file");
        assert_eq!(linear("0 0 x 1\n"), "line 1: expected a number, found \"x\"");
        assert_eq!(linear("0 0 0 -1\n"), "line 1: expected a radius that is not negative, found -1");
        assert_eq!(linear("0 nan 0 1\n"), "line 1: expected finite numbers, found NaN");
        assert_eq!(linear("# hair\n"), "line 1: expected a number, found \"#\"");
        assert!(linear("0 0 0 1 7\n").starts_with("line 1: expected the end of the line"));
        let spline = counts("0 0 0 1\n0 0 0 1\n0 0 0 1", CurveBasis::BSpline).unwrap_err();
        assert_eq!(spline, "line 3: expected at least 4 control points before this line, found 3");
    }

    #[test]
    fn damaged_files_do_no_harm() {
        let valid = b"0 0 0 1\n1 2 3 4\n\n5 6 7 8\n1e9 -3.5 inf 0\n".to_vec();
        crate::mesh::fuzz::feed_damaged(&[valid], |bytes| drop(parse_curves(bytes, CurveBasis::Linear)));
    }
}
