//! Files: what they mean, and the line of what is wrong in them.

use std::io::Write;

use flate2::{Compression, write::GzEncoder};
use lichtweg_walk::read::{Input, parse_edges, parse_market, parse_vector, read_input, read_vector};

const SYMMETRIC: &str = "%%MatrixMarket matrix coordinate real symmetric
% a comment

3 3 4
1 1 4
2 1 -1.5e0
3 2 2
3 3 1
";

fn compressed(text: &str) -> Vec<u8> {
    let mut encoder = GzEncoder::new(Vec::new(), Compression::fast());
    encoder.write_all(text.as_bytes()).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn matrix_market_means_what_it_says() {
    let m = parse_market("m", SYMMETRIC.as_bytes()).unwrap();
    assert_eq!((m.get(0, 0), m.get(1, 0), m.get(0, 1), m.get(1, 2), m.entries()), (4.0, -1.5, -1.5, 2.0, 6));
    assert_eq!(parse_market("m", &compressed(SYMMETRIC)).unwrap(), m);
    let skew = "%%MatrixMarket matrix coordinate integer skew-symmetric\n2 2 1\n2 1 3\n";
    let m = parse_market("m", skew.as_bytes()).unwrap();
    assert_eq!((m.get(1, 0), m.get(0, 1)), (3.0, -3.0));
    let pattern = "%%matrixmarket MATRIX Coordinate Pattern General\r\n2 3 2\r\n1 3\r\n2 1\r\n";
    let m = parse_market("m", pattern.as_bytes()).unwrap();
    assert_eq!((m.rows(), m.columns(), m.get(0, 2), m.get(1, 0)), (2, 3, 1.0, 1.0));
    let array = "%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n4\n";
    let m = parse_market("m", array.as_bytes()).unwrap();
    assert_eq!((m.get(1, 0), m.get(0, 1)), (2.0, 3.0));
    let lower = "%%MatrixMarket matrix array real symmetric\n2 2\n1\n2\n3\n";
    let m = parse_market("m", lower.as_bytes()).unwrap();
    assert_eq!((m.get(1, 0), m.get(0, 1), m.get(1, 1)), (2.0, 2.0, 3.0));
    let skew = "%%MatrixMarket matrix array real skew-symmetric\n3 3\n1\n2\n3\n";
    let m = parse_market("m", skew.as_bytes()).unwrap();
    assert_eq!((m.get(1, 0), m.get(2, 0), m.get(2, 1), m.get(1, 2)), (1.0, 2.0, 3.0, -3.0));
}

#[test]
fn edge_lists_keep_their_ids() {
    let graph = parse_edges("e", b"# Nodes: 3\n10\t20\n20 7\n10,7,2.5\n10 20\n").unwrap();
    assert_eq!(graph.labels, [7, 10, 20]);
    let (ten, twenty) = (graph.node(10).unwrap(), graph.node(20).unwrap());
    assert_eq!((graph.adjacency.get(ten, twenty), graph.adjacency.get(ten, 0)), (2.0, 2.5));
    assert_eq!(graph.node(8), None);
    assert!(parse_edges("e", b"# nothing\n").unwrap().labels.is_empty());
}

#[test]
fn vectors_in_any_dress() {
    for text in
        ["1 2\n3", "1,2,3 # end\n", "%%MatrixMarket matrix array real general\n3 1\n1\n2\n3\n", "1;2\n\n3\n"]
    {
        assert_eq!(parse_vector("v", text.as_bytes()).unwrap(), [1.0, 2.0, 3.0], "{text}");
    }
    let sparse = "%%MatrixMarket matrix coordinate real general\n1 3 1\n1 2 5\n";
    assert_eq!(parse_vector("v", sparse.as_bytes()).unwrap(), [0.0, 5.0, 0.0]);
    assert!(parse_vector("v", b"").unwrap().is_empty());
}

#[test]
fn files_are_told_apart() {
    let directory = tempfile::tempdir().unwrap();
    let path = |name: &str, bytes: &[u8]| {
        let path = directory.path().join(name);
        std::fs::write(&path, bytes).unwrap();
        path
    };
    assert!(matches!(read_input(&path("a", &compressed(SYMMETRIC))), Ok(Input::Matrix(_))));
    assert!(matches!(read_input(&path("b", b"1 2\n")), Ok(Input::Graph(_))));
    assert_eq!(read_vector(&path("c", b"1\n2\n")).unwrap(), [1.0, 2.0]);
    let missing = read_vector(&directory.path().join("none")).unwrap_err();
    assert!(missing.to_string().contains("none"), "{missing}");
    let mut damaged = compressed(SYMMETRIC);
    damaged.truncate(damaged.len() / 2);
    assert!(read_input(&path("d", &damaged)).is_err());
}

#[test]
fn errors_tell_the_line() {
    let head = "%%MatrixMarket matrix coordinate real general\n";
    for (text, expected) in [
        ("", "m:1: expected \"%%MatrixMarket"),
        ("%%MatrixMarket matrix coordinate real\n", "m:1: expected"),
        ("%%MatrixMarket matrix sparse real general\n", "m:1: unknown format \"sparse\""),
        ("%%MatrixMarket matrix coordinate complex general\n", "m:1: unsupported field"),
        ("%%MatrixMarket matrix coordinate real hermitian\n", "m:1: unsupported symmetry"),
        (&format!("{head}% comment\n2 2\n"), "m:3: expected \"ROWS COLUMNS ENTRIES\""),
        (&format!("{head}2 2 x\n"), "m:2: \"x\" is not a whole number"),
        (head, "the file ends before"),
        (&format!("{head}2 2 1\n3 1 1\n"), "m:3: row 3 is not in 1 to 2"),
        (&format!("{head}2 2 1\n0 1 1\n"), "m:3: row 0 is not in 1 to 2"),
        (&format!("{head}2 2 1\n1 1\n"), "m:3: the value is missing"),
        (&format!("{head}2 2 1\n\n1 1 abc\n"), "m:4: \"abc\" is not a number"),
        (&format!("{head}2 2 1\n1 1 nan\n"), "m:3: \"nan\" is not finite"),
        (&format!("{head}2 2 1\n1 1 1 1\n"), "m:3: unexpected \"1\""),
        (&format!("{head}2 2 2\n1 1 1\n"), "m:3: the file ends after 1 of 2 entries"),
        (&format!("{head}2 2 1\n1 1 1\n2 2 1\n"), "m:4: more than the 1 entries promised"),
        (&format!("{head}2 2 5\n"), "5 entries do not fit"),
        (&format!("{head}4000000000 4000000000 1\n1 1 1\n"), "cannot be meant"),
        (&format!("{head}99999999999999999999 1 1\n"), "is not a whole number"),
        (&format!("{head}5000000000 1 1\n"), "too large"),
        ("%%MatrixMarket matrix coordinate real symmetric\n2 2 1\n1 2 1\n", "m:3: symmetric matrices store"),
        ("%%MatrixMarket matrix coordinate real symmetric\n2 3 1\n1 1 1\n", "not square"),
        (
            "%%MatrixMarket matrix coordinate integer general\n1 1 1\n1 1 1.5\n",
            "m:3: \"1.5\" is not an integer",
        ),
        ("%%MatrixMarket matrix coordinate integer skew-symmetric\n1 1 1\n1 1 1\n", "the diagonal of a skew"),
        ("%%MatrixMarket matrix array real general\n2 2\n1\n2\n3\n", "m:5: the file ends after 3 of 4"),
        ("%%MatrixMarket matrix array real general\n1 1\n1\n2\n", "m:4: more than the 1 numbers"),
        ("%%MatrixMarket matrix array pattern general\n1 1\n1\n", "m:1: a pattern has neither"),
    ] {
        let error = parse_market("m", text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(expected), "{text:?}: {error}");
    }
    for (text, expected) in [
        ("1 2\n3\n", "e:2: the second node"),
        ("1 x\n", "e:1: \"x\" is not a whole number"),
        ("1 2 -1\n", "e:1: the weight \"-1\" is negative"),
        ("1 2 3 4\n", "e:1: unexpected \"4\""),
    ] {
        let error = parse_edges("e", text.as_bytes()).unwrap_err().to_string();
        assert!(error.contains(expected), "{text:?}: {error}");
    }
    let error = parse_vector("v", b"1\n2 oops\n").unwrap_err().to_string();
    assert_eq!(error, "v:2: \"oops\" is not a number");
    let error = parse_vector("v", SYMMETRIC.as_bytes()).unwrap_err().to_string();
    assert!(error.contains("a vector is expected, not a matrix of 3 x 3"), "{error}");
}

#[test]
fn damaged_files_neither_panic_nor_hang() {
    let texts = [SYMMETRIC, "%%MatrixMarket matrix array integer symmetric\n2 2\n1\n2\n3\n", "1 2\n3 4 5\n"];
    for text in texts {
        for cut in 0..text.len() {
            for byte in [b' ', b'9', b'-', b'\n', 0xff] {
                let mut bytes = text.as_bytes().to_vec();
                bytes[cut] = byte;
                let _ = (parse_market("m", &bytes), parse_edges("e", &bytes), parse_vector("v", &bytes));
            }
            let _ = parse_market("m", &text.as_bytes()[..cut]);
        }
    }
}
