//! `robots`: the robots that can be named.

use crate::cli;
use crate::output::{note, print, print_json};
use mp_io::RobotPath;
use mp_plan::{Error, count};

/// Lists the robots, one on each line: name, joints, file. True when there is one.
pub(crate) fn run(args: &cli::Robots) -> Result<bool, Error> {
    let path = RobotPath::of_environment();
    let word = args.word.as_deref().unwrap_or_default().to_lowercase();
    let mut robots = path.all();
    robots.retain(|robot| robot.name.to_lowercase().contains(&word));
    if args.json {
        print_json(&robots)?;
        return Ok(!robots.is_empty());
    }
    let width = robots.iter().map(|robot| robot.name.chars().count()).max().unwrap_or(0);
    for robot in &robots {
        print(&format!("{:width$}  {:3} joints  {}", robot.name, robot.joints, robot.file.display()))?;
    }
    if robots.is_empty() {
        let folders: Vec<_> = path.folders().iter().map(|folder| folder.display().to_string()).collect();
        note(&format!("no robots in {}; set MP_ROBOTS to folders that hold URDFs", folders.join(", ")));
    } else {
        note(&count(robots.len(), "robot"));
    }
    Ok(!robots.is_empty())
}
