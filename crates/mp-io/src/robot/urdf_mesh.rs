//! Finding the meshes that a URDF names: files relative to it, and files of packages.

use super::DescribedRobot;
use crate::robots::package_folders;
use mp_formats::files::{Disk, Files, percent_decoded};
use mp_formats::mesh::{Axes, MAX_COORDINATE, read_mesh_with, solid_mesh, vertex_beyond};
use mp_geom::TriMesh;
use std::path::{Path, PathBuf};

/// In how many folders, from that of the URDF upward, the files of a package of another name are looked for.
const RENAMED: usize = 4;

impl DescribedRobot {
    /// Reads a mesh that the URDF names: a file relative to the URDF, `file://` and an absolute name, or
    /// `package://PACKAGE/NAME`. A package is searched in the folder of packages that the problem gives, or else in the
    /// folders above the URDF, as `PACKAGE/NAME` and `share/PACKAGE/NAME`, and as `NAME` where the folder is called
    /// PACKAGE, and then in the folders of `ROS_PACKAGE_PATH` and `AMENT_PREFIX_PATH`; last as NAME in the folder of the URDF and the three above it, with a remark, for packages that have
    /// another name there. `package:///NAME` names no package: `NAME` is searched in the same folders. `model://` means the same as `package://`. If there is no such file, `%20` and the like
    /// stand for the characters of a URI.
    ///
    /// It is a solid if the problem says so.
    ///
    /// # Errors
    /// A message that says which file was searched, and where, or why it is not usable.
    pub fn mesh(&self, name: &str) -> Result<TriMesh, String> {
        self.mesh_from(&Disk, name)
    }

    /// As [`mesh`](Self::mesh), with the file read through `files`.
    ///
    /// # Errors
    /// As [`mesh`](Self::mesh).
    pub fn mesh_from(&self, files: &dyn Files, name: &str) -> Result<TriMesh, String> {
        if let Some(made) = self.mjcf.as_ref().and_then(|mjcf| mjcf.made.get(name)) {
            return Ok(made.clone());
        }
        let place = self.place_of(files, name)?;
        let read = read_mesh_with(files, &place, Axes::OfFile);
        let read = read.and_then(|mesh| match self.solid && !files.only_reads() {
            true => solid_mesh(&place.display().to_string(), mesh),
            false => Ok(mesh),
        });
        let mesh = read.map_err(|e| match e.remedy() {
            Some(remedy) => format!("{e} ({remedy})"),
            None => e.to_string(),
        })?;
        match vertex_beyond(&mesh) {
            Some(_) => Err(format!("{} has a vertex beyond {MAX_COORDINATE:e} m", place.display())),
            None => Ok(mesh),
        }
    }

    /// The file of a mesh that the URDF names, as [`mesh`](Self::mesh) finds it; `None` when it is not there.
    #[must_use]
    pub fn mesh_file(&self, name: &str) -> Option<PathBuf> {
        self.place_of(&Disk, name).ok()
    }

    /// The file that a name means as it is, or else as a URI: with `%20` and the like as the characters for which they stand.
    fn place_of(&self, files: &dyn Files, name: &str) -> Result<PathBuf, String> {
        let literal = self.place_of_name(files, name);
        match percent_decoded(name) {
            Some(meant) if !literal.as_ref().is_ok_and(|place| files.holds(place)) => {
                self.place_of_name(files, &meant).ok().filter(|place| files.holds(place)).map_or(literal, Ok)
            }
            _ => literal,
        }
    }

    fn place_of_name(&self, files: &dyn Files, name: &str) -> Result<PathBuf, String> {
        let folder = self.urdf_file.parent().unwrap_or(Path::new(""));
        // Gazebo's models are folders that are found as packages are.
        let Some(inside) = name.strip_prefix("package://").or_else(|| name.strip_prefix("model://")) else {
            let here = name.strip_prefix("file://localhost").filter(|file| file.starts_with('/'));
            return Ok(folder.join(here.or_else(|| name.strip_prefix("file://")).unwrap_or(name)));
        };
        let (package, rest) = inside.split_once('/').unwrap_or((inside, ""));
        // With further slashes it would be an absolute name.
        let rest = rest.trim_start_matches('/');
        if rest.is_empty() {
            return Err(format!("{name} names no file: write package://PACKAGE/FILE"));
        }
        let start = self.packages.as_deref().unwrap_or(folder);
        let absolute = files.absolute(start).map_err(|e| {
            let whose = if self.packages.is_some() { "`packages` of the problem" } else { "of the URDF" };
            format!("{name} cannot be sought in the folder {whose}, {}: {e}", start.display())
        })?;
        let above = if self.packages.is_some() { 1 } else { usize::MAX };
        for folder in absolute.ancestors().take(above) {
            if let Some(found) = in_folder(files, folder, package, rest) {
                return Ok(found);
            }
        }
        if self.packages.is_none()
            && let Some(found) = package_folders().find_map(|folder| in_folder(files, &folder, package, rest))
        {
            return Ok(found);
        }
        // Packages are copied under other names.
        let renamed = || absolute.ancestors().take(RENAMED).map(|folder| folder.join(rest));
        if self.packages.is_none()
            && let Some(found) = renamed().find(|place| files.holds(place))
        {
            files.note(&found, &format!("the package {package} is not there; taken instead"));
            return Ok(found);
        }
        let (file, holds) = match package {
            "" => (rest.to_owned(), rest.split('/').next().unwrap_or(rest)),
            _ => (format!("{package}/{rest}"), package),
        };
        let start = absolute.display();
        Err(match self.packages {
            Some(_) => format!(
                "{name} is not there: {file} and share/{file} were sought in {start}, the folder `packages` of the \
                 problem; it must be the folder that holds {holds}"
            ),
            None => format!(
                "{name} is not there: {file} and share/{file} were sought in {start} and every folder above; say \
                 `packages = \"FOLDER\"` in the problem, the folder that holds {holds}"
            ),
        })
    }
}

/// The file `rest` of a package in or below `folder`, if it is there.
fn in_folder(files: &dyn Files, folder: &Path, package: &str, rest: &str) -> Option<PathBuf> {
    let in_package = |folder: PathBuf| folder.join(package).join(rest);
    let own = package.is_empty() || folder.file_name().is_some_and(|name| name == package);
    let places = [
        Some(in_package(folder.to_owned())),
        Some(in_package(folder.join("share"))),
        own.then(|| folder.join(rest)),
    ];
    places.into_iter().flatten().find(|place| files.holds(place))
}
