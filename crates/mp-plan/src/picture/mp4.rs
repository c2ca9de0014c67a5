//! MP4 files, made by the program ffmpeg.

use crate::Error;
use mp_render::Picture;
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::process::{Child, ChildStdin, Command, Stdio};
use tempfile::TempDir;

/// An ffmpeg that is fed frames. Dropped before the end, it is stopped, and nothing is left behind.
pub(crate) struct Mp4 {
    child: Child,
    frames: Option<ChildStdin>,
    /// Has the film, and what ffmpeg says.
    folder: TempDir,
}

const FILM: &str = "film.mp4";
const LOG: &str = "log.txt";

impl Mp4 {
    /// A film of frames with `size` pixels, both even; `rate` frames per second.
    pub(crate) fn new((width, height): (usize, usize), rate: f64) -> Result<Self, Error> {
        let unmade = |e: std::io::Error| Error::new(format!("cannot make a folder for temporary files: {e}"));
        let folder = tempfile::tempdir().map_err(unmade)?;
        let log = File::create(folder.path().join(LOG)).map_err(unmade)?;
        let (size, rate) = (format!("{width}x{height}"), rate.to_string());
        // One thread and nothing about time or machine in the file: the same frames give the same bytes.
        let mut command = Command::new("ffmpeg");
        // Ctrl-C is for this program, which then stops ffmpeg.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let child = command
            .args(["-hide_banner", "-loglevel", "error", "-y"])
            .args([
                "-f",
                "rawvideo",
                "-pix_fmt",
                "rgb24",
                "-video_size",
                &size,
                "-framerate",
                &rate,
                "-i",
                "-",
            ])
            .args(["-an", "-threads", "1", "-c:v", "libx264", "-crf", "20"])
            .args(["-vf", "scale=out_color_matrix=bt709:out_range=tv", "-pix_fmt", "yuv420p"])
            .args(["-colorspace", "bt709", "-color_primaries", "bt709", "-color_trc", "bt709"])
            .args(["-map_metadata", "-1", "-fflags", "+bitexact", "-flags:v", "+bitexact"])
            .args(["-movflags", "+faststart"])
            .arg(folder.path().join(FILM))
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .stderr(log)
            .spawn();
        let mut child = child.map_err(|e| match e.kind() {
            ErrorKind::NotFound => Error::new("the program ffmpeg, which makes MP4 files, is not installed").help(
                "install it (apt install ffmpeg, brew install ffmpeg, winget install ffmpeg), or end the name in .gif",
            ),
            _ => Error::new(format!("cannot start ffmpeg, which makes MP4 files: {e}"))
                .help("end the name in .gif"),
        })?;
        let frames = child.stdin.take();
        Ok(Self { child, frames, folder })
    }

    /// Adds a frame.
    pub(crate) fn add(&mut self, picture: &Picture) -> Result<(), Error> {
        let written = self.frames.as_mut().map(|frames| frames.write_all(picture.rgb()));
        match written {
            Some(Ok(())) => Ok(()),
            Some(Err(e)) => Err(self.failed(&e.to_string())),
            None => Err(self.failed("it takes no frames")),
        }
    }

    /// The content of the file.
    pub(crate) fn finish(mut self) -> Result<Vec<u8>, Error> {
        drop(self.frames.take());
        let status = self.child.wait().map_err(|e| self.failed(&e.to_string()))?;
        if !status.success() {
            return Err(self.failed(&status.to_string()));
        }
        std::fs::read(self.folder.path().join(FILM)).map_err(|e| self.failed(&e.to_string()))
    }

    /// The error with what ffmpeg says, or `else_` if it says nothing.
    fn failed(&mut self, else_: &str) -> Error {
        drop(self.frames.take());
        let _ = self.child.wait();
        let log = std::fs::read(self.folder.path().join(LOG)).unwrap_or_default();
        let log = String::from_utf8_lossy(&log);
        let lines: Vec<&str> = log.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
        let said = if lines.is_empty() {
            else_.to_owned()
        } else {
            lines[lines.len().saturating_sub(3)..].join("; ")
        };
        Error::new(format!("ffmpeg could not make the MP4: {said}"))
            .help("an ffmpeg with libx264 is needed; or end the name in .gif")
    }
}

impl Drop for Mp4 {
    fn drop(&mut self) {
        drop(self.frames.take());
        if let Ok(None) = self.child.try_wait() {
            let _ = self.child.kill();
            let _ = self.child.wait();
        }
    }
}
