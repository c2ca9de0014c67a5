//! The SRDF of a robot that nobody has named: beside the URDF, or where MoveIt's packages have it.

use crate::robot::read_robot_text;
use mp_formats::files::Files;
use mp_formats::formats::Content;
use std::path::{Path, PathBuf};

/// An SRDF that was found.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FoundSrdf {
    /// The path of the SRDF.
    pub file: PathBuf,
    /// Its content.
    pub text: String,
}

/// How many folders above that of the URDF are looked at for packages of MoveIt.
const ABOVE: usize = 3;

/// The SRDF of the robot that `urdf` describes, in the file `file`, and the name of one in the first three folders that may be of another robot,
/// relative to the folder of the URDF.
///
/// It searches the folder of the URDF, the folder `srdf` in and beside it, and the folder `config` of each `*_moveit_config` in the folder of
/// the URDF and the three above, in this order, each by the alphabet. An SRDF is of this robot if it has the same `<robot name>` as the URDF.
/// Of several, it takes the one with the file name of the URDF, otherwise the first. If there is none, it takes the SRDF beside the URDF
/// with its file name, whatever robot that names.
pub(super) fn srdf_near(files: &dyn Files, file: &Path, urdf: &str) -> (Option<FoundSrdf>, Option<String>) {
    let folder = file.parent().unwrap_or(Path::new(""));
    let own = file.with_extension(Content::RobotSemantics.ending());
    let mut places = srdfs_in(files, folder);
    // Not all kinds of files know what else is in a folder.
    if !places.contains(&own) && files.holds(&own) {
        places.insert(0, own.clone());
    }
    places.extend(srdfs_in(files, &folder.join("srdf")));
    places.extend(srdfs_in(files, &folder.join("..").join("srdf")));
    let beside = places.first().cloned();
    let mut above = folder.to_owned();
    for _ in 0..=ABOVE {
        let packages = files.names_in(&above).into_iter().filter(|name| name.ends_with("_moveit_config"));
        places.extend(packages.flat_map(|name| srdfs_in(files, &above.join(name).join("config"))));
        above = above.join("..");
    }
    let read = |place: PathBuf| {
        let text = read_robot_text(files, &place).ok()?;
        Some(FoundSrdf { file: place, text })
    };
    let robot = robot_name(urdf);
    let is_own = |found: &FoundSrdf| robot.is_some() && robot_name(&found.text) == robot;
    let mut found: Vec<FoundSrdf> = places.into_iter().filter_map(read).collect();
    let of_robot = found.iter().position(|f| is_own(f) && f.file.file_stem() == own.file_stem());
    let of_robot = of_robot.or_else(|| found.iter().position(is_own));
    let chosen = of_robot.or_else(|| found.iter().position(|f| f.file == own));
    let name = |place: PathBuf| place.strip_prefix(folder).unwrap_or(&place).display().to_string();
    (chosen.map(|at| found.swap_remove(at)), beside.map(name))
}

/// The SRDFs in a folder, by the alphabet.
fn srdfs_in(files: &dyn Files, folder: &Path) -> Vec<PathBuf> {
    let is_one =
        |name: &String| Content::of(Path::new(name)).any(|content| content == Content::RobotSemantics);
    files.names_in(folder).into_iter().filter(is_one).map(|name| folder.join(name)).collect()
}

/// The name of the robot in the text of a URDF or SRDF.
#[must_use]
pub fn robot_name(text: &str) -> Option<String> {
    let mut rest = text;
    loop {
        rest = &rest[rest.find('<')?..];
        let skipped =
            [("<?", "?>"), ("<!--", "-->"), ("<!", ">")].iter().find(|(start, _)| rest.starts_with(start));
        match skipped {
            Some((_, end)) => rest = &rest[rest.find(end)? + end.len()..],
            None => break,
        }
    }
    // Blanks may be around `=`, and `>` in a value.
    while let Some((before, after)) = rest.split_once('=').filter(|(before, _)| !before.contains('>')) {
        let after = after.trim_start();
        let quote = after.chars().next().filter(|c| matches!(c, '"' | '\''))?;
        let (value, more) = after[1..].split_once(quote)?;
        if before.split_whitespace().last() == Some("name") {
            return Some(value.to_owned());
        }
        rest = more;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use mp_formats::files::Disk;

    /// As in packages of example-robot-data: the URDF is of "iCub", the SRDF of "icub".
    #[test]
    fn one_of_another_robot_is_named() {
        let dir = tempfile::tempdir().unwrap();
        let (robots, srdf) = (dir.path().join("robots"), dir.path().join("srdf"));
        std::fs::create_dir(&robots).unwrap();
        std::fs::create_dir(&srdf).unwrap();
        let near = || srdf_near(&Disk, &robots.join("a.urdf"), "<robot name='iCub'/>");
        assert_eq!(near(), (None, None));
        std::fs::write(srdf.join("icub.srdf"), "<robot name='icub'/>").unwrap();
        assert_eq!(near(), (None, Some(Path::new("../srdf/icub.srdf").display().to_string())));
        std::fs::write(srdf.join("other.srdf"), "<robot name='iCub'/>").unwrap();
        assert_eq!(near().0.map(|found| found.file), Some(robots.join("../srdf/other.srdf")));
    }

    #[test]
    fn robots_have_names() {
        let of = |text: &str| robot_name(text);
        assert_eq!(
            of("<?xml version=\"1.0\"?>\n<!-- <robot name=\"no\"> -->\n<robot\n name='a b'>").unwrap(),
            "a b"
        );
        assert_eq!(of("<robot version=\"1\" name=\"panda\" />").unwrap(), "panda");
        for text in [
            "<robot name = 'r'>",
            "<robot\txmlns:name='a>b' name=\n\"r\">",
            "<robot note=\"name='x'\" name ='r'/>",
        ] {
            assert_eq!(of(text).as_deref(), Some("r"), "{text}");
        }
        assert_eq!(of("<robot><link name='l'>"), None);
        assert_eq!((of("<robot>"), of(""), of("<robot name=\"x"), of("<!-- ")), (None, None, None, None));
    }
}
