//! `view`: the viewer in the browser, with the planner behind it.

use crate::browser::{self, Screen};
use crate::cli::View;
use crate::input::{is_standard, judged_path, refuse_two_standard_inputs, scene};
use crate::interrupt;
use crate::output::{note, print};
use mp_io::{Content, Files as _};
use mp_plan::{Error, Look, PictureKind, Scene};
use mp_serve::{Limits, Server, Wake};
use mp_store::folder_of;
use mp_view::{Opening, Planner, SceneFile, Session};
use std::path::{Path, PathBuf};

/// A request may hold the largest mesh file, and what is said about it.
const BODY_BYTES: u64 = mp_io::MAX_MESH_BYTES + (1 << 20);

/// A session of the viewer behind the server.
struct Served(Session);

impl mp_serve::Session for Served {
    fn handle(&self, request: &[u8]) -> Vec<u8> {
        self.0.handle(request)
    }
    fn take_event(&self) -> Option<Vec<u8>> {
        self.0.take_event()
    }
}

/// Serves the page until Ctrl-C.
pub(crate) fn run(args: &View) -> Result<bool, Error> {
    let opening = Opening { thumbnail: Some(thumbnail), ..opening(args)? };
    let page = mp_view::page(None, Planner::Server);
    let limits = Limits { body_bytes: BODY_BYTES, ..Limits::default() };
    let open = move |wake: Wake| -> Box<dyn mp_serve::Session> {
        Box::new(Served(Session::new(opening.clone(), move || wake.wake())))
    };
    let server = Server::bind(args.port.unwrap_or(0), page, limits, open);
    let server = server.map_err(|e| Error::new(e.to_string()).help("name another port by --port"))?;
    let stop = server.stop();
    interrupt::on_first(move || stop.stop());
    print(&server.address())?;
    if !args.no_browser {
        show(&server);
    }
    note("Ctrl-C ends it");
    server.run().map_err(|e| Error::new(e.to_string()))?;
    Ok(true)
}

/// A scene as the gallery shows it, at half of this size.
fn thumbnail(scene: &Scene) -> Result<Vec<u8>, Error> {
    scene.picture(None, "", PictureKind::Png, &Look { size: (440, 300), ..Look::default() })
}

/// Opens the browser, or says where the address can be opened.
fn show(server: &Server) {
    let port = server.port();
    match Screen::find() {
        Screen::Here => {
            if let Err(e) = browser::open(&server.ticket()) {
                note(&format!("{e}; open the address above"));
            }
        }
        Screen::OverSsh => note(&format!(
            "this is an ssh session: on your own machine run `ssh -N -L {port}:127.0.0.1:{port} HOST`, where HOST is this \
             machine, and open the address there"
        )),
        Screen::None => note("there is no display: open the address in a browser of this machine"),
    }
}

/// What each tab begins with.
fn opening(args: &View) -> Result<Opening, Error> {
    let folder = folder(args)?;
    let Some(given) = &args.scene else {
        return Ok(Opening { folder: Some(folder), ..Opening::default() });
    };
    refuse_two_standard_inputs(given, args.path.as_deref())?;
    if let Some(shown) = scene_file(given)? {
        return match args.path {
            None => Ok(Opening { shown: Some(shown), folder: Some(folder), ..Opening::default() }),
            Some(_) => Err(Error::new(format!("{} shows its own paths", given.display()))
                .help("leave the path out, or name the scene that the file was made from")),
        };
    }
    if is_mesh_file(given) && !args.changes.of_problem().is_empty() {
        return Err(Error::new(format!("{} is a mesh: it has no start, goal or obstacles", given.display()))
            .help("leave out --from, --to and --obstacle"));
    }
    let scene = if is_mesh_file(given) {
        mp_view::scene_of_mesh(&mp_io::Disk, given)?
    } else {
        scene(given, &args.changes.of_problem())?
    };
    let path = args.path.as_ref().map(|file| judged_path(&scene, file)).transpose()?;
    let path = path.map(|(path, _)| path);
    Ok(Opening { scene: Some(scene), path, folder: Some(folder), ..Opening::default() })
}

/// The scene file of the viewer at `given`, if it is one.
fn scene_file(given: &Path) -> Result<Option<SceneFile>, Error> {
    if !Content::of(given).any(|content| content == Content::ViewerScene) {
        return Ok(None);
    }
    let bytes = mp_io::Disk.read(given, mp_io::MAX_MESH_BYTES)?;
    let file = SceneFile::parse(&bytes);
    file.map(Some).map_err(|e| {
        Error::new(format!("{}: {e}", given.display())).help("write it again: `mp render SCENE --out x.mpv`")
    })
}

/// Whether there is a mesh at `given`.
fn is_mesh_file(given: &Path) -> bool {
    // Errors come when it is read as a scene.
    !is_standard(given)
        && mp_io::Disk.read(given, mp_io::MAX_MESH_BYTES).is_ok_and(|bytes| mp_view::is_mesh(given, &bytes))
}

/// The folder for files: the one asked for, that of the scene when it is a file, or the current one.
fn folder(args: &View) -> Result<PathBuf, Error> {
    let scene = args.scene.as_ref().filter(|scene| !is_standard(scene) && scene.is_file());
    let folder = match (&args.folder, scene) {
        (Some(folder), _) => folder.as_path(),
        (None, Some(scene)) => folder_of(scene),
        (None, None) => Path::new("."),
    };
    if !folder.is_dir() {
        return Err(Error::new(format!("{} is not a folder", folder.display())).help("name one that exists"));
    }
    folder.canonicalize().map_err(|e| Error::new(format!("cannot find the folder {}: {e}", folder.display())))
}
