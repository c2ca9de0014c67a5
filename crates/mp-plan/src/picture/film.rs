//! Films of scenes and paths.

use crate::picture::mp4::Mp4;
use crate::picture::{World, failed, placed_bodies};
use crate::{Cancel, Error, Look, PathRows, Scene, Track, in_parallel};
use mp_io::Content;
use mp_render::{Animation, Gif, Moment, Picture, Shot};
use nalgebra::Point3;
use std::f64::consts::TAU;
use std::path::Path;

/// The most frames of a film.
const MAX_FRAMES: f64 = 100_000.0;
/// How many frames the palette of a GIF is made from.
const PALETTE_FRAMES: usize = 8;

/// A format of films.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum FilmKind {
    /// An animated GIF: at most 255 colours, plays everywhere, repeats.
    Gif,
    /// An MP4 with H.264, which the program ffmpeg makes: it must be installed.
    Mp4,
}

impl FilmKind {
    /// The kind of film for a file, by the ending of its name; `None` when it is not a film.
    #[must_use]
    pub fn of(file: &Path) -> Option<Self> {
        Content::of(file).find_map(|content| match content {
            Content::Gif => Some(Self::Gif),
            Content::Mp4 => Some(Self::Mp4),
            _ => None,
        })
    }
}

/// What a film shows, and how.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// The kind of file.
    pub kind: FilmKind,
    /// How frames are drawn; [`Look::at`] is not used.
    pub look: Look,
    /// Whether the robot moves along the path; otherwise all configurations are shown at once.
    pub step: bool,
    /// Whether the camera turns once around the scene.
    pub turntable: bool,
    /// Whether the camera moves with the robot.
    pub follow: bool,
    /// Its length, seconds.
    pub seconds: f64,
    /// Frames per second.
    pub rate: f64,
    /// How many frames are drawn at the same time. The film does not depend on it.
    pub threads: usize,
}

impl Film {
    /// A film of 8 s, 640 × 480 pixels and 20 frames per second, in which the robot moves along the path.
    #[must_use]
    pub fn new(kind: FilmKind) -> Self {
        Self {
            kind,
            look: Look { size: (640, 480), ..Look::default() },
            step: true,
            turntable: false,
            follow: false,
            seconds: 8.0,
            rate: 20.0,
            threads: 1,
        }
    }

    /// How many frames the film has: its seconds times its rate, within limits.
    #[must_use]
    pub fn frames(&self) -> usize {
        (self.seconds * self.rate).round().clamp(1.0, MAX_FRAMES) as usize
    }

    /// How far along the path frame `i` is, 0 to 1: the first is at the start, the last at the goal.
    fn progress(&self, i: usize) -> f64 {
        i as f64 / (self.frames() - 1).max(1) as f64
    }

    /// The angle by which the camera is turned in frame `i`, radians. The last frame is one step before the first.
    fn turn(&self, i: usize) -> f64 {
        TAU * i as f64 / self.frames() as f64
    }
}

/// What draws the frames of a film.
enum Stage<'s> {
    Space { shot: Shot<'s>, robot: Vec<mp_render::Body> },
    Plane(World),
}

impl Stage<'_> {
    fn frame(&self, film: &Film, track: &Track, i: usize) -> Result<Picture, Error> {
        let progress = film.progress(i);
        let (poses, point) = track.at(progress).unwrap_or((Vec::new(), Point3::origin()));
        match self {
            Self::Space { shot, robot } => {
                let robot = placed_bodies(robot, &poses);
                shot.picture(&Moment { robot, progress, turn: film.turn(i), centre: point }).map_err(failed)
            }
            Self::Plane(world) => {
                let now = film.step.then_some(poses.as_slice());
                let centre = film.follow.then(|| point.xy());
                world.drawing(now, centre).pixels(film.look.size).map_err(failed)
            }
        }
    }
}

/// A film that is being written.
enum Writer {
    Gif(Gif),
    Mp4(Mp4),
}

impl Scene {
    /// Refuses a film that cannot be made of this scene, before any work is done. `path` says whether there is a path.
    ///
    /// # Errors
    /// When nothing would move, the camera would follow nothing, or length, rate or size are not possible.
    pub fn check_film(&self, film: &Film, path: bool) -> Result<(), Error> {
        let wrong = |what: String, help: &str| Err(Error::new(what).help(help));
        if !path && film.follow {
            return wrong(
                "there is no path along which the camera could follow the robot".into(),
                "name a path",
            );
        }
        let moves = path && film.step;
        if !film.turntable && !moves {
            let what = match path {
                false => "nothing moves in this film: there is no path",
                true => "nothing moves in this film: all configurations are shown at once",
            };
            let help = match path {
                false => "name a path, or let the camera turn with --turntable",
                true => "let the robot move with --animation step, or the camera turn with --turntable",
            };
            return wrong(what.into(), help);
        }
        if self.is_planar_world() && film.turntable {
            let what = format!("{} is a world in the plane, around which no camera turns", self.name());
            return wrong(what, "leave out --turntable");
        }
        let frames = film.seconds * film.rate;
        let (positive, finite) = (film.seconds > 0.0 && film.rate > 0.0, frames.is_finite());
        if !positive || !finite || !(1.0..=MAX_FRAMES).contains(&frames.round()) {
            let what =
                format!("a film of {} s with {} frames per second cannot be made", film.seconds, film.rate);
            return wrong(what, "let it have from 1 to 100000 frames");
        }
        let most = if film.kind == FilmKind::Gif { Gif::MAX_RATE } else { 240.0 };
        if film.rate > most {
            let what = format!("{} frames per second are too many for this kind of film", film.rate);
            return wrong(what, &format!("take at most {most}"));
        }
        let (width, height) = film.look.size;
        if film.kind == FilmKind::Mp4 && (width % 2 == 1 || height % 2 == 1) {
            let what = format!("{width}x{height} pixels: an MP4 needs an even width and height");
            return wrong(what, "change --size by one pixel");
        }
        self.check_look(&Look { at: None, ..film.look.clone() }, path)
    }

    /// The bytes of a film of the scene, with the path if one is given, and `caption` below the name of the scene. The same
    /// film has the same bytes, on any number of threads (an MP4 also needs the same ffmpeg). `progress` gets the number of
    /// frames done. `None` when `cancel` was raised.
    ///
    /// # Errors
    /// As [`check_film`](Self::check_film); when the path is of another robot; for an MP4, when ffmpeg is missing or fails.
    pub fn film(
        &self,
        path: Option<&PathRows>,
        caption: &str,
        film: &Film,
        cancel: &Cancel,
        progress: &mut dyn FnMut(usize),
    ) -> Result<Option<Vec<u8>>, Error> {
        self.check_film(film, path.is_some())?;
        let track = path.map(|path| self.track(path)).transpose()?.unwrap_or_default();
        let film = &Film { step: film.step && path.is_some(), ..film.clone() };
        if self.is_planar_world() {
            let stage = Stage::Plane(self.world(path, caption, &film.look)?);
            return write(&stage, film, &track, cancel, progress);
        }
        let scene = self.solid(path, caption, &film.look)?;
        let Film { step, turntable, follow, .. } = *film;
        let shot = scene.shot(film.look.size, Animation { step, turntable, follow }).map_err(failed)?;
        write(&Stage::Space { shot, robot: self.robot_bodies() }, film, &track, cancel, progress)
    }
}

/// Draws and writes all frames.
fn write(
    stage: &Stage<'_>,
    film: &Film,
    track: &Track,
    cancel: &Cancel,
    progress: &mut dyn FnMut(usize),
) -> Result<Option<Vec<u8>>, Error> {
    let frames = |numbers: &[usize]| -> Result<Option<Vec<Picture>>, Error> {
        let draw = |k: usize| stage.frame(film, track, numbers[k]);
        let drawn = in_parallel(numbers.len(), film.threads, cancel, draw);
        let drawn: Option<Vec<_>> = drawn.into_iter().collect();
        drawn.map(|all| all.into_iter().collect()).transpose()
    };
    let count = film.frames();
    let mut writer = match film.kind {
        FilmKind::Mp4 => Writer::Mp4(Mp4::new(film.look.size, film.rate)?),
        FilmKind::Gif => {
            let samples = count.min(PALETTE_FRAMES);
            let numbers: Vec<usize> = (0..samples).map(|k| k * (count - 1) / (samples - 1).max(1)).collect();
            let Some(samples) = frames(&numbers)? else { return Ok(None) };
            Writer::Gif(Gif::new(&samples, film.rate).map_err(failed)?)
        }
    };
    // Few at a time, so that memory does not grow with the length of the film.
    let all: Vec<usize> = (0..count).collect();
    for numbers in all.chunks(4 * film.threads.max(1)) {
        let Some(drawn) = frames(numbers)? else { return Ok(None) };
        for picture in &drawn {
            match &mut writer {
                Writer::Gif(gif) => gif.add(picture),
                Writer::Mp4(mp4) => mp4.add(picture)?,
            }
        }
        progress(numbers[0] + drawn.len());
    }
    match writer {
        Writer::Gif(gif) => Ok(Some(gif.finish())),
        Writer::Mp4(mp4) => mp4.finish().map(Some),
    }
}
