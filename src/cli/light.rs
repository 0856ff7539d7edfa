//! What the commands about scenes share.

use super::notes::Notes;
use super::stop::Stop;
use crate::light::scene::{Scene, read};
use crate::light::walk::{Power, Walk, WalkError};
use crate::parameter::{listed, nearest};
use crate::sample::Sample;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

/// The scene in the file at `path`; `-` is the standard input.
///
/// # Errors
/// With everything that is wrong with it.
pub fn scene(path: &Path) -> Result<Arc<Scene>, Stop> {
    read::scene(path)
        .map(Arc::new)
        .map_err(|problems| Stop::problems(&problems))
}

/// The position of the surface of that name.
///
/// # Errors
/// If there is none.
pub fn surface(scene: &Scene, name: &str) -> Result<usize, Stop> {
    if let Some((position, _)) = scene.surface(name) {
        return Ok(position);
    }
    let names: Vec<&str> = scene.surfaces().iter().map(|s| s.name.as_str()).collect();
    let guess = nearest(name, names.iter().copied())
        .map(|name| format!(" did you mean `{name}`?"))
        .unwrap_or_default();
    Err(Stop::Input(format!(
        "--surface: the scene has no surface \"{}\";{guess} allowed are {}",
        name.escape_debug(),
        listed(&names)
    )))
}

/// The hits of so many photons as a sample for each surface, with the flux that arrives or that is `returned`; none where nothing hit, or on a mesh.
///
/// # Errors
/// If the walk cannot be stored, or light leaks out of the scene.
pub fn walk(
    scene: &Arc<Scene>,
    photons: u64,
    seed: u64,
    returned: bool,
) -> Result<impl Fn(usize) -> Option<Sample<2>> + use<>, Stop> {
    let told = |error: WalkError| Stop::Input(error.to_string());
    let scene = scene.clone();
    let (hits, _) = Walk::new(&scene, Power::Same, photons, seed)
        .map(|walk| if returned { walk.returned() } else { walk })
        .and_then(|walk| walk.run())
        .map_err(told)?;
    Ok(move |surface: usize| hits.sample(&scene, surface)?.ok())
}

/// Something that takes a while, on a terminal.
pub fn bar(notes: Notes, what: &'static str) -> ProgressBar {
    if notes.quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::new_spinner().with_message(what);
    bar.enable_steady_tick(Duration::from_millis(200));
    match ProgressStyle::with_template("{spinner} {msg}, {elapsed}") {
        Ok(style) => bar.with_style(style),
        Err(_) => bar,
    }
}
