//! Writes the triangles of `builtin:street` as a PLY file, for the benchmark of `lichtweg-ray`.
//!
//! `cargo run --release -p lichtweg-io --example street_ply -- street.ply`

use std::fs::File;
use std::io::{self, BufWriter, Write};

use lichtweg_io::builtin::street;

fn main() -> io::Result<()> {
    let path = std::env::args_os().nth(1).ok_or_else(|| io::Error::other("the name of a file is missing"))?;
    let (positions, triangles) = street::triangles(street::Parameters::default());
    let mut file = BufWriter::new(File::create(path)?);
    writeln!(file, "ply\nformat binary_little_endian 1.0\nelement vertex {}", positions.len())?;
    writeln!(file, "property float x\nproperty float y\nproperty float z\nelement face {}", triangles.len())?;
    writeln!(file, "property list uchar int vertex_indices\nend_header")?;
    for x in positions.iter().flat_map(|p| p.to_array()) {
        file.write_all(&x.to_le_bytes())?;
    }
    for triangle in triangles {
        file.write_all(&[3])?;
        for i in triangle {
            file.write_all(&i.to_le_bytes())?;
        }
    }
    file.flush()
}
