//! What goes into the file of a picture, by the ending of its name.

use crate::cli::{Animation, Drawing};
use crate::interrupt::within;
use crate::page_planner::PagePlanner;
use crate::progress::Line;
use mp_io::Content;
use mp_plan::{
    Cancel, Error, Film, FilmKind, GrownRoadmap, Interrupt, Look, PICTURE_SIZE, PathRows, PictureKind,
    Progress, Report, Scene, SearchEvent, Stage, Verdict, Watch,
};
use mp_view::{GrownTrees, SceneFile};
use std::path::Path;
use std::time::Duration;

/// What goes into the file of a picture.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Picture {
    /// A picture in pixels or lines.
    Drawn(PictureKind, Look),
    Film(Film),
    /// The viewer with the scene inside, for a browser; with a planner inside when there is one.
    Page(Option<PagePlanner>),
    /// The scene as the viewer reads it.
    Scene,
    /// Meshes that move for this many seconds.
    Meshes(f64),
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown<'a> {
    pub(crate) scene: &'a Scene,
    pub(crate) path: Option<&'a PathRows>,
    /// Of a path that is not that of the report.
    pub(crate) verdict: Option<&'a Verdict>,
    pub(crate) report: Option<&'a Report>,
    pub(crate) caption: &'a str,
}

/// The progress of a run, and what it grows if the picture shows that.
#[derive(Debug)]
pub(crate) struct Watched<'l> {
    pub(crate) line: &'l mut Line,
    pub(crate) grown: Option<GrownTrees>,
}

impl Watch for Watched<'_> {
    fn stage(&mut self, stage: Stage) {
        self.line.stage(stage);
    }
    fn progress(&mut self, progress: &Progress) {
        self.line.progress(progress);
    }
    fn wants_events(&self) -> bool {
        self.grown.as_ref().is_some_and(Watch::wants_events)
    }
    fn event(&mut self, event: SearchEvent<'_>) {
        if let Some(grown) = &mut self.grown {
            grown.event(event);
        }
    }
    fn wants_roadmap(&self) -> bool {
        self.grown.as_ref().is_some_and(Watch::wants_roadmap)
    }
    fn roadmap(&mut self, roadmap: GrownRoadmap) {
        if let Some(grown) = &mut self.grown {
            grown.roadmap(roadmap);
        }
    }
}

/// How long a picture may be drawn after an interruption.
const PATIENCE: Duration = Duration::from_millis(500);

/// How long a film takes, seconds.
const SECONDS: f64 = 8.0;

impl Picture {
    /// By the ending of the name of `file`. `path` says whether there is a path.
    ///
    /// # Errors
    /// When this scene cannot be written as such a file, or an option has no meaning for it.
    pub(crate) fn of(scene: &Scene, file: &Path, drawing: &Drawing, path: bool) -> Result<Self, Error> {
        let content = Content::of(file).find(|content| content.is_shown());
        let seconds = drawing.seconds.unwrap_or(SECONDS);
        let look = |size, at| Look {
            size: drawing.size.unwrap_or(size),
            mode: drawing.mode.unwrap_or_default(),
            view: drawing.camera.unwrap_or_default(),
            at,
            field: drawing.field.clone(),
        };
        let picture = match (content, FilmKind::of(file)) {
            (Some(Content::Page), _) => {
                Self::Page(drawing.with_planner.then(|| PagePlanner::of(scene)).transpose()?)
            }
            (Some(Content::ViewerScene), _) => Self::Scene,
            (Some(Content::Gltf), _) => Self::Meshes(seconds),
            (_, Some(kind)) => {
                let mut film = Film::new(kind);
                film.look = look(film.look.size, None);
                film.step = drawing.animation != Some(Animation::All);
                (film.turntable, film.follow) = (drawing.turntable, drawing.follow);
                (film.seconds, film.rate) = (seconds, drawing.fps.unwrap_or(film.rate));
                let cores = std::thread::available_parallelism().map_or(1, usize::from);
                film.threads = drawing.threads.map_or(cores, usize::from);
                scene.check_film(&film, path)?;
                Self::Film(film)
            }
            (None, _) => return Err(Content::not_named(file, "a picture", Content::is_shown).into()),
            _ => {
                let kind = scene.picture_kind(file)?;
                let step = (drawing.animation == Some(Animation::Step)).then_some(0.5);
                if drawing.animation == Some(Animation::All) && drawing.at.is_some() {
                    return Err(
                        Error::new("--animation all has no moment --at").help("leave one of them out")
                    );
                }
                let look = look(PICTURE_SIZE, drawing.at.or(step));
                scene.check_look(&look, path)?;
                Self::Drawn(kind, look)
            }
        };
        picture.refuse_useless(drawing, content.map_or("", Content::ending))?;
        Ok(picture)
    }

    /// Refuses options that have no meaning for this kind of file.
    fn refuse_useless(&self, drawing: &Drawing, ending: &str) -> Result<(), Error> {
        let film = matches!(self, Self::Film(_));
        let still = matches!(self, Self::Drawn(..));
        let meshes = matches!(self, Self::Meshes(_));
        let page = matches!(self, Self::Page(_));
        let pages = ("pages", &[Content::Page][..]);
        let pictures = ("pictures", &[Content::Png, Content::Svg][..]);
        let films = ("films", &[Content::Gif, Content::Mp4][..]);
        let drawn = ("pictures and films", &[pictures.1, films.1].concat()[..]);
        let moving = ("films and meshes", &[films.1, &[Content::Gltf]].concat()[..]);
        let options = [
            ("--with-planner", drawing.with_planner, page, pages),
            ("--size", drawing.size.is_some(), film || still, drawn),
            ("--mode", drawing.mode.is_some(), film || still, drawn),
            ("--camera", drawing.camera.is_some(), film || still, drawn),
            ("--field", drawing.field.is_some(), film || still, drawn),
            ("--animation", drawing.animation.is_some(), film || still, drawn),
            ("--at", drawing.at.is_some(), still, pictures),
            ("--turntable", drawing.turntable, film, films),
            ("--follow", drawing.follow, film, films),
            ("--seconds", drawing.seconds.is_some(), film || meshes, moving),
            ("--fps", drawing.fps.is_some(), film, films),
        ];
        match options.into_iter().find(|(_, given, used, _)| *given && !used) {
            None => Ok(()),
            Some((name, _, _, (what, of))) => {
                let of = Content::endings(|content| of.contains(&content));
                let what = format!("{name} has no meaning for a .{ending} file: it is for {what} ({of})");
                Err(Error::new(what).help("leave it out, or end the name of the file otherwise"))
            }
        }
    }

    /// Whether it shows what a run grows: its trees or its roadmap.
    pub(crate) fn shows_search(&self) -> bool {
        matches!(self, Self::Page(_) | Self::Scene)
    }

    /// Whether it is worth stopping.
    pub(crate) fn takes_long(&self) -> bool {
        matches!(self, Self::Film(_))
    }

    /// The bytes of the file; `None` when `cancel` was raised before they were complete. A page shows the report too, and
    /// what the run has `grown`, if there are any.
    pub(crate) fn bytes(
        &self,
        shown: &Shown<'_>,
        grown: Option<GrownTrees>,
        cancel: &Cancel,
        line: &Line,
    ) -> Result<Option<Vec<u8>>, Error> {
        let Shown { scene, path, verdict, report, caption } = *shown;
        match self {
            Self::Drawn(kind, look) => {
                let (scene, path, caption) = (scene.clone(), path.cloned(), caption.to_owned());
                let (kind, look) = (*kind, look.clone());
                let draw = move || scene.picture(path.as_ref(), &caption, kind, &look);
                return within(&Interrupt::new(cancel.clone()), PATIENCE, draw)?.transpose();
            }
            Self::Film(film) => {
                let frames = film.frames();
                let mut say = |done: usize| line.say(&format!("drawing the film, {done} of {frames} frames"));
                return scene.film(path, caption, film, cancel, &mut say);
            }
            _ => {}
        }
        // A planner inside of the page says where things are.
        let plans = matches!(self, Self::Page(Some(_)));
        let mut file = if plans { SceneFile::of(scene) } else { SceneFile::for_file(scene) }?;
        match (report, path.zip(verdict)) {
            (Some(report), _) => file.add_run(scene, report)?,
            (None, Some((path, verdict))) => {
                file.add_judged_path(scene, "path", path, verdict.free, verdict.path_length)?;
            }
            (None, None) => {}
        }
        if let Some(grown) = grown {
            grown.add_to(&mut file);
        }
        Ok(Some(match self {
            Self::Page(None) => file.to_html().into_bytes(),
            Self::Page(Some(planner)) => {
                mp_view::page_with_files(&file, &planner.module, &planner.files).into_bytes()
            }
            Self::Meshes(seconds) => file.to_glb(*seconds),
            _ => file.to_bytes(),
        }))
    }
}
