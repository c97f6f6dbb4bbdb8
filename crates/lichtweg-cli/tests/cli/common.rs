//! Running the built command in a directory of its own.

use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStderr, Command, Output, Stdio};

use lichtweg_io::image::{ExrChannels, read_exr_layers};
use serde_json::Value;
use tempfile::TempDir;

/// A floor, a ball and a lamp; parameters `spp` and `name`.
pub const SCENE: &str = r#"<scene version="3.0.0">
    <default name="spp" value="4"/>
    <default name="albedo" value="0.5"/>
    <integrator type="path"><integer name="max_depth" value="4"/></integrator>
    <sensor type="perspective">
        <transform name="to_world"><lookat origin="0,2,6" target="0,0.7,0" up="0,1,0"/></transform>
        <sampler type="independent"><integer name="sample_count" value="$spp"/></sampler>
        <film type="hdrfilm">
            <integer name="width" value="32"/><integer name="height" value="24"/>
            <rfilter type="box"/>
        </film>
    </sensor>
    <bsdf type="diffuse" id="grey"><rgb name="reflectance" value="$albedo"/></bsdf>
    <shape type="rectangle">
        <transform name="to_world"><scale value="5"/><rotate x="1" angle="-90"/></transform>
        <ref id="grey"/>
    </shape>
    <shape type="sphere"><point name="center" x="0" y="1" z="0"/><ref id="grey"/></shape>
    <shape type="sphere">
        <point name="center" x="1" y="4" z="2"/><float name="radius" value="0.3"/>
        <emitter type="area"><rgb name="radiance" value="20"/></emitter>
    </shape>
</scene>
"#;

/// A directory that holds `scene.xml`.
pub struct Workplace {
    directory: TempDir,
}

impl Workplace {
    /// With [`SCENE`].
    pub fn new() -> Self {
        Self::with(SCENE)
    }

    /// With a scene of its own.
    pub fn with(scene: &str) -> Self {
        let directory = tempfile::tempdir().unwrap();
        std::fs::write(directory.path().join("scene.xml"), scene).unwrap();
        Self { directory }
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.directory.path().join(name)
    }

    pub fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_lichtweg"));
        command.args(arguments).current_dir(self.directory.path()).stdin(Stdio::null());
        command
    }

    /// Runs to the end.
    pub fn run(&self, arguments: &[&str]) -> Output {
        self.command(arguments).output().unwrap()
    }

    /// Runs what has to go well; its standard error.
    #[track_caller]
    pub fn succeed(&self, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(0), "{arguments:?}\n{stderr}");
        stderr
    }

    /// Runs what has to fail with a code; its standard error.
    #[track_caller]
    pub fn fail(&self, code: i32, arguments: &[&str]) -> String {
        let output = self.run(arguments);
        let stderr = text(&output.stderr);
        assert_eq!(output.status.code(), Some(code), "{arguments:?}\n{stderr}");
        stderr
    }

    /// Starts a render that ends by signals only, and waits until it renders.
    pub fn start(&self, arguments: &[&str]) -> Running {
        let mut child = self.command(arguments).stderr(Stdio::piped()).spawn().unwrap();
        let stderr = BufReader::new(child.stderr.take().unwrap());
        let mut running = Running { child, stderr };
        running.wait_for("rendering");
        running
    }

    pub fn exr(&self, name: &str) -> ExrChannels {
        read_exr_layers(&self.path(name)).unwrap()
    }

    pub fn json(&self, name: &str) -> Value {
        serde_json::from_str(&std::fs::read_to_string(self.path(name)).unwrap()).unwrap()
    }

    /// Renders the scene with further options; its channels.
    #[track_caller]
    pub fn render(&self, options: &[&str]) -> ExrChannels {
        let arguments = [&["render", "scene.xml", "-o", "out.exr"], options].concat();
        self.succeed(&arguments);
        self.exr("out.exr")
    }

    /// Renders the scene with further options; its statistics.
    #[track_caller]
    pub fn stats(&self, options: &[&str]) -> Value {
        let arguments =
            [&["render", "scene.xml", "-o", "out.exr", "--stats", "stats.json"], options].concat();
        self.succeed(&arguments);
        self.json("stats.json")
    }
}

/// A render under way.
pub struct Running {
    child: Child,
    stderr: BufReader<ChildStderr>,
}

impl Running {
    /// Reads standard error up to a line that contains `words`.
    #[track_caller]
    pub fn wait_for(&mut self, words: &str) {
        let mut seen = String::new();
        while !seen.contains(words) {
            let read = self.stderr.read_line(&mut seen).unwrap();
            assert!(read > 0, "ended without \"{words}\":\n{seen}");
        }
    }

    /// What Ctrl-C sends.
    pub fn interrupt(&self) {
        let sent = Command::new("kill").args(["-INT", &self.child.id().to_string()]).status().unwrap();
        assert!(sent.success());
    }

    /// Closes the other end of standard error and waits for the end; exit code.
    pub fn end_unheard(mut self) -> Option<i32> {
        drop(self.stderr);
        self.child.wait().unwrap().code()
    }

    /// Waits for the end; exit code and the rest of standard error.
    pub fn end(mut self) -> (Option<i32>, String) {
        let mut rest = String::new();
        self.stderr.read_to_string(&mut rest).unwrap();
        (self.child.wait().unwrap().code(), rest)
    }
}

pub fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A value of a file's metadata.
pub fn metadata<'a>(exr: &'a ExrChannels, key: &str) -> &'a str {
    let found = exr.metadata.iter().find(|(k, _)| k == key || k.strip_prefix("lichtweg:") == Some(key));
    found.map(|(_, value)| value.as_str()).unwrap_or_else(|| panic!("no {key} in {:?}", exr.metadata))
}

/// Names of the files in a directory, sorted.
pub fn files(directory: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(directory).unwrap();
    let mut names: Vec<String> =
        entries.map(|entry| entry.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
