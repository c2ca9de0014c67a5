//! Robots by name: descriptions in the places where other programs keep them.

use mp_formats::formats::Content;
use serde::Serialize;
use std::collections::BTreeSet;
use std::env;
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

/// A description of a robot.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct FoundRobot {
    /// The name of its file, without ending.
    pub name: String,
    /// The path of the URDF or MJCF.
    pub file: PathBuf,
    /// How many joints move on their own.
    pub joints: usize,
}

/// The folders in which robots are looked for, the first one first.
///
/// ```
/// use mp_io::RobotPath;
/// let folder = tempfile::tempdir()?;
/// std::fs::create_dir(folder.path().join("urdf"))?;
/// let urdf = "<robot name='r'><joint name='j' type='continuous'/></robot>";
/// std::fs::write(folder.path().join("urdf/crane.urdf"), urdf)?;
/// let path = RobotPath::new([folder.path().to_owned()]);
/// assert_eq!(path.find("crane")[0].file, folder.path().join("urdf/crane.urdf"));
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RobotPath {
    folders: Vec<PathBuf>,
}

/// Folders are looked at this deep below those of the path.
const MAX_DEPTH: usize = 10;
/// No more files and folders are looked at below each folder of the path.
const MAX_ENTRIES: usize = 300_000;
/// A description that is larger is none.
const MAX_BYTES: u64 = 16 << 20;

impl RobotPath {
    /// These folders.
    pub fn new(folders: impl IntoIterator<Item = PathBuf>) -> Self {
        let mut known = BTreeSet::new();
        Self { folders: folders.into_iter().filter(|f| known.insert(f.clone())).collect() }
    }

    /// What the environment says: `MP_ROBOTS`, `ROS_PACKAGE_PATH` and `AMENT_PREFIX_PATH`, which are lists of folders, the cache of
    /// `robot_descriptions` for Python, and the packages of Python: those of `VIRTUAL_ENV`, `CONDA_PREFIX`, of the first `python3` on the
    /// `PATH`, and of the user.
    #[must_use]
    pub fn of_environment() -> Self {
        let folder = |name: &str| env::var_os(name).filter(|value| !value.is_empty()).map(PathBuf::from);
        let home = env::home_dir();
        let cache = folder("ROBOT_DESCRIPTIONS_CACHE")
            .or_else(|| Some(home.as_ref()?.join(".cache").join("robot_descriptions")));
        let on_path = || list("PATH").find(|bin| bin.join("python3").is_file())?.parent().map(Path::to_owned);
        let prefixes = [folder("VIRTUAL_ENV"), folder("CONDA_PREFIX"), on_path()];
        let user = home.as_ref().map(|home| home.join(".local"));
        // Debian keeps what is installed by hand apart.
        let system = prefixes[2].as_ref().filter(|prefix| *prefix == Path::new("/usr"));
        let system = system.map(|prefix| prefix.join("local"));
        let python =
            prefixes.into_iter().flatten().chain(user).chain(system).flat_map(|prefix| packages_of(&prefix));
        Self::new(list("MP_ROBOTS").chain(package_folders()).chain(cache).chain(python))
    }

    /// The folders that are searched, in this order.
    #[must_use]
    pub fn folders(&self) -> &[PathBuf] {
        &self.folders
    }

    /// All robots in URDF and MJCF, in the order of the folders, then of their files. A file that several folders of the path hold is there once.
    #[must_use]
    pub fn all(&self) -> Vec<FoundRobot> {
        let mut robots = self.descriptions();
        robots.retain(|robot| robot.joints > 0);
        robots
    }

    /// As [`all`](Self::all), and descriptions without joints that move, such as tables.
    #[must_use]
    pub fn descriptions(&self) -> Vec<FoundRobot> {
        let mut known = BTreeSet::new();
        let robots = self.folders.iter().flat_map(|folder| descriptions_below(folder, &|_| true));
        robots.filter(|robot| known.insert(robot.file.clone())).collect()
    }

    /// The robots called `name`: those of the first folder of the path that holds any. A name may have folders before it, as in
    /// `kuka/model`.
    #[must_use]
    pub fn find(&self, name: &str) -> Vec<FoundRobot> {
        let (wanted, last) = (Path::new(name), name.rsplit('/').next().unwrap_or(name));
        if last.is_empty() || wanted.is_absolute() {
            return Vec::new();
        }
        let is_it = |file: &Path| {
            file.file_stem().is_some_and(|stem| stem.eq_ignore_ascii_case(last))
                && file
                    .parent()
                    .is_some_and(|folder| folder.ends_with(wanted.parent().unwrap_or(Path::new(""))))
        };
        let arms = |folder: &PathBuf| -> Vec<FoundRobot> {
            descriptions_below(folder, &is_it).into_iter().filter(|robot| robot.joints > 0).collect()
        };
        let mut found = self.folders.iter().map(arms).find(|robots| !robots.is_empty()).unwrap_or_default();
        // A name that a URDF has means that.
        if found.iter().any(|robot| is_urdf(&robot.file)) {
            found.retain(|robot| is_urdf(&robot.file));
        }
        found
    }
}

/// The folders that a variable of the environment lists.
fn list(variable: &str) -> impl Iterator<Item = PathBuf> {
    let value = env::var_os(variable).unwrap_or_default();
    env::split_paths(&value).filter(|folder| !folder.as_os_str().is_empty()).collect::<Vec<_>>().into_iter()
}

/// The folders that hold the packages of ROS, by the environment.
pub(crate) fn package_folders() -> impl Iterator<Item = PathBuf> {
    list("ROS_PACKAGE_PATH").chain(list("AMENT_PREFIX_PATH").map(|prefix| prefix.join("share")))
}

/// The folders of Python's packages below `prefix`.
fn packages_of(prefix: &Path) -> Vec<PathBuf> {
    let versions = sorted(&prefix.join("lib"), 10_000).into_iter();
    let versions = versions.filter(|(name, _)| name.to_string_lossy().starts_with("python3"));
    let folders = versions.flat_map(|(name, _)| {
        ["site-packages", "dist-packages"].map(|packages| prefix.join("lib").join(&name).join(packages))
    });
    folders.chain([prefix.join("Lib").join("site-packages")]).filter(|folder| folder.is_dir()).collect()
}

/// What is in a folder, by the alphabet, and whether it is a folder itself.
fn sorted(folder: &Path, most: usize) -> Vec<(std::ffi::OsString, bool)> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().take(most);
    let entry = |entry: std::fs::DirEntry| Some((entry.file_name(), entry.file_type().ok()?.is_dir()));
    let mut entries: Vec<_> = entries.filter_map(entry).collect();
    entries.sort();
    entries
}

/// The robots below a folder of which `wanted` is true, by the alphabet. Links to folders are not followed.
fn descriptions_below(folder: &Path, wanted: &dyn Fn(&Path) -> bool) -> Vec<FoundRobot> {
    let passed_over = |name: &OsStr| {
        let name = name.to_string_lossy();
        name.starts_with('.')
            || name == "__pycache__"
            || name == "node_modules"
            || name.ends_with(".dist-info")
    };
    let (mut found, mut left) = (Vec::new(), MAX_ENTRIES);
    let mut pending = vec![(folder.to_owned(), 0)];
    while let Some((folder, depth)) = pending.pop() {
        let entries = sorted(&folder, left);
        left -= entries.len();
        let mut folders = Vec::new();
        for (name, is_folder) in entries {
            let path = folder.join(&name);
            if is_folder {
                folders.extend((depth < MAX_DEPTH && !passed_over(&name)).then_some((path, depth + 1)));
            } else if is_description(&path) && wanted(&path) {
                found.extend(described(path));
            }
        }
        pending.extend(folders.into_iter().rev());
    }
    found
}

/// Whether a file is called like a description that is read.
fn is_description(file: &Path) -> bool {
    is_urdf(file)
        || file.extension().is_some_and(|ending| MJCF.iter().any(|mjcf| ending.eq_ignore_ascii_case(mjcf)))
}

/// The endings of models of MuJoCo, which other files have too.
const MJCF: [&str; 2] = ["xml", "mjcf"];

fn is_urdf(file: &Path) -> bool {
    file.extension().is_some_and(|ending| ending.eq_ignore_ascii_case(Content::Robot.ending()))
}

fn described(file: PathBuf) -> Option<FoundRobot> {
    let bytes = mp_store::read(&file, MAX_BYTES).ok()?;
    let text = String::from_utf8_lossy(&bytes);
    let joints = match (is_urdf(&file), crate::mjcf::is_mjcf(&text)) {
        (true, false) => moving_joints(&text),
        (_, true) => moving_joints_of_mjcf(&text),
        (false, false) => return None,
    };
    let name = file.file_stem()?.to_string_lossy().into_owned();
    Some(FoundRobot { name, file, joints })
}

/// The text of an XML file without comments.
fn uncommented(text: &str) -> String {
    let (first, rest) = text.split_once("<!--").unwrap_or((text, ""));
    let after = rest.split("<!--").map(|part| part.split_once("-->").map_or("", |(_, rest)| rest));
    std::iter::once(first).chain(after).collect()
}

/// How many joints of a model of MuJoCo move on their own, without those of files that it includes.
fn moving_joints_of_mjcf(text: &str) -> usize {
    let text = uncommented(text);
    let bodies =
        text.split("<worldbody").skip(1).map(|part| part.split("</worldbody").next().unwrap_or(part));
    let joints = bodies.flat_map(|bodies| bodies.split("<joint").skip(1));
    let moves = |joint: &str| {
        let tag = joint.split('>').next().unwrap_or(joint);
        let is =
            |kind: &str| tag.contains(&format!("type=\"{kind}\"")) || tag.contains(&format!("type='{kind}'"));
        if is("free") {
            0
        } else if is("ball") {
            3
        } else {
            1
        }
    };
    joints.map(moves).sum()
}

/// How many joints of a URDF move on their own.
fn moving_joints(urdf: &str) -> usize {
    let text = uncommented(urdf);
    let moves = |joint: &str| {
        let (tag, inside) = joint.split_once('>').unwrap_or((joint, ""));
        let inside = if tag.ends_with('/') { "" } else { inside.split("</joint").next().unwrap_or(inside) };
        let is = |kind: &str| tag.contains(&format!("\"{kind}\"")) || tag.contains(&format!("'{kind}'"));
        match joint.starts_with(char::is_whitespace) && !inside.contains("<mimic") {
            true if is("planar") => 3,
            true => usize::from(["revolute", "continuous", "prismatic"].into_iter().any(is)),
            false => 0,
        }
    };
    text.split("<joint").skip(1).map(moves).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn write(folder: &Path, name: &str, text: &str) {
        let file = folder.join(name);
        std::fs::create_dir_all(file.parent().unwrap()).unwrap();
        std::fs::write(file, text).unwrap();
    }

    #[test]
    fn robots_are_found_by_name_in_the_order_of_the_path() {
        let (first, second) = (tempfile::tempdir().unwrap(), tempfile::tempdir().unwrap());
        let arm = "<robot name='r'><!-- <joint type='continuous'> --><joint name='a' type=\"revolute\"><limit/></joint>\
                   <joint name='b' type='prismatic'><mimic joint='a'/></joint><joint name='c' type='fixed'/></robot>";
        write(first.path(), "b/deep/arm.urdf", arm);
        write(first.path(), "a/other/Arm.urdf", arm);
        write(first.path(), "a/table.urdf", "<robot name='t'><link name='l'/></robot>");
        write(first.path(), ".hidden/arm.urdf", arm);
        let model = "<?xml?><!-- a --><mujoco><default><joint/></default><worldbody><body><joint/><!-- <joint/> --><freejoint/>\
                     <joint type='free'/><joint type=\"ball\"/></body></worldbody></mujoco>";
        write(first.path(), "m/arm.xml", model);
        write(first.path(), "m/hand.xml", model);
        write(first.path(), "a/package.xml", "<package><joint/></package>");
        write(second.path(), "arm.urdf", arm);
        write(second.path(), "crane.urdf", arm);
        let path =
            RobotPath::new([first.path().to_owned(), second.path().to_owned(), first.path().to_owned()]);
        let files =
            |robots: Vec<FoundRobot>| -> Vec<PathBuf> { robots.into_iter().map(|r| r.file).collect() };
        let [a, b] = ["a/other/Arm.urdf", "b/deep/arm.urdf"].map(|name| first.path().join(name));
        assert_eq!(files(path.find("arm")), [a.clone(), b.clone()]);
        assert_eq!(files(path.find("deep/arm")), std::slice::from_ref(&b));
        assert_eq!(files(path.find("crane")), [second.path().join("crane.urdf")]);
        assert!(
            path.find("table").is_empty() && path.find("/arm").is_empty() && path.find("a/arm").is_empty()
        );
        let hand = path.find("hand");
        assert!(hand.len() == 1 && hand[0].joints == 4, "{hand:?}");
        let mut all = path.all();
        all.retain(|robot| is_urdf(&robot.file));
        assert!(all.len() == 4 && all.iter().all(|robot| robot.joints == 1), "{all:?}");
        assert_eq!(files(all)[..2], [a, b]);
    }
}
