//! What a scene reader is told, and what it tells besides the scene.

/// How to read a scene.
#[derive(Clone, Debug, Default)]
pub struct ReadOptions {
    /// Values for the parameters a Mitsuba scene declares with `<default>` (`-D name=value`), the last of a name counting.
    /// Formats without parameters report them as unused.
    pub defines: Vec<(String, String)>,
}

/// Where the time of loading a scene went.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadReport {
    /// Seconds of reading, parsing and translating the scene files themselves.
    pub parse_seconds: f64,
    /// Seconds of reading mesh files, summed over threads.
    pub mesh_seconds: f64,
    /// Seconds of reading and decoding images, summed over threads.
    pub image_seconds: f64,
    /// Seconds until everything was read; meshes and images are read in parallel.
    pub total_seconds: f64,
}
