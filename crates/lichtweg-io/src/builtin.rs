//! Scenes that come with the program, by name: `builtin:cornell-box`.
//!
//! They are the files of the folder `scenes`, which need no others, compiled in.

/// What stands before a name wherever a scene is asked for.
pub const PREFIX: &str = "builtin:";

/// A scene that comes with the program.
#[derive(Clone, Copy, Debug)]
pub struct BuiltinScene {
    /// Its name, without [`PREFIX`].
    pub name: &'static str,
    /// What it shows, in one line.
    pub about: &'static str,
    /// Its Mitsuba XML.
    pub xml: &'static str,
}

/// A file of the folder `scenes`.
macro_rules! scene {
    ($name:literal, $about:literal) => {
        BuiltinScene {
            name: $name,
            about: $about,
            xml: include_str!(concat!("../../../scenes/", $name, ".xml")),
        }
    };
}

/// All of them; the first is the one to render where none is named.
pub const SCENES: &[BuiltinScene] = &[
    scene!("cornell-box", "two blocks in a box with a red and a green wall, from the measured data"),
    scene!("veach-mis", "four glossy plates reflect four lights: what multiple importance sampling is for"),
    scene!("lamp-room", "a room lit by two lamps whose bulbs are hidden, with caustics of glass"),
    scene!("door-ajar", "a room lit only through a door left ajar"),
    scene!("furnace", "a diffuse block in a glowing sphere: its radiance is known exactly"),
    scene!(
        "knife-edge",
        "the penumbra of a straight edge: the fraction of the light that is seen is known exactly"
    ),
];

/// The scene of a name, with or without [`PREFIX`].
pub fn find(name: &str) -> Option<&'static BuiltinScene> {
    let name = name.strip_prefix(PREFIX).unwrap_or(name);
    SCENES.iter().find(|scene| scene.name == name)
}
