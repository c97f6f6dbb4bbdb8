//! What the commands about paths have in common: a scene, settings that replace its own, and threads.

use clap::Args;
use lichtweg::render::{Job, LayerSelection};
use lichtweg::scene::Scene;
use lichtweg::scene::description::{Description, EstimatorKind};
use lichtweg_io::scene_file::SceneLocation;

use crate::console::Console;
use crate::failure::Failure;
use crate::load::location_parser;
use crate::options::{self, IntegratorChoice};
use crate::settings::SettingsArgs;

/// A scene and settings.
#[derive(Debug, Args)]
pub struct SetupArgs {
    /// Scene file (.xml, .pbrt, .pbrt.gz) or builtin:NAME
    #[arg(value_parser = location_parser())]
    scene: SceneLocation,

    /// Settings of bidirectional path tracing: bdpt:heuristic=balance|power,
    /// lights=auto|uniform|power|tree, rr_depth=N|off, hide_emitters=true|false
    #[arg(long, value_name = "bdpt[:KEY=VALUE,...]", value_parser = options::parse_integrator)]
    integrator: Option<IntegratorChoice>,

    #[command(flatten)]
    settings: SettingsArgs,
}

/// A scene that is ready to be rendered.
#[derive(Debug)]
pub struct Setup {
    /// As it was described, settings replaced.
    pub description: Description,
    /// Compiled.
    pub scene: Scene,
    /// Its job.
    pub job: Job,
    /// Where to talk.
    pub console: Console,
}

impl SetupArgs {
    /// Does something with the scene, in a pool of the threads asked for.
    pub fn with(
        &self,
        prepare: impl FnOnce(&mut Description) + Send,
        action: impl FnOnce(Setup) -> Result<(), Failure> + Send,
    ) -> Result<(), Failure> {
        self.settings.threads()?.install(|| action(self.compile(prepare)?))
    }

    fn compile(&self, prepare: impl FnOnce(&mut Description)) -> Result<Setup, Failure> {
        let console = self.settings.console();
        let (mut loader, mut description) = self.settings.load(&self.scene, console)?;
        self.settings.overrides(self.integrator.as_ref()).apply(&mut description)?;
        description.integrator.estimator = EstimatorKind::Bidirectional;
        prepare(&mut description);
        let diagnostics = &mut loader.diagnostics;
        let job = Job::compile(&description, LayerSelection::default(), None, diagnostics);
        let scene = console.stage("building", || Scene::compile(&description, diagnostics));
        let (Some(job), Some(scene)) = (job, scene) else { return Err(loader.fail()) };
        loader.show();
        Ok(Setup { description, scene, job, console })
    }
}

/// Makes a directory, if it is not there.
pub fn make_directory(path: &std::path::Path) -> Result<(), Failure> {
    std::fs::create_dir_all(path)
        .map_err(|error| Failure::Failed(format!("{} cannot be made: {error}", path.display())))
}

/// Writes a file.
pub fn write_file(path: &std::path::Path, text: &str) -> Result<(), Failure> {
    std::fs::write(path, text)
        .map_err(|error| Failure::Failed(format!("{} cannot be written: {error}", path.display())))
}
